//! What stays where it is, frame after frame: hot pixels, dirt, lamps and the robot's own airframe, as long as the camera does not turn.
//!
//! In: of each frame its observations, and how likely each is clutter. Out: how dense clutter is at an observation for having been there before, and how
//! much of it that explains: the rest is what comes and goes.

use alloc::vec::Vec;
use core::f64::consts::TAU;

use super::Sighting;
use super::companions::about_as_bright;
use super::memory::Memory;

/// Most places that are remembered: the rarest gives way.
const MOST: usize = 256;
/// A place is the same within this many pixels, ...
const SAME_PX: f64 = 1.5;
/// ... off by this standard deviation, px, and as bright within this of its logarithm.
const SIGMA_PX: f64 = 0.5;
const LIGHT_SIGMA: f64 = 0.5;
/// What stays is a neighbour at least so likely.
const LEAST_DOUBT: f64 = 1e-4;

/// A place in the image where clutter was.
#[derive(Clone, Copy, Debug)]
struct Fixture {
    u: f64,
    v: f64,
    log_light: Option<f64>,
    /// How often something was there, of the frames that are remembered, and how often that was clutter.
    seen: f64,
    times: f64,
}

/// What stays where it is.
#[derive(Debug)]
pub(super) struct Fixtures {
    with_light: bool,
    /// From left to right.
    list: Vec<Fixture>,
    /// Frames, those long ago counting less and less.
    frames: f64,
    /// By observation of the frame: which fixture is nearest to it.
    nearest: Vec<Option<usize>>,
}

impl Fixtures {
    /// None yet. Without `with_light` the density is one of places alone.
    pub(super) fn new(with_light: bool) -> Self {
        Self { with_light, list: Vec::with_capacity(MOST), frames: 0.0, nearest: Vec::new() }
    }

    pub(super) fn forget(&mut self) {
        self.list.clear();
        self.frames = 0.0;
    }

    /// Finds the fixture of each observation of a frame.
    pub(super) fn find(&mut self, sightings: &[Sighting]) {
        let Self { list, nearest, .. } = self;
        list.sort_unstable_by(|a, b| a.u.total_cmp(&b.u).then(a.v.total_cmp(&b.v)));
        nearest.clear();
        nearest.extend(sightings.iter().map(|sighting| {
            let from = list.partition_point(|fixture| fixture.u < sighting.spot.centre.u - SAME_PX);
            let beside = list.iter().enumerate().skip(from);
            let beside = beside.take_while(|(_, fixture)| fixture.u < sighting.spot.centre.u + SAME_PX);
            let gaps = beside.map(|(index, fixture)| (fixture.gap_px(sighting), index));
            let (gap_px, index) = gaps.min_by(|a, b| a.0.total_cmp(&b.0))?;
            (gap_px < SAME_PX).then_some(index)
        }));
    }

    /// How often what is at an observation's place was there before, 0 to 1.
    pub(super) fn share(&self, observation: usize) -> f64 {
        self.nearest[observation].map_or(0.0, |index| self.list[index].times / (self.frames + 1.0))
    }

    /// Logarithm of the odds that what was at an observation's place before is clutter. A neighbour that hovers before a camera that hovers stays where it is,
    /// too: that something is there again makes it no more likely clutter than it was.
    pub(super) fn log_odds(&self, observation: usize) -> f64 {
        self.nearest[observation].map_or(0.0, |index| {
            let Fixture { seen, times, .. } = self.list[index];
            let clutter = (times / seen.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0 - LEAST_DOUBT);
            libm::log(clutter.max(f64::MIN_POSITIVE) / (1.0 - clutter))
        })
    }

    /// How dense clutter is at an observation for having been there before, per px^2 and per unit of the logarithm of light.
    pub(super) fn density(&self, sighting: &Sighting, observation: usize) -> f64 {
        let Some(index) = self.nearest[observation] else { return 0.0 };
        let fixture = &self.list[index];
        let off = fixture.gap_px(sighting) / SIGMA_PX;
        let place = self.share(observation) * libm::exp(-0.5 * off * off) / (TAU * SIGMA_PX * SIGMA_PX);
        let lights = fixture.log_light.zip(sighting.log_light).filter(|_| self.with_light);
        about_as_bright(place, lights.map(|(before, now)| now.value - before), LIGHT_SIGMA)
    }

    /// Remembers where a frame had clutter.
    pub(super) fn remember(&mut self, sightings: &[Sighting], clutter: impl Fn(usize) -> f64) {
        let kept = 1.0 - 1.0 / Memory::FRAMES as f64;
        self.frames = self.frames * kept + 1.0;
        for fixture in &mut self.list {
            fixture.seen *= kept;
            fixture.times *= kept;
        }
        for (index, sighting) in sightings.iter().enumerate() {
            let share = clutter(index);
            match self.nearest[index] {
                Some(own) => self.list[own].see(sighting, share),
                None => self.add(sighting, share),
            }
        }
    }

    fn add(&mut self, sighting: &Sighting, times: f64) {
        let seen = Fixture {
            u: sighting.spot.centre.u,
            v: sighting.spot.centre.v,
            log_light: sighting.log_light.map(|light| light.value),
            seen: 1.0,
            times,
        };
        if self.list.len() < MOST {
            self.list.push(seen);
            return;
        }
        let rarest = self.list.iter_mut().min_by(|a, b| a.times.total_cmp(&b.times));
        if let Some(rarest) = rarest.filter(|rarest| rarest.times < times) {
            *rarest = seen;
        }
    }
}

impl Fixture {
    fn gap_px(&self, sighting: &Sighting) -> f64 {
        libm::hypot(self.u - sighting.spot.centre.u, self.v - sighting.spot.centre.v)
    }

    /// Is there once more: its place and light are the means of all times.
    fn see(&mut self, sighting: &Sighting, share: f64) {
        self.seen += 1.0;
        self.times += share;
        if self.times <= 0.0 {
            return;
        }
        let gain = share / self.times;
        self.u += gain * (sighting.spot.centre.u - self.u);
        self.v += gain * (sighting.spot.centre.v - self.v);
        if let (Some(before), Some(now)) = (&mut self.log_light, sighting.log_light) {
            *before += gain * (now.value - *before);
        }
    }
}
