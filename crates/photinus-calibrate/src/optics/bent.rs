//! The table of the spots and that of two Gaussians which learning began with, in; how far places may be off by where in a pixel they are, out.
//!
//! A bent table with uneven places explains spots as well as a straight one with even places: what the places of the beginning were off by, the table that was made
//! of them keeps, but for what their evenness tells (`phases.rs`). So spots of the table are fitted with two Gaussians all over a pixel.

use nalgebra::{Matrix4, Vector4};

use super::noise::Noise;
use super::table::{Shares, Table};

/// Places along each axis of a pixel.
const PLACES: usize = 8;
/// Pixels to every side of the middle that a fit sees.
const REACH: usize = 5;
const STEPS: usize = 6;
/// The level of a spot is known to this from the ring around, grey levels.
const LEVEL_SIGMA_DN: f64 = 0.2;

/// Anywhere in a pixel: no spot that is seen is further off, px (standard deviation).
const ANYWHERE_PX: f64 = 0.29;

/// How far places are off, px (standard deviations along an axis).
#[derive(Clone, Copy, Debug)]
pub(super) struct Bend {
    /// By where in a pixel they are along that axis.
    pub(super) along_px: f64,
    /// And beyond that, by where they are along the other.
    pub(super) across_px: f64,
}

impl Bend {
    /// Of what places along an axis may be off by, their evenness tells all but so much. What is sheared is as even as before.
    pub(super) fn told_to_px(self, even_px: f64) -> f64 {
        libm::hypot(self.along_px.min(even_px), self.across_px).min(ANYWHERE_PX)
    }
}

/// Spots of this light by the `table`, fitted with the `start`. What all of them have in common is not counted; infinite where some have no place by it.
pub(super) fn places_px(table: &Table, start: &Table, noise: &Noise, light: f64) -> Bend {
    let along = |index: usize| (index as f64 + 0.5) / PLACES as f64 - 0.5;
    let offs = (0..PLACES * PLACES).map(|place| {
        let at = [along(place % PLACES), along(place / PLACES)];
        off_px(table, start, noise, light, at)
    });
    let Some(offs) = offs.collect::<Option<Vec<[f64; 2]>>>() else {
        return Bend { along_px: f64::INFINITY, across_px: f64::INFINITY };
    };
    let (mut all, mut along) = (0.0, 0.0);
    for axis in 0..2 {
        let line_of = |place: usize| [place % PLACES, place / PLACES][axis];
        let middle = offs.iter().map(|off| off[axis]).sum::<f64>() / offs.len() as f64;
        let mut lines = [0.0; PLACES];
        offs.iter().enumerate().for_each(|(place, off)| lines[line_of(place)] += off[axis]);
        for (place, off) in offs.iter().enumerate() {
            let of_line = lines[line_of(place)] / PLACES as f64 - middle;
            all += (off[axis] - middle) * (off[axis] - middle);
            along += of_line * of_line;
        }
    }
    let sigma = |squares: f64| (squares.max(0.0) / (2 * offs.len()) as f64).sqrt();
    Bend { along_px: sigma(along), across_px: sigma(all - along) }
}

