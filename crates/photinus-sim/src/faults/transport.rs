//! What becomes of frames on their way: lost, shown twice, exchanged, torn.
//!
//! Numbers, times and gravity of frames go on as they should; pixels do not. A buffer that was filled too late or read too early
//! looks like this.

use photinus_io::Result;
use photinus_io::image::GreyImage;

use super::chance::Chance;
use super::{Shot, Shots, repainted};

/// A share of the frames never comes.
pub(super) fn dropped(shots: Shots<'_>, share: f64, chance: Chance) -> Shots<'_> {
    Box::new(shots.filter(move |shot| {
        shot.as_ref().map_or(true, |shot| chance.of_frame(shot.frame.index).share(0) >= share)
    }))
}

/// A share of the frames shows what the camera saw one frame earlier.
pub(super) fn duplicated(shots: Shots<'_>, share: f64, chance: Chance) -> Shots<'_> {
    late(shots, share, chance, |_, before, _| before.clone())
}

/// A share of the frames shows from some row on what the camera saw one frame earlier.
pub(super) fn torn(shots: Shots<'_>, share: f64, chance: Chance) -> Shots<'_> {
    late(shots, share, chance, |now, before, where_| {
        let row = 1 + (where_ * (now.height() - 1) as f64) as usize;
        let tear = row.min(now.height()) * now.width();
        repainted(now, [&now.pixels()[..tear], &before.pixels()[tear..]].concat())
    })
}

/// A share of the frames is made of itself, the one before, and a number between 0 and 1.
fn late<'a>(
    shots: Shots<'a>,
    share: f64,
    chance: Chance,
    mix: impl Fn(&GreyImage, &GreyImage, f64) -> GreyImage + 'a,
) -> Shots<'a> {
    let mut before: Option<GreyImage> = None;
    super::each(shots, move |shot| {
        let now = shot.frame.image.clone();
        let chance = chance.of_frame(shot.frame.index);
        let same_size =
            |before: &&GreyImage| (before.width(), before.height()) == (now.width(), now.height());
        if let Some(before) = before.as_ref().filter(same_size)
            && chance.share(0) < share
        {
            shot.frame.image = mix(&now, before, chance.share(1));
        }
        before = Some(now);
    })
}

/// Frames some of which have exchanged their pixels with the next one.
pub(super) struct Swapped<'a> {
    shots: Shots<'a>,
    share: f64,
    chance: Chance,
    waiting: Option<Result<Shot>>,
}

impl<'a> Swapped<'a> {
    pub(super) fn new(shots: Shots<'a>, share: f64, chance: Chance) -> Self {
        Self { shots, share, chance, waiting: None }
    }
}

impl Iterator for Swapped<'_> {
    type Item = Result<Shot>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Some(second) = self.waiting.take() {
            return Some(second);
        }
        let mut first = self.shots.next()?;
        if let Ok(shot) = &mut first
            && self.chance.of_frame(shot.frame.index).share(0) < self.share
        {
            self.waiting = self.shots.next();
            if let Some(Ok(second)) = &mut self.waiting {
                core::mem::swap(&mut shot.frame.image, &mut second.frame.image);
            }
        }
        Some(first)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Fault;
    use super::super::tests::{faulty, shot};
    use super::*;

    /// Frames of 16 pixels that all read their own number.
    fn numbered(count: u64) -> Vec<Shot> {
        (0..count).map(|number| shot(number, vec![(number % 251) as u8; 16], 4, 4)).collect()
    }

    /// Within four standard errors of a share.
    fn is_share(count: usize, of: usize, share: f64) -> bool {
        let (count, of) = (count as f64, of as f64);
        (count / of - share).abs() < 4.0 * (share * (1.0 - share) / of).sqrt()
    }

    #[test]
    fn so_many_frames_are_dropped_and_the_rest_keeps_its_numbers() {
        let left = faulty(Fault::Dropped(0.1), 3, numbered(10_000));
        assert!(is_share(10_000 - left.len(), 10_000, 0.1), "{}", left.len());
        assert!(left.iter().all(|shot| u64::from(shot.frame.image.pixels()[0]) == shot.frame.index % 251));
        assert!(left.windows(2).all(|two| two[0].frame.index < two[1].frame.index));
    }

    #[test]
    fn so_many_frames_show_the_one_before() {
        let shown = faulty(Fault::Duplicated(0.2), 3, numbered(10_000));
        assert!((0..).zip(&shown).all(|(number, shot)| shot.frame.index == number));
        let ago = |shot: &Shot| (shot.frame.index + 251 - u64::from(shot.frame.image.pixels()[0])) % 251;
        assert!(shown.iter().all(|shot| ago(shot) <= 1), "never older than one");
        let late = shown.iter().filter(|shot| ago(shot) == 1).count();
        assert!(is_share(late, 10_000, 0.2), "{late}");
    }

    #[test]
    fn so_many_pairs_are_exchanged() {
        let shown = faulty(Fault::Swapped(0.1), 3, numbered(10_000));
        assert_eq!(shown.len(), 10_000);
        let pixel = |shot: &Shot| u64::from(shot.frame.image.pixels()[0]);
        let off: Vec<usize> =
            (0..10_000).filter(|&i| pixel(&shown[i]) != shown[i].frame.index % 251).collect();
        for pair in off.chunks(2) {
            let [a, b] = [&shown[pair[0]], &shown[pair[1]]];
            assert_eq!((pixel(a), pixel(b)), (b.frame.index % 251, a.frame.index % 251));
        }
        // every frame that is not the second of a pair begins one with 0.1: 2 p / (1 + p) of all are in one
        assert!((off.len() as f64 / 10_000.0 - 0.2 / 1.1).abs() < 0.02, "{}", off.len());
    }

    #[test]
    fn a_torn_frame_ends_as_the_one_before() {
        let shown = faulty(Fault::Torn(0.5), 3, numbered(4000));
        let (mut torn, mut tears) = (0, [0; 4]);
        for shot in &shown {
            let (own, before) = (shot.frame.index % 251, (shot.frame.index + 250) % 251);
            let rows: Vec<u64> = shot.frame.image.pixels().chunks(4).map(|row| u64::from(row[0])).collect();
            let tear = rows.iter().take_while(|&&row| row == own).count();
            assert!(tear >= 1 && rows[tear..].iter().all(|&row| row == before), "{rows:?}");
            torn += usize::from(tear < 4);
            tears[tear - 1] += 1;
        }
        assert!(is_share(torn, 4000, 0.5), "{torn}");
        assert!(tears[..3].iter().all(|&count| is_share(count, 4000, 0.5 / 3.0)), "{tears:?}");
    }
}
