//! How dense clutter is: bright points that are no neighbour's markers.
//!
//! In: how likely each observation of the frame is clutter, and which belong together if they are not clutter. Out: the density of clutter at each
//! observation, from the others: those of the frame as a whole, those around it, for glints and hot pixels come in crowds, and those right beside it, for
//! clutter comes in clumps; and from what stays where it is. Regions that the detector rejected say beforehand that there is clutter, and where. Observations that belong
//! together are clutter together or not at all: the first of them is as dense as what is around, each further one as if those before were clutter
//! (a Poisson process whose rate is not known), and each gets the mean of the logarithms. A density is per sr and per unit of the logarithm of light.

use alloc::vec;
use alloc::vec::Vec;

use super::Sighting;
use super::cells::Cells;
use super::companions::Companions;
use super::grouping::Groups;
use super::memory::Memory;
use super::places::{LIGHT_STEP, LIGHT_STEPS, Place, light_step};
use crate::spots::{Reason, Rejected};

/// Clutter of a frame before any was seen: this many points, and as many for each region that was rejected, worth this many frames.
pub(super) const BEFOREHAND: f64 = 0.2;
const PER_REGION: f64 = 1.0;
const WORTH_FRAMES: f64 = 0.3;
/// Side of the cells in which clutter is counted, px: an observation's surroundings are three by three of them.
const CELL_PX: f64 = 64.0;
/// The mean of the whole frame is worth what the surroundings tell over this many times their area.
const WORTH_SURROUNDINGS: f64 = 1.0;
/// The light of clutter may be anything over this many units of its logarithm, a factor of 3,000: as good as this many points that show their light.
pub(super) const LIGHT_RANGE: f64 = 8.0;
const WORTH_POINTS: f64 = 3.0;
/// What is likelier than this to be clutter is remembered as clutter.
const LIKELY: f64 = 0.5;

/// What the density of clutter at an observation depends on.
#[derive(Clone, Copy)]
pub(super) struct Surroundings<'a> {
    /// Of each observation.
    pub(super) places: &'a [Place],
    /// Clutter of the frame besides.
    pub(super) besides: &'a Counts,
    /// Clutter that regions of the frame say there is.
    pub(super) beforehand: &'a Counts,
    pub(super) companions: &'a Companions,
    pub(super) memory: &'a Memory,
}

/// The density of clutter at each observation.
#[derive(Debug)]
pub(super) struct Clutter {
    frame_px: f64,
    with_light: bool,
    log_density: Vec<f64>,
    /// How likely each observation is clutter that comes and goes, of no kind of its own.
    shares: Vec<f64>,
    /// The same of hot pixels.
    hot: Vec<f64>,
    /// The same as `shares` while a group is asked about: of its observations those before one.
    shares_before: Vec<f64>,
    counts: Counts,
    /// Counts of the observations before one, or of those to remember.
    before: Counts,
}

impl Clutter {
    /// Nothing measured yet, in images of `size` (width, height) px. Without `with_light` the density is one of directions alone.
    pub(super) fn new(size: [usize; 2], with_light: bool) -> Self {
        Self {
            frame_px: (size[0] * size[1]) as f64,
            with_light,
            log_density: Vec::new(),
            shares: Vec::new(),
            hot: Vec::new(),
            shares_before: Vec::new(),
            counts: Counts::of(size),
            before: Counts::of(size),
        }
    }

    /// Logarithm of the density at each observation.
    pub(super) fn log_density(&self) -> &[f64] {
        &self.log_density
    }

    /// Measures the density, where `share` tells how likely an observation is clutter, after the frames that are remembered.
    pub(super) fn measure(
        &mut self,
        frame: &Surroundings<'_>,
        groups: &Groups,
        share: impl Fn(usize) -> f64,
    ) {
        let Surroundings { places, besides, companions, .. } = *frame;
        self.share_out(places, share);
        self.shares_before.clone_from(&self.shares);
        self.counts.list.copy_from_slice(&besides.list);
        for index in 0..places.len() {
            self.count(places, index, 1.0);
        }
        self.log_density.clear();
        self.log_density.resize(places.len(), 0.0);
        for members in (0..groups.len()).map(|group| groups.group(group)) {
            members.iter().for_each(|&index| self.count(places, index, -1.0));
            let hot_pixels = self.counts.hot_pixels(frame.memory);
            let mean = match *members {
                [only] => {
                    let beside: f64 =
                        companions.of(only).iter().map(|near| near.density_at(&self.shares)).sum();
                    self.log_per_sr(&self.counts, frame, &places[only], 0.0, beside)
                }
                _ => self.mean_of_group(frame, members),
            };
            for &index in members {
                self.log_density[index] = places[index].with_what_stands(mean, hot_pixels);
                self.count(places, index, 1.0);
            }
        }
    }

