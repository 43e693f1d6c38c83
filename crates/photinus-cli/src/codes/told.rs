//! What a book has, as facts and notes.

use photinus::identity::{CodeBook, Properties};

use crate::info::{Report, counted};

/// What a user should know of a book.
pub(crate) fn report(book: &CodeBook) -> Report {
    let has = Properties::of(book);
    let mut report = Report::new("blink sequences");
    report.fact("words", format!("{} of {}", book.words().len(), counted(book.length(), "bit")));
    if let Some((distance, [a, b])) = has.distance {
        let corrects = counted(distance.saturating_sub(1) as usize / 2, "wrong bit");
        report.fact(
            "distance",
            format!("{distance} at any shift, words {a} and {b}: corrects {corrects} in a round"),
        );
    }
    if let Some((distance, word)) = has.self_distance {
        report.fact("from own shifts", format!("{distance}, word {word}"));
    }
    report.fact("from steady light", has.steady_distance.to_string());
    report.fact("longest dark run", counted(has.longest_dark, "frame"));
    report.fact("longest lit run", counted(has.longest_lit, "frame"));
    let [least, most] = has.duty.map(|duty| format!("{duty:.2}"));
    report.fact("duty", if least == most { least } else { format!("{least} to {most}") });
    let after = |bits: Option<usize>| bits.map_or("never".to_owned(), |bits| counted(bits, "frame"));
    report.fact("word known after", after(has.unique_after));
    report.fact("phase known after", after(has.in_phase_after));
    report.notes = notes(book, &has);
    report
}

fn notes(book: &CodeBook, has: &Properties) -> Vec<String> {
    let mut notes = Vec::new();
    if book.words().iter().any(|word| word.ones() == 0) {
        notes.push("a word that is never on shows no marker".to_owned());
    }
    if has.steady_distance == 0 {
        notes.push("a word that is always on looks like any lamp".to_owned());
    }
    match has.distance {
        Some((0, [a, b])) => notes.push(format!(
            "words {a} and {b} are the same but for their beginning: they cannot be told apart"
        )),
        Some((distance @ 1..=2, [a, b])) => {
            let bits = counted(distance as usize, "bit");
            notes.push(format!("words {a} and {b} differ in {bits}: one wrong bit makes them alike"));
        }
        _ => {}
    }
    if let Some((0, word)) = has.self_distance {
        notes.push(format!("word {word} repeats itself before its end: its phase has more than one answer"));
    }
    notes
}
