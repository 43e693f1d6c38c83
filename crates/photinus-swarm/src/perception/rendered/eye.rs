//! One camera: world -> frame -> what is located in it; and what it tells of who is followed, in the body frame.

use std::sync::Arc;

use nalgebra::{Isometry3, Unit, Vector3};
use photinus::camera::Bearing;
use photinus::locator::{self, Distance, Input, Located, Locator, Neighbour};
use photinus::lookout::{Glance, Lookout};
use photinus::ranging::{Estimate, Interval};
use photinus::tracking::{Track, Tracked, Turned};
use photinus_control::{Normal, Seen};
use photinus_sim::background::Daylight;
use photinus_sim::snapshot::{LedLight, Lit, Snapshot, Vehicle};
use photinus_sim::source::Emitter;
use photinus_sim::{CameraView, Renderer};

use super::EyesError;
use crate::perception::{Looking, Moment, Present};
use crate::scenario::Scenario;

/// Nobody is drawn from farther, m: an LED there leaves less than an electron.
const FARTHEST_M: f64 = 100.0;

/// A camera and what looks through it.
#[derive(Debug)]
pub(super) struct Eye {
    camera: usize,
    body_from_camera: Isometry3<f64>,
    renderer: Renderer,
    locator: Locator,
    emitter: Emitter,
    daylight: Option<Daylight>,
    airframe_reach_m: f64,
}

/// What the last frame told that showed a track: from the body's origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shown {
    pub(super) track: u64,
    pub(super) time_s: f64,
    distance: Distance,
    bearing_bound_rad: f64,
    spot_px: Option<f64>,
}

impl Shown {
    /// What a neighbour of a frame says of its track. The camera sits `away_m` from the body's origin: bounds from there are wider by that.
    fn by(
        neighbour: &Neighbour,
        (track, time_s): (u64, f64),
        located: &Located,
        [away_m, reach_m]: [f64; 2],
    ) -> Self {
        let bounds = neighbour.distance.bounds;
        let lever = (away_m / bounds.min_m().max(away_m)).min(1.0);
        let bound_rad = bearing_bound_rad(neighbour, located, reach_m) + libm::asin(lever);
        let wider = Interval::new((bounds.min_m() - away_m).max(0.0), bounds.max_m() + away_m);
        Self {
            track,
            time_s,
            distance: Distance { bounds: wider.unwrap_or(Interval::ANY), ..neighbour.distance },
            bearing_bound_rad: bound_rad.min(core::f64::consts::PI),
            spot_px: largest_spot_px(neighbour, located),
        }
    }
}

