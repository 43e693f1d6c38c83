//! How well optics that were learned elsewhere say what frames show.

use photinus::optics::{Optics, SpreadField};

use super::choice::choose;
use super::collect::Collection;
use super::field::Field;
use super::noise::{Noise, ROUNDING, darkness};
use super::spot::{self, Spot};
use super::table::{Shares, Table};
use super::{PLACE_REACH, place};

/// Pixels of spots against what optics expect of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// Spots without a full pixel.
    pub spots: usize,
    /// Their pixels, within 8 px.
    pub pixels: usize,
    /// Squares of what is left over its variance, per pixel; the four numbers that each spot is fitted with are taken off.
    pub chi_square: f64,
    /// The same of the middle half of the spots: what is in most of them, without those that are two LEDs or an LED and its mirror image.
    pub typical: f64,
}

/// Fits every spot of frames with optics that are given: only place, light and level are free. `None` where there is no spot.
pub fn predict(optics: &Optics, collection: &Collection) -> Option<Prediction> {
    let sensor = &optics.sensor;
    let field = Field::given(tables(&optics.spread), optics.spread.columns(), collection.size_px()?);
    let noise = Noise {
        dark: sensor.read_noise_dn.value * sensor.read_noise_dn.value + ROUNDING,
        shot: sensor.shot.value,
        shape: optics.spread.shape_error(),
        bend: sensor.bent().map_or(0.0, |response| response.bend_per_dn.value),
        is_dark_seen: darkness(&collection.patches.kept).noise_dn.is_some(),
    };
    let full_from = sensor.full_from_dn();
    let mut spots = spot::of(&collection.windows.kept, full_from);
    choose(&mut spots);
    spots.retain(Spot::is_linear);
    place(&mut spots, &field, &noise, 8);
    let mut shares = Shares::default();
    let (mut squares, mut pixels, mut count) = (0.0, 0, 0);
    let mut misfits = Vec::new();
    for spot in spots.iter().filter(|spot| spot.is_used) {
        let before = (squares, pixels);
        // As the detector does: the frame's own noise where that is more.
        let noise = Noise { dark: noise.dark.max(spot.window.unevenness()), ..noise };
        spot.each_pixel(field.at(spot.place_px()), &noise, PLACE_REACH, &mut shares, |pixel| {
            squares += pixel.left * pixel.left * pixel.weight;
            pixels += 1;
        });
        misfits.push((squares - before.0) / ((pixels - before.1) as f64 - 4.0).max(1.0));
        count += 1;
    }
    misfits.sort_by(f64::total_cmp);
    let middle = &misfits[misfits.len() / 4..misfits.len() - misfits.len() / 4];
    (count > 0).then(|| Prediction {
        spots: count,
        pixels,
        chi_square: squares / (pixels - 4 * count).max(1) as f64,
        typical: middle.iter().sum::<f64>() / middle.len() as f64,
    })
}

fn tables(spread: &SpreadField) -> Vec<Table> {
    spread.zones().iter().map(|zone| Table::new(zone.samples().to_vec())).collect()
}
