//! What the frames before told: how bright the LEDs are, where clutter is, and how many neighbours there are, and where.
//!
//! In: of each frame its clutter, how many neighbours it has, where, the power of their LEDs and how it spreads, which of these do not show, and how far
//! they tilt. Out: the same over the last [`Memory::FRAMES`] frames.

use alloc::vec;
use alloc::vec::Vec;

use super::whereabouts::PerFrame;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::pose::{LightSpread, LogLight, Missed, Tilting};

/// Spread of the logarithm of light between neighbours, before any are compared: lobes, units, the lens towards its edge.
pub(super) const LOG_POWER_SIGMA: f64 = 0.35;
/// That is as sure as what so many neighbours would tell.
const SUPPOSED: f64 = 4.0;
/// The power of the LEDs is known from this many frames on.
const FEWEST: usize = 3;

/// How often a marker that must show does not is supposed to be as sure as what so many markers would tell, ...
const SUPPOSED_MARKERS: f64 = 50.0;
/// ... and all frames tell no more than so many: they show the same ones again.
const MOST_MARKERS: f64 = 200.0;

/// How far neighbours are supposed to tilt is as sure as what three of them would tell, each along two axes, ...
const SUPPOSED_TILTS: f64 = 6.0;
/// ... and all frames tell no more than twelve: they show the same ones again.
const MOST_TILTS: f64 = 24.0;

/// How far LEDs' light is supposed to spread is as sure as what so many of them would tell, ...
const SUPPOSED_LIGHTS: f64 = 6.0;
/// ... and all frames tell no more than so many: they show the same ones again.
const MOST_LIGHTS: f64 = 24.0;

/// What is remembered of a frame.
#[derive(Clone, Copy)]
pub(super) struct Frame<'a> {
    /// By cell of the image and of light.
    pub(super) clutter: &'a [f64],
    pub(super) neighbours: f64,
    /// By cell of the image and by distance.
    pub(super) whereabouts: &'a [f64],
    pub(super) power: Option<Told>,
    /// Of all its neighbours.
    pub(super) missed: Missed,
    /// Of those that are sure.
    pub(super) tilting: Tilting,
    /// Of the LEDs of those.
    pub(super) light_spread: LightSpread,
}

/// What a frame tells of the power of LEDs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Told {
    /// The light of an LED straight ahead at 1 m, as a logarithm.
    pub(super) log_power: f64,
    /// Whether a neighbour of three spots tells it: two are as well a nearer neighbour of weaker LEDs.
    pub(super) is_clear: bool,
    /// How neighbours of one frame differ in it, where there are enough to compare: only these are different vehicles.
    pub(super) spread: Option<Spread>,
}

/// How neighbours of one frame differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spread {
    pub(super) variance: f64,
    /// How many differences tell it.
    pub(super) freedom: f64,
}

impl Spread {
    /// Fewer neighbours tell nothing that one that is no vehicle could not change.
    const FEWEST: usize = 4;

    /// Of the logarithms of their light, ascending.
    pub(super) fn of(sorted: &[f64]) -> Option<Self> {
        (sorted.len() >= Self::FEWEST).then(|| {
            let sigma = sigma_of(sorted);
            Self { variance: sigma * sigma, freedom: (sorted.len() - 1) as f64 }
        })
    }
}

/// The value below which so many quarters of these are, ascending.
fn quartile(sorted: &[f64], quarters: usize) -> f64 {
    sorted[(sorted.len() - 1) * quarters / 4]
}

/// Standard deviation of these, ascending, whatever the outermost are: half of the width between the quartiles is two thirds of it.
fn sigma_of(sorted: &[f64]) -> f64 {
    (quartile(sorted, 3) - quartile(sorted, 1)) / 1.35
}

/// What each of the last frames counted by cell.
#[derive(Debug, Default)]
struct Counted {
    cells: usize,
    /// By frame and cell, and the sums by cell.
    frames: Vec<f64>,
    sums: Vec<f64>,
}

impl Counted {
    fn new(cells: usize) -> Self {
        Self { cells, frames: vec![0.0; cells * Memory::FRAMES], sums: vec![0.0; cells] }
    }