impl Eye {
    pub(super) fn new(
        scenario: &Scenario,
        index: usize,
        camera: usize,
        settings: &locator::Settings,
    ) -> Result<Self, EyesError> {
        let vehicle = &scenario.vehicles[index];
        let mounted = &vehicle.kind.cameras[camera];
        let preset = &scenario.preset;
        let view = CameraView {
            camera: mounted.camera.clone(),
            lens: preset.lens.clone(),
            sensor: preset.sensor.clone(),
        };
        let unit = ((index as u64) << 8) | camera as u64;
        let renderer = Renderer::new(view, scenario.seed ^ unit.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let expects = &vehicle.kind.expects;
        Ok(Self {
            camera,
            body_from_camera: mounted.body_from_camera,
            renderer,
            locator: Locator::new(mounted.camera.clone(), expects, None, *settings)?,
            emitter: preset.emitter,
            daylight: scenario.daylight,
            airframe_reach_m: expects.max_radius_m(),
        })
    }

    /// Looks through the camera, and has `lookout` follow what it shows; the vehicle turned so since its frames before, and since the last one of any of its
    /// cameras.
    pub(super) fn look(
        &mut self,
        looking: &Looking<'_>,
        moment: &Moment<'_>,
        [turned, since_any]: [Option<Turned>; 2],
        lookout: &mut Lookout,
        shown: &mut Vec<Shown>,
    ) {
        let snapshot = self.snapshot(looking.vehicle, moment);
        let frame = self.renderer.render(&snapshot, moment.number).image;
        let camera_from_body = self.body_from_camera.rotation.inverse().to_rotation_matrix();
        let down = camera_from_body * (looking.own.attitude.inverse() * -Vector3::z());
        let gravity = Unit::new_normalize(down);
        let of_camera = |turned: Turned| Turned {
            now_from_before: camera_from_body * turned.now_from_before * camera_from_body.inverse(),
            ..turned
        };
        // the renderer makes frames of the camera's size
        let exposure_s = moment.exposure_us * 1e-6;
        let view = frame.view();
        let reach_m = [self.body_from_camera.translation.vector.norm(), self.airframe_reach_m];
        let input = Input::frame(&view).gravity(&gravity).exposure(exposure_s);
        let Ok(located) = self.locator.locate(input) else { return };
        let glance = Glance {
            camera: self.camera,
            time_s: moment.time_s,
            exposure_s,
            turned: turned.map(of_camera),
            turned_since_any: since_any.map(of_camera),
            moving: None,
            gravity: Some(gravity),
            located,
        };
        if lookout.look(&glance).is_err() {
            return;
        }
        let tracked = lookout.tracked();
        for track in &tracked.tracks {
            let Some(neighbour) = own_match(located, track, tracked) else { continue };
            let told = Shown::by(neighbour, (track.id, moment.time_s), located, reach_m);
            match shown.iter_mut().find(|shown| shown.track == track.id) {
                Some(before) => *before = told,
                None => shown.push(told),
            }
        }
    }

    /// A track that is told in this camera's axes, in the body frame.
    pub(super) fn seen(
        &self,
        track: &Track,
        last: Option<&Shown>,
        identity: Option<u32>,
        now_s: f64,
    ) -> Seen {
        let turn = self.body_from_camera.rotation.to_rotation_matrix();
        let about = |covariance| turn.matrix() * covariance * turn.matrix().transpose();
        let mean = turn * track.position_m + self.body_from_camera.translation.vector;
        let covariance = about(track.position_covariance_m2);
        let bearing = Bearing::new(mean).map_or(Vector3::x_axis(), |b| Unit::new_unchecked(*b.vector()));
        let along = bearing.dot(&(covariance * bearing.into_inner()));
        let estimate = Estimate { distance_m: mean.norm(), sigma_m: along.max(0.0).sqrt() };
        Seen {
            track: track.id,
            identity,
            bearing,
            bearing_bound_rad: last.map_or(core::f64::consts::PI, |last| last.bearing_bound_rad),
            distance: Distance {
                estimate: Some(estimate),
                bounds: last.map_or(Interval::ANY, |last| last.distance.bounds),
                perpendicular_m: last.and_then(|last| last.distance.perpendicular_m),
                inline_m: last.and_then(|last| last.distance.inline_m),
            },
            position_m: Some(Normal { mean, covariance }),
            velocity_m_s: Some(Normal {
                mean: turn * track.velocity_m_s,
                covariance: about(track.velocity_covariance_m2_s2),
            }),
            heading: None,
            probability: track.existence,
            spot_px: last.and_then(|last| last.spot_px),
            age_s: last.map_or(0.0, |last| now_s - last.time_s),
        }
    }

    /// The world as this camera sees it.
    fn snapshot(&self, observer: usize, moment: &Moment<'_>) -> Snapshot {
        let exposure = self.renderer.view().exposure(moment.time_s, moment.exposure_us * 1e-6);
        let span_s = exposure.span_s();
        let own = &moment.vehicles[observer].kinematics;
        let camera = own.during(0.0, span_s).carrying(&self.body_from_camera);
        let camera_m = (own.pose * self.body_from_camera).translation.vector;
        let others = moment.vehicles.iter().enumerate().filter(|(index, other)| {
            let far_m = (other.kinematics.pose.translation.vector - camera_m).norm();
            *index != observer && far_m < FARTHEST_M
        });
        let vehicles = others.map(|(index, other)| Vehicle {
            id: index as u32,
            airframe: Arc::clone(&other.kind.airframe),
            solids: Arc::clone(&other.kind.solids),
            looks: Arc::default(),
            motion: other.kinematics.during(0.0, span_s),
            leds: leds(other, moment, &camera_m, (exposure.start_s, span_s)),
        });
        Snapshot {
            exposure,
            camera,
            vehicles: vehicles.collect(),
            emitter: self.emitter,
            daylight: self.daylight,
            water: None,
            lamps: Vec::new(),
        }
    }
}

/// What the LEDs of a vehicle do as far as this camera is concerned: those behind an obstacle are dark to it.
fn leds(
    other: &Present,
    moment: &Moment<'_>,
    camera_m: &Vector3<f64>,
    (start_s, span_s): (f64, f64),
) -> Vec<LedLight> {
    let pose = &other.kinematics.pose;
    let mut shines = Lit::always();
    if let Some(blink) = &other.blink {
        blink.light(start_s, span_s, &mut shines);
    }
    let led = |(led, power): (&photinus::airframe::Led, &f64)| {
        let place_m = pose.rotation * led.position_m + pose.translation.vector;
        let hidden = moment.obstacles.iter().any(|obstacle| obstacle.hides(camera_m, &place_m));
        LedLight { power: *power, lit: if hidden { Lit::never() } else { shines.clone() } }
    };
    other.kind.airframe.leds().iter().zip(&other.powers).map(led).collect()
}

/// Pixels of the largest of a neighbour's spots.
fn largest_spot_px(neighbour: &Neighbour, located: &Located) -> Option<f64> {
    let areas = neighbour.sightings.iter().map(|&member| located.sightings[member].spot.area_px);
    areas.max().map(f64::from)
}

/// The located neighbour that shares most sightings with a track; `None` where it has some of another track, too: then this frame took markers of two vehicles
/// for those of one, and its bounds are of nobody.
fn own_match<'a>(located: &'a Located, track: &Track, tracked: &Tracked) -> Option<&'a Neighbour> {
    let shared = |neighbour: &Neighbour, track: &Track| {
        let members = tracked.members(track);
        neighbour.sightings.iter().filter(|member| members.contains(member)).count()
    };
    let best = located.neighbours.iter().max_by_key(|neighbour| shared(neighbour, track))?;
    let is_of = |other: &Track| shared(best, other) > 0;
    let is_of_two = tracked.tracks.iter().any(|other| other.id != track.id && is_of(other));
    (is_of(track) && !is_of_two).then_some(best)
}

/// How far the true direction of the origin can be from the told one: past a marker's bearing by what that may be off, and by what the airframe spans at
/// the least distance.
fn bearing_bound_rad(neighbour: &Neighbour, located: &Located, reach_m: f64) -> f64 {
    let least_m = neighbour.distance.bounds.min_m().max(reach_m);
    let spans_rad = libm::asin((reach_m / least_m).min(1.0));
    let members = neighbour.sightings.iter().map(|&member| &located.sightings[member]);
    let by_marker = members
        .map(|sighting| neighbour.bearing.angle_to(&sighting.bearing) + sighting.bound_rad + spans_rad);
    by_marker.fold(core::f64::consts::PI, f64::min)
}
