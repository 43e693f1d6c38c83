//! Who could be seen at all: in a camera's field, with a marker that shines towards it, and nothing in between.

use nalgebra::{Isometry3, Vector3};
use photinus::camera::Bearing;
use photinus_sim::occlusion::Solid;

use super::{Moment, Present};

/// A vehicle that a camera could see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InView {
    /// Which vehicle.
    pub target: usize,
    /// The camera that sees it nearest to its axis.
    pub camera: usize,
    /// From the camera to the vehicle's origin, m.
    pub distance_m: f64,
    /// How many of its markers shine towards the camera and are not hidden.
    pub markers: usize,
    /// The brightest of them: power over squared distance times exposure, us/m^2.
    pub light: f64,
}

/// A marker fainter than this towards the camera, against one straight ahead, is not seen.
const FAINT: f64 = 0.02;

/// Whom `observer` could see, by number of the vehicle.
pub fn in_view(moment: &Moment<'_>, observer: usize, views: &mut Vec<InView>) {
    views.clear();
    let own = &moment.vehicles[observer];
    let here_m = own.kinematics.pose.translation.vector;
    for (target, other) in moment.vehicles.iter().enumerate() {
        let way_m = other.kinematics.pose.translation.vector - here_m;
        if target == observer || way_m.norm() > moment.range_m {
            continue;
        }
        views.extend(best_camera(own, other).and_then(|(camera, world_from_camera)| {
            shines(moment, observer, target, camera, &world_from_camera)
        }));
    }
}

/// The camera in whose image the other's centre is nearest to the axis, and its pose.
fn best_camera(own: &Present, other: &Present) -> Option<(usize, Isometry3<f64>)> {
    let centre_m = other.kinematics.pose.translation.vector;
    let cameras = own.kind.cameras.iter().zip(&own.cameras_work).enumerate();
    let seeing = cameras.filter(|(_, (_, works))| **works).filter_map(|(index, (mounted, _))| {
        let world_from_camera = own.kinematics.pose * mounted.body_from_camera;
        let bearing = Bearing::new(local(&world_from_camera, &centre_m))?;
        mounted.camera.pixel(&bearing)?;
        Some((bearing.off_axis_rad(), index, world_from_camera))
    });
    seeing.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, index, pose)| (index, pose))
}

/// What of the other's markers shines towards the camera.
fn shines(
    moment: &Moment<'_>,
    observer: usize,
    target: usize,
    camera: usize,
    world_from_camera: &Isometry3<f64>,
) -> Option<InView> {
    let other = &moment.vehicles[target];
    let camera_m = world_from_camera.translation.vector;
    let centre_m = other.kinematics.pose.translation.vector;
    let hidden = moment.obstacles.iter().any(|obstacle| obstacle.hides(&camera_m, &centre_m));
    if hidden || eclipsed(moment, observer, target, &camera_m, &centre_m) {
        return None;
    }
    let in_body_m = local(&other.kinematics.pose, &camera_m);
    let (mut markers, mut strongest) = (0, 0.0_f64);
    for marker in other.kind.airframe.markers() {
        let leds = other.kind.airframe.leds();
        let light: f64 =
            marker.leds.iter().map(|&led| leds[led].intensity(&in_body_m) * other.powers[led]).sum();
        let own_body_hides = other.kind.solids.iter().any(|solid| solid.cuts(&in_body_m, &marker.position_m));
        if light > FAINT && !own_body_hides {
            markers += 1;
            strongest = strongest.max(light);
        }
    }
    let distance_m = (centre_m - camera_m).norm();
    let light = strongest / (distance_m * distance_m) * moment.exposure_us;
    (markers > 0).then_some(InView { target, camera, distance_m, markers, light })
}

/// Whether another vehicle's body stands in between.
fn eclipsed(
    moment: &Moment<'_>,
    observer: usize,
    target: usize,
    camera_m: &Vector3<f64>,
    centre_m: &Vector3<f64>,
) -> bool {
    let way_m = centre_m - camera_m;
    let length_m = way_m.norm();
    moment.vehicles.iter().enumerate().any(|(index, between)| {
        if index == observer || index == target {
            return false;
        }
        let pose = &between.kinematics.pose;
        let off_m = pose.translation.vector - camera_m;
        let along_m = off_m.dot(&way_m) / length_m;
        let reach_m = between.kind.solids.iter().map(Solid::reach_m).fold(0.0, f64::max);
        if along_m <= 0.0
            || along_m >= length_m
            || off_m.norm_squared() - along_m * along_m > reach_m * reach_m
        {
            return false;
        }
        let (from_m, to_m) = (local(pose, camera_m), local(pose, centre_m));
        between.kind.solids.iter().any(|solid| solid.cuts(&from_m, &to_m))
    })
}

/// A place of the world in the body frame of a pose, m.
fn local(pose: &Isometry3<f64>, place_m: &Vector3<f64>) -> Vector3<f64> {
    pose.rotation.inverse() * (place_m - pose.translation.vector)
}
