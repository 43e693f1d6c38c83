//! The reliability table: truth drawn from what the program believes, and clutter, told down to one in a hundred; how many are
//! right, by what they claim.

use photinus_evaluate::{Decile, ProbabilityScore, expected_calibration_error};
use photinus_sim::faults::{Fault, Lamp};

use crate::row::{Eye, Outcome, Row};
use crate::table::{Table, number, percent};

/// Neighbours that are hardly likely are told, too.
const LEAST: f64 = 0.01;
/// Deciles of the table.
const DECILES: usize = 10;

/// The rows, with how many frames each has for `frames` of single vehicles.
pub(crate) fn rows(eye: &Eye, frames: u64) -> Vec<(Row, u64)> {
    let beside = Fault::Lamp(Lamp::Beside { gap_px: 25.0 });
    // Clutter that is anywhere in each frame is as the model has it; that which stays for a while is not.
    let clutter = [
        ("none", vec![], 1),
        ("30 hot pixels, others in each frame", vec![Fault::Hot(30)], 1),
        ("foreign lamp, elsewhere in each frame", vec![Fault::Lamp(Lamp::Somewhere)], 1),
        ("30 hot pixels", vec![Fault::Hot(30)], 20),
        ("foreign lamp, fixed", vec![Fault::Lamp(Lamp::Somewhere)], 20),
        ("foreign lamp 25 px beside", vec![beside], 20),
    ];
    let plain = |name: String, arms| Row { min_probability: LEAST, ..Row::plain(name, eye, arms) };
    let single = clutter.into_iter().flat_map(|(name, faults, spell)| {
        [6, 4].map(|arms| (Row { faults: faults.clone(), spell, ..plain(name.to_owned(), arms) }, frames))
    });
    let crowds = [5_usize, 10].into_iter().flat_map(|vehicles| {
        let crowd =
            |arms| Row { vehicles, ranges_m: [3.0, 15.0], ..plain(format!("{vehicles} vehicles"), arms) };
        [6, 4].map(|arms| (crowd(arms), (frames / vehicles as u64).max(1)))
    });
    single.chain(crowds).collect()
}

/// The table, with last lines for the rows that are as the model has it, and for all of them.
pub(crate) fn table(outcomes: &[Outcome]) -> Table {
    let mut heads: Vec<String> =
        ["what", "airframe", "frames", "told", "right %", "ECE %", "Brier"].map(str::to_owned).to_vec();
    heads.extend((0..DECILES).map(|decile| format!("{} to {} %", 10 * decile, 10 * (decile + 1))));
    let scored = outcomes.iter().filter_map(|outcome| Some((outcome, outcome.scores.probability.as_ref()?)));
    let scored: Vec<(&Outcome, &ProbabilityScore)> = scored.collect();
    let own = scored.iter().map(|row| line([&row.0.name, &row.0.airframe], std::slice::from_ref(row)));
    let mut lines: Vec<Vec<String>> = own.collect();
    let believed: Vec<_> = scored.iter().filter(|(outcome, _)| outcome.is_as_believed).copied().collect();
    lines.push(line(["as believed", ""], &believed));
    lines.push(line(["all", ""], &scored));
    Table::new(heads, lines)
}

/// Deciles of several rows as one.
fn together(all: &[&Decile]) -> Vec<Decile> {
    let numbered = (0..DECILES).map(|number| all.iter().filter(move |decile| number_of(decile) == number));
    let joined = numbered.filter_map(|those| {
        those.copied().copied().reduce(|a, b| {
            let count = a.count + b.count;
            let claimed = (a.claimed * a.count as f64 + b.claimed * b.count as f64) / count as f64;
            Decile { count, claimed, right: a.right + b.right, far_off: a.far_off + b.far_off, ..a }
        })
    });
    joined.collect()
}

fn number_of(decile: &Decile) -> usize {
    (decile.from * DECILES as f64).round() as usize
}

/// The cells of some rows together.
fn line([name, airframe]: [&str; 2], scored: &[(&Outcome, &ProbabilityScore)]) -> Vec<String> {
    let deciles: Vec<&Decile> = scored.iter().flat_map(|(_, score)| &score.deciles).collect();
    let deciles = together(&deciles);
    let frames: u64 = scored.iter().map(|(outcome, _)| outcome.frames).sum();
    let count: usize = scored.iter().map(|(_, score)| score.count).sum();
    let right: usize = scored.iter().map(|(_, score)| score.right).sum();
    let squares: f64 = scored.iter().map(|(_, score)| score.brier * score.count as f64).sum();
    let mut cells = vec![
        name.to_owned(),
        airframe.to_owned(),
        frames.to_string(),
        count.to_string(),
        percent(Some(right as f64 / count as f64)),
        number(expected_calibration_error(&deciles).map(|error| 100.0 * error), 2),
        number(Some(squares / count as f64), 4),
    ];
    cells.extend((0..DECILES).map(|number| {
        let decile = deciles.iter().find(|decile| number_of(decile) == number);
        decile.map_or("-".to_owned(), cell)
    }));
    cells
}

/// `claimed / right % (count, of which far off)`.
fn cell(decile: &Decile) -> String {
    let Decile { count, claimed, right, far_off, .. } = *decile;
    let off = if far_off > 0 { format!(", {far_off} far off") } else { String::new() };
    format!("{} / {} ({count}{off})", percent(Some(claimed)), percent(Some(right as f64 / count as f64)))
}
