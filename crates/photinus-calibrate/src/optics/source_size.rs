//! How wide the sources of spots are beyond those that the table was made of: how that grows with light, and how far it scatters.
//!
//! In: the spots that the table was made of. Out: the variance that each has of its own (half the table's Laplacian says what a small
//! one does), by weighted least squares a straight line over light, and the scatter around it that noise does not explain.

use nalgebra::{SMatrix, SVector};
use photinus::optics::{Measured, SourceSize};

use super::field::Field;
use super::noise::Noise;
use super::spot::Spot;
use super::table::Shares;

/// Step of a place for second differences, px.
const STEP_PX: f64 = 0.1;
/// Fewer spots tell nothing of sources.
const LEAST_SPOTS: usize = 20;
/// Rounds in which scatter and line are found in turn.
const ROUNDS: usize = 10;
/// A spot farther from the line than this many sigmas counts as so far.
const CLIP: f64 = 4.0;
/// Growth that is farther from what is believed than this many sigmas is of LEDs that are larger than usual.
const USUAL_SIGMAS: f64 = 2.5;
/// Spots tell how sources grow where LEDs are larger than usual, or where their sigma is no more than so many times that of what is believed: they count for a
/// fifth or more.
const TELLING: f64 = 2.0;

/// A spot's own variance, px^2, with its light, grey levels.
#[derive(Clone, Copy, Debug)]
struct Source {
    light: f64,
    own: f64,
    variance: f64,
}

/// How wide sources are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sources {
    pub(super) size: SourceSize,
    /// Whether spots tell how they grow with light.
    pub(super) is_seen: bool,
}

