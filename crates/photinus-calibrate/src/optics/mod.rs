//! Frames with LEDs in; the optics of the camera that took them out, each number with its sigma, and what the frames do not tell.
//!
//! No truth is needed, and what moves may move: a spot says by itself what a point of light becomes. In the order of the flow:
//!
//! ```text
//! collect      frames -> windows around spots that stand alone, patches without light
//! saturation   where the brightest pixels pile up
//! noise        level and noise of darkness
//! start        the round core and halo that explain the spots best
//! ground       how the level under each spot rises and bends
//! spot, field  places and light of spots by the table, the table by what they leave, in turn (phases: kept even)
//! bent         how far all places may be off together, for the table keeps the bend that it began with
//! light        noise against light, and how wrong the table is
//! source_size  how wide sources are, by their light
//! response     whether bright spots are flatter than faint ones
//! spill        what the excess of full pixels does to their neighbours
//! choice       which spots are fit to learn from
//! dark_frame   frames kept whole -> what each pixel reads without light
//! hot          pixels that are bright without any
//! column_smear what dark pixels get of the light in their column
//! trail, vignetting  one LED at many places of the image -> how much light passes there
//! prediction   what was learned against other frames
//! ```
//! What a recording does not excite stays what is believed beforehand and is named in [`Learned::unseen`].

mod bent;
mod choice;
mod collect;
mod column_smear;
mod correction;
mod dark_frame;
mod evidence;
mod field;
mod ground;
mod hot;
mod learned;
mod light;
mod noise;
mod phases;
mod prediction;
mod profile;
mod response;
mod saturation;
mod source_size;
mod spill;
mod spot;
mod start;
mod summits;
mod table;
mod trail;
mod vignetting;
mod window;

use photinus::camera::Pixel;
use photinus::optics::{HotPixels, Measured, Optics, OpticsError, Response, Saturation, Sensor, SpreadField};

use choice::{choose, clear_of_full, leave_out};
pub use collect::Collection;
use dark_frame::DarkFrame;
pub use evidence::{Evidence, NoiseBin};
use field::Field;
use hot::Candidate;
pub use learned::{LearnError, Learned, Unseen};
use light::LightNoise;
use noise::{Darkness, Noise, ROUNDING};
pub use prediction::{Prediction, predict};
use saturation::Pile;
use spill::Spill;
use spot::Spot;
use table::Shares;

/// Fewest spots that make a point spread.
pub const FEWEST_SPOTS: usize = 40;
/// Of fewer spots a third makes no table that is worth comparing with.
const FEWEST_PARTED: usize = 4 * FEWEST_SPOTS;
/// Spots of a node of the grid over which the point spread may change.
const SPOTS_PER_NODE: usize = 40;
const ROUNDS_WHOLE: usize = 5;
const ROUNDS_BY_NODE: usize = 8;
/// Rounds in which tables of a part of the spots are learned.
const ROUNDS_OF_PARTS: usize = 6;
/// Rounds after which noise is explained anew: what the table cannot follow yet must not be taken for noise.
const NOISE_AFTER: [usize; 2] = [8, 10];
/// Rounds after which a bend of the response is taken out of grey levels: the table follows it otherwise.
const BEND_AFTER: [usize; 4] = [3, 5, 8, 10];
/// How far from a spot its place is told, px.
const PLACE_REACH: usize = 8;
/// What is believed of a sensor that nobody measured.
const READ_NOISE_BELIEVED: Measured = Measured { value: 1.0, sigma: 1.0 };
const SPILL_BELIEVED: Measured = Measured { value: 0.0, sigma: 0.5 };

