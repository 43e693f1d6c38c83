//! Which photos and LEDs tell more than they ask for: photos of four LEDs or more, LEDs of two photos or more.

use super::{FEWEST_LEDS, KnownDistance, LayoutError, LedSighting};

/// Indices of the sightings that count, of those that `are_good`.
pub(super) fn sightings(sightings: &[LedSighting], are_good: &[bool]) -> Vec<usize> {
    let mut used: Vec<usize> = (0..sightings.len()).filter(|&index| are_good[index]).collect();
    loop {
        let count =
            |of: &dyn Fn(&LedSighting) -> bool| used.iter().filter(|&&index| of(&sightings[index])).count();
        let kept: Vec<usize> = used
            .iter()
            .copied()
            .filter(|&index| {
                let LedSighting { photo, led, .. } = sightings[index];
                count(&|other| other.photo == photo) >= FEWEST_LEDS && count(&|other| other.led == led) >= 2
            })
            .collect();
        if kept.len() == used.len() {
            return used;
        }
        used = kept;
    }
}

/// Refuses photos that tell no more than they ask for, and distances between LEDs that they do not tell.
pub(super) fn check(used: &[LedSighting], distances: &[KnownDistance]) -> Result<(), LayoutError> {
    let (photos, leds) = counts(used);
    if photos < 2 || freedom(used, distances) < 1 {
        let unknown = (6 * photos + 3 * leds).saturating_sub(7);
        return Err(LayoutError::TooFew { photos, measured: 2 * used.len(), unknown });
    }
    let is_used = |led: usize| used.iter().any(|sighting| sighting.led == led);
    match distances.iter().find(|distance| !distance.leds.into_iter().all(is_used)) {
        Some(&KnownDistance { leds, distance_m, sigma_m }) => {
            Err(LayoutError::Distance { leds, distance_m, sigma_m })
        }
        None => Ok(()),
    }
}

/// Measured coordinates in excess of unknowns: origin, axes and scale are none of them.
pub(super) fn freedom(used: &[LedSighting], distances: &[KnownDistance]) -> i64 {
    let (photos, leds) = counts(used);
    let measured = 2 * used.len() + distances.len().saturating_sub(1);
    measured as i64 + 7 - (6 * photos + 3 * leds) as i64
}

fn counts(used: &[LedSighting]) -> (usize, usize) {
    let distinct = |mut numbers: Vec<usize>| {
        numbers.sort_unstable();
        numbers.dedup();
        numbers.len()
    };
    let (photos, leds) = used.iter().map(|sighting| (sighting.photo, sighting.led)).unzip();
    (distinct(photos), distinct(leds))
}
