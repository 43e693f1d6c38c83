//! Lights with the signals that they blink, and how the vehicle is built -> which LEDs are dark though they face the camera, and which blink the signal
//! of another. Where lights are tells the vehicle's attitude but for turns that leave the airframe as it is; of those, and of other ways to see it, the
//! one with the fewest swapped signals is the likeliest.

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use nalgebra::{Rotation3, Unit, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::{Bearing, Camera, Pixel};
use photinus::locator::{Input, Locator, LocatorError, Settings};
use photinus::pose::{Pose, Symmetry};
use photinus::spots::Spot;

/// A light within this of where a marker must be is that marker, px.
const SAME_PX: f64 = 5.0;
/// What it costs to believe that two signals are swapped, nats: one board in ten thousand.
const SWAPPED_NATS: f64 = 9.2;
/// Explanations so much worse than the best are ten times less likely, nats.
const LIKELY_NATS: f64 = 2.3;
/// A marker is missed where one that shines so much as this share of it was seen.
const FAINTEST: f64 = 0.9;

/// What is wrong with an LED.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Fault {
    /// This marker faces the camera and there is no light.
    Dark(usize),
    /// This marker blinks the other signal.
    Swapped(usize, u32),
}

/// What is known of the vehicle and of who looks.
pub(super) struct Placing<'a> {
    pub(super) airframe: &'a Airframe,
    pub(super) camera: &'a Camera,
    /// Down in the camera frame, where that is known.
    pub(super) down: Option<Unit<Vector3<f64>>>,
}

/// What places tell.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Placed {
    /// What is wrong in every likely explanation.
    pub(super) sure: Vec<Fault>,
    /// Whether in every likely one something is, though not the same.
    pub(super) is_unsure: bool,
}

/// One way to see the lights as this airframe.
struct Explanation {
    nats: f64,
    faults: BTreeSet<Fault>,
}

impl Placing<'_> {
    /// What lights with these signals tell; `None` where they are not seen as this airframe.
    pub(super) fn placed(
        &self,
        lights: &[Spot],
        signals: &[Option<u32>],
    ) -> Result<Option<Placed>, LocatorError> {
        let mut settings = Settings::default();
        settings.min_probability = 0.0;
        let mut locator = Locator::new(self.camera.clone(), self.airframe, None, settings)?;
        let Ok(located) = locator.locate(Input::spots(lights).gravity(self.down.as_ref())) else {
            return Ok(None);
        };
        let Some(neighbour) = located.neighbours.iter().max_by_key(|neighbour| neighbour.sightings.len())
        else {
            return Ok(None);
        };
        let turns = Symmetry::of(self.airframe).turns();
        let turned = |pose: &Pose, turn: usize| Pose {
            camera_from_body: pose.camera_from_body
                * Rotation3::from_axis_angle(&Vector3::z_axis(), TAU * turn as f64 / turns as f64),
            ..*pose
        };
        let explanations: Vec<Explanation> = neighbour
            .modes
            .iter()
            .flat_map(|mode| (0..turns).map(move |turn| (mode.weight, turned(&mode.pose, turn))))
            .map(|(weight, pose)| self.explained(&pose, weight, lights, signals))
            .collect();
        let best = explanations.iter().map(|explanation| explanation.nats).fold(f64::INFINITY, f64::min);
        let mut likely =
            explanations.into_iter().filter(|explanation| explanation.nats <= best + LIKELY_NATS).peekable();
        let Some(mut sure) = likely.peek().map(|first| first.faults.clone()) else { return Ok(None) };
        let mut is_wrong = true;
        for Explanation { faults, .. } in likely {
            is_wrong &= !faults.is_empty();
            sure.retain(|fault| faults.contains(fault));
        }
        Ok(Some(Placed { is_unsure: is_wrong && sure.is_empty(), sure: sure.into_iter().collect() }))
    }

    fn explained(&self, pose: &Pose, weight: f64, lights: &[Spot], signals: &[Option<u32>]) -> Explanation {
        let camera_m = pose.camera_in_body_m();
        let places: Vec<(usize, Pixel, f64)> = self
            .airframe
            .visible(camera_m)
            .filter_map(|marker| {
                let at_m =
                    pose.position_m + pose.camera_from_body * self.airframe.markers()[marker].position_m;
                let pixel = self.camera.pixel(&Bearing::new(at_m)?)?;
                Some((marker, pixel, self.airframe.intensity(marker, &camera_m)))
            })
            .collect();
        let gap_px =
            |light: &Spot, pixel: &Pixel| libm::hypot(light.centre.u - pixel.u, light.centre.v - pixel.v);
        // Each light is the marker that must be nearest to it, if any is near.
        let marker_of: Vec<Option<usize>> = lights
            .iter()
            .map(|light| {
                let nearest = (0..places.len())
                    .min_by(|&a, &b| gap_px(light, &places[a].1).total_cmp(&gap_px(light, &places[b].1)));
                nearest.filter(|&place| gap_px(light, &places[place].1) < SAME_PX)
            })
            .collect();
        let seen = marker_of.iter().flatten();
        let faintest = seen.map(|&place| places[place].2).fold(f64::INFINITY, f64::min);
        let mut faults = BTreeSet::new();
        for (place, (marker, pixel, intensity)) in places.iter().enumerate() {
            let is_near_one = lights.iter().any(|light| gap_px(light, pixel) < SAME_PX);
            if !marker_of.contains(&Some(place)) && !is_near_one && *intensity >= FAINTEST * faintest {
                faults.insert(Fault::Dark(*marker));
            }
        }
        let mut swapped = BTreeSet::new();
        for (place, signal) in marker_of.iter().zip(signals) {
            let (Some(place), Some(signal)) = (place, signal) else { continue };
            let marker = places[*place].0;
            let own = self.signals(marker);
            if let Some(first) = own.first()
                && !own.contains(signal)
            {
                faults.insert(Fault::Swapped(marker, *signal));
                swapped.insert((*first.min(signal), *first.max(signal)));
            }
        }
        let nats = -libm::log(weight.max(1e-300)) + SWAPPED_NATS * swapped.len() as f64;
        Explanation { nats, faults }
    }

    /// The signals that a marker's LEDs carry.
    pub(super) fn signals(&self, marker: usize) -> Vec<u32> {
        let leds = self.airframe.markers()[marker].leds.iter();
        leds.filter_map(|&led| self.airframe.leds()[led].signal).collect()
    }

    /// What a marker is called: its LEDs, in the order of the airframe's file, and the signals that they must blink.
    pub(super) fn named(&self, marker: usize) -> String {
        let list = |numbers: Vec<String>| numbers.join(" and ");
        let leds = list(self.airframe.markers()[marker].leds.iter().map(usize::to_string).collect());
        let mut signals = self.signals(marker);
        signals.dedup();
        match signals.as_slice() {
            [] => format!("LED {leds}"),
            signals => format!("LED {leds} of signal {}", list(signals.iter().map(u32::to_string).collect())),
        }
    }
}