    /// Shares out how likely each observation is clutter: what comes and goes is a hot pixel or not.
    fn share_out(&mut self, places: &[Place], share: impl Fn(usize) -> f64) {
        self.shares.clear();
        self.hot.clear();
        for (index, place) in places.iter().enumerate() {
            let all = share(index) * place.comes_and_goes;
            let hot = all * place.is_hot();
            self.shares.push(all - hot);
            self.hot.push(hot);
        }
    }

    /// Counts an observation as clutter so many times.
    fn count(&mut self, places: &[Place], index: usize, times: f64) {
        self.counts.add(&places[index], times * self.shares[index], times * self.hot[index]);
    }

    /// The same of what comes and goes, for a group: the mean over its observations, one after the other.
    fn mean_of_group(&mut self, frame: &Surroundings<'_>, members: &[usize]) -> f64 {
        let each = members.iter().map(|&index| self.shares[index]).sum::<f64>() / members.len() as f64;
        members.iter().for_each(|&index| self.shares_before[index] = 0.0);
        let mut sum = 0.0;
        for (before, &index) in members.iter().enumerate() {
            let near = frame.companions.of(index).iter();
            let beside: f64 = near.map(|near| near.density_at(&self.shares_before)).sum();
            sum += self.log_per_sr(&self.counts, frame, &frame.places[index], before as f64 * each, beside);
            self.shares_before[index] = each;
        }
        members.iter().for_each(|&index| self.shares_before[index] = self.shares[index]);
        sum / members.len() as f64
    }

    /// How much less likely it is that all observations are clutter, as likely as `share` tells, than the densities measured have it: each of those is
    /// after all others, but a frame is drawn one after the other (chain rule).
    pub(super) fn excess(&mut self, frame: &Surroundings<'_>, share: impl Fn(usize) -> f64) -> f64 {
        let Surroundings { places, besides, companions, .. } = *frame;
        self.share_out(places, &share);
        self.before.list.copy_from_slice(&besides.list);
        let mut excess = 0.0;
        for (index, place) in places.iter().enumerate() {
            let earlier = companions.of(index).iter().filter(|near| near.observation < index);
            let beside: f64 = earlier.map(|near| near.density_at(&self.shares)).sum();
            let by_itself = self.log_per_sr(&self.before, frame, place, 0.0, beside);
            let first = place.with_what_stands(by_itself, self.before.hot_pixels(frame.memory));
            excess += share(index) * (self.log_density[index] - first);
            self.before.add(place, self.shares[index], self.hot[index]);
        }
        excess
    }

    /// How much clutter of a frame is to be remembered in every cell of the image and step of light, where `share` tells how likely an observation is clutter: nothing of what is
    /// rather a neighbour's. Small shares of many frames would add up to points that never were, and confirm themselves.
    pub(super) fn counts_to_remember(
        &mut self,
        places: &[Place],
        besides: &Counts,
        share: impl Fn(usize) -> f64,
    ) -> &[f64] {
        let likely = |index: usize| Some(share(index)).filter(|share| *share > LIKELY);
        self.share_out(places, |index| likely(index).unwrap_or(0.0));
        self.before.list.copy_from_slice(&besides.list);
        for (index, place) in places.iter().enumerate() {
            self.before.add(place, self.shares[index], self.hot[index]);
        }
        &self.before.list
    }

