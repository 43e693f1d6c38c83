//! Places within a pixel are even: what a table and places may be bent by together, without any spot fitting worse, is taken out.
//!
//! A lens much sharper than its pixels does not tell a bent table with uneven places from a straight one with even places. Many
//! LEDs at many places are even, so waves in how often each place occurs are errors of the places, and of the table with them. Only of LEDs
//! that are not full at any place: of brighter ones those in the middle of a pixel are missing.

use core::f64::consts::PI;
use std::collections::HashSet;

use super::spot::Spot;

/// Waves along a pixel that places may be bent by.
const WAVES: usize = 2;

/// Moves places along both axes so that they fall evenly over a pixel, as far as the number of those in which a spot `is_anywhere` tells
/// that they do not.
pub(super) fn even_out(spots: &mut [Spot<'_>], is_anywhere: impl Fn(&Spot<'_>) -> bool) {
    let counted: Vec<bool> = spots.iter().map(|spot| spot.is_used && is_anywhere(spot)).collect();
    even_out_along(spots, &counted, |spot| spot.window.column as f64 + spot.u, |spot, px| spot.u += px);
    even_out_along(spots, &counted, |spot| spot.window.row as f64 + spot.v, |spot, px| spot.v += px);
}

/// How far places along an axis are off by where in a pixel they are, px (standard deviation), as far as their evenness tells: were they bent by a wave of so much, how
/// often each place occurs would rise and fall by 2 pi times as much, which so many distinct places show down to chance.
pub(super) fn known_to_px(spots: &[Spot<'_>], is_anywhere: impl Fn(&Spot<'_>) -> bool) -> f64 {
    let counted = spots.iter().filter(|spot| spot.is_used && is_anywhere(spot));
    let waves: f64 = (1..=WAVES).map(|number| 1.0 / (number * number) as f64).sum();
    (waves / (2.0 * PI * PI * distinct(counted).max(1.0))).sqrt()
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
    use core::f64::consts::TAU;
    let used = || spots.iter().zip(counted).filter(|(_, counted)| **counted).map(|(spot, _)| spot);
    let count = f64::max(used().count() as f64, 1.0);
    let mut waves = [(0.0, 0.0); WAVES];
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

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use photinus::optics::Gaussian;
    use rand_distr::{Distribution as _, Uniform};
    use rand_pcg::Pcg64;

    use super::super::spot;
    use super::super::table::Table;
    use super::super::window::Window;
    use super::*;

    /// Places that are even, drawn anew and anew: the bend that their waves seem to show is chance, and as large as told.
    #[test]
    fn evenness_tells_places_to_what_chance_shows() {
        const PLACES: usize = 120;
        let mut random = Pcg64::new(5, 0xe7e2);
        let table = Table::gaussians(&[Gaussian { share: 1.0, sigma_px: 0.8 }]);
        let drawn = Window::drawn(0, &table, 300.0, (6.0, 0.03), &mut random);
        let windows: Vec<Window> =
            (0..PLACES).map(|number| Window { column: 20 + 5 * number, ..drawn.clone() }).collect();
        let mut spots = spot::of(&windows, 255);
        let within = Uniform::new(-0.5, 0.5).expect("a pixel");
        let (mut squares, draws) = (0.0, 400);
        for _ in 0..draws {
            spots.iter_mut().for_each(|spot| spot.u = within.sample(&mut random));
            for number in (1..=WAVES).map(|number| number as f64) {
                let waves = spots.iter().map(|spot| libm::sincos(TAU * number * spot.place_px()[0]));
                let (sin, cos) = waves.fold((0.0, 0.0), |sum, (sin, cos)| (sum.0 + sin, sum.1 + cos));
                let amplitude = libm::hypot(sin, cos) / (PLACES as f64 * PI * number);
                squares += 0.5 * amplitude * amplitude;
            }
        }
        let (seen, told) = ((squares / f64::from(draws)).sqrt(), known_to_px(&spots, |_| true));
        assert!((told / seen - 1.0).abs() < 0.08, "{told} not {seen} px");
        assert!(known_to_px(&spots, |spot| spot.window.column < 300) > 1.3 * told, "fewer places tell less");
    }
}
