//! The pose of one photo from LEDs whose places are about known, without a guess: from many directions, the best is taken.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{UnitQuaternion, Vector3};

use super::LedSighting;
use super::adjust::Adjustment;
use crate::resection::{Free, Known, Observation, Pose, Refined, refine};
use crate::robust::Loss;

/// A photo fits badly whose cost per LED is this many squared sigmas; 2 are to be expected.
const BAD_FIT: f64 = 5.0;

/// What a photo shows, with the LEDs at `leds_m`.
pub(super) fn observations(of_photo: &[LedSighting], leds_m: &[Vector3<f64>]) -> Vec<Observation> {
    let observation =
        |seen: &LedSighting| Observation { sighted: seen.sighted, known: Known::Position(leds_m[seen.led]) };
    of_photo.iter().map(observation).collect()
}

/// The pose of least cost over starts from turns all over: each by squares, which find their way from far, then by `loss`.
pub(super) fn pose(observations: &[Observation], loss: Loss) -> Option<Refined> {
    let spread = Spread::of(observations)?;
    let found = turns().filter_map(|turn| {
        let near = refine(observations, spread.pose(turn), Free::RotationAndCentre, Loss::Squares)?;
        refine(observations, near.pose, Free::RotationAndCentre, loss)
    });
    found.min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// Poses each photo that fits badly anew with the LEDs where they now are, and keeps the new pose where it costs less: a photo
/// that had fallen for a mirror image of the layout, or for a wrong label, comes back.
pub(super) fn retry(adjustment: &mut Adjustment, sigma: f64, loss: Loss) {
    for photo in 0..adjustment.poses.len() {
        let Some(current) = adjustment.poses[photo] else { continue };
        let of_photo = adjustment.sightings().iter().filter(|sighting| sighting.photo == photo);
        let seen = observations(&of_photo.copied().collect::<Vec<_>>(), &adjustment.leds_m);
        let Some(kept) = refine(&seen, current, Free::RotationAndCentre, loss) else { continue };
        if kept.cost < BAD_FIT * sigma * sigma * seen.len() as f64 {
            continue;
        }
        if let Some(again) = pose(&seen, loss).filter(|again| again.cost < kept.cost) {
            adjustment.poses[photo] = Some(again.pose);
        }
    }
}

/// The middle of what is seen and of what is known, and how far away it is by the ratio of their sizes.
struct Spread {
    seen: Vector3<f64>,
    middle_m: Vector3<f64>,
    distance_m: f64,
}

impl Spread {
    fn of(observations: &[Observation]) -> Option<Self> {
        let count = observations.len() as f64;
        let positions_m = observations.iter().map(|seen| match seen.known {
            Known::Position(position_m) => position_m,
            Known::Direction(direction) => direction.into_inner(),
        });
        let positions_m: Vec<Vector3<f64>> = positions_m.collect();
        let bearings: Vec<Vector3<f64>> =
            observations.iter().map(|seen| *seen.sighted.bearing().vector()).collect();
        let middle_m = positions_m.iter().sum::<Vector3<f64>>() / count;
        let seen = bearings.iter().sum::<Vector3<f64>>().try_normalize(1e-6)?;
        let rms = |squares: f64| (squares / count).sqrt();
        let size_m = rms(positions_m.iter().map(|position_m| (position_m - middle_m).norm_squared()).sum());
        let angle_rad = rms(bearings.iter().map(|bearing| (bearing - seen).norm_squared()).sum());
        let distance_m = size_m / angle_rad;
        distance_m.is_finite().then_some(Self { seen, middle_m, distance_m })
    }

    fn pose(&self, body_from_camera: UnitQuaternion<f64>) -> Pose {
        Pose { body_from_camera, centre_m: self.middle_m - body_from_camera * self.seen * self.distance_m }
    }
}

/// The 24 turns of a cube and the same between them: none is farther than 45 deg from one of these.
fn turns() -> impl Iterator<Item = UnitQuaternion<f64>> {
    let quarter =
        |axis: Vector3<f64>, quarters: f64| UnitQuaternion::from_scaled_axis(axis * (quarters * FRAC_PI_2));
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    let faces = [
        quarter(x, 0.0),
        quarter(x, 1.0),
        quarter(x, 2.0),
        quarter(x, 3.0),
        quarter(y, 1.0),
        quarter(y, 3.0),
    ];
    let between = quarter(z, 0.5) * quarter(x, 0.5);
    let cube = faces
        .into_iter()
        .flat_map(move |face| (0..4).map(move |quarters| face * quarter(z, f64::from(quarters))));
    cube.flat_map(move |turn| [turn, turn * between])
}
