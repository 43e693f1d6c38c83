//! Neighbours -> OBSTACLE_DISTANCE: how near something surely may be, by direction.
//!
//! A distance is the strict minimum, never the estimate. A direction into which no camera looks is unknown, and so is, unless the settings
//! say otherwise, one in which no neighbour is seen: a camera that sees ultraviolet markers does not see trees.

use core::f64::consts::{PI, TAU};

use mavlink::dialects::common::{MavDistanceSensor, MavFrame, OBSTACLE_DISTANCE_DATA};
use nalgebra::{UnitQuaternion, Vector3};
use photinus::camera::{Bearing, Camera};
use photinus::frame::Mask;
use photinus_io::results::FrameRecord;

/// Directions of one message.
pub const SECTORS: usize = 72;
const SECTOR_RAD: f64 = TAU / SECTORS as f64;
/// What nobody knows.
pub const UNKNOWN_CM: u16 = u16::MAX;
/// A neighbour may be this many sigma beside its bearing.
const SIGMAS: f64 = 3.0;
/// The sector of a direction is looked into at this many elevations, on both sides of the horizon.
const LOOKS: i32 = 3;

/// What neighbours are taken for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacles {
    /// How far from its origin a neighbour reaches, m: distances are to its hull.
    pub radius_m: f64,
    /// Neighbours are seen up to here, m: farther ones are not told.
    pub reach_m: f64,
    /// Whether a direction into which a camera looks and sees no neighbour is told as free up to the reach.
    pub tells_free: bool,
}

/// What one camera tells of the directions around its vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct Outlook {
    body_from_camera: UnitQuaternion<f64>,
    /// How far it is from its vehicle's origin, m.
    lever_m: f64,
    /// The directions into which it looks, all of each.
    sees: [bool; SECTORS],
}

impl Outlook {
    /// The directions that a camera sees that is mounted so: the whole sector near the horizon is within its field and not masked.
    #[must_use]
    pub fn new(
        camera: &Camera,
        (body_from_camera, camera_m): (UnitQuaternion<f64>, Vector3<f64>),
        mask: Option<&Mask>,
    ) -> Self {
        let is_seen = |ahead: Vector3<f64>| {
            let bearing = Bearing::new(body_from_camera.inverse() * ahead);
            let pixel = bearing.and_then(|bearing| camera.pixel(&bearing));
            pixel.is_some_and(|pixel| {
                let inside = |px: f64, size: usize| px > -0.5 && px < size as f64 - 0.5;
                inside(pixel.u, camera.width())
                    && inside(pixel.v, camera.height())
                    && mask
                        .is_none_or(|mask| !mask.ignores(pixel.u.round() as usize, pixel.v.round() as usize))
            })
        };
        let mut sees = [false; SECTORS];
        for (sector, seen) in sees.iter_mut().enumerate() {
            let looks = (-LOOKS..=LOOKS).flat_map(|side| (-1..=1).map(move |up| (side, up)));
            *seen = looks.into_iter().all(|(side, up)| {
                let right_rad = (sector as f64 + 0.5 * f64::from(side) / f64::from(LOOKS)) * SECTOR_RAD;
                let up_rad = f64::from(up) * 0.5 * SECTOR_RAD;
                let level = libm::cos(up_rad);
                is_seen(Vector3::new(
                    level * libm::cos(right_rad),
                    -level * libm::sin(right_rad),
                    libm::sin(up_rad),
                ))
            });
        }
        Self { body_from_camera, lever_m: camera_m.norm(), sees }
    }
}

/// Distances by direction: index 0 ahead, then to the right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    settings: Obstacles,
    nearest_m: [Option<f64>; SECTORS],
    sees: [bool; SECTORS],
}

impl Ring {
    /// Nothing is known.
    #[must_use]
    pub fn unknown(settings: Obstacles) -> Self {
        Self { settings, nearest_m: [None; SECTORS], sees: [false; SECTORS] }
    }

    /// Adds what a camera sees. Who is followed through the dark counts, too: with the nearest distance that is likely at all.
    pub fn add(&mut self, record: &FrameRecord, outlook: &Outlook) {
        for (sector, seen) in outlook.sees.iter().enumerate() {
            self.sees[sector] |= seen;
        }
        // Distances are from the camera, and told from the vehicle's origin.
        let radius_m = self.settings.radius_m + outlook.lever_m;
        for neighbour in &record.neighbours {
            let sigma_rad =
                neighbour.position_m.zip(neighbour.position_covariance_m2).map_or(0.0, |(at_m, m2)| {
                    let [[xx, ..], [_, yy, _], [.., zz]] = m2;
                    let away_m2: f64 = at_m.iter().map(|axis| axis * axis).sum();
                    ((xx + yy + zz) / away_m2.max(1e-6)).sqrt()
                });
            self.put(
                outlook.body_from_camera * Vector3::from(neighbour.bearing),
                neighbour.distance_m.min,
                sigma_rad,
                radius_m,
            );
        }
        for track in record.tracks.iter().filter(|track| track.predicted) {
            let place = Vector3::from(track.position_m);
            let [[xx, ..], [_, yy, _], [.., zz]] = track.position_covariance_m2;
            let sigma_m = (xx + yy + zz).sqrt();
            let nearest_m = (place.norm() - SIGMAS * sigma_m).max(0.0);
            self.put(outlook.body_from_camera * place, nearest_m, sigma_m / place.norm().max(1e-3), radius_m);
        }
    }

