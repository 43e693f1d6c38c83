//! A frame -> neighbours: the whole flow on one page.
//!
//! ```text
//! frame -> spots     what is bright                         crate::spots
//!       -> sightings where each spot lies, how sure, how far  sighting; how bright, brightness
//!       -> groups    which spots are one neighbour          grouping, by matching
//!       -> poses     where, how turned, between which bounds  posing, by matching, crate::pose and crate::ranging
//! ```
//!
//! Without identities the spots of a neighbour are interchangeable. What the airframe can look like is laid out once, in
//! `views`; `matching` asks how well a handful of spots looks like one of those views, which tells whether they belong
//! together and which markers they may be. From there [`crate::pose`] finds every pose that explains them and how sure each
//! is; the bounds are strict and come from [`crate::ranging::DistanceBounds`] and spot sizes alone.

mod alternatives;
mod brightness;
mod candidates;
mod clutter;
mod context;
mod error;
mod explanation;
mod grouping;
mod matching;
mod memory;
mod neighbour;
mod pairs;
mod posing;
mod settings;
mod sighting;
mod telling;
mod views;

use nalgebra::{Unit, Vector3};

use crate::airframe::Airframe;
use crate::camera::{Camera, Watched};
use crate::frame::{FrameView, Mask};
use crate::ranging::SpotCurve;
use crate::spots::{Detector, Reason, Rejected, Spot};
use alternatives::Alternatives;
use candidates::Candidates;
use clutter::Clutter;
use context::Context;
pub use error::{LocateError, LocatorError};
use explanation::Explanation;
use grouping::Groups;
use matching::Matcher;
use memory::Memory;
pub use neighbour::{Distance, Located, Neighbour, Orientation, Position, RunnerUp};
use posing::Poser;
pub use settings::Settings;
pub use sighting::Sighting;
use telling::Telling;

/// First looks, each at what the one before leaves as clutter.
const LOOKS: usize = 4;
/// An observation that is likelier than this to be clutter may be another neighbour's.
const DOUBTFUL: f64 = 0.05;
/// Rounds of looking for other ways to put observations together, each at what the one before left.
const ROUNDS: usize = 2;
/// However seldom neighbours were, there are so many per frame.
const FEWEST_NEIGHBOURS: f64 = 0.2;
/// Rounds of telling how dense clutter is from what is explained, and what is explained from that.
const CLUTTER_ROUNDS: usize = 2;

/// A stage of the flow, named when it ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Spots were found.
    Spots,
    /// Spots have bearings.
    Bearings,
    /// Spots were sorted by neighbour.
    Grouping,
    /// Neighbours have poses and distances.
    Posing,
}

/// Locates neighbours of one kind of airframe in the frames of one camera. Keeps its room from frame to frame, so that a
/// warm locator allocates nothing.
#[derive(Debug)]
pub struct Locator {
    camera: Camera,
    curve: Option<SpotCurve>,
    mask: Option<Mask>,
    detector: Detector,
    matcher: Matcher,
    poser: Poser,
    groups: Groups,
    memory: Memory,
    /// Clutter after a first look, and with what is explained.
    first_clutter: Clutter,
    clutter: Clutter,
    candidates: Candidates,
    alternatives: Alternatives,
    doubtful: Vec<usize>,
    explanation: Explanation,
    telling: Telling,
    use_brightness: bool,
    min_probability: f64,
    order: Vec<usize>,
    located: Located,
}

impl Locator {
    /// A locator; lays out what the airframe can look like, which takes a tenth of a second to a second.
    ///
    /// # Errors
    /// [`LocatorError`] when a setting has no meaning.
    pub fn new(
        camera: Camera,
        airframe: &Airframe,
        curve: Option<SpotCurve>,
        settings: Settings,
    ) -> Result<Self, LocatorError> {
        if !(0.0..=std::f64::consts::PI).contains(&settings.max_tilt_rad) {
            return Err(LocatorError::Tilt(settings.max_tilt_rad));
        }
        if !(0.0..=1.0).contains(&settings.min_probability) {
            return Err(LocatorError::Probability(settings.min_probability));
        }
        let detector = Detector::with_optics(settings.spots, camera.optics().cloned())?;
        let memory = Memory::new(Clutter::counts_of([camera.width(), camera.height()]));
        Ok(Self {
            camera,
            curve,
            mask: None,
            detector,
            matcher: Matcher::new(airframe, settings.max_tilt_rad, &settings.pose, posing::faintest_light(&settings.spots)),
            poser: Poser::new(airframe, settings.pose, &settings.spots)?,
            groups: Groups::default(),
            memory,
            first_clutter: Clutter::default(),
            clutter: Clutter::default(),
            candidates: Candidates::with_room(),
            alternatives: Alternatives::default(),
            doubtful: Vec::new(),
            explanation: Explanation::with_room(),
            telling: Telling::default(),
            use_brightness: settings.pose.use_brightness,
            min_probability: settings.min_probability,
            order: Vec::new(),
            located: Located::with_room(),
        })
    }

