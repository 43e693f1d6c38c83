//! A frame -> what the paper's pipeline and Photinus' own see in it, beside the truth.
//!
//! The paper's: pixels at or above a fixed threshold, the middle pixel of each spot, the widest pair of adjacent spots,
//! (5) and (6). Photinus' own: contrast against the background, centroids, neighbours with an estimate and bounds.

use nalgebra::{Quaternion, Unit, UnitQuaternion, Vector3};
use photinus::camera::{Bearing, Camera, Pixel};
use photinus::locator::{Input, Locator, Settings};
use photinus::ranging::{AdjacentPair, Interval, bearing_bound_rad};
use photinus::spots::{self, Brightness, Detector, Spot};
use photinus_sim::Rendered;

use crate::{ReproduceError, Rig};

/// The threshold of the paper's figures 10 and 11.
pub(crate) const PAPER_DN: u8 = 200;
/// The preset's outdoor threshold: the lower end of what later practice flies with (50 to 120), because at 200 nobody is seen
/// at 15 m, see docs/sensor-preset.md.
pub(crate) const OUTDOOR_DN: u8 = 50;
/// A spot is of an LED no farther from it than this, or than half its own width where that is more, px.
const GATE_PX: f64 = 2.5;
/// A neighbour is the target when its bearing is no farther off than this, or than 0.6 m, rad.
const NEIGHBOUR_GATE_RAD: f64 = 0.05;

/// A marker's direction as it was seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SeenMarker {
    /// How far the marker is, m.
    pub(crate) distance_m: f64,
    /// How far off its bearing is, rad.
    pub(crate) error_rad: f64,
}

/// What the paper makes of the widest pair of adjacent spots.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SeenPair {
    /// Angle between them, rad.
    pub(crate) alpha_rad: f64,
    /// k (S - 1/2) of the larger and of the smaller spot, rad.
    pub(crate) eps_rad: [f64; 2],
    /// l_A, m.
    pub(crate) perpendicular_m: f64,
    /// l_B, m.
    pub(crate) inline_m: f64,
}

/// What the paper's pipeline sees.
#[derive(Clone, Debug)]
pub(crate) struct PaperView {
    /// Markers that were found.
    pub(crate) markers: Vec<SeenMarker>,
    /// The widest pair, where there are two spots.
    pub(crate) pair: Option<SeenPair>,
}

/// What Photinus makes of the target.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OwnNeighbour {
    /// Direction of its origin.
    pub(crate) bearing: Bearing,
    /// Estimate of its distance, m.
    pub(crate) estimate_m: Option<f64>,
    /// Strict bounds.
    pub(crate) bounds: Interval,
    /// The paper's l_A and l_B from centroids, m, where two neighbouring markers are seen.
    pub(crate) paper_m: Option<(f64, f64)>,
}

/// What Photinus sees.
#[derive(Clone, Debug)]
pub(crate) struct OwnView {
    /// Markers that were found.
    pub(crate) markers: Vec<SeenMarker>,
    /// The target, where it was found.
    pub(crate) neighbour: Option<OwnNeighbour>,
}

/// A frame as everybody sees it.
#[derive(Clone, Debug)]
pub(crate) struct Seen {
    /// Middle of the exposure, s.
    pub(crate) time_s: f64,
    /// True place of the target, camera frame, m.
    pub(crate) position_m: Vector3<f64>,
    /// Down, camera frame.
    pub(crate) gravity: Unit<Vector3<f64>>,
    /// The paper's view, for every threshold of the observer.
    pub(crate) paper: Vec<PaperView>,
    /// Photinus' own.
    pub(crate) own: OwnView,
}

impl Seen {
    /// Whether the truth lies between l_B and l_A from centroids; `None` without a pair.
    pub(crate) fn is_between_centroids(&self) -> Option<bool> {
        let (perpendicular_m, inline_m) = self.own.neighbour?.paper_m?;
        Some(inline_m <= self.distance_m() && self.distance_m() <= perpendicular_m)
    }

    /// True distance of the target, m.
    pub(crate) fn distance_m(&self) -> f64 {
        self.position_m.norm()
    }
}

/// An LED that reached the image: where it is in the image and in space.
struct LitLed {
    pixel: Pixel,
    position_m: Vector3<f64>,
}

/// Looks at the frames of a rig with every pipeline.
pub(crate) struct Observer<'a> {
    rig: &'a Rig,
    pair: AdjacentPair,
    detectors: Vec<Detector>,
    locator: Locator,
}

impl<'a> Observer<'a> {
    /// An observer whose paper's pipelines have these thresholds.
    pub(crate) fn new(rig: &'a Rig, thresholds_dn: &[u8]) -> Result<Self, ReproduceError> {
        let detector = |&threshold_dn: &u8| Detector::new(fixed(threshold_dn));
        let detectors = thresholds_dn.iter().map(detector).collect::<Result<_, _>>()?;
        let locator = Locator::new(rig.camera().clone(), rig.airframe(), None, Settings::default())?;
        Ok(Self { rig, pair: rig.pair(), detectors, locator })
    }

