//! What the numbers rest on, for people to look at.

use super::field::Field;
use super::light::Residual;
use super::noise::Noise;
use super::spot::Spot;

/// What was seen, beside what was made of it.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// How many spots have each grey level in the pixel where their light is.
    pub summits: [u32; 256],
    /// Noise against light, by rising light.
    pub noise: Vec<NoiseBin>,
    /// Squares of what is left within 1.5 px of spots over their variance, by where in a pixel the spot is: tenths along columns,
    /// then along rows. 1 where the table is right at that phase.
    pub phases: [Vec<f64>; 2],
}

/// Pixels with about the same light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseBin {
    /// Mean light, grey levels above the spot's level.
    pub light_dn: f64,
    /// Mean square of what is left, what the fits took away put back, grey levels squared.
    pub variance_dn2: f64,
    /// Its standard deviation.
    pub sigma_dn2: f64,
}

/// Bins of light per factor of two.
const PER_OCTAVE: f64 = 2.0;
const LEAST_PIXELS: usize = 20;
const PHASES: usize = 10;
const CORE_PX: f64 = 1.5;

/// Noise against light.
pub(super) fn noise(residuals: &[Residual], noise: &Noise) -> Vec<NoiseBin> {
    let mut sorted: Vec<&Residual> = residuals.iter().collect();
    sorted.sort_by(|a, b| a.light.total_cmp(&b.light));
    let octave = |residual: &Residual| (PER_OCTAVE * libm::log2(residual.light.max(0.5))).floor() as i64;
    let bins = sorted.chunk_by(|a, b| octave(a) == octave(b)).filter(|bin| bin.len() >= LEAST_PIXELS);
    bins.map(|bin| {
        let count = bin.len() as f64;
        let mean =
            |of: &dyn Fn(&Residual) -> f64| bin.iter().map(|residual| of(residual)).sum::<f64>() / count;
        let variance_dn2 = mean(&|residual| residual.put_back(noise));
        let sigma_dn2 = variance_dn2 * (2.0 / count).sqrt();
        NoiseBin { light_dn: mean(&|residual| residual.light), variance_dn2, sigma_dn2 }
    })
    .collect()
}

/// How well spots are explained, by their place within a pixel.
pub(super) fn phases(spots: &[Spot<'_>], field: &Field, noise: &Noise) -> [Vec<f64>; 2] {
    let mut sums = [[(0.0, 0.0); PHASES]; 2];
    for spot in spots.iter().filter(|spot| spot.is_used && spot.is_linear()) {
        let bins = spot.place_px().map(|px| ((px - px.floor()) * PHASES as f64) as usize % PHASES);
        let Some(told) = spot.told(field.at(spot.place_px()), noise, 3) else { continue };
        for pixel in &told.pixels {
            let free = 1.0 - told.taken(pixel);
            let off = [pixel.column as f64 - spot.u, pixel.row as f64 - spot.v];
            if off.iter().all(|px| px.abs() <= CORE_PX) && free > 0.0 {
                for (axis, bin) in bins.into_iter().enumerate() {
                    let (squares, count) = &mut sums[axis][bin];
                    (*squares, *count) = (*squares + pixel.left * pixel.left * pixel.weight, *count + free);
                }
            }
        }
    }
    sums.map(|axis| axis.iter().map(|(squares, count)| squares / f64::max(*count, 1e-9)).collect())
}