    /// Sums are made anew in one order, so that they are the same whenever the memory began.
    fn sum(&mut self, places: impl Iterator<Item = usize>) {
        self.sums.fill(0.0);
        for place in places {
            for (sum, count) in self.sums.iter_mut().zip(&self.frames[place * self.cells..]) {
                *sum += count;
            }
        }
    }
}

/// The last frames.
#[derive(Debug, Default)]
pub(super) struct Memory {
    frames: usize,
    next: usize,
    /// Clutter in the cells of the image, and of its light.
    clutter: Counted,
    /// Neighbours in the cells of the image, and by distance.
    whereabouts: Counted,
    powers: Vec<Option<Told>>,
    neighbours: Vec<f64>,
    missed: Vec<Missed>,
    tiltings: Vec<Tilting>,
    light_spreads: Vec<LightSpread>,
    sorted: Vec<f64>,
}

impl Memory {
    /// This many frames are remembered.
    pub(super) const FRAMES: usize = 64;

    /// Nothing yet, of images with this many cells of clutter, and of neighbours.
    pub(super) fn new(clutter: usize, whereabouts: usize) -> Self {
        Self {
            frames: 0,
            next: 0,
            clutter: Counted::new(clutter),
            whereabouts: Counted::new(whereabouts),
            powers: vec![None; Self::FRAMES],
            neighbours: vec![0.0; Self::FRAMES],
            missed: vec![Missed::default(); Self::FRAMES],
            tiltings: vec![Tilting::default(); Self::FRAMES],
            light_spreads: vec![LightSpread::default(); Self::FRAMES],
            sorted: Vec::with_capacity(Self::FRAMES),
        }
    }

    /// Forgets all frames.
    pub(super) fn forget(&mut self) {
        self.frames = 0;
        self.next = 0;
        self.clutter.sums.fill(0.0);
        self.whereabouts.sums.fill(0.0);
        self.powers.fill(None);
    }

    /// How many frames are remembered.
    pub(super) fn frames(&self) -> usize {
        self.frames
    }

    /// The clutter that they had in each cell, together.
    pub(super) fn clutter_by_cell(&self) -> &[f64] {
        &self.clutter.sums
    }