/// Sizes of the sources of spots; `None` where these are few.
pub(super) fn learn(spots: &[Spot<'_>], field: &Field, noise: &Noise) -> Option<Sources> {
    let used = spots.iter().filter(|spot| spot.is_used && spot.is_linear());
    let sources: Vec<Source> = used.filter_map(|spot| source(spot, field, noise)).collect();
    (sources.len() >= LEAST_SPOTS).then(|| line(&sources))
}

/// The own variance of a spot as its pixels have it.
fn source(spot: &Spot<'_>, field: &Field, noise: &Noise) -> Option<Source> {
    let table = field.at(spot.place_px());
    let beside = [(STEP_PX, 0.0), (-STEP_PX, 0.0), (0.0, STEP_PX), (0.0, -STEP_PX)].map(|(u, v)| {
        let mut shares = Shares::default();
        table.window(spot.u + u, spot.v + v, usize::MAX, &mut shares);
        shares
    });
    let mut normal = SMatrix::<f64, 5, 5>::zeros();
    let mut right = SVector::<f64, 5>::zeros();
    spot.each_pixel(table, noise, usize::MAX, &mut Shares::default(), |pixel| {
        let here = pixel.light / spot.light;
        let around: f64 = beside.iter().map(|shares| shares.at(pixel.column, pixel.row).value).sum();
        let laplacian = (around - 4.0 * here) / (STEP_PX * STEP_PX);
        let row = pixel.jacobian.push(0.5 * spot.light * laplacian);
        normal += row * row.transpose() * pixel.weight;
        right += row * (pixel.left * pixel.weight);
    });
    let inverse = normal.try_inverse()?;
    let (own, variance) = ((inverse * right)[4], inverse[(4, 4)]);
    (own.is_finite() && variance > 0.0).then_some(Source { light: spot.light, own, variance })
}

/// Growth with so many times the light, as it is believed of LEDs.
fn believed(lights: f64) -> Measured {
    let Measured { value, sigma } = SourceSize::UNKNOWN.growth_px2;
    Measured { value: lights * value, sigma: lights * sigma }
}

/// Growth as seen, with what is believed where that may be so.
fn with_belief(seen: Measured, believed: Measured) -> Measured {
    if seen.value - believed.value > USUAL_SIGMAS * libm::hypot(seen.sigma, believed.sigma) {
        return seen;
    }
    let [by_spots, before] = [seen, believed].map(|of| 1.0 / (of.sigma * of.sigma));
    let value = (by_spots * seen.value + before * believed.value) / (by_spots + before);
    Measured { value: value.max(0.0), sigma: (1.0 / (by_spots + before)).sqrt() }
}

/// The line through sources over their light, and the scatter around it.
fn line(sources: &[Source]) -> Sources {
    let mut scatter2 = 0.0;
    let mut told = Sources { size: SourceSize::UNKNOWN, is_seen: false };
    for _ in 0..ROUNDS {
        let weight = |source: &Source| 1.0 / (source.variance + scatter2);
        let sum = |of: &dyn Fn(&Source) -> f64| {
            sources.iter().map(|source| weight(source) * of(source)).sum::<f64>()
        };
        let all = sum(&|_| 1.0);
        let light_dn = sum(&|source| source.light) / all;
        let middle = sum(&|source| source.own) / all;
        let from = |source: &Source| source.light / light_dn - 1.0;
        // Lights that are all alike tell of no growth.
        let information = sum(&|source| from(source) * from(source)).max(f64::MIN_POSITIVE);
        let seen = Measured {
            value: sum(&|source| from(source) * (source.own - middle)) / information,
            sigma: (1.0 / information).sqrt(),
        };
        let believed = believed(light_dn / SourceSize::UNKNOWN.light_dn);
        let growth_px2 = with_belief(seen, believed);
        let value = growth_px2.value;
        let (mut squares, mut weights) = (0.0, 0.0);
        for source in sources {
            let off = source.own - middle - value * from(source);
            let most = CLIP * CLIP / weight(source);
            squares += weight(source) * weight(source) * ((off * off).min(most) - source.variance);
            weights += weight(source) * weight(source);
        }
        scatter2 = f64::max(squares / weights, 0.0);
        let scatter_px2 = (scatter2 + (2.0 / weights).sqrt()).sqrt();
        let size = SourceSize { light_dn, growth_px2, scatter_px2 };
        told = Sources { size, is_seen: growth_px2 == seen || seen.sigma < TELLING * believed.sigma };
    }
    told
}

#[cfg(test)]
mod tests {
    use photinus::optics::Gaussian;
    use rand_pcg::Pcg64;

    use super::super::choice::choose;
    use super::super::spot;
    use super::super::table::Table;
    use super::super::window::Window;
    use super::*;

    const NOISE: Noise = Noise { dark: 0.44, shot: 0.02, shape: 0.0, bend: 0.0, is_dark_seen: true };

    fn spread(variance_px2: f64) -> Table {
        Table::gaussians(&[Gaussian { share: 1.0, sigma_px: (0.36 + variance_px2).sqrt() }])
    }

    /// Spots of LEDs whose own variance grows with their light, in noise.
    fn windows(growth_px2: f64, seed: u64) -> Vec<Window> {
        let mut random = Pcg64::new(u128::from(seed), 1);
        let window = |number: usize| {
            let light = 100.0 + 500.0 * (number % 20) as f64 / 20.0;
            Window::drawn(number, &spread(growth_px2 * light / 500.0), light, (6.0, 0.02), &mut random)
        };
        (0..400).map(window).collect()
    }

    #[test]
    fn lights_that_are_all_alike_leave_the_belief() {
        let alike = [Source { light: 500.0, own: 0.01, variance: 1e-6 }; 30];
        let Sources { size, is_seen } = line(&alike);
        assert!(!is_seen);
        assert!((size.growth_px2.value - SourceSize::UNKNOWN.growth_px2.value).abs() < 1e-9, "{size:?}");
        assert!(size.check().is_ok(), "{size:?}");
    }

    #[test]
    fn growth_is_that_of_the_sources() {
        for (seed, growth_px2) in [(1, 0.0), (2, 1e-3), (3, 0.01), (4, 0.03)] {
            let windows = windows(growth_px2, seed);
            let mut spots = spot::of(&windows, 255);
            choose(&mut spots);
            let field = Field::new(spread(growth_px2 * 0.8), [200, 200], [1, 1]);
            super::super::place(&mut spots, &field, &NOISE, 6);
            let Sources { size, is_seen } = learn(&spots, &field, &NOISE).expect("400 spots");
            assert_eq!(is_seen, growth_px2 > 5e-3, "400 spots tell less than what is believed of usual ones");
            let Measured { value, sigma } = size.growth_px2;
            let (value, sigma) = (value * 500.0 / size.light_dn, sigma * 500.0 / size.light_dn);
            assert!((value - growth_px2).abs() < 3.0 * sigma, "{value} +- {sigma} not {growth_px2}");
            assert!(sigma < 2e-3 && size.scatter_px2 < 0.006, "{size:?}");
        }
    }
}