/// Learns the optics of the camera whose frames were collected.
///
/// # Errors
/// [`LearnError`] when too few spots stand alone, or they have nothing in common.
pub fn learn(collection: &Collection) -> Result<Learned, LearnError> {
    let windows = &collection.windows.kept;
    let summits = saturation::summits(windows);
    let pile = saturation::find(&summits);
    let dark_frame = DarkFrame::of(collection);
    let standing = dark_frame.as_ref().map(|dark| hot::candidates(dark, collection.mask.as_ref()));
    let full_from = pile.map_or(255, |pile| pile.least_dn());
    let darkness = noise::darkness(&collection.patches.kept);
    let mut spots = spot::of(windows, full_from);
    leave_out(&mut spots, standing.as_deref().unwrap_or_default());
    let all = spots.clone();
    let full: Vec<Spot<'_>> = spots.iter().filter(|spot| !spot.is_linear()).cloned().collect();
    choose(&mut spots);
    let size_px = collection.size_px.unwrap_or([1, 1]);
    let mut noise = first_noise(&darkness);
    if spots.len() < FEWEST_SPOTS {
        return Err(LearnError::TooFew { found: spots.len(), needed: FEWEST_SPOTS });
    }
    let start = start::core_and_halo(&spots, &noise);
    let nodes = nodes(spots.len(), size_px);
    let mut field = Field::new(start.table(), size_px, nodes);
    let has_full = spots.iter().any(|spot| !spot.is_linear());
    for round in 0..ROUNDS_WHOLE + ROUNDS_BY_NODE {
        place(&mut spots, &field, &noise, if round == 0 { 6 } else { 1 });
        phases::even_out(&mut spots, |spot| has_full || field.is_never_full(spot, full_from));
        if round < ROUNDS_WHOLE {
            field.learn_whole(&spots, &noise);
        } else {
            field.learn(&spots, &noise);
        }
        if NOISE_AFTER.contains(&round) {
            noise =
                light::explain(&light::residuals(&spots, &field, &noise), darkness.noise_dn, &noise).noise;
        }
        if BEND_AFTER.contains(&round) {
            noise.bend = bend(&clear_of_full(&spots, &field, &noise, full_from), &field, &noise);
        }
    }
    place(&mut spots, &field, &noise, 2);
    let clear = clear_of_full(&spots, &field, &noise, full_from);
    let response = response::learn(&clear, &field, &noise).map(|bend_per_dn| Response { bend_per_dn });
    let told = if clear.iter().filter(|spot| spot.is_used && spot.is_linear()).count() < FEWEST_SPOTS {
        // Being too dark by a little, as spots are that happen not to be full, is less wrong than hearing none of the bright ones.
        &spots
    } else {
        &clear
    };
    let of_part = |part: usize, parts: usize| {
        let start = Field::new(start.table(), size_px, nodes);
        field_of_part(told, start, &noise, (part, parts))
    };
    let told_by = |residuals: Vec<light::Residual>| {
        let light = light::explain(&residuals, darkness.noise_dn, &noise);
        (residuals, light)
    };
    // A few spots that are two LEDs, which all tables leave alike, make it by themselves.
    let free = (told.len() >= FEWEST_PARTED)
        .then(|| [0, 1, 2].map(|third| of_part(third, 3)))
        .map(|thirds| told_by(light::free_residuals(told, thirds.each_ref(), &noise)))
        .filter(|(_, light)| light.tells_shape());
    let (residuals, light) = free.unwrap_or_else(|| told_by(light::residuals(told, &field, &noise)));
    let used = spots.iter().filter(|spot| spot.is_used).count();
    if used < FEWEST_SPOTS {
        return Err(LearnError::TooFew { found: used, needed: FEWEST_SPOTS });
    }
    let spill = pile.and_then(|pile| spill::learn(&full, &field, &light.noise, &pile));
    let column_smear = dark_frame.as_ref().and_then(|dark| column_smear::learn(dark, &noise, full_from));
    let vignetting = collection.camera.as_ref().and_then(|camera| {
        let mut spots = all;
        place(&mut spots, &field, &light.noise, 5);
        let clear = clear_of_full(&spots, &field, &light.noise, full_from);
        vignetting::learn(&clear, &field, &light.noise, camera)
    });
    // Where spots are few, what they leave of the table that follows them says too little of how far that is off.
    let scatter = Field::scatter(&[0, 1].map(|half| of_part(half, 2)));
    let shape_error = light.noise.shape.max(scatter.all).min(1.0);
    let wings_error = scatter.wings.max(shape_error).min(1.0);
    let bend = bent::places_px(field.whole(), &start.table(), &light.noise, median_light(&spots));
    let even_px = phases::known_to_px(&spots, |spot| has_full || field.is_never_full(spot, full_from));
    let spread = field
        .spread(shape_error)?
        .with_wings_error(wings_error)?
        .with_unknown_below(scatter.unknown_below.min(1.0))?
        .with_place_error_px(bend.told_to_px(even_px))?;
    let sources = source_size::learn(told, &field, &light.noise);
    let spread = match sources {
        Some(sources) => spread.with_source_size(sources.size)?,
        None => spread,
    };
    let hot_pixels = standing.as_ref().map(|standing| hot_pixels(standing, &spread)).transpose()?;
    let (sensor, mut unseen) = sensor(&darkness, &light, pile.as_ref(), spill);
    let missing = [
        (sources.is_none_or(|sources| !sources.is_seen), Unseen::Sources),
        (nodes == [1, 1], Unseen::Field),
        (vignetting.is_none(), Unseen::Vignetting),
        (column_smear.is_none(), Unseen::ColumnSmear),
        (response.is_none(), Unseen::Response),
        (hot_pixels.is_none(), Unseen::HotPixels),
    ];
    unseen.extend(missing.into_iter().filter_map(|(is_missing, unseen)| is_missing.then_some(unseen)));
    unseen.sort_unstable();
    let sensor = Sensor { response, column_smear, ..sensor };
    sensor.check()?;
    let optics = Optics { spread, sensor, vignetting, hot_pixels: hot_pixels.unwrap_or_default() };
    Ok(Learned {
        optics,
        saturation_sigma_dn: pile.map(|pile| pile.sigma_dn),
        shape_error_sigma: light.shape_sigma,
        unseen,
        frames: collection.frames,
        spots: used,
        evidence: Evidence {
            summits,
            noise: evidence::noise(&residuals, &light.noise),
            phases: evidence::phases(&spots, &field, &light.noise),
        },
    })
}

