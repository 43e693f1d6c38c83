//! One camera: world -> frame -> tracks in the body frame.

use std::sync::Arc;

use nalgebra::{Isometry3, Rotation3, Unit, Vector3};
use photinus::camera::Bearing;
use photinus::locator::{self, Distance, Input, Located, Locator, Neighbour};
use photinus::lookout::{Fleet, Glance, Lookout};
use photinus::ranging::{Estimate, Interval};
use photinus::tracking::{self, Track, Tracked, Turned};
use photinus_control::{Normal, Seen};
use photinus_sim::background::Daylight;
use photinus_sim::snapshot::{LedLight, Lit, Snapshot, Vehicle};
use photinus_sim::source::Emitter;
use photinus_sim::{CameraView, Renderer};

use super::EyesError;
use crate::perception::{Looking, Moment, Present};
use crate::scenario::Scenario;

/// A name is taken for right from this probability on.
const SURE_NAME: f64 = 0.9;
/// By how much neighbours tilt more than their autopilots ask for: overshoot, and the error of the own tilt.
const TILT_MARGIN_RAD: f64 = 0.15;
/// Gyros are never trusted beyond this, rad/s.
const LEAST_TURN_RAD_S: f64 = 1e-3;
/// Nobody is drawn from farther, m: an LED there leaves less than an electron.
const FARTHEST_M: f64 = 100.0;

/// A camera and what looks through it.
#[derive(Debug)]
pub(super) struct Eye {
    camera: usize,
    body_from_camera: Isometry3<f64>,
    renderer: Renderer,
    locator: Locator,
    lookout: Lookout,
    emitter: Emitter,
    daylight: Option<Daylight>,
    airframe_reach_m: f64,
    /// How far what the gyro tells of a turn from frame to frame may be off, per axis, rad.
    turn_sigma_rad: f64,
    followed: Vec<Followed>,
}

/// What the last frame told that showed a track.
#[derive(Clone, Copy, Debug)]
struct Followed {
    track: u64,
    time_s: f64,
    distance: Distance,
    bearing_bound_rad: f64,
    spot_px: Option<f64>,
}

impl Eye {
    pub(super) fn new(scenario: &Scenario, index: usize, camera: usize) -> Result<Self, EyesError> {
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
        let tilts = scenario.vehicles.iter().map(|vehicle| vehicle.kind.build.tilt_rad);
        let max_tilt_rad = tilts.fold(0.0, f64::max) + TILT_MARGIN_RAD;
        let mut settings = locator::Settings { max_tilt_rad, ..locator::Settings::default() };
        // half of the largest tilt is as likely as not to be passed in a turn
        settings.pose.tilt_sigma_rad = settings.pose.tilt_sigma_rad.max(0.3 * max_tilt_rad);
        let expects = &vehicle.kind.expects;
        let fleet = scenario.codes.as_ref().map(|codes| {
            let word = |other: &crate::scenario::Vehicle| photinus::lookout::Vehicle {
                id: other.id,
                words: vec![other.id as usize],
            };
            let others = scenario.vehicles.iter().map(|other| (word(other), codes.rate_hz));
            Fleet::new(codes.book.clone(), others)
        });
        let fleet = fleet.transpose()?;
        let tracking = tracking::Settings::default();
        Ok(Self {
            camera,
            body_from_camera: mounted.body_from_camera,
            renderer,
            locator: Locator::new(mounted.camera.clone(), expects, None, settings)?,
            lookout: Lookout::new(mounted.camera.clone(), expects, &settings, tracking, fleet.as_ref())?,
            emitter: preset.emitter,
            daylight: scenario.daylight,
            airframe_reach_m: expects.max_radius_m(),
            turn_sigma_rad: scenario.period_s()
                * (scenario.accuracy.gyro_bias_rad_s + scenario.accuracy.gyro_noise_rad_s)
                    .max(LEAST_TURN_RAD_S),
            followed: Vec::new(),
        })
    }

