//! Response: whether grey levels grow in proportion to light, from spots of all brightnesses.
//!
//! A bend of the response makes bright spots flatter than faint ones, which no point spread does: what it does to all alike is the
//! table's, what differs with their light is the response's. Each pixel's slope by the bend is freed of what its spot's own fit and
//! the table can follow, and what is left of the pixels is set against it (two-stage least squares: such a slope is an instrument).
//! Spots of one LED have much in common besides its light, as a horizon beside it: what leaving out LEDs changes counts where it is more than what
//! leaving out spots does.

use std::collections::BTreeSet;

use nalgebra::{SMatrix, SVector};
use photinus::optics::Measured;

use super::field::Field;
use super::noise::Noise;
use super::spot::Spot;
use super::table::Shares;

const REACH_PX: usize = 4;
/// Rings of shares, per factor of e, over which the table is free.
const PER_E: f64 = 3.0;
const RINGS: usize = 24;
/// Parts of the spots, and at most of the LEDs, each of which is left out once.
const PARTS: usize = 10;
/// Fewer LEDs tell nothing.
const LEAST_LEDS: usize = 3;
/// It is told if at so many grey levels of light it is known to this share of them.
const AT_DN: f64 = 200.0;
const KNOWN: f64 = 0.02;
/// A pixel counts as no farther off than this many sigmas.
const CLIP: f64 = 4.0;

/// A pixel: ring, weight, what its value is left over, slope by the bend, freed of its spot's fit, and light of its spot.
struct Slope {
    ring: usize,
    weight: f64,
    left: f64,
    freed: f64,
    light: f64,
    /// Which part of the spots and of the LEDs it is of.
    parts: [usize; 2],
}

/// The bend on top of that of `noise`, and how sure it is; `None` where lights are too much alike.
pub(super) fn learn(spots: &[Spot<'_>], field: &Field, noise: &Noise) -> Option<Measured> {
    let used = || spots.iter().filter(|spot| spot.is_used && spot.is_linear());
    let leds: BTreeSet<u64> = used().map(|spot| spot.window.seen.trail).collect();
    if leds.len() < LEAST_LEDS {
        return None;
    }
    let mut slopes = Vec::new();
    for (number, spot) in used().enumerate() {
        let led = leds.range(..spot.window.seen.trail).count();
        gather(spot, field, noise, [number % PARTS, led % PARTS], &mut slopes);
    }
    let whole = solve(&slopes, |_| true)?;
    let mut sigma = 0.0_f64;
    for (of, parts) in [PARTS, leds.len().min(PARTS)].into_iter().enumerate() {
        let mut square = 0.0;
        for part in 0..parts {
            let off = solve(&slopes, |slope| slope.parts[of] != part)? - whole;
            square += off * off;
        }
        sigma = sigma.max((square * (parts - 1) as f64 / parts as f64).sqrt());
    }
    (0.5 * AT_DN * sigma < KNOWN).then_some(Measured { value: noise.bend + whole, sigma })
}

/// The slopes of one spot, freed of its place, light and level.
fn gather(spot: &Spot<'_>, field: &Field, noise: &Noise, parts: [usize; 2], slopes: &mut Vec<Slope>) {
    let table = field.at(spot.place_px());
    let mut shares = Shares::default();
    let (mut normal, mut right) = (SMatrix::<f64, 4, 4>::zeros(), SVector::<f64, 4>::zeros());
    let mut pixels = Vec::new();
    spot.each_pixel(table, noise, REACH_PX, &mut shares, |pixel| {
        let by_bend = by_bend(pixel.light, noise.bend);
        normal += pixel.jacobian * pixel.jacobian.transpose() * pixel.weight;
        right += pixel.jacobian * (by_bend * pixel.weight);
        pixels.push((*pixel, by_bend));
    });
    let Some(factor) = normal.cholesky() else { return };
    let followed = factor.solve(&right);
    for (pixel, by_bend) in pixels {
        let share = (pixel.light / spot.light).max(1e-9);
        let ring = ((-libm::log(share) * PER_E).max(0.0) as usize).min(RINGS - 1);
        let most = CLIP / pixel.weight.sqrt();
        slopes.push(Slope {
            ring,
            weight: pixel.weight,
            left: pixel.left.clamp(-most, most),
            freed: by_bend - pixel.jacobian.dot(&followed),
            light: spot.light,
            parts,
        });
    }
}

/// How what is left of a pixel of so much light changes with the bend: light that is straightened too little is too little.
fn by_bend(light: f64, bend: f64) -> f64 {
    // of x = -ln(1 - b y) / b by b, at the y that x reads as
    if (bend * light).abs() < 1e-3 {
        return -0.5 * light * light;
    }
    -(libm::expm1(bend * light) - bend * light) / (bend * bend)
}

/// The bend that is missing, by the pixels that are used.
fn solve(slopes: &[Slope], is_used: impl Fn(&Slope) -> bool) -> Option<f64> {
    let used = || slopes.iter().filter(|slope| is_used(slope));
    // the table follows what grows with the light alone, ring by ring
    let mut rings = [(0.0, 0.0); RINGS];
    for slope in used() {
        let (product, square) = &mut rings[slope.ring];
        *product += slope.weight * slope.light * slope.freed;
        *square += slope.weight * slope.light * slope.light;
    }
    let (mut left, mut along) = (0.0, 0.0);
    for slope in used() {
        let (product, square) = rings[slope.ring];
        let instrument = slope.freed - slope.light * product / f64::max(square, 1e-12);
        left += slope.weight * instrument * slope.left;
        along += slope.weight * instrument * slope.freed;
    }
    (along > 0.0).then(|| left / along)
}