    /// Sets where not to look.
    ///
    /// # Errors
    /// [`LocatorError::Mask`] when the mask is not of the camera's size.
    pub fn set_mask(&mut self, mask: Option<Mask>) -> Result<(), LocatorError> {
        if let Some(mask) = &mask {
            mask.check_size(self.camera.width(), self.camera.height()).map_err(LocatorError::Mask)?;
        }
        self.mask = mask;
        Ok(())
    }

    /// Forgets what frames told of the power of LEDs and of clutter: for frames that do not follow on those before.
    pub fn forget(&mut self) {
        self.memory.forget();
    }

    /// The camera in use.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Locates the neighbours in `frame`. `gravity` is down in the camera frame, where it is known. `finished` is told
    /// each stage as it ends, so that a caller with a clock can time it.
    ///
    /// # Errors
    /// [`LocateError::Size`] when the frame is not of the camera's size.
    pub fn locate(
        &mut self,
        frame: &FrameView<'_>,
        gravity: Option<&Unit<Vector3<f64>>>,
        finished: &mut dyn FnMut(Stage),
    ) -> Result<&Located, LocateError> {
        let size = self.wrong_size(frame);
        if (frame.width(), frame.height()) != (self.camera.width(), self.camera.height()) {
            return Err(size);
        }
        let detections = self.detector.detect(frame, self.mask.as_ref()).map_err(|_| size)?;
        self.located.rejected.clone_from(&detections.rejected);
        finished(Stage::Spots);
        let spots = detections.spots.iter().map(|spot| (spot, None));
        sight_all(&self.camera, self.curve.as_ref(), spots, &mut self.located);
        brightness::tell(&mut self.located.sightings, &mut self.order);
        finished(Stage::Bearings);
        Ok(self.tell_neighbours(gravity, finished))
    }

    /// Locates the neighbours behind spots that another detector found.
    pub fn locate_spots(
        &mut self,
        spots: &[Spot],
        gravity: Option<&Unit<Vector3<f64>>>,
        finished: &mut dyn FnMut(Stage),
    ) -> &Located {
        self.sight_and_tell(spots.iter().map(|spot| (spot, None)), gravity, finished)
    }

    /// The same with the signal that each spot was seen to blink, `None` where that is not known: with them a symmetric
    /// airframe's yaw is told as far as its signals differ. A signal that no LED of the airframe carries tells nothing, a
    /// wrong one little.
    pub fn locate_signalled(
        &mut self,
        spots: &[(Spot, Option<u32>)],
        gravity: Option<&Unit<Vector3<f64>>>,
        finished: &mut dyn FnMut(Stage),
    ) -> &Located {
        self.sight_and_tell(spots.iter().map(|(spot, signal)| (spot, *signal)), gravity, finished)
    }

    fn wrong_size(&self, frame: &FrameView<'_>) -> LocateError {
        LocateError::Size {
            width: frame.width(),
            height: frame.height(),
            camera_width: self.camera.width(),
            camera_height: self.camera.height(),
        }
    }

    fn sight_and_tell<'a>(
        &mut self,
        spots: impl Iterator<Item = (&'a Spot, Option<u32>)>,
        gravity: Option<&Unit<Vector3<f64>>>,
        finished: &mut dyn FnMut(Stage),
    ) -> &Located {
        self.located.rejected.clear();
        finished(Stage::Spots);
        sight_all(&self.camera, self.curve.as_ref(), spots, &mut self.located);
        brightness::tell(&mut self.located.sightings, &mut self.order);
        finished(Stage::Bearings);
        self.tell_neighbours(gravity, finished)
    }