    /// Looks through the camera and hands over each neighbour that it follows, in the body frame.
    pub(super) fn look(
        &mut self,
        looking: &Looking<'_>,
        moment: &Moment<'_>,
        mut hand_over: impl FnMut(Seen),
    ) {
        let snapshot = self.snapshot(looking.vehicle, moment);
        let frame = self.renderer.render(&snapshot, moment.number).image;
        let camera_from_body = self.body_from_camera.rotation.inverse();
        let down = camera_from_body * (looking.own.attitude.inverse() * -Vector3::z());
        let gravity = Unit::new_normalize(down);
        let turn = camera_from_body * looking.turned.inverse() * self.body_from_camera.rotation;
        // the renderer makes frames of the camera's size
        let exposure_s = moment.exposure_us * 1e-6;
        let view = frame.view();
        let input = Input::frame(&view).gravity(&gravity).exposure(exposure_s);
        let Ok(located) = self.locator.locate(input) else { return };
        let glance = Glance {
            camera: 0,
            turned_since_any: None,
            time_s: moment.time_s,
            exposure_s,
            turned: (moment.number > 0)
                .then(|| Turned { now_from_before: Rotation3::from(turn), sigma_rad: self.turn_sigma_rad }),
            moving: None,
            gravity: Some(gravity),
            located,
        };
        if self.lookout.look(&glance).is_err() {
            return;
        }
        let tracked = self.lookout.tracked();
        self.followed.retain(|followed| tracked.tracks.iter().any(|track| track.id == followed.track));
        for track in &tracked.tracks {
            let told = own_match(located, track, tracked).map(|neighbour| Followed {
                track: track.id,
                time_s: moment.time_s,
                distance: neighbour.distance,
                bearing_bound_rad: bearing_bound_rad(neighbour, located, self.airframe_reach_m),
                spot_px: largest_spot_px(neighbour, located),
            });
            let before = self.followed.iter_mut().find(|followed| followed.track == track.id);
            match (told, before) {
                (Some(told), Some(before)) => *before = told,
                (Some(told), None) => self.followed.push(told),
                _ => {}
            }
        }
        for track in &tracked.tracks {
            let name = self.lookout.name(track.id).filter(|name| name.probability > SURE_NAME);
            let last = self.followed.iter().find(|followed| followed.track == track.id);
            hand_over(self.seen(track, last, name.map(|name| name.id), moment.time_s));
        }
    }

    /// A track in the body frame.
    fn seen(&self, track: &Track, last: Option<&Followed>, identity: Option<u32>, now_s: f64) -> Seen {
        let turn = self.body_from_camera.rotation.to_rotation_matrix();
        let about = |covariance| turn.matrix() * covariance * turn.matrix().transpose();
        let offset_m = self.body_from_camera.translation.vector;
        let mean = turn * track.position_m + offset_m;
        let covariance = about(track.position_covariance_m2);
        let bearing = Bearing::new(mean).map_or(Vector3::x_axis(), |b| Unit::new_unchecked(*b.vector()));
        let along = bearing.dot(&(covariance * bearing.into_inner()));
        let estimate = Estimate { distance_m: mean.norm(), sigma_m: along.max(0.0).sqrt() };
        // the camera sits beside the body's origin: bounds from there are wider by that
        let away_m = offset_m.norm();
        let bounds = last.map_or((0.0, f64::INFINITY), |last| {
            let bounds = last.distance.bounds;
            ((bounds.min_m() - away_m).max(0.0), bounds.max_m() + away_m)
        });
        let bearing_bound_rad = last.map_or(core::f64::consts::PI, |last| {
            let lever = (away_m / last.distance.bounds.min_m().max(away_m)).min(1.0);
            (last.bearing_bound_rad + libm::asin(lever)).min(core::f64::consts::PI)
        });
        Seen {
            track: (track.id << 2) | self.camera as u64,
            identity,
            bearing,
            bearing_bound_rad,
            distance: Distance {
                estimate: Some(estimate),
                bounds: Interval::new(bounds.0, bounds.1)
                    .unwrap_or_else(|| Interval::new(0.0, f64::INFINITY).expect("in order")),
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