    /// What everybody sees in a frame; `None` for one that is not of the rig's camera or has no target.
    pub(crate) fn look(&mut self, rendered: &Rendered) -> Option<Seen> {
        let target = rendered.truth.neighbours.first()?;
        let position_m = Vector3::from(target.position_m);
        let [x, y, z, w] = target.orientation_xyzw;
        let camera_from_body = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        let leds = self.rig.airframe().leds();
        let lit = target.leds.iter().filter_map(|seen| {
            let led = leds.get(seen.led? as usize)?;
            let position_m = camera_from_body * led.position_m + position_m;
            Some(LitLed { pixel: Pixel::new(seen.u_px, seen.v_px), position_m })
        });
        let lit: Vec<LitLed> = lit.collect();
        let view = rendered.image.view();
        let mut paper = Vec::with_capacity(self.detectors.len());
        for detector in &mut self.detectors {
            let spots = &detector.detect(&view, None).ok()?.spots;
            paper.push(PaperView {
                markers: markers(&lit, spots, |spot| middle_bearing(self.rig.camera(), spot)),
                pair: widest_pair(self.rig, &self.pair, spots),
            });
        }
        let located = self.locator.locate(Input::frame(&view).gravity(&rendered.gravity)).ok()?;
        let spots: Vec<Spot> = located.sightings.iter().map(|sighting| sighting.spot.clone()).collect();
        let camera = self.rig.camera();
        let own_markers = markers(&lit, &spots, |spot| camera.bearing(spot.centre));
        let truth = Bearing::new(position_m)?;
        let gate_rad = NEIGHBOUR_GATE_RAD.max(0.6 / position_m.norm());
        let off = |neighbour: &&photinus::locator::Neighbour| neighbour.bearing.angle_to(&truth);
        let nearest = located.neighbours.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        let neighbour = nearest.filter(|neighbour| off(neighbour) < gate_rad).map(|found| OwnNeighbour {
            bearing: found.bearing,
            estimate_m: found.distance.estimate.map(|estimate| estimate.distance_m),
            bounds: found.distance.bounds,
            paper_m: found.distance.perpendicular_m.zip(found.distance.inline_m),
        });
        Some(Seen {
            time_s: rendered.truth.time_s,
            position_m,
            gravity: rendered.gravity,
            paper,
            own: OwnView { markers: own_markers, neighbour },
        })
    }
}

/// Settings of a detector with a fixed threshold.
pub(crate) fn fixed(threshold_dn: u8) -> spots::Settings {
    let mut settings = spots::Settings::default();
    settings.brightness = Brightness::Threshold(threshold_dn);
    settings
}

/// (2): the bearing of a spot's middle pixel.
fn middle_bearing(camera: &Camera, spot: &Spot) -> Option<Bearing> {
    camera.bearing(Pixel::new(f64::from(spot.middle.0), f64::from(spot.middle.1)))
}

/// Each LED with the bearing of the nearest spot.
fn markers(lit: &[LitLed], spots: &[Spot], bearing: impl Fn(&Spot) -> Option<Bearing>) -> Vec<SeenMarker> {
    let seen = lit.iter().filter_map(|led| {
        let off_px = |spot: &Spot| libm::hypot(spot.centre.u - led.pixel.u, spot.centre.v - led.pixel.v);
        let spot = spots.iter().min_by(|a, b| off_px(a).total_cmp(&off_px(b)))?;
        let gate_px = GATE_PX.max(0.5 * f64::from(spot.extent.width().max(spot.extent.height())));
        let truth = Bearing::new(led.position_m)?;
        (off_px(spot) <= gate_px).then_some(())?;
        Some(SeenMarker { distance_m: led.position_m.norm(), error_rad: bearing(spot)?.angle_to(&truth) })
    });
    seen.collect()
}

/// The pair of adjacent spots that are farthest apart, and what (5) and (6) make of it.
fn widest_pair(rig: &Rig, pair: &AdjacentPair, spots: &[Spot]) -> Option<SeenPair> {
    let mut seen: Vec<(&Spot, Bearing)> =
        spots.iter().filter_map(|spot| Some((spot, middle_bearing(rig.camera(), spot)?))).collect();
    seen.sort_by_key(|(spot, _)| spot.middle);
    let widest = seen
        .windows(2)
        .map(|two| (two[0].1.angle_to(&two[1].1), [two[0].0.area_px, two[1].0.area_px]))
        .reduce(|a, b| if b.0 > a.0 { b } else { a });
    let (alpha_rad, areas_px) = widest?;
    let eps = |area_px: u32| bearing_bound_rad(rig.rad_per_px(), area_px);
    let [a, b] = areas_px;
    Some(SeenPair {
        alpha_rad,
        eps_rad: [eps(a.max(b)), eps(a.min(b))],
        perpendicular_m: pair.perpendicular_m(alpha_rad)?,
        inline_m: pair.inline_m(alpha_rad)?,
    })
}

#[cfg(test)]
mod tests {
    use photinus_sim::Simulator;

    use super::*;
    use crate::rig::tests::rig;

    #[test]
    fn both_pipelines_see_a_near_hexarotor() {
        let rig = rig();
        let place_m = Vector3::new(0.5, 0.2, 4.0);
        let scene = rig.posed(&[(place_m, 0.5)], true, 3);
        let rendered = Simulator::new(&scene, 0).unwrap().frame(0);
        let seen = Observer::new(&rig, &[PAPER_DN, OUTDOOR_DN]).unwrap().look(&rendered).unwrap();
        assert!((seen.distance_m() - place_m.norm()).abs() < 1e-9);
        for view in &seen.paper {
            let pair = view.pair.unwrap();
            assert!(pair.inline_m < 4.2 && 3.9 < pair.perpendicular_m, "{pair:?}");
            assert!(view.markers.iter().all(|marker| marker.error_rad < 0.01));
        }
        let own = seen.own.neighbour.unwrap();
        assert!(own.bounds.contains(seen.distance_m()) && (own.estimate_m.unwrap() - 4.05).abs() < 0.6);
        assert!(seen.own.markers.iter().all(|marker| marker.error_rad < 2e-3), "{:?}", seen.own.markers);
    }
}