    /// The neighbours that they had in each cell and at each distance, together.
    pub(super) fn whereabouts(&self) -> PerFrame<'_> {
        PerFrame { sums: &self.whereabouts.sums, frames: self.frames }
    }

    /// How many neighbours each of them had.
    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> {
        (0..self.frames).map(|age| self.neighbours[self.aged(age)])
    }

    /// How often a marker that must show does not, where it is supposed to this often.
    pub(super) fn miss_rate(&self, supposed: f64) -> f64 {
        let told = |place: usize| (self.missed[place].missed, self.missed[place].expected);
        self.mean((supposed, SUPPOSED_MARKERS), MOST_MARKERS, told)
    }

    /// How far neighbours tilt, rad, where they are supposed to tilt this far: no less, for one that hovers upright now may tilt any moment.
    pub(super) fn tilt_sigma_rad(&self, supposed_rad: f64) -> f64 {
        let told = |place: usize| (self.tiltings[place].squares_rad2, self.tiltings[place].degrees);
        let mean_rad2 = self.mean((supposed_rad * supposed_rad, SUPPOSED_TILTS), MOST_TILTS, told);
        mean_rad2.sqrt().max(supposed_rad)
    }

    /// How many times as much as supposed the power of LEDs spreads: no less.
    pub(super) fn light_times(&self) -> f64 {
        let told = |place: usize| (self.light_spreads[place].squares, self.light_spreads[place].degrees);
        self.mean((1.0, SUPPOSED_LIGHTS), MOST_LIGHTS, told).sqrt().max(1.0)
    }

    /// The mean of what frames tell, by place each a sum and of how many, where a mean is supposed beforehand as surely as so many would tell it, and all frames
    /// tell no more than `most`.
    fn mean(&self, (supposed, as_many): (f64, f64), most: f64, told: impl Fn(usize) -> (f64, f64)) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for (of_frame, many) in (0..self.frames).map(|age| told(self.aged(age))) {
            sum += of_frame;
            count += many;
        }
        let share = if count > most { most / count } else { 1.0 };
        (as_many * supposed + share * sum) / (as_many + share * count)
    }

    /// The place of the frame this many frames ago.
    fn aged(&self, age: usize) -> usize {
        Self::before(self.next, age)
    }

    /// The place of the frame this many before the last one before `next`.
    fn before(next: usize, age: usize) -> usize {
        (next + Self::FRAMES - 1 - age) % Self::FRAMES
    }

    /// The light of an LED straight ahead at 1 m, where enough frames told it.
    pub(super) fn power(&mut self) -> Option<LogLight> {
        self.sorted.clear();
        let told = self.powers.iter().flatten();
        self.sorted.extend(told.clone().filter(|told| told.is_clear).map(|told| told.log_power));
        if self.sorted.len() < FEWEST {
            self.sorted.clear();
            self.sorted.extend(told.map(|told| told.log_power));
        }
        if self.sorted.len() < FEWEST {
            return None;
        }
        self.sorted.sort_unstable_by(f64::total_cmp);
        let sigma = libm::hypot(self.between_neighbours(), sigma_of(&self.sorted));
        Some(LogLight { value: quartile(&self.sorted, 2), sigma })
    }

    /// Standard deviation of the logarithm of light between neighbours. Frames show the same ones again, so all of them tell no more than one does.
    fn between_neighbours(&self) -> f64 {
        let (mut frames, mut freedom, mut squares) = (0.0, 0.0, 0.0);
        for spread in self.powers.iter().flatten().filter_map(|told| told.spread) {
            frames += 1.0;
            freedom += spread.freedom;
            squares += spread.freedom * spread.variance;
        }
        let (freedom, squares) = if frames > 0.0 { (freedom / frames, squares / frames) } else { (0.0, 0.0) };
        let supposed = SUPPOSED * LOG_POWER_SIGMA * LOG_POWER_SIGMA;
        ((supposed + squares) / (SUPPOSED + freedom)).sqrt()
    }

    /// Remembers a frame and forgets the oldest.
    pub(super) fn remember(&mut self, frame: Frame<'_>) {
        let Frame { clutter, neighbours, whereabouts, power, missed, tilting, light_spread } = frame;
        for (counted, counts) in [(&mut self.clutter, clutter), (&mut self.whereabouts, whereabouts)] {
            counted.frames[self.next * counted.cells..][..counted.cells].copy_from_slice(counts);
        }
        self.powers[self.next] = power;
        self.neighbours[self.next] = neighbours;
        self.missed[self.next] = missed;
        self.tiltings[self.next] = tilting;
        self.light_spreads[self.next] = light_spread;
        self.next = (self.next + 1) % Self::FRAMES;
        self.frames = (self.frames + 1).min(Self::FRAMES);
        let next = self.next;
        let places = (0..self.frames).map(move |age| Self::before(next, age));
        self.clutter.sum(places.clone());
        self.whereabouts.sum(places);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(log_power: f64) -> Told {
        Told { log_power, is_clear: false, spread: None }
    }

    /// A frame with a neighbour.
    fn of_power(power: Told) -> Frame<'static> {
        let missed = Missed::default();
        Frame {
            clutter: &[0.0],
            neighbours: 1.0,
            whereabouts: &[1.0],
            power: Some(power),
            missed,
            tilting: Tilting::default(),
            light_spread: LightSpread::default(),
        }
    }

    #[test]
    fn what_three_spots_tell_goes_before_what_two_do() {
        let mut memory = Memory::new(1, 1);
        for number in 0..Memory::FRAMES {
            let is_clear = number % 16 == 0;
            let log_power = if is_clear { 10.0 } else { 8.0 };
            memory.remember(of_power(Told { log_power, is_clear, spread: None }));
        }
        assert_eq!(memory.power(), Some(LogLight { value: 10.0, sigma: LOG_POWER_SIGMA }));
    }

    #[test]
    fn frames_older_than_the_last_are_forgotten() {
        let frame = |number: usize| {
            let clutter = [0.1 * (number % 7) as f64, 1.0 / (1 + number % 5) as f64];
            (clutter, (!number.is_multiple_of(3)).then_some(told(9.0 + 0.01 * (number % 11) as f64)))
        };
        let after = |first: usize| {
            let mut memory = Memory::new(2, 1);
            for number in first..200 {
                let (clutter, power) = frame(number);
                let neighbours = number as f64 % 3.0;
                let missed = Missed { expected: 3.0 * neighbours, missed: 0.1 * neighbours };
                let whereabouts = &[0.9 * neighbours];
                let tilting = Tilting { degrees: neighbours, squares_rad2: 0.03 * neighbours };
                memory.remember(Frame {
                    clutter: &clutter,
                    neighbours,
                    whereabouts,
                    power,
                    missed,
                    tilting,
                    light_spread: LightSpread { degrees: neighbours, squares: 1.5 * neighbours },
                });
            }
            (
                memory.frames(),
                [0, 1].map(|cell: usize| memory.clutter_by_cell()[cell].to_bits()),
                memory.numbers().sum::<f64>(),
                memory.whereabouts().sums[0].to_bits(),
                memory.power(),
                memory.miss_rate(0.02).to_bits(),
                memory.tilt_sigma_rad(0.1).to_bits(),
                memory.light_times().to_bits(),
            )
        };
        assert_eq!(after(0), after(200 - Memory::FRAMES));
        assert_ne!(after(0), after(200 - Memory::FRAMES / 2));
    }

    #[test]
    fn power_is_the_surer_the_more_alike_neighbours_of_one_frame_are() {
        let sigma = |neighbours: usize, apart: f64, frames: usize| {
            let mut memory = Memory::new(1, 1);
            let powers: Vec<f64> = (0..neighbours).map(|own| 9.0 + apart * own as f64).collect();
            for _ in 0..frames {
                let spread = Spread::of(&powers);
                memory.remember(of_power(Told { log_power: 9.0, is_clear: true, spread }));
            }
            memory.power().unwrap().sigma
        };
        assert!((sigma(3, 0.0, 8) - LOG_POWER_SIGMA).abs() < 1e-12);
        assert!(sigma(9, 0.02, 8) < 0.25 && sigma(17, 0.01, 8) < sigma(9, 0.02, 8));
        assert!((sigma(9, 0.02, 8) - sigma(9, 0.02, 64)).abs() < 1e-12, "the same neighbours again");
        assert!(sigma(9, 0.25, 8) > 0.5);
    }

    #[test]
    fn power_that_changes_is_known_as_badly_as_it_changes() {
        let mut memory = Memory::new(1, 1);
        assert_eq!(memory.power(), None);
        for number in 0..Memory::FRAMES {
            memory.remember(of_power(told(if number % 2 == 0 { 8.0 } else { 10.0 })));
        }
        let LogLight { value, sigma } = memory.power().unwrap();
        assert!((8.0..=10.0).contains(&value) && sigma > 1.0, "{value} {sigma}");
    }

    #[test]
    fn how_often_markers_are_missed_is_told_by_frames_but_never_for_sure() {
        let after = |frames: usize, missed: f64| {
            let mut memory = Memory::new(1, 1);
            for _ in 0..frames {
                let missed = Missed { expected: 4.0, missed };
                memory.remember(Frame { missed, ..of_power(told(9.0)) });
            }
            memory.miss_rate(0.02)
        };
        assert!((after(0, 0.0) - 0.02).abs() < 1e-12);
        assert!((after(10, 1.0) - (1.0 + 10.0) / (50.0 + 40.0)).abs() < 1e-12);
        assert!((after(64, 1.0) - (1.0 + 50.0) / 250.0).abs() < 1e-12, "no more than 200 markers");
        assert!((after(64, 0.0) - 1.0 / 250.0).abs() < 1e-12);
    }

    #[test]
    fn how_far_neighbours_tilt_is_told_by_frames_but_never_to_be_less_than_supposed() {
        let after = |frames: usize, squares_rad2: f64| {
            let mut memory = Memory::new(1, 1);
            for _ in 0..frames {
                let tilting = Tilting { degrees: 1.5, squares_rad2 };
                memory.remember(Frame { tilting, ..of_power(told(9.0)) });
            }
            let sigma_rad = memory.tilt_sigma_rad(0.1);
            sigma_rad * sigma_rad
        };
        assert!((after(0, 0.0) - 0.01).abs() < 1e-12);
        assert!((after(8, 0.12) - (0.06 + 0.96) / (6.0 + 12.0)).abs() < 1e-12);
        assert!((after(64, 0.12) - (0.06 + 24.0 * 0.08) / 30.0).abs() < 1e-12, "no more than 24 tilts");
        assert!((after(64, 0.0) - 0.01).abs() < 1e-12);
    }
}
