//! The round part of the point spread: its radial profile, level and light of every spot solved with it.
//!
//! A faint wide halo and the level under a spot look much alike: improved in turn, either would keep what the other got wrong at
//! first. Here the corrections of the profile are solved for with every spot's light and level eliminated.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

use super::field::Field;
use super::noise::Noise;
use super::spot::Spot;
use super::table::{Shares, Table, radius_px};

/// From one support of the profile to the next, px.
const STEP_PX: f64 = 0.6;
/// Supports, out to 12 px.
const SUPPORTS: usize = 21;
/// Corrections are believed to be of this share of the summit, before anything is seen.
const BELIEVED: f64 = 0.1;
/// Farther out than this there is no light, px: what the profile has there belongs to the level.
const LAST_PX: f64 = 11.0;

/// The supports around a radius with the share of each; `None` past the last.
fn supports(radius_px: f64) -> Option<[(usize, f64); 2]> {
    let at = radius_px / STEP_PX;
    let first = at as usize;
    (first + 1 < SUPPORTS).then(|| [(first, 1.0 - at.fract()), (first + 1, at.fract())])
}

/// Corrects the profile of a table by what spots leave.
pub(super) fn correct(table: &mut Table, spots: &[Spot<'_>], field: &Field, noise: &Noise) {
    let summit = table.samples.iter().copied().fold(0.0, f64::max);
    let mut normal = DMatrix::<f64>::zeros(SUPPORTS, SUPPORTS);
    let mut right = DVector::<f64>::zeros(SUPPORTS);
    let mut shares = Shares::default();
    for spot in spots.iter().filter(|spot| spot.is_used && spot.window.reach >= 8) {
        let (mut own, mut own_right) = (Matrix2::zeros(), Vector2::zeros());
        let mut across = DMatrix::<f64>::zeros(SUPPORTS, 2);
        let at = field.at(spot.place_px());
        spot.each_pixel(at, noise, usize::MAX, &mut shares, |pixel| {
            let radius = libm::hypot(pixel.column as f64 - spot.u, pixel.row as f64 - spot.v);
            let Some(two) = supports(radius) else { return };
            let most = 6.0 / pixel.weight.sqrt() + 0.05 * summit * spot.light;
            let left = pixel.left.clamp(-most, most);
            let row = Vector2::new(pixel.light / spot.light, 1.0);
            own += row * row.transpose() * pixel.weight;
            own_right += row * (left * pixel.weight);
            for (support, near) in two {
                let weight = near * spot.light * pixel.weight;
                right[support] += weight * left;
                (0..2).for_each(|k| across[(support, k)] += weight * row[k]);
                for (other, near) in two {
                    normal[(support, other)] += weight * near * spot.light;
                }
            }
        });
        let Some(inverse) = own.try_inverse() else { continue };
        let weighed = &across * inverse;
        normal -= &weighed * across.transpose();
        right -= weighed * own_right;
    }
    let belief = 1.0 / (BELIEVED * summit * BELIEVED * summit);
    (0..SUPPORTS).for_each(|support| normal[(support, support)] += belief);
    let Some(found) = normal.cholesky().map(|factor| factor.solve(&right)) else { return };
    let value = |radius_px: f64| {
        supports(radius_px)
            .map_or(found[SUPPORTS - 1], |two| two.iter().map(|&(k, near)| near * found[k]).sum())
    };
    for (sample, share) in table.samples.iter_mut().enumerate() {
        *share += value(radius_px(sample));
    }
    let rim = |(sample, _): &(usize, &f64)| (radius_px(*sample) - LAST_PX).abs() < 0.5;
    let last: Vec<f64> = table.samples.iter().enumerate().filter(rim).map(|(_, share)| *share).collect();
    let rest = last.iter().sum::<f64>() / last.len() as f64;
    for (sample, share) in table.samples.iter_mut().enumerate() {
        *share = if radius_px(sample) < LAST_PX { *share - rest } else { 0.0 };
    }
    table.settle_in(noise);
}