    fn tell_neighbours(
        &mut self,
        gravity: Option<&Unit<Vector3<f64>>>,
        finished: &mut dyn FnMut(Stage),
    ) -> &Located {
        let size = [self.camera.width(), self.camera.height()];
        let (sightings, with_light) = (&self.located.sightings, self.use_brightness);
        let watched = Watched::new(&self.camera, self.mask.as_ref());
        let context = Context { sightings, gravity, watched, power: None, clutter: &[], log_neighbours: 0.0 };
        let of_frame = self.groups.sort_out(&context, &mut self.matcher);
        self.groups.look(&context, &mut self.matcher);
        let memory = &self.memory;
        let looked = |groups: &mut Groups, clutter: &mut Clutter, supposed: f64| {
            groups.suppose(sightings.len(), supposed);
            let mut total = 0.0;
            for _ in 0..LOOKS {
                clutter.measure(sightings, groups, size, with_light, Some(memory), |spot| groups.clutter(spot));
                total = groups.weigh_looks(clutter.log_density(), log_neighbours(groups.neighbours(), Some(memory)));
            }
            total
        };
        // All clutter and no clutter both bear themselves out: what makes the frame likelier is right.
        let [all, none] = [1.0, 0.0].map(|share| looked(&mut self.groups, &mut self.first_clutter, share));
        if all > none {
            looked(&mut self.groups, &mut self.first_clutter, 1.0);
        }
        let clear_power = self.groups.clear_log_power(&context, &mut self.matcher);
        finished(Stage::Grouping);
        let mut log_density_of_neighbours = log_neighbours(self.groups.neighbours(), Some(&self.memory));
        self.clutter.measure(sightings, &self.groups, size, with_light, Some(&self.memory), |spot| self.groups.clutter(spot));
        let context = Context {
            power: self.memory.power().or(of_frame),
            clutter: self.first_clutter.log_density(),
            log_neighbours: log_density_of_neighbours,
            ..context
        };
        self.candidates.clear();
        for group in 0..self.groups.len() {
            self.poser.weigh(&context, self.groups.group(group), &mut self.matcher, &mut self.candidates);
        }
        self.explanation.explain(&self.candidates, context.clutter, context.log_neighbours);
        let power = context.power;
        for round in 0..ROUNDS {
            let clutter = if round == 0 { self.first_clutter.log_density() } else { self.clutter.log_density() };
            let context = Context { sightings, gravity, watched, power, clutter, log_neighbours: log_density_of_neighbours };
            self.doubtful.clear();
            self.doubtful.extend((0..sightings.len()).filter(|&spot| self.explanation.clutter(spot) > DOUBTFUL));
            if round == 0 {
                for group in 0..self.groups.len() {
                    let members = self.groups.group(group);
                    if self.candidates.is_doubtful(members, clutter, log_density_of_neighbours) {
                        self.doubtful.extend_from_slice(members);
                    }
                }
                self.doubtful.sort_unstable();
                self.doubtful.dedup();
            }
            let Self { alternatives, doubtful, matcher, poser, candidates, .. } = self;
            for &spot in doubtful.iter() {
                alternatives.around(&context, spot, matcher, |handful, matcher| {
                    poser.weigh(&context, handful, matcher, candidates);
                });
            }
            let Self { explanation, clutter, groups, candidates, memory, .. } = self;
            let mut settle = |supposed: Option<f64>| {
                let first = |spot: usize| supposed.unwrap_or(groups.clutter(spot));
                clutter.measure(sightings, groups, size, with_light, Some(memory), first);
                log_density_of_neighbours = log_neighbours(groups.neighbours(), Some(memory));
                for _ in 0..CLUTTER_ROUNDS {
                    explanation.explain(candidates, clutter.log_density(), log_density_of_neighbours);
                    clutter.measure(sightings, groups, size, with_light, Some(memory), |spot| explanation.clutter(spot));
                    log_density_of_neighbours = log_neighbours(explanation.neighbours(), Some(memory));
                }
                explanation.explain(candidates, clutter.log_density(), log_density_of_neighbours);
                explanation.log_density(clutter.log_density())
            };
            // As with first looks, little clutter and much both bear themselves out.
            let [much, little] = [None, Some(0.0)].map(&mut settle);
            if much > little {
                settle(None);
            }
        }
        self.memory.remember(self.clutter.counts(), self.explanation.neighbours(), clear_power);
        self.telling.tell(&self.candidates, &self.explanation, self.min_probability, &mut self.located);
        finished(Stage::Posing);
        &self.located
    }
}

/// Logarithm of how many neighbours there are per sr, where a frame has so many: as many as that tells without one of them, with those that are
/// remembered, and one to begin with; in a field of half the sphere.
fn log_neighbours(in_frame: f64, memory: Option<&Memory>) -> f64 {
    let (remembered, frames) = memory.map_or((0.0, 0.0), |memory| (memory.neighbours(), memory.frames() as f64));
    let per_frame = (1.0 + remembered + (in_frame - 1.0).max(0.0)) / (2.0 + frames);
    libm::log(per_frame.max(FEWEST_NEIGHBOURS) / core::f64::consts::TAU)
}

/// Gives every spot its bearing; those that have none are rejected.
fn sight_all<'a>(
    camera: &Camera,
    curve: Option<&SpotCurve>,
    spots: impl Iterator<Item = (&'a Spot, Option<u32>)>,
    located: &mut Located,
) {
    located.sightings.clear();
    for (spot, signal) in spots {
        match sighting::sight(camera, curve, spot, signal) {
            Some(sighting) => located.sightings.push(sighting),
            None => located.rejected.push(Rejected {
                centre: spot.centre,
                area_px: spot.area_px,
                peak: spot.peak,
                reason: Reason::Outside,
                extent: spot.extent,
            }),
        }
    }
}

#[cfg(test)]
mod tests;
