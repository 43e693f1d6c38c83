//! The paper's first experiment: one LED that recedes along the optical axis, and the size of its spot.
//!
//! Figures 10 and 11 of the paper count the pixels at or above a threshold. What a distance gives depends on where in a
//! pixel the point falls; here it falls on a raster of places in one octant of a pixel (the others are its mirror images),
//! without noise, so that the smallest and the largest spot are known rather than sampled.

use crate::optics::{Lens, PointLight};
use crate::sensor::{Charge, Sensor};
use crate::source::Emitter;

/// One camera and one LED on its axis.
#[derive(Clone, Debug)]
pub struct RecedingLed {
    /// The LED.
    pub emitter: Emitter,
    /// The lens.
    pub lens: Lens,
    /// The sensor.
    pub sensor: Sensor,
    /// Angle per pixel at the axis, rad/px (k of the paper's (1)).
    pub rad_per_px: f64,
    /// Grey level from which a pixel counts.
    pub threshold_dn: u8,
}

/// The areas that a distance gives, over all places in a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Areas {
    /// Smallest spot, px; 0 where one place gives none.
    pub min_px: u32,
    /// Largest spot, px.
    pub max_px: u32,
}

impl RecedingLed {
    /// Side of the patch that is rendered, px: room for a spot of 0.3 m distance.
    const PATCH_PX: usize = 48;
    /// Steps from the centre of a pixel to its border.
    const STEPS: u32 = 4;

    /// Photo-electrons in all, from `distance_m` in an exposure of `exposure_us`.
    pub fn electrons(&self, distance_m: f64, exposure_us: f64) -> f64 {
        let power_w = self.lens.gathered_w(self.emitter.irradiance_w_m2(1.0, distance_m), 0.0);
        self.sensor.photo_electrons(power_w, exposure_us * 1e-6, self.emitter.photon_j())
    }

    /// Pixels at or above the threshold, for a point that falls `offset_px` from the centre of a pixel.
    pub fn area_px(&self, distance_m: f64, exposure_us: f64, offset_px: [f64; 2]) -> u32 {
        let mut charge = Charge::new(Self::PATCH_PX, Self::PATCH_PX);
        let middle = (Self::PATCH_PX / 2) as f64;
        let light = PointLight {
            u_px: middle + offset_px[0],
            v_px: middle + offset_px[1],
            electrons: self.electrons(distance_m, exposure_us),
            off_axis_rad: 0.0,
            radius_px: self.emitter.radius_m / distance_m / self.rad_per_px,
            among: 1.0,
            outward: [0.0; 2],
        };
        self.lens.spread.draw(&light, &mut charge);
        self.sensor.overflow.settle(&mut charge, self.sensor.full_well_e);
        // a pixel reads as the threshold from half a level below on
        let least = self.sensor.electrons_at(f64::from(self.threshold_dn) - 0.5) as f32;
        let count = |v| charge.row(v).iter().filter(|electrons| **electrons >= least).count();
        (0..Self::PATCH_PX).map(count).sum::<usize>() as u32
    }

    /// The areas at a distance.
    pub fn areas(&self, distance_m: f64, exposure_us: f64) -> Areas {
        let place = |step: u32| 0.5 * f64::from(step) / f64::from(Self::STEPS);
        let mut areas = Areas { min_px: u32::MAX, max_px: 0 };
        for i in 0..=Self::STEPS {
            for j in 0..=i {
                let area_px = self.area_px(distance_m, exposure_us, [place(i), place(j)]);
                areas = Areas { min_px: areas.min_px.min(area_px), max_px: areas.max_px.max(area_px) };
            }
        }
        areas
    }

    /// The distance past which no spot is larger than a pixel, m; searched from 0.3 m to 40 m.
    pub fn last_two_px_m(&self, exposure_us: f64) -> f64 {
        bisect(|distance_m| self.areas(distance_m, exposure_us).max_px > 1)
    }

    /// The distance from which on some spot is one pixel or less, m; searched from 0.3 m to 40 m.
    pub fn first_one_px_m(&self, exposure_us: f64) -> f64 {
        bisect(|distance_m| self.areas(distance_m, exposure_us).min_px > 1)
    }

    /// The distance past which a point in the middle of a pixel is below the threshold, m: the range of detection.
    pub fn last_seen_m(&self, exposure_us: f64) -> f64 {
        bisect(|distance_m| self.area_px(distance_m, exposure_us, [0.0; 2]) > 0)
    }

    /// The distance past which some place in a pixel gives no spot, m: where drop-outs begin.
    pub fn last_always_seen_m(&self, exposure_us: f64) -> f64 {
        bisect(|distance_m| self.areas(distance_m, exposure_us).min_px > 0)
    }
}

/// The largest distance at which `holds`, to a millimetre, for what holds near by and not far away.
fn bisect(holds: impl Fn(f64) -> bool) -> f64 {
    let (mut near_m, mut far_m) = (0.3, 40.0);
    while far_m - near_m > 1e-3 {
        let middle_m = 0.5 * (near_m + far_m);
        if holds(middle_m) { near_m = middle_m } else { far_m = middle_m }
    }
    near_m
}