    /// Logarithm of how dense clutter is at an observation, with this many more points at the same place, and so dense beside others per px^2.
    fn log_per_sr(
        &self,
        counts: &Counts,
        frame: &Surroundings<'_>,
        place: &Place,
        more: f64,
        beside: f64,
    ) -> f64 {
        let Surroundings { memory, beforehand, .. } = *frame;
        let frames = 1.0 + memory.frames() as f64;
        let cells = counts.cells;
        let around = cells.around(place.cell);
        let (mut count, mut in_area) = (0, 0.0);
        for row in around {
            count += row.len();
            let both = counts.list[row.clone()].iter().zip(&memory.clutter_by_cell()[row.clone()]);
            both.zip(&beforehand.list[row]).for_each(|((own, before), said)| in_area += own + before + said);
        }
        let area_px = count as f64 * cells.area_px2();
        let in_area = f64::max(in_area, 0.0) + more;
        let in_frame = counts.total(memory) + beforehand.all() + more;
        let mean = (BEFOREHAND * WORTH_FRAMES + in_frame) / (self.frame_px * (frames + WORTH_FRAMES));
        let here = mean * area_px * WORTH_SURROUNDINGS + in_area;
        let by_itself =
            here / (area_px * (frames + WORTH_SURROUNDINGS)) * self.of_light(counts, memory, place);
        libm::log((by_itself + beside) / place.rad2_per_px2)
    }

    /// How dense the light of clutter is at that of an observation.
    fn of_light(&self, counts: &Counts, memory: &Memory, place: &Place) -> f64 {
        let Some(step) = place.light_step.filter(|_| self.with_light) else { return 1.0 };
        let count = |step: usize| {
            let place = counts.cells.count() + step;
            counts.list[place] + memory.clutter_by_cell()[place]
        };
        let there = 0.25 * count(step.saturating_sub(1))
            + 0.5 * count(step)
            + 0.25 * count((step + 1).min(LIGHT_STEPS - 1));
        let density = WORTH_POINTS / LIGHT_RANGE + there.max(0.0) / LIGHT_STEP;
        density / (WORTH_POINTS + counts.total(memory))
    }
}

/// Clutter by cell of the image, then by step of light, then in all; then hot pixels.
#[derive(Debug)]
pub(super) struct Counts {
    cells: Cells,
    list: Vec<f64>,
}

impl Counts {
    /// None, in images of `size` (width, height) px.
    pub(super) fn of(size: [usize; 2]) -> Self {
        let cells = Cells::new(size, CELL_PX);
        Self { cells, list: vec![0.0; cells.count() + LIGHT_STEPS + 2] }
    }

    /// Its cells.
    pub(super) fn cells(&self) -> &Cells {
        &self.cells
    }

    /// How many numbers they are.
    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    /// Counts these observations and no others.
    pub(super) fn count(&mut self, clutter: &[Sighting]) {
        self.list.fill(0.0);
        for sighting in clutter {
            let step = sighting.log_light.map(|light| light_step(light.value));
            self.add_at(self.cells.of_observation(sighting), step, 1.0);
        }
    }

    /// Counts what these regions say beforehand.
    pub(super) fn expect(&mut self, rejected: &[Rejected]) {
        self.list.fill(0.0);
        let tells = |region: &&Rejected| {
            matches!(region.reason, Reason::Background | Reason::Reflection | Reason::Streak)
        };
        for region in rejected.iter().filter(tells) {
            self.add_at(self.cells.at(region.centre), None, PER_REGION * WORTH_FRAMES);
        }
    }

    /// All of it.
    fn all(&self) -> f64 {
        self.list[self.list.len() - 2]
    }

    /// All of it, with what is remembered.
    fn total(&self, memory: &Memory) -> f64 {
        self.at(self.list.len() - 2, memory)
    }

    /// Hot pixels of a frame.
    fn hot_pixels(&self, memory: &Memory) -> f64 {
        self.at(self.list.len() - 1, memory) / (1.0 + memory.frames() as f64 + WORTH_FRAMES)
    }

    fn at(&self, place: usize, memory: &Memory) -> f64 {
        (self.list[place] + memory.clutter_by_cell()[place]).max(0.0)
    }

    /// Counts an observation by this much, and as a hot pixel by that.
    fn add(&mut self, place: &Place, share: f64, hot: f64) {
        self.add_at(place.cell, place.light_step, share);
        if let Some(all) = self.list.last_mut() {
            *all += hot;
        }
    }

    fn add_at(&mut self, cell: [usize; 2], light_step: Option<usize>, share: f64) {
        self.list[self.cells.index(cell)] += share;
        let total = self.list.len() - 2;
        self.list[total] += share;
        if let Some(step) = light_step {
            self.list[self.cells.count() + step] += share;
        }
    }
}
