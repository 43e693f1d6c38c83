//! Scores as tables to read: a block for each thing that is scored, a row over all and one for each range.

use std::fmt;

use photinus_evaluate::{
    Bounds, ByRange, Consistency, FollowedScore, GospaScore, IdentityScore, ProbabilityScore, Scores, Spread,
    TrackScore,
};

use crate::aligned::{Aligned, Side};

/// After this many violations the others are only counted.
const LISTED_VIOLATIONS: usize = 10;

/// All tables.
pub(super) struct Tables<'a>(pub(super) &'a Scores);

impl fmt::Display for Tables<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scores = self.0;
        let frames = scores.frames;
        write!(
            f,
            "frames  {} of truth, {} evaluated, {} missing",
            frames.truth, frames.evaluated, frames.missing
        )?;
        if frames.without_truth > 0 {
            write!(f, "; {} without truth left out", frames.without_truth)?;
        }
        writeln!(f)?;
        neighbours(f, scores)?;
        probability(f, scores.probability.as_ref())?;
        spots(f, scores)?;
        errors(f, scores)?;
        bounds(f, &scores.bounds)?;
        paper(f, scores)?;
        identity(f, scores.identity.as_ref())?;
        tracks(f, scores.tracks.as_ref())?;
        followed(f, scores.followed.as_ref())?;
        latency(f, scores.latency_s.as_ref())
    }
}

/// A block: its title, its columns, a row over all and one for each range.
fn block<S>(
    f: &mut fmt::Formatter<'_>,
    title: &str,
    columns: &[&str],
    scores: &ByRange<S>,
    cells: impl Fn(&S) -> Vec<String>,
) -> fmt::Result {
    let mut table = Aligned::new(2, &vec![Side::Right; columns.len() + 1]);
    table.row(["range m"].iter().chain(columns).copied());
    let row = |range: String, score: &S| std::iter::once(range).chain(cells(score));
    table.row(row("all".to_owned(), &scores.overall));
    for bin in &scores.bins {
        let range = match bin.to_m {
            Some(to_m) => format!("{}-{to_m}", bin.from_m),
            None => format!("{}+", bin.from_m),
        };
        table.row(row(range, &bin.score));
    }
    write!(f, "\n{title}\n{table}\n")
}

/// A number with this many decimals, `-` where there is none.
fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.decimals$}"))
}

fn percent(share: Option<f64>) -> String {
    number(share.map(|share| 100.0 * share), 1)
}

fn neighbours(f: &mut fmt::Formatter<'_>, scores: &Scores) -> fmt::Result {
    let columns = ["visible", "found", "missed", "false", "recall %", "precision %"];
    block(f, "neighbours", &columns, &scores.neighbours.by_range, |score| {
        let counts =
            [score.visible, score.found, score.missed, score.false_neighbours].map(|n| n.to_string());
        counts.into_iter().chain([percent(score.recall), percent(score.precision)]).collect()
    })?;
    let (merged, split) = (scores.neighbours.merged, scores.neighbours.split);
    writeln!(f, "  {merged} taken together with another, {split} taken apart")
}

/// Reliability by decile, then what each least probability keeps.
fn probability(f: &mut fmt::Formatter<'_>, score: Option<&ProbabilityScore>) -> fmt::Result {
    let Some(score) = score else { return Ok(()) };
    let mut reliability = Aligned::new(2, &[Side::Right; 5]);
    reliability.row(["claimed %", "count", "mean claim %", "right %", "far off"]);
    for decile in &score.deciles {
        let right = decile.right as f64 / decile.count as f64;
        reliability.row([
            format!("{:.0}-{:.0}", 100.0 * decile.from, 100.0 * decile.to),
            decile.count.to_string(),
            percent(Some(decile.claimed)),
            percent(Some(right)),
            decile.far_off.to_string(),
        ]);
    }
    let [error, brier] = [score.expected_calibration_error, score.brier].map(|value| number(Some(value), 4));
    write!(f, "\nprobability\n{reliability}\n  expected calibration error {error}, Brier score {brier}\n")?;
    let mut kept = Aligned::new(2, &[Side::Right; 5]);
    kept.row(["min probability", "found", "false", "recall %", "precision %"]);
    for row in &score.kept {
        let counts = [row.found, row.false_neighbours].map(|n| n.to_string());
        let shares = [percent(row.recall), percent(row.precision)];
        kept.row(std::iter::once(row.min_probability.to_string()).chain(counts).chain(shares));
    }
    let area = number(score.average_precision, 4);
    write!(f, "\nprecision and recall by least probability\n{kept}\n  average precision {area}\n")
}

