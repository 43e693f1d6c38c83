//! Fixed pattern: pixels that are not all alike, the same in every frame of a unit.
//!
//! EMVA 1288 calls the spread of dark levels DSNU and that of gains PRNU. Full wells differ as gains do, and columns have
//! amplifiers of their own. All are normal; where they lie is a matter of the unit.

use std::sync::Arc;

use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::Charge;
use super::noise::hash;

/// How unequal the pixels are: sigmas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pattern {
    /// Of the dark level of a pixel, grey levels.
    pub offset_dn: f64,
    /// Of the dark level of a column, grey levels.
    pub column_offset_dn: f64,
    /// Of the photo-electrons of a pixel, as a share.
    pub gain: f64,
    /// Of the full well of a pixel, as a share.
    pub well: f64,
}

impl Pattern {
    /// Pixels that are all alike.
    pub const NONE: Self = Self { offset_dn: 0.0, column_offset_dn: 0.0, gain: 0.0, well: 0.0 };

    pub(super) fn is_none(&self) -> bool {
        [self.offset_dn, self.column_offset_dn, self.gain, self.well].iter().all(|sigma| *sigma <= 0.0)
    }
}

/// The pattern of a unit, pixel by pixel.
#[derive(Clone, Debug)]
pub(super) struct Map {
    width: usize,
    has_wells: bool,
    /// Shared among threads that render the same camera.
    pixels: Arc<[PixelPattern]>,
}

/// What is particular about a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelPattern {
    pub(super) offset_dn: f32,
    pub(super) gain: f32,
    pub(super) well: f32,
    /// What is seen of the background: its gain, and less of it where something stands before the pixel.
    pub(super) background: f32,
}

impl Map {
    /// The pattern of unit number `unit`.
    pub(super) fn new(pattern: &Pattern, (width, height): (usize, usize), unit: u64) -> Self {
        let numbers = |salt: u64| {
            let mut random = Pcg64::new(u128::from(hash(unit ^ hash(salt))), 0xfb);
            move || -> f64 { StandardNormal.sample(&mut random) }
        };
        let (mut column, mut offset, mut gain, mut well) = (numbers(1), numbers(2), numbers(3), numbers(4));
        let columns: Vec<f64> = (0..width).map(|_| pattern.column_offset_dn * column()).collect();
        let pixels = (0..width * height).map(|index| {
            let gain = (1.0 + pattern.gain * gain()).max(0.0) as f32;
            PixelPattern {
                offset_dn: (columns[index % width] + pattern.offset_dn * offset()) as f32,
                gain,
                well: (1.0 + pattern.well * well()).max(0.1) as f32,
                background: gain,
            }
        });
        Self { width, has_wells: pattern.well > 0.0, pixels: pixels.collect() }
    }

    /// Whether full wells differ.
    pub(super) fn has_wells(&self) -> bool {
        self.has_wells
    }

    /// The full well of a pixel against that of the sensor.
    pub(super) fn well(&self, u: usize, v: usize) -> f32 {
        self.pixels[v * self.width + u].well
    }

    /// The pixels of row `v` from column `first` on.
    pub(super) fn row(&self, first: usize, v: usize) -> &[PixelPattern] {
        &self.pixels[v * self.width + first..(v + 1) * self.width]
    }

    /// Lets hidden pixels see the background `brightness` times as bright.
    pub(super) fn hide(&mut self, hidden: &[bool], brightness: f32) {
        let mut pixels = self.pixels.to_vec();
        for (pixel, _) in pixels.iter_mut().zip(hidden).filter(|(_, hidden)| **hidden) {
            pixel.background = pixel.gain * brightness;
        }
        self.pixels = pixels.into();
    }

    /// Multiplies the light of every pixel by its gain.
    pub(super) fn scale(&self, charge: &mut Charge) {
        for v in 0..charge.height() {
            let Some((first, pixels)) = charge.touched_row_mut(v) else { continue };
            pixels.iter_mut().zip(self.row(first, v)).for_each(|(e, pixel)| *e *= pixel.gain);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_keeps_its_pattern_and_the_spreads_are_those_asked_for() {
        let pattern = Pattern { offset_dn: 1.5, column_offset_dn: 0.5, gain: 0.01, well: 0.02 };
        let map = |unit| Map::new(&pattern, (1000, 1000), unit);
        let one = map(7);
        let statistics = |value: &dyn Fn(&PixelPattern) -> f32| {
            let mean = one.pixels.iter().map(|p| f64::from(value(p))).sum::<f64>() / 1e6;
            let square = one.pixels.iter().map(|p| (f64::from(value(p)) - mean).powi(2)).sum::<f64>() / 1e6;
            (mean, square)
        };
        let (offset, gain, well) =
            (statistics(&|p| p.offset_dn), statistics(&|p| p.gain), statistics(&|p| p.well));
        assert!(offset.0.abs() < 0.06 && (offset.1 / 2.5 - 1.0).abs() < 0.02, "{offset:?}");
        assert!((gain.0 - 1.0).abs() < 1e-4 && (gain.1 / 1e-4 - 1.0).abs() < 0.01, "{gain:?}");
        assert!((well.0 - 1.0).abs() < 1e-4 && (well.1 / 4e-4 - 1.0).abs() < 0.01, "{well:?}");
        // the mean of a column of 1000 keeps the column's own offset: 0.5^2 + 1.5^2 / 1000
        let column = |u: usize| {
            one.pixels.iter().skip(u).step_by(1000).map(|p| f64::from(p.offset_dn)).sum::<f64>() / 1000.0
        };
        let columns = (0..1000).map(|u| column(u).powi(2)).sum::<f64>() / 1000.0;
        assert!((columns / 0.252_25 - 1.0).abs() < 0.15, "{columns}");
        let bits = |unit| map(unit).pixels[4711].gain.to_bits();
        assert_eq!(bits(7), bits(7));
        assert_ne!(bits(7), bits(8));
    }
}
