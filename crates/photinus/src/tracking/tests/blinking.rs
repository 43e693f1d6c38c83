//! Vehicles whose LEDs blink alike, one of them dead: what a frame without spots says, and which markers are looked for.

use nalgebra::Rotation3;
use rand_pcg::Pcg64;

use super::simulator::{Observer, Seen, Vehicle, camera, down, hexarotor, look};
use crate::airframe::Airframe;
use crate::camera::Bearing;
use crate::locator::Input;
use crate::pose::{Observation, Whitened};
use crate::tracking::branches::{Around, Branches};
use crate::tracking::component::{Component, Covariance, YAW};
use crate::tracking::silent::Silent;
use crate::tracking::{Blinking, Look, Settings, Turned};

const AWAY_M: f64 = 6.0;
const PERIOD_S: f64 = 1.0 / 60.0;

/// A hexarotor with a marker straight ahead of the camera, whose LED is dead: two spots, which two neighbouring markers of a nearer one make as well.
fn with_a_dead_led(airframe: &Airframe) -> Vec<Seen> {
    let still = Rotation3::identity();
    let at = |yaw_deg: f64| Vehicle::at([0.0, 0.1, AWAY_M], [0.0; 3], yaw_deg.to_radians());
    let seen = |yaw_deg: f64| look(airframe, &[at(yaw_deg)], &still, &mut Pcg64::new(3, 5));
    let most = |seen: &[Seen]| seen.iter().map(|seen| seen.spot.flux).fold(0.0, f64::max);
    let ahead = (0..60).map(f64::from).max_by(|a, b| most(&seen(*a)).total_cmp(&most(&seen(*b)))).unwrap();
    let mut seen = seen(ahead);
    assert_eq!(seen.len(), 3);
    let brightest = most(&seen);
    seen.retain(|seen| seen.spot.flux < brightest);
    seen
}

/// An observer that has a frame.
fn see(observer: &mut Observer, number: usize, seen: &[Seen], longest_dark_s: f64) {
    let spots: Vec<_> = seen.iter().map(|seen| seen.spot.clone()).collect();
    let gravity = down(&Rotation3::identity());
    let look = Look {
        camera: 0,
        time_s: number as f64 * PERIOD_S,
        turned: Some(Turned { now_from_before: Rotation3::identity(), sigma_rad: 0.0 }),
        moving: None,
        gravity: Some(gravity),
        located: observer.locator.locate(Input::spots(&spots).gravity(&gravity)).unwrap(),
        signals: &[],
        lit: &[],
        blinking: Some(Blinking {
            followed: &[],
            others: 0.5,
            longest_dark_s,
            alike: true,
            called: &[],
            strangers: &[],
            named: &[],
        }),
    };
    observer.tracker.track(&look).unwrap();
}

/// The distributions of the only vehicle, those as far away as it is and those that are nearer.
fn far_and_near(observer: &Observer) -> [Vec<Component>; 2] {
    let state = observer.tracker.history.newest().unwrap();
    assert_eq!(state.targets.len(), 1);
    let all = state.components(&state.targets[0]).iter().copied();
    let (far, near) = all.partition(|own| own.pose.position_m.norm() > 0.85 * AWAY_M);
    [far, near]
}

fn weight(components: &[Component]) -> f64 {
    components.iter().map(|component| component.weight).sum()
}

#[test]
fn dark_frames_say_the_same_of_poses_with_two_markers_and_with_three() {
    let mut observer = Observer::new(hexarotor(), Settings::default());
    let seen = with_a_dead_led(&observer.airframe);
    see(&mut observer, 0, &seen, f64::INFINITY);
    let before = far_and_near(&observer).map(|own| weight(&own));
    assert!(before.iter().all(|&share| share > 1e-3), "{before:?}");
    (1..4).for_each(|number| see(&mut observer, number, &[], f64::INFINITY));
    let after = weight(&far_and_near(&observer)[0]);
    assert!((after / before[0] - 1.0).abs() < 0.1, "{before:?}, {after}");
}

#[test]
fn who_is_dark_for_longer_than_anybody_is_hidden_or_gone() {
    let shown = |longest_dark_s: f64| {
        let mut observer = Observer::new(hexarotor(), Settings::default());
        let seen = with_a_dead_led(&observer.airframe);
        see(&mut observer, 0, &seen, longest_dark_s);
        (1..6).for_each(|number| see(&mut observer, number, &[], longest_dark_s));
        let target = observer.tracker.history.newest().unwrap().targets[0];
        target.existence * (1.0 - target.hidden)
    };
    assert!(shown(3.5 * PERIOD_S) < 0.2 * shown(f64::INFINITY));
}

#[test]
fn a_marker_beyond_the_edge_is_looked_for_where_yaw_is_unsure() {
    let (airframe, mut branches) = (hexarotor(), Branches::with_room(6));
    let seen = with_a_dead_led(&airframe);
    let mut observer = Observer::new(hexarotor(), Settings::default());
    see(&mut observer, 0, &seen, f64::INFINITY);
    let far = far_and_near(&observer)[0][0];
    // turned so that one of the two markers shines away by 4 degrees
    let turned = Rotation3::from_axis_angle(&nalgebra::Vector3::z_axis(), 34f64.to_radians());
    let mut pose = far.pose;
    pose.camera_from_body *= turned;
    let dark = (0..6).filter(|&own| airframe.intensity(own, &pose.camera_in_body_m()) == 0.0);
    let direction = |own: usize| {
        Bearing::new(pose.camera_from_body * airframe.markers()[own].position_m + pose.position_m).unwrap()
    };
    let camera_m = pose.camera_in_body_m();
    let edge = dark
        .max_by(|&a, &b| {
            let ahead = |own: usize| airframe.markers()[own].position_m.dot(&camera_m);
            ahead(a).total_cmp(&ahead(b))
        })
        .unwrap();
    let observation = Observation {
        bearing: direction(edge),
        covariance_rad2: nalgebra::Matrix3::identity() * 1e-8,
        log_light: None,
        resolution_rad: 1e-3,
        signal: None,
        clutter_log_density: -5.0,
    };
    let whitened = [Whitened::of(&observation, 0.0)];
    let mut is_found = |yaw_sigma_rad: f64| {
        let mut covariance = Covariance::identity() * 1e-4;
        covariance[(YAW, YAW)] = yaw_sigma_rad * yaw_sigma_rad;
        let component = Component { pose, covariance, silent: Silent::BEFOREHAND, ..far };
        let around = Around {
            airframe: &airframe,
            observations: &[observation],
            whitened: &whitened,
            lit: &[1.0; 6],
            missed: 0.02,
        };
        branches.grow(&around, &component, |_, _| 0.0);
        branches.grown().iter().any(|own| own.pairs.marker_of(0) == Some(edge as u16))
    };
    assert!(is_found(0.1) && !is_found(0.01));
    assert!(camera().pixel(&observation.bearing).is_some());
}
