//! Places within a pixel are even: what a table and places may be bent by together, without any spot fitting worse, is taken out.
//!
//! A lens much sharper than its pixels does not tell a bent table with uneven places from a straight one with even places. Many
//! LEDs at many places are even, so waves in how often each place occurs are errors of the places, and of the table with them. Only of LEDs
//! that are not full at any place: of brighter ones those in the middle of a pixel are missing.

use std::collections::HashSet;

use super::spot::Spot;

/// Moves places along both axes so that they fall evenly over a pixel, as far as the number of those in which a spot `is_anywhere` tells
/// that they do not.
pub(super) fn even_out(spots: &mut [Spot<'_>], is_anywhere: impl Fn(&Spot<'_>) -> bool) {
    let counted: Vec<bool> = spots.iter().map(|spot| spot.is_used && is_anywhere(spot)).collect();
    even_out_along(spots, &counted, |spot| spot.window.column as f64 + spot.u, |spot, px| spot.u += px);
    even_out_along(spots, &counted, |spot| spot.window.row as f64 + spot.v, |spot, px| spot.v += px);
}

/// Places that are not the same: an LED that stands still is one place, however often it is seen.
fn distinct<'a, 'b: 'a>(spots: impl Iterator<Item = &'a Spot<'b>>) -> f64 {
    let cell = |px: f64| (8.0 * px).floor() as i64;
    let places: HashSet<(i64, i64)> = spots.map(Spot::place_px).map(|[u, v]| (cell(u), cell(v))).collect();
    places.len() as f64
}

fn even_out_along(
    spots: &mut [Spot<'_>],
    counted: &[bool],
    place_px: impl Fn(&Spot<'_>) -> f64,
    shift: impl Fn(&mut Spot<'_>, f64),
) {
    use core::f64::consts::{PI, TAU};
    let used = || spots.iter().zip(counted).filter(|(_, counted)| **counted).map(|(spot, _)| spot);
    let count = f64::max(used().count() as f64, 1.0);
    let mut waves = [(0.0, 0.0); 2];
    for spot in used() {
        for (number, wave) in (1..).zip(&mut waves) {
            let (sin, cos) = libm::sincos(TAU * f64::from(number) * place_px(spot));
            *wave = (wave.0 + cos / count, wave.1 + sin / count);
        }
    }
    // even places give sums of this square by chance
    let chance = 1.0 / distinct(used()).max(1.0);
    for (sum_cos, sum_sin) in &mut waves {
        let square = *sum_cos * *sum_cos + *sum_sin * *sum_sin;
        let told = (1.0 - 2.0 * chance / square.max(chance)).max(0.0);
        (*sum_cos, *sum_sin) = (*sum_cos * told, *sum_sin * told);
    }
    for spot in spots {
        let place = place_px(spot);
        let mut shift_px = 0.0;
        for (number, wave) in (1..).map(f64::from).zip(&waves) {
            let (sin, cos) = libm::sincos(TAU * number * place);
            shift_px += (wave.0 * sin - wave.1 * cos) / (PI * number);
        }
        shift(spot, 0.5 * shift_px);
    }
}