fn spots(f: &mut fmt::Formatter<'_>, scores: &Scores) -> fmt::Result {
    let Some(spots) = &scores.spots else {
        return writeln!(f, "\nspots: truth lists no LED");
    };
    let columns = [
        "LEDs",
        "found",
        "merged",
        "missed",
        "double",
        "false",
        "recall %",
        "precision %",
        "rms px",
        "bias u",
        "bias v",
        "NEES/2",
    ];
    block(f, "spots, and their centres", &columns, &spots.by_range, |score| {
        let counts = [score.leds, score.found, score.merged, score.missed, score.double, score.false_spots];
        let shares = [percent(score.recall), percent(score.precision)];
        let centres = [
            number(score.centroid_error_px.rms, 3),
            number(score.centroid_bias_u_px, 3),
            number(score.centroid_bias_v_px, 3),
            number(score.centroid_nees.map(|nees| nees / 2.0), 2),
        ];
        counts.into_iter().map(|n| n.to_string()).chain(shares).chain(centres).collect()
    })?;
    for (reason, leds) in &spots.rejected_leds {
        writeln!(f, "  {leds} LEDs missed because they were rejected as {reason}")?;
    }
    Ok(())
}

fn errors(f: &mut fmt::Formatter<'_>, scores: &Scores) -> fmt::Result {
    let columns = ["count", "rms mrad", "median", "95 %", "largest"];
    block(f, "bearing error", &columns, &scores.bearing_error_rad, |error: &Spread| {
        let sizes = [error.rms, error.median, error.p95, error.max];
        let sizes = sizes.map(|rad| number(rad.map(|rad| 1e3 * rad), 2));
        std::iter::once(error.count.to_string()).chain(sizes).collect()
    })?;
    let columns = ["count", "bias m", "rms m", "median m", "95 % m", "bias %", "rms %", "NEES/1"];
    block(f, "distance error", &columns, &scores.distance, |score| {
        let error = score.error_m;
        let metres = [error.bias, error.rms, error.median, error.p95].map(|m| number(m, 3));
        let relative = [percent(score.relative_error.bias), percent(score.relative_error.rms)];
        let count = std::iter::once(error.count.to_string());
        count.chain(metres).chain(relative).chain([number(score.nees, 2)]).collect()
    })?;
    let columns = ["count", "rms m", "median m", "95 % m", "NEES/3", "+-", "in 95 % ellipsoid %"];
    block(f, "position error", &columns, &scores.position, |score| {
        let error = score.error_m;
        let metres = [error.rms, error.median, error.p95].map(|m| number(m, 3));
        let count = std::iter::once(error.count.to_string());
        count.chain(metres).chain(consistency(&score.consistency)).collect()
    })
}

/// NEES over what is right, its standard error, and the share inside the 95 % ellipsoid.
fn consistency(score: &Consistency) -> [String; 3] {
    let [nees, error] =
        [score.nees, score.nees_standard_error].map(|nees| number(nees.map(|nees| nees / 3.0), 2));
    [nees, error, percent(score.inside_95)]
}

fn bounds(f: &mut fmt::Formatter<'_>, bounds: &Bounds) -> fmt::Result {
    let columns = ["count", "inside", "inside %", "bounded", "median width m", "of distance %"];
    block(f, "bounds of distance", &columns, &bounds.by_range, |score| {
        let counts = [score.count.to_string(), score.inside.to_string(), percent(score.coverage)];
        let widths = [number(score.median_width_m, 2), percent(score.median_relative_width)];
        counts.into_iter().chain([score.bounded.to_string()]).chain(widths).collect()
    })?;
    for v in bounds.violations.iter().take(LISTED_VIOLATIONS) {
        let max = v.max_m.map_or("infinity".to_owned(), |max| format!("{max:.3}"));
        writeln!(
            f,
            "  violated: frame {}, neighbour {}, at {:.3} m, bounds {:.3} to {max} m, out by {:.3} m",
            v.frame,
            v.id,
            v.distance_m,
            v.min_m,
            v.by_m.abs()
        )?;
    }
    match bounds.violations.len().saturating_sub(LISTED_VIOLATIONS) {
        0 => Ok(()),
        more => writeln!(f, "  and {more} more, all of them in the output of --json"),
    }
}

