//! Designed books against brute force that shares nothing with the search.

use super::*;
use proptest::prelude::*;

fn quick() -> Effort {
    Effort { seed: 1, work: 500_000, branches: 50_000 }
}

/// The size of the largest set without conflicts, by trying with and without each in turn.
fn most(words: &[Word], distance: u32) -> usize {
    let Some((first, rest)) = words.split_first() else { return 0 };
    let is_far = |other: &&Word| first.cyclic_distance(other).unwrap() >= distance;
    let without = most(rest, distance);
    let fitting: Vec<Word> = rest.iter().filter(is_far).copied().collect();
    without.max(1 + most(&fitting, distance))
}

#[test]
fn small_books_are_the_most_by_trying_all() {
    for (length, distance) in [(5, 1), (6, 2), (7, 2), (7, 3), (8, 3), (9, 4), (9, 3)] {
        let requirements = Requirements::new(length, distance).unwrap().with_longest_run(length - 2);
        let designed = design(&requirements, quick()).unwrap();
        let all = requirements.candidates().unwrap();
        assert_eq!(designed.book.words().len(), most(&all, distance), "{length} bits, distance {distance}");
        assert!(designed.is_the_most() && requirements.are_met_by(&designed.book));
    }
}

#[test]
fn circles_are_counted_as_necklaces_are() {
    // aperiodic necklaces of two colours: OEIS A001037
    for (length, count) in [(2, 1), (3, 2), (4, 3), (6, 9), (10, 99), (12, 335)] {
        assert_eq!(Requirements::new(length, 1).unwrap().candidates().unwrap().len(), count);
    }
}

#[test]
fn what_cannot_be_designed_is_said() {
    assert_eq!(Requirements::new(1, 3), Err(Unmet::Length(1)));
    assert_eq!(Requirements::new(25, 3), Err(Unmet::Length(25)));
    let none = Requirements::new(9, 3).unwrap().with_longest_run(1);
    assert_eq!(design(&none, quick()).unwrap_err(), Unmet::NoWord);
    let many = Requirements::new(19, 3).unwrap();
    assert_eq!(design(&many, quick()).unwrap_err(), Unmet::TooMany(27_594));
    let narrow = Requirements::new(8, 3).unwrap().with_duty(0.4..=0.6);
    let designed = design(&narrow, quick()).unwrap();
    assert!(designed.book.words().iter().all(|word| word.ones() == 4));
}

#[test]
fn the_same_effort_gives_the_same_book_and_more_effort_no_smaller_one() {
    let requirements = Requirements::new(13, 3).unwrap().with_longest_run(3);
    let few = Effort { branches: 0, ..quick() };
    let [one, again] = [0, 0].map(|_| design(&requirements, few).unwrap());
    assert_eq!(one, again);
    let more = design(&requirements, Effort { work: 5_000_000, ..few }).unwrap();
    assert!(more.book.words().len() >= one.book.words().len());
    assert!(requirements.are_met_by(&one.book) && requirements.are_met_by(&more.book));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Found is never more than the bound, and where all sets are tried, both searches agree with it.
    #[test]
    fn bounds_hold(length in 4..11_usize, distance in 1..6_u32, run in 2..6_usize, seed in any::<u64>()) {
        let requirements = Requirements::new(length, distance).unwrap().with_longest_run(run);
        let Ok(words) = requirements.candidates() else { return Ok(()) };
        let conflicts = Conflicts::among(&words, distance);
        let grown = local_search::grow(&conflicts, Effort { seed, ..quick() });
        let bound = bound::at_most(&conflicts, &requirements, &words);
        prop_assert!(grown.len() <= bound, "{} of {bound}", grown.len());
        if let exact::Outcome::Most(most) = exact::search(&conflicts, &[], 20_000) {
            prop_assert!(grown.len() <= most.len() && most.len() <= bound, "{} {} {bound}", grown.len(), most.len());
            let apart = |&a: &usize, &b: &usize| words[a].cyclic_distance(&words[b]).unwrap() >= distance;
            prop_assert!(most.iter().all(|a| most.iter().all(|b| a == b || apart(a, b))));
        }
    }
}