/// How far off a fit with the `start` places a spot of the `table`; `None` where it tells no place.
fn off_px(table: &Table, start: &Table, noise: &Noise, light: f64, [u, v]: [f64; 2]) -> Option<[f64; 2]> {
    let (mut seen, mut shares) = (Shares::default(), Shares::default());
    table.window(u, v, REACH, &mut seen);
    let mut numbers = Vector4::from([u, v, light, 0.0]);
    for _ in 0..STEPS {
        start.window(numbers[0], numbers[1], REACH, &mut shares);
        let mut normal = Matrix4::zeros();
        normal[(3, 3)] = 1.0 / (LEVEL_SIGMA_DN * LEVEL_SIGMA_DN);
        let mut right = Vector4::from([0.0, 0.0, 0.0, -numbers[3] * normal[(3, 3)]]);
        for (seen, share) in seen.of_pixels.iter().zip(&shares.of_pixels) {
            let own = numbers[2] * share.value;
            let weight = 1.0 / noise.variance(own);
            let row = Vector4::from([numbers[2] * share.by_u, numbers[2] * share.by_v, share.value, 1.0]);
            normal += row * row.transpose() * weight;
            right += row * (weight * (light * seen.value - own - numbers[3]));
        }
        let mut step = normal.cholesky()?.solve(&right);
        (0..2).for_each(|axis| step[axis] = step[axis].clamp(-0.3, 0.3));
        numbers += step;
    }
    let off = [numbers[0] - u, numbers[1] - v];
    off.iter().all(|off| off.abs() < 0.5).then_some(off)
}

#[cfg(test)]
mod tests {
    use photinus::optics::Gaussian;

    use super::super::table::{COUNT, PER_PX, SIDE, radius_px};
    use super::*;

    const NOISE: Noise = Noise { dark: 0.44, shot: 0.03, shape: 0.0, bend: 0.0, is_dark_seen: true };

    fn gaussian(sigma_px: f64) -> Table {
        Table::gaussians(&[Gaussian { share: 1.0, sigma_px }])
    }

    #[test]
    fn what_two_gaussians_explain_is_straight() {
        for sigma_px in [0.3, 0.6, 1.5] {
            let off = places_px(&gaussian(sigma_px), &gaussian(sigma_px), &NOISE, 300.0);
            assert!(off.told_to_px(1.0) < 1e-6, "{off:?} at {sigma_px} px");
        }
        let off = places_px(&gaussian(0.4), &gaussian(0.3), &NOISE, 300.0);
        assert!((0.01..0.1).contains(&off.told_to_px(1.0)), "{off:?} by one that is too sharp");
        let dark = Table::new(vec![0.0; COUNT]);
        let none = places_px(&gaussian(0.4), &dark, &NOISE, 300.0);
        assert!((none.told_to_px(1.0) - ANYWHERE_PX).abs() < 1e-9, "no light tells no place");
    }

    /// A table whose samples are moved along rows by a wave of 0.03 px, by where they are along rows (0) or along columns (1).
    fn waved(axis: usize) -> Table {
        let even = gaussian(0.6);
        let bent = (0..COUNT).map(|sample| {
            let (column, row) = (sample % SIDE, sample / SIDE);
            let from_middle = |place: usize| (place as f64 - (SIDE / 2) as f64) / PER_PX as f64;
            let off = 0.03 * libm::sin(core::f64::consts::TAU * from_middle([column, row][axis]));
            let slope = if (1..SIDE - 1).contains(&column) {
                let at = |column: usize| even.samples[row * SIDE + column];
                0.5 * PER_PX as f64 * (at(column + 1) - at(column - 1))
            } else {
                0.0
            };
            if radius_px(sample) < 6.0 { even.samples[sample] + slope * off } else { 0.0 }
        });
        Table::new(bent.collect())
    }

    /// A table that is itself bent places spots so wrong: of a wave along rows evenness tells, of one across them it does not.
    #[test]
    fn a_bent_table_is_off_by_its_bend() {
        let even = gaussian(0.6);
        let rms = 0.03 / 2.0; // of a wave along one of two axes
        for (axis, told_px) in [(0, 0.004), (1, rms)] {
            let bend = places_px(&waved(axis), &even, &NOISE, 300.0);
            let (own, other) = [(bend.along_px, bend.across_px), (bend.across_px, bend.along_px)][axis];
            assert!((own / rms - 1.0).abs() < 0.1, "{bend:?} not {rms}");
            assert!(other < 0.1 * rms, "{bend:?}");
            assert!((bend.told_to_px(0.004) / told_px - 1.0).abs() < 0.1, "{bend:?}");
        }
    }
}