    /// Something that way, not nearer than `least_m` to its origin.
    fn put(&mut self, ahead_flu: Vector3<f64>, least_m: f64, sigma_rad: f64, radius_m: f64) {
        let hull_m = (least_m - radius_m).max(0.0);
        if hull_m > self.settings.reach_m {
            return;
        }
        let level = libm::hypot(ahead_flu.x, ahead_flu.y);
        let right_rad = libm::atan2(-ahead_flu.y, ahead_flu.x);
        // Who may be as near as its own size is all around.
        let own_rad =
            if least_m <= radius_m { PI } else { libm::asin(radius_m / least_m) + SIGMAS * sigma_rad };
        // Above or below, a small angle is a wide one around.
        let steep = level / ahead_flu.norm().max(1e-9);
        let half_rad = if own_rad >= libm::asin(steep.clamp(0.0, 1.0)) {
            PI
        } else {
            libm::asin((libm::sin(own_rad) / steep).min(1.0))
        };
        for (sector, nearest_m) in self.nearest_m.iter_mut().enumerate() {
            let off = sector as f64 * SECTOR_RAD - right_rad;
            let off = (off - TAU * (off / TAU).round()).abs();
            if off <= half_rad + 0.5 * SECTOR_RAD {
                *nearest_m = Some(nearest_m.map_or(hull_m, |known| known.min(hull_m)));
            }
        }
    }

    /// Distances in cm, rounded down; one more than the reach is free.
    #[must_use]
    pub fn distances_cm(&self) -> [u16; SECTORS] {
        let reach_cm = self.reach_cm();
        core::array::from_fn(|sector| match self.nearest_m[sector] {
            Some(hull_m) => ((hull_m * 100.0).floor() as u16).min(reach_cm),
            None if self.settings.tells_free && self.sees[sector] => reach_cm + 1,
            None => UNKNOWN_CM,
        })
    }

    fn reach_cm(&self) -> u16 {
        (self.settings.reach_m * 100.0).floor().clamp(1.0, f64::from(UNKNOWN_CM - 2)) as u16
    }

    /// The message, of a time on the sender's clock.
    #[must_use]
    pub fn message(&self, time_usec: u64) -> OBSTACLE_DISTANCE_DATA {
        OBSTACLE_DISTANCE_DATA {
            time_usec,
            distances: self.distances_cm(),
            min_distance: 0,
            max_distance: self.reach_cm(),
            sensor_type: MavDistanceSensor::MAV_DISTANCE_SENSOR_UNKNOWN,
            increment: 0,
            increment_f: (360.0 / SECTORS as f64) as f32,
            angle_offset: 0.0,
            frame: MavFrame::MAV_FRAME_BODY_FRD,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: Obstacles = Obstacles { radius_m: 0.4, reach_m: 30.0, tells_free: true };

    fn ring(ahead_flu: [f64; 3], least_m: f64, sigma_rad: f64) -> Ring {
        let mut ring = Ring::unknown(SETTINGS);
        ring.put(Vector3::from(ahead_flu).normalize(), least_m, sigma_rad, SETTINGS.radius_m);
        ring
    }

    fn told(ring: &Ring) -> Vec<usize> {
        ring.distances_cm()
            .iter()
            .enumerate()
            .filter(|told| *told.1 != UNKNOWN_CM)
            .map(|told| told.0)
            .collect()
    }

    #[test]
    fn right_is_after_ahead_and_distances_are_to_the_hull() {
        let right = ring([0.0, -1.0, 0.0], 4.0, 0.0);
        assert_eq!(told(&right), [17, 18, 19]);
        assert_eq!(right.distances_cm()[18], 360);
        assert_eq!(told(&ring([0.0, 1.0, 0.0], 4.0, 0.0)), [53, 54, 55]);
        assert_eq!(told(&ring([1.0, 0.0, 0.0], 4.0, 0.0)), [0, 1, 71]);
        assert!(told(&ring([1.0, 0.0, 0.0], 31.0, 0.0)).is_empty(), "beyond the reach");
    }

    #[test]
    fn what_is_near_or_overhead_is_all_around() {
        assert_eq!(told(&ring([1.0, 0.0, 0.0], 0.3, 0.0)).len(), SECTORS);
        assert_eq!(told(&ring([0.01, 0.0, 1.0], 5.0, 0.0)).len(), SECTORS);
    }

    #[test]
    fn every_point_of_a_hull_is_in_a_sector_that_tells_no_more_than_its_distance() {
        let mut random = rand_pcg::Pcg64::new(2, 9);
        let mut normal = || {
            <rand_distr::StandardNormal as rand_distr::Distribution<f64>>::sample(
                &rand_distr::StandardNormal,
                &mut random,
            )
        };
        for _ in 0..20_000 {
            let place = Vector3::new(normal(), normal(), normal()) * 6.0;
            let ring = ring(place.into(), place.norm(), 0.0);
            let point = place + Vector3::new(normal(), normal(), normal()).normalize() * SETTINGS.radius_m;
            let right_rad = libm::atan2(-point.y, point.x);
            let sector = (right_rad / SECTOR_RAD).round().rem_euclid(SECTORS as f64) as usize;
            if point.norm() > 1e-3 && place.norm() < SETTINGS.reach_m {
                let told_m = f64::from(ring.distances_cm()[sector]) / 100.0;
                assert!(told_m <= point.norm() + 1e-9, "{place} {point}: {told_m}");
            }
        }
    }

    #[test]
    fn nothing_is_told_of_where_nobody_looks() {
        let mut ring = Ring::unknown(SETTINGS);
        assert_eq!(ring.distances_cm(), [UNKNOWN_CM; SECTORS]);
        ring.sees[5] = true;
        assert_eq!((ring.distances_cm()[5], ring.distances_cm()[6]), (3001, UNKNOWN_CM));
        ring.settings.tells_free = false;
        assert_eq!(ring.distances_cm(), [UNKNOWN_CM; SECTORS]);
    }
}
