//! Smear along columns: the share of a column's light that each of its dark pixels gets.
//!
//! In: whole frames less their darkness. In each column the mean of the pixels far from every spot is set against the light of
//! the spots in it, both against their means over frames and the first against the columns aside: what a column has always, and what
//! changes over many columns, says nothing. Columns near a full pixel are left out: nobody knows what light it got.

use photinus::optics::Measured;

use super::collect::Whole;
use super::dark_frame::DarkFrame;
use super::noise::Noise;

/// A pixel farther than this from every spot along columns and rows is dark.
const FAR_PX: usize = 24;
/// Light of a spot is looked for so far from its middle along columns and rows, px.
const LIGHT_PX: usize = 10;
/// Columns aside, whose mean is what a column has without smear: from so far on to so far.
const ASIDE_PX: (usize, usize) = (11, 22);
/// Fewer dark pixels of a column tell nothing.
const FEWEST_PX: f64 = 30.0;
const PARTS: usize = 5;
/// A column with less light than this tells noise, grey levels.
const LEAST_DN: f64 = 30.0;

/// A column of a frame.
#[derive(Clone, Copy, Debug, Default)]
struct Column {
    /// Mean of its dark pixels above their darkness, grey levels; 0 of none that can be told.
    dark_dn: f64,
    light_dn: f64,
    is_told: bool,
}

/// The share; `None` where no light moved along columns. `full_from` is the least grey level of a full pixel; light is what levels stand
/// for by the response of `noise`.
pub(super) fn learn(dark: &DarkFrame<'_>, noise: &Noise, full_from: u8) -> Option<Measured> {
    let mut frames: Vec<Vec<Column>> =
        dark.frames.iter().map(|frame| columns(dark, frame, noise, full_from)).collect();
    frames.iter_mut().for_each(|columns| against_aside(columns));
    against_means(&mut frames, dark.width);
    let whole = slope(&frames, |_| true)?;
    let parts = (0..PARTS).filter_map(|part| slope(&frames, |number| number % PARTS != part));
    let square: f64 = parts.map(|part| (part.0 - whole.0) * (part.0 - whole.0)).sum();
    let scattered = (square * (PARTS - 1) as f64 / PARTS as f64).sqrt();
    // a few parts may agree by chance: not better than the dark pixels' own scatter tells
    Some(Measured { value: whole.0.clamp(0.0, 1.0), sigma: scattered.max(whole.1) })
}

/// Light and darkness of every column of a frame.
fn columns(dark: &DarkFrame<'_>, frame: &Whole, noise: &Noise, full_from: u8) -> Vec<Column> {
    let mut columns = vec![Column { is_told: true, ..Column::default() }; dark.width];
    let span = |middle: usize, reach: usize, length: usize| {
        middle.saturating_sub(reach)..(middle + reach + 1).min(length)
    };
    let mut is_dark = vec![true; dark.width * dark.height];
    let mut is_lit = vec![false; dark.width * dark.height];
    for summit in &frame.summits {
        for row in span(summit.row, FAR_PX, dark.height) {
            let line = row * dark.width;
            span(summit.column, FAR_PX, dark.width).for_each(|column| is_dark[line + column] = false);
            if summit.row.abs_diff(row) <= LIGHT_PX {
                span(summit.column, LIGHT_PX, dark.width).for_each(|column| is_lit[line + column] = true);
            }
        }
        let is_full = summit.value >= full_from;
        if is_full {
            span(summit.column, FAR_PX, dark.width).for_each(|column| columns[column].is_told = false);
        }
    }
    for (at, column) in columns.iter_mut().enumerate() {
        let mut count = 0.0;
        for row in 0..dark.height {
            let index = row * dark.width + at;
            if is_dark[index] {
                count += 1.0;
                column.dark_dn += dark.excess(frame, at, row);
            } else if is_lit[index] {
                column.light_dn += noise.straightened(dark.excess(frame, at, row)).0;
            }
        }
        column.dark_dn /= f64::max(count, 1.0);
        column.is_told &= count >= FEWEST_PX;
    }
    columns
}

/// Takes away from each column what those aside have.
fn against_aside(columns: &mut [Column]) {
    let before = columns.to_vec();
    for (at, column) in columns.iter_mut().enumerate() {
        let (mut count, mut sum) = (0.0, 0.0);
        let far = |aside: &usize| (ASIDE_PX.0..=ASIDE_PX.1).contains(&aside.abs_diff(at));
        for aside in (at.saturating_sub(ASIDE_PX.1)..=at + ASIDE_PX.1).filter(far) {
            if let Some(other) = before.get(aside).filter(|other| other.is_told && other.light_dn < LEAST_DN)
            {
                (count, sum) = (count + 1.0, sum + other.dark_dn);
            }
        }
        column.is_told &= count >= ASIDE_PX.0 as f64;
        column.dark_dn -= sum / f64::max(count, 1.0);
        if column.light_dn < LEAST_DN {
            column.light_dn = 0.0;
        }
    }
}

/// Takes away from each column its mean over frames.
fn against_means(frames: &mut [Vec<Column>], width: usize) {
    for at in 0..width {
        let (mut count, mut sums) = (0.0, [0.0; 2]);
        for column in frames.iter().map(|columns| &columns[at]).filter(|column| column.is_told) {
            count += 1.0;
            sums = [sums[0] + column.dark_dn, sums[1] + column.light_dn];
        }
        let [dark_dn, light_dn] = sums.map(|sum| sum / f64::max(count, 1.0));
        for columns in &mut *frames {
            columns[at].dark_dn -= dark_dn;
            columns[at].light_dn -= light_dn;
        }
    }
}

/// Least squares of darkness on light, with the sigma that the scatter of what is left tells.
fn slope(frames: &[Vec<Column>], is_used: impl Fn(usize) -> bool) -> Option<(f64, f64)> {
    let used = || {
        let frames = frames.iter().enumerate().filter(|(number, _)| is_used(*number));
        frames.flat_map(|(_, columns)| columns.iter().filter(|column| column.is_told))
    };
    let (mut count, mut products, mut squares) = (0.0, 0.0, 0.0);
    for column in used() {
        count += 1.0;
        products += column.light_dn * column.dark_dn;
        squares += column.light_dn * column.light_dn;
    }
    if squares < 1e4 || count < 100.0 {
        return None;
    }
    let share = products / squares;
    let left: f64 = used().map(|column| (column.dark_dn - share * column.light_dn).powi(2)).sum();
    Some((share, (left / count / squares).sqrt()))
}