/// The pixels that are no LEDs behind this lens.
fn hot_pixels(standing: &[Candidate], spread: &SpreadField) -> Result<HotPixels, OpticsError> {
    let is_hot = |candidate: &&Candidate| {
        let place = Pixel::new(f64::from(candidate.pixel.column), f64::from(candidate.pixel.row));
        let spread = spread.at(place);
        let around = (0..9).filter(|at| *at != 4).map(|at| [f64::from(at % 3 - 1), f64::from(at / 3 - 1)]);
        let around: f64 = around.map(|[x, y]| spread.share(x, y)).sum();
        candidate.is_hot(around / spread.share(0.0, 0.0))
    };
    HotPixels::new(standing.iter().filter(is_hot).map(|candidate| candidate.pixel).collect())
}

/// The bend of the response that spots tell; none where it may be chance.
fn bend(spots: &[Spot<'_>], field: &Field, noise: &Noise) -> f64 {
    let told = response::learn(spots, field, noise).map(|bend_per_dn| Response { bend_per_dn });
    told.filter(Response::is_bent).map_or(0.0, |response| response.bend_per_dn.value)
}

fn first_noise(darkness: &Darkness) -> Noise {
    let read = darkness.noise_dn.map_or(READ_NOISE_BELIEVED.value, |noise| noise.value);
    Noise {
        dark: read * read + ROUNDING,
        shot: light::SHOT_BELIEVED.value,
        shape: 0.02,
        bend: 0.0,
        is_dark_seen: darkness.noise_dn.is_some(),
    }
}

/// Nodes along columns and rows that this many spots allow.
fn nodes(spots: usize, [width_px, height_px]: [usize; 2]) -> [usize; 2] {
    let most = (spots / SPOTS_PER_NODE).min(24);
    let shape = width_px as f64 / height_px as f64;
    let rows = ((most as f64 / shape).sqrt().floor() as usize).clamp(1, 5);
    let columns = ((rows as f64 * shape).round() as usize).clamp(1, 6);
    if rows < 2 || columns < 2 { [1, 1] } else { [columns, rows] }
}

/// Finds where spots are, and which of them the table explains.
fn place(spots: &mut [Spot<'_>], field: &Field, noise: &Noise, steps: usize) {
    let mut shares = Shares::default();
    for spot in spots.iter_mut() {
        let table = field.at(spot.place_px());
        spot.fit(table, noise, PLACE_REACH, steps, &mut shares);
    }
    let mut misfits: Vec<f64> = spots.iter().filter(|spot| spot.is_used).map(|spot| spot.misfit).collect();
    misfits.sort_by(f64::total_cmp);
    let Some(&middle) = misfits.get(misfits.len() / 2) else { return };
    spots.iter_mut().for_each(|spot| spot.is_used &= spot.misfit < 2.5 * middle + 0.5);
}

/// The light that half of the spots that are used have more of, grey levels.
fn median_light(spots: &[Spot<'_>]) -> f64 {
    let mut lights: Vec<f64> = spots.iter().filter(|spot| spot.is_used).map(|spot| spot.light).collect();
    lights.sort_by(f64::total_cmp);
    lights.get(lights.len() / 2).copied().unwrap_or(1.0)
}

/// Tables of every so manieth spot from one on, from a start that knows none of them.
fn field_of_part(spots: &[Spot<'_>], start: Field, noise: &Noise, (part, parts): (usize, usize)) -> Field {
    let mut spots: Vec<Spot<'_>> = spots.iter().skip(part).step_by(parts).cloned().collect();
    let mut field = start;
    for round in 0..ROUNDS_OF_PARTS {
        if round < ROUNDS_OF_PARTS / 2 {
            field.learn_whole(&spots, noise);
        } else {
            field.learn(&spots, noise);
        }
        place(&mut spots, &field, noise, 1);
    }
    field
}

/// The sensor, and what was not seen of it.
fn sensor(
    darkness: &Darkness,
    light: &LightNoise,
    pile: Option<&Pile>,
    spill: Option<Spill>,
) -> (Sensor, Vec<Unseen>) {
    let mut unseen = Vec::new();
    if darkness.level_dn.is_none() {
        unseen.push(Unseen::Darkness);
    }
    let read_noise_dn = darkness.noise_dn.unwrap_or_else(|| {
        let variance = (light.noise.dark - ROUNDING).max(0.0);
        let sigma = 0.5 * light.dark_sigma / variance.sqrt().max(0.05);
        if variance > 3.0 * light.dark_sigma {
            Measured { value: variance.sqrt(), sigma }
        } else {
            unseen.push(Unseen::ReadNoise);
            Measured { value: variance.sqrt(), sigma: sigma.min(READ_NOISE_BELIEVED.sigma) }
        }
    });
    let shot = Measured { value: light.noise.shot, sigma: light.shot_sigma };
    if !light.is_shot_seen {
        unseen.push(Unseen::ShotNoise);
    }
    let saturation = pile.map_or(Saturation { level_dn: 255.0, spread_dn: 0.0 }, |pile| Saturation {
        level_dn: pile.level_dn.min(255.0),
        spread_dn: pile.spread_dn,
    });
    if pile.is_none() {
        unseen.push(Unseen::Saturation);
    }
    let spill = spill.unwrap_or(Spill { share: SPILL_BELIEVED, well_dn: None, is_seen: false });
    if !spill.is_seen {
        unseen.push(Unseen::Spill);
    }
    let sensor = Sensor {
        dark_dn: darkness.level_dn,
        read_noise_dn,
        shot,
        saturation,
        spill: spill.share,
        full_well_dn: spill.well_dn,
        column_smear: None,
        response: None,
    };
    (sensor, unseen)
}
