//! Outcomes of rows -> a table of neighbours and a table of spots, aligned for reading or as Markdown.

use photinus_evaluate::SpotClass;

use crate::row::Outcome;

/// Cells under their heads.
pub(crate) struct Table {
    heads: Vec<String>,
    lines: Vec<Vec<String>>,
}

pub(crate) fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.digits$}"))
}

pub(crate) fn percent(share: Option<f64>) -> String {
    number(share.map(|share| 100.0 * share), 1)
}

/// A ratio that may be anything from 0 to many thousands: three digits of it.
fn ratio(value: Option<f64>) -> String {
    number(value, value.map_or(0, |value| if value < 10.0 { 2 } else { usize::from(value < 100.0) }))
}

impl Table {
    /// Lines of as many cells as there are heads.
    pub(crate) fn new(heads: Vec<String>, lines: Vec<Vec<String>>) -> Self {
        Self { heads, lines }
    }

    /// Neighbours: how many, how far off, and whether what they claim holds.
    pub(crate) fn of_neighbours(outcomes: &[Outcome]) -> Self {
        let heads = [
            "what",
            "airframe",
            "frames",
            "recall %",
            "of all %",
            "of those apart %",
            "precision %",
            "claimed %",
            "sure phantoms / frame",
            "distance: median m",
            "rms m",
            "NEES / 3",
            "in 50 %",
            "in 95 %",
            "bounds violated",
        ];
        let line = |outcome: &Outcome| {
            let scores = &outcome.scores;
            let neighbours = &scores.neighbours.by_range.overall;
            let (distance, position) = (&scores.distance.overall, &scores.position.overall);
            let frames = outcome.frames as f64;
            let there = frames * outcome.vehicles as f64;
            let bounds = &scores.bounds;
            vec![
                outcome.name.clone(),
                outcome.airframe.clone(),
                outcome.frames.to_string(),
                percent(neighbours.recall),
                percent(Some(neighbours.found as f64 / there)),
                percent(neighbours.apart_recall),
                percent(neighbours.precision),
                percent(scores.probability.as_ref().map(|score| score.claimed)),
                number(Some(neighbours.sure_false as f64 / frames), 3),
                number(distance.error_m.median, 4),
                number(distance.error_m.rms, 3),
                ratio(position.consistency.nees.map(|nees| nees / 3.0)),
                percent(position.consistency.inside_50),
                percent(position.consistency.inside_95),
                format!("{} of {}", bounds.violations.len(), bounds.by_range.overall.count),
            ]
        };
        Self { heads: heads.map(str::to_owned).to_vec(), lines: outcomes.iter().map(line).collect() }
    }

    /// Spots by what they look like: how many, and the squared error of centre and light over what is claimed.
    pub(crate) fn of_spots(outcomes: &[Outcome]) -> Self {
        let mut heads = vec!["what".to_owned(), "airframe".to_owned()];
        heads.extend(SpotClass::ALL.iter().map(|class| class.name().to_owned()));
        let line = |outcome: &Outcome| {
            let mut cells = vec![outcome.name.clone(), outcome.airframe.clone()];
            cells.extend(SpotClass::ALL.iter().map(|class| of_class(outcome, *class)));
            cells
        };
        Self { heads, lines: outcomes.iter().map(line).collect() }
    }

    /// Columns padded with spaces.
    pub(crate) fn aligned(&self) -> String {
        let all = || std::iter::once(&self.heads).chain(&self.lines);
        let width = |column: usize| all().map(|line| line[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..self.heads.len()).map(width).collect();
        let padded = |line: &Vec<String>| {
            let cells = line.iter().zip(&widths).enumerate();
            let cells = cells.map(|(column, (cell, &width))| match column {
                0 | 1 => format!("{cell:width$}"),
                _ => format!("{cell:>width$}"),
            });
            cells.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
        };
        all().map(padded).collect()
    }

    /// A table of Markdown.
    pub(crate) fn markdown(&self) -> String {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        let rule = vec!["---".to_owned(); self.heads.len()].join("|");
        let lines: String = self.lines.iter().map(|cells| line(cells)).collect();
        format!("{}|{rule}|\n{lines}", line(&self.heads))
    }
}

/// `centre / light (count)`: 1 is right for both.
fn of_class(outcome: &Outcome, class: SpotClass) -> String {
    let spots = outcome.scores.spots.as_ref().and_then(|spots| spots.classes.get(&class));
    spots.map_or("-".to_owned(), |score| {
        let centre = ratio(score.nees.map(|nees| nees / 2.0));
        format!("{centre} / {} ({})", ratio(outcome.lights.of(class)), score.count)
    })
}
