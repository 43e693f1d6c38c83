//! How many neighbours frames had -> how dense neighbours are in this one.
//!
//! In: the numbers of the frames that are remembered, and how many the frame has. Out: the density of neighbours, and how much less likely one more is where so many others are
//! there already. Were numbers drawn anew in each frame, from those of a Poisson process, one more would be as likely however many there are: after a hundred frames of one vehicle a lamp
//! would be a second one every other time. Frames show the same vehicles again, and their numbers scatter by less.

use core::f64::consts::TAU;

use super::memory::Memory;

/// However seldom neighbours were, there are this many per frame.
const FEWEST_NEIGHBOURS: f64 = 0.2;
/// That numbers scatter as those of a Poisson process is as sure as what so many frames would tell.
const SUPPOSED_FRAMES: f64 = 4.0;

/// The numbers of neighbours that are remembered.
#[derive(Clone, Copy, Debug)]
pub(super) struct Number {
    /// One more than all that were there, in two frames more.
    all: f64,
    frames: f64,
    /// As many are no surprise: the mean, and a standard deviation more.
    usual: f64,
    /// How much more surely they are known than those of a Poisson process: the difference of one over the variance.
    steadiness: f64,
    /// The logarithm of how often, of as many frames as are remembered and two more, what never changed may (rule of succession).
    rarest_change: f64,
}

impl Number {
    pub(super) fn of(memory: &Memory) -> Self {
        let (all, frames) = (1.0 + memory.numbers().sum::<f64>(), 2.0 + memory.frames() as f64);
        let remembered = memory.frames().max(1) as f64;
        // One may always come.
        let mean = ((all - 1.0) / remembered).max(1.0);
        let squares: f64 = memory.numbers().map(|number| (number - mean) * (number - mean)).sum();
        let variance = (SUPPOSED_FRAMES * mean + squares) / (SUPPOSED_FRAMES + memory.frames() as f64);
        let steadiness = (1.0 / variance - 1.0 / mean).max(0.0);
        Self {
            all,
            frames,
            usual: mean + libm::sqrt(squares / remembered),
            steadiness,
            rarest_change: -libm::log(frames),
        }
    }

    /// Logarithm of how many neighbours there are per sr, where a frame has this many: as many as that tells without one of them, with those that are
    /// remembered, and one to begin with; in a field of half the sphere.
    pub(super) fn log_density(&self, in_frame: f64) -> f64 {
        let per_frame = (self.all + (in_frame - 1.0).max(0.0)) / self.frames;
        log_per_sr(per_frame.max(FEWEST_NEIGHBOURS))
    }

    /// How much less likely one more is beside so many others than by that density, as a logarithm: in a normal distribution of the variance that numbers had, over one of the variance that a
    /// Poisson process has. Never more likely: what was counted before may have been the same mistake.
    pub(super) fn one_more(&self, others: f64) -> f64 {
        let over = others.max(0.0) + 0.5 - self.usual;
        (-over * self.steadiness).clamp(self.rarest_change, 0.0)
    }

    /// How much less likely this many neighbours are than where each has this density: that is as it is after all others, but a frame is drawn one after
    /// the other (chain rule).
    pub(super) fn excess(&self, in_frame: f64, log_density: f64) -> f64 {
        let drawn = libm::lgamma(self.all + in_frame) - libm::lgamma(self.all)
            + in_frame * log_per_sr(1.0 / self.frames);
        in_frame * log_density - drawn
    }

    /// The same of [`Self::one_more`], where each has it beside all others.
    pub(super) fn excess_of_one_more(&self, in_frame: f64) -> f64 {
        let whole = in_frame as usize;
        let one_by_one: f64 = (0..whole).map(|others| self.one_more(others as f64)).sum();
        let rest = in_frame - whole as f64;
        in_frame * self.one_more(in_frame - 1.0) - one_by_one - rest * self.one_more(whole as f64)
    }
}

fn log_per_sr(per_frame: f64) -> f64 {
    libm::log(per_frame / TAU)
}

#[cfg(test)]
mod tests {
    use super::super::memory::Frame;
    use super::*;
    use crate::pose::{LightSpread, Missed, Tilting};

    /// After frames with so many neighbours.
    fn after(numbers: impl IntoIterator<Item = f64>) -> Number {
        let mut memory = Memory::new(1, 1);
        for neighbours in numbers {
            memory.remember(Frame {
                clutter: &[0.0],
                neighbours,
                whereabouts: &[0.0],
                power: None,
                missed: Missed::default(),
                tilting: Tilting::default(),
                light_spread: LightSpread::default(),
            });
        }
        Number::of(&memory)
    }

    #[test]
    fn beside_as_many_as_ever_one_more_is_as_rare_as_a_change() {
        let steady = after([1.0; 64]);
        assert!(steady.one_more(0.0) == 0.0, "it is there again");
        assert!((steady.one_more(1.0) + libm::log(66.0)).abs() < 1e-12);
        assert!((steady.one_more(5.0) + libm::log(66.0)).abs() < 1e-12);
        let few = after([1.0; 3]);
        assert!(few.one_more(1.0) < 0.0 && few.one_more(1.0) >= -libm::log(5.0));
    }

    #[test]
    fn what_changes_all_the_time_is_no_surprise() {
        // As many as a Poisson process of three per frame would have, in its shares.
        let often = [0, 3, 9, 14, 14, 11, 6, 3, 2, 1];
        let numbers =
            often.iter().enumerate().flat_map(|(number, &times)| core::iter::repeat_n(number as f64, times));
        let changing = after(numbers);
        for others in 0..9 {
            assert!(
                changing.one_more(f64::from(others)) > -0.6,
                "{others}: {}",
                changing.one_more(f64::from(others))
            );
        }
        assert!(after([]).one_more(0.0) == 0.0 && after([]).one_more(9.0) == 0.0, "nothing is known");
        assert!(after([0.0; 64]).one_more(0.0) == 0.0, "one may always come");
        let steady = after([20.0; 64]);
        assert!(
            steady.one_more(20.0) > -1.0 && steady.one_more(26.0) < -3.0,
            "one more of twenty is soon there"
        );
    }

    /// Frames drawn one neighbour after the other are as likely as the chain rule has it.
    #[test]
    fn excess_is_what_the_chain_rule_leaves() {
        let number = after([2.0; 9]);
        for in_frame in 0..6 {
            let n = f64::from(in_frame);
            let log_density = number.log_density(n);
            let chained: f64 = (0..in_frame)
                .map(|before| {
                    let before = f64::from(before);
                    libm::log((number.all + before) / number.frames / TAU) + number.one_more(before)
                })
                .sum();
            let after_all = n * (log_density + number.one_more(n - 1.0));
            let excess = number.excess(n, log_density) + number.excess_of_one_more(n);
            assert!((after_all - excess - chained).abs() < 1e-9, "{n}: {}", after_all - excess - chained);
        }
    }
}
