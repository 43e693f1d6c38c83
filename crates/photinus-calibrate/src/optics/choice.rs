//! Spots in; those out that a number can be learned from without leaning to one side.

use super::FEWEST_SPOTS;
use super::field::Field;
use super::hot::Candidate;
use super::noise::Noise;
use super::spot::Spot;
use super::table::Shares;

/// Most spots that the table is made of.
const MOST_SPOTS: usize = 3000;
/// So far below what a full pixel reads none is full by chance.
const CLEAR_SIGMAS: f64 = 3.0;
/// What stands out all the time so near to a spot is in its light, px.
const STANDING_PX: usize = 4;

/// Takes out spots at pixels that stand out all the time, where enough are left without: they may be hot pixels.
pub(super) fn leave_out(spots: &mut Vec<Spot<'_>>, standing: &[Candidate]) {
    let is_moving = |spot: &Spot<'_>| {
        let near = |at: usize, hot: u32| at.abs_diff(hot as usize) <= STANDING_PX;
        let window = spot.window;
        !standing.iter().any(|hot| near(window.column, hot.pixel.column) && near(window.row, hot.pixel.row))
    };
    if spots.iter().filter(|spot| is_moving(spot)).count() >= 3 * FEWEST_SPOTS {
        spots.retain(is_moving);
    }
}

/// Keeps the spots that a table can be made of: those without full pixels, the brighter the better, spread over the image.
pub(super) fn choose(spots: &mut Vec<Spot<'_>>) {
    let linear = spots.iter().filter(|spot| spot.is_linear()).count();
    if linear >= 3 * FEWEST_SPOTS {
        spots.retain(Spot::is_linear);
    }
    spots.retain(|spot| spot.window.reach >= 4 && spot.light > 0.0);
    if spots.len() > MOST_SPOTS {
        spots.sort_by(|a, b| b.light.total_cmp(&a.light));
        spots.truncate(MOST_SPOTS);
    }
}

/// Spots of which no pixel would be full by chance: were those left out that are, the rest would be darker than they are on average.
pub(super) fn clear_of_full<'a>(
    spots: &[Spot<'a>],
    field: &Field,
    noise: &Noise,
    full_from: u8,
) -> Vec<Spot<'a>> {
    let is_clear = |spot: &&Spot<'_>| {
        let table = field.at(spot.place_px());
        let (full, slope) = noise.straightened(f64::from(full_from) - spot.level);
        let mut brightest = 0.0_f64;
        spot.each_pixel(table, noise, 1, &mut Shares::default(), |pixel| {
            brightest = brightest.max(pixel.light);
        });
        brightest + CLEAR_SIGMAS * slope * noise.variance(brightest).sqrt() < full
    };
    spots.iter().filter(is_clear).cloned().collect()
}