fn paper(f: &mut fmt::Formatter<'_>, scores: &Scores) -> fmt::Result {
    let all = &scores.paper.overall;
    if all.perpendicular_error_m.count + all.inline_error_m.count == 0 {
        return Ok(());
    }
    let columns = ["l_A count", "bias m", "rms %", "l_B count", "bias m", "rms %", "l_B <= truth <= l_A %"];
    block(f, "the paper's l_A and l_B", &columns, &scores.paper, |score| {
        let of = |error: &Spread, relative: &Spread| {
            [error.count.to_string(), number(error.bias, 3), percent(relative.rms)]
        };
        let perpendicular = of(&score.perpendicular_error_m, &score.perpendicular_relative_error);
        let inline = of(&score.inline_error_m, &score.inline_relative_error);
        perpendicular.into_iter().chain(inline).chain([percent(score.between)]).collect()
    })
}

fn identity(f: &mut fmt::Formatter<'_>, score: Option<&IdentityScore>) -> fmt::Result {
    let Some(score) = score else { return Ok(()) };
    writeln!(
        f,
        "\nidentities  {} of {} found have one; {} right ({} %)",
        score.identified,
        score.found,
        score.correct,
        percent(score.accuracy)
    )?;
    let time = &score.time_to_identity_s;
    writeln!(
        f,
        "  after {} s in the median, {} s at most, {} never; {} switches, the longest wrong for {} s",
        number(time.median, 2),
        number(time.max, 2),
        score.never,
        score.switches,
        number(Some(score.longest_wrong_s), 2)
    )
}

fn tracks(f: &mut fmt::Formatter<'_>, score: Option<&TrackScore>) -> fmt::Result {
    let Some(score) = score else { return Ok(()) };
    writeln!(
        f,
        "\ntracks  {} of {} neighbours, {} false; {} switches, {} fragments; {} % of what was visible is on a track",
        score.tracks,
        score.neighbours,
        score.false_tracks,
        score.switches,
        score.fragments,
        percent(score.coverage)
    )
}

/// What is followed, then its errors, then GOSPA.
fn followed(f: &mut fmt::Formatter<'_>, score: Option<&FollowedScore>) -> fmt::Result {
    let Some(score) = score else { return Ok(()) };
    writeln!(
        f,
        "\nfollowed  {} of {} visible ({} %), {} of {} hidden ({} %), {} false; IDF1 {}",
        score.followed,
        score.visible,
        percent(score.recall),
        score.hidden_followed,
        score.hidden,
        percent(score.hidden_recall),
        score.false_tracks,
        number(score.idf1, 3)
    )?;
    let mut errors = Aligned::new(
        2,
        &[
            Side::Left,
            Side::Right,
            Side::Right,
            Side::Right,
            Side::Right,
            Side::Right,
            Side::Right,
            Side::Right,
        ],
    );
    errors.row(["of tracks", "count", "rms", "median", "95 %", "NEES/3", "+-", "in 95 % ellipsoid %"]);
    for (name, error, kept) in [
        ("position seen, m", &score.seen_error_m, &score.seen),
        ("position predicted, m", &score.predicted_error_m, &score.predicted),
        ("velocity, m/s", &score.velocity_error_m_s, &score.velocity),
    ] {
        let sizes = [error.rms, error.median, error.p95].map(|size| number(size, 3));
        let cells = [name.to_owned(), error.count.to_string()].into_iter().chain(sizes);
        errors.row(cells.chain(consistency(kept)));
    }
    writeln!(f, "{errors}")?;
    for (name, gospa) in [("GOSPA", &score.gospa), ("probabilistic GOSPA", &score.probabilistic_gospa)] {
        writeln!(f, "  {name} {}", told(gospa))?;
    }
    Ok(())
}

fn told(gospa: &GospaScore) -> String {
    let parts = [gospa.place_m2, gospa.existence_m2, gospa.missed_m2, gospa.false_m2];
    let [place, existence, missed, made_up] = parts.map(|part| number(part, 4));
    let mean = number(gospa.mean_m, 3);
    format!(
        "{mean} m; of its square: place {place} m^2, existence {existence}, missed {missed}, false {made_up}"
    )
}

fn latency(f: &mut fmt::Formatter<'_>, latency_s: Option<&Spread>) -> fmt::Result {
    let Some(latency_s) = latency_s else { return Ok(()) };
    let [median, p95, max] =
        [latency_s.median, latency_s.p95, latency_s.max].map(|s| number(s.map(|s| 1e3 * s), 1));
    writeln!(f, "\nlatency  median {median} ms, 95 % {p95} ms, longest {max} ms")
}
