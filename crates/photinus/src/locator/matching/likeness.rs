//! What a handful of spots in order looks like: what a first look tells before anything is known of the power of the LEDs.
//!
//! The same handfuls are asked for again and again while a frame is sorted out; each is compared with the views once.

use alloc::boxed::Box;
use alloc::vec;

use super::image::Image;
use super::ordered::{Best, Ordered};
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::lanes::{self, Lanes};
use crate::locator::Sighting;
use crate::locator::views::MOST_ORDERED;
use crate::pose::LogLight;

/// Views that cost this much more than the best, nats, add nothing that a sum in 32 bits would show.
const WEIGHTLESS_NATS: f32 = 20.0;

/// The view that a handful looks like, all views taken together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Likeness {
    /// What the views cost, nats.
    pub(super) views_nats: f64,
    /// Where it is if it looks like the best of them, m.
    pub(super) distance_m: f64,
    /// Mean of the logarithms of its markers' intensities then.
    log_intensity: f64,
    /// How much more powerful its LEDs are on average over the views than as the best of them, as a logarithm, and the variance over the views.
    log_power_off: f64,
    log_power_variance: f64,
    /// Logarithm of the density of its places and of its lights against each other, as all views together have it at whatever distance.
    pub(super) log_density: f64,
    /// Whether some of its spots have a light.
    pub(super) is_lit: bool,
}

impl Likeness {
    /// Of the costs of the views, in which places and lights have this density where they are as a view has them.
    pub(super) fn of(
        seen: &Ordered,
        image: &Image<'_>,
        best: &Best<'_>,
        costs: &[Lanes],
        (log_peak, is_lit): (f64, bool),
    ) -> Self {
        let (least, most) = (Lanes::splat(best.nats), Lanes::splat(best.nats + WEIGHTLESS_NATS));
        let of_best = Lanes::splat(best.arrangement.far_log_power() as f32);
        let [mut weight, mut first, mut second] = [Lanes::ZERO; 3];
        for (&four, quad) in costs.iter().zip(best.quads).filter(|(four, _)| four.simd_lt(most).any()) {
            let (each, off) = (lanes::exp(least - four), quad.log_power - of_best);
            weight += each;
            first += each * off;
            second += each * off * off;
        }
        let [weight, first, second] = [weight, first, second].map(|sum| f64::from(lanes::sum(sum)));
        let off = first / weight;
        let views_nats = f64::from(best.nats) - libm::log(weight);
        Self {
            views_nats,
            log_power_off: off,
            log_power_variance: (second / weight - off * off).max(0.0),
            distance_m: seen.place(best.arrangement, image).0.norm(),
            log_intensity: best.arrangement.mean_log_intensity,
            log_density: log_peak - views_nats,
            is_lit,
        }
    }

    /// Logarithm of the light that an LED of the group then has straight ahead at 1 m; `None` where a spot has no light.
    pub(super) fn log_power(&self, sightings: &[Sighting], group: &[usize]) -> Option<f64> {
        let sum = group.iter().try_fold(0.0, |sum, &spot| Some(sum + sightings[spot].log_light?.value))?;
        Some(sum / group.len() as f64 + 2.0 * libm::log(self.distance_m) - self.log_intensity)
    }

    /// The same of all views together: they have a group at many distances.
    pub(super) fn log_power_of_views(&self, sightings: &[Sighting], group: &[usize]) -> Option<LogLight> {
        let value = self.log_power(sightings, group)? + self.log_power_off;
        Some(LogLight { value, sigma: self.log_power_variance.sqrt() })
    }
}

/// Spots, ascending, as few as have an order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Handful {
    spots: [usize; MOST_ORDERED],
    count: usize,
}

impl Handful {
    /// `None` for more spots than have an order.
    pub(super) fn of(group: &[usize]) -> Option<Self> {
        let mut spots = [0; MOST_ORDERED];
        spots.get_mut(..group.len())?.copy_from_slice(group);
        spots[..group.len()].sort_unstable();
        Some(Self { spots, count: group.len() })
    }

    pub(super) fn spots(&self) -> &[usize] {
        &self.spots[..self.count]
    }

    /// Where it is kept.
    fn place(&self) -> usize {
        let mixed = |mixed: u64, &spot: &usize| (mixed ^ spot as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let mixed = self.spots().iter().fold(self.count as u64, mixed);
        (mixed >> (u64::BITS - PLACES.ilog2())) as usize
    }
}

/// Places for handfuls: a frame of dozens of neighbours, or of hundreds of points of clutter, finds nearly all of its own again.
const PLACES: usize = 8192;

/// What handfuls of a frame look like; `None` where a handful cannot be one neighbour. One that comes to the place of another takes it.
#[derive(Debug)]
pub(super) struct Likenesses {
    frame: u32,
    places: Box<[Place]>,
}

#[derive(Clone, Copy, Debug)]
struct Place {
    frame: u32,
    handful: Handful,
    likeness: Option<Likeness>,
}

impl Likenesses {
    /// None yet.
    pub(super) fn none() -> Self {
        let empty =
            Place { frame: 0, handful: Handful { spots: [0; MOST_ORDERED], count: 0 }, likeness: None };
        Self { frame: 1, places: vec![empty; PLACES].into_boxed_slice() }
    }

    /// Forgets them all: spots of another frame.
    pub(super) fn forget(&mut self) {
        self.frame = self.frame.wrapping_add(1);
        if self.frame == 0 {
            // What is left of as many frames ago must not seem to be of this one.
            self.places.iter_mut().for_each(|place| place.frame = 0);
            self.frame = 1;
        }
    }

    pub(super) fn of(&self, handful: &Handful) -> Option<Option<Likeness>> {
        let place = &self.places[handful.place()];
        (place.frame == self.frame && place.handful == *handful).then_some(place.likeness)
    }

    pub(super) fn keep(&mut self, handful: Handful, likeness: Option<Likeness>) {
        self.places[handful.place()] = Place { frame: self.frame, handful, likeness };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn likeness(distance_m: f64) -> Option<Likeness> {
        Some(Likeness {
            views_nats: 0.0,
            distance_m,
            log_intensity: 0.0,
            log_power_off: 0.0,
            log_power_variance: 0.0,
            log_density: 0.0,
            is_lit: true,
        })
    }

    #[test]
    fn a_handful_finds_its_own_likeness_and_no_other() {
        let mut kept = Likenesses::none();
        let group = |number: usize| [number, number + 7, 3 * number];
        for number in 0..3 * PLACES {
            let handful = Handful::of(&group(number)[..2 + number % 2]).unwrap();
            assert!(kept.of(&handful).is_none());
            kept.keep(handful, likeness(number as f64));
            let mut other_order = group(number)[..2 + number % 2].to_vec();
            other_order.reverse();
            let same = Handful::of(&other_order).unwrap();
            let found = kept.of(&same).flatten().unwrap();
            assert_eq!(found.distance_m.to_bits(), (number as f64).to_bits());
        }
        kept.forget();
        assert!((0..3 * PLACES).all(|number| kept.of(&Handful::of(&group(number)).unwrap()).is_none()));
    }

    #[test]
    fn what_cannot_be_is_kept_too_and_more_spots_have_no_order() {
        let mut kept = Likenesses::none();
        let handful = Handful::of(&[4, 2]).unwrap();
        kept.keep(handful, None);
        assert!(kept.of(&handful).is_some_and(|likeness| likeness.is_none()));
        assert!(Handful::of(&[0; MOST_ORDERED + 1]).is_none());
    }
}
