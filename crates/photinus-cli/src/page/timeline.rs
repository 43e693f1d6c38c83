//! A distance over time, drawn in the page: truth, the estimate and the strict bounds, with a cursor that a player moves.

use std::fmt::Write;

use super::escaped;

/// Of the drawing, px at its full width.
const SIZE: (f64, f64) = (1000.0, 260.0);
/// Where the axes end: left, right, top, bottom.
const FIELD: [f64; 4] = [100.0, 990.0, 14.0, 222.0];
/// More moments than this cannot be told apart.
const MOST: usize = 900;

/// What is known of a moment.
#[derive(Clone, Copy)]
pub(crate) struct Moment {
    /// When, s.
    pub(crate) time_s: f64,
    /// The true distance, m.
    pub(crate) truth_m: f64,
    /// The estimate, m, where there is one.
    pub(crate) estimate_m: Option<f64>,
    /// The bounds, m, where it was found; the far one may be open.
    pub(crate) bounds_m: Option<(f64, Option<f64>)>,
}

/// A distance over time.
pub(crate) struct Timeline {
    /// What it shows.
    pub(crate) title: String,
    /// In order of time.
    pub(crate) moments: Vec<Moment>,
}

impl Timeline {
    pub(super) fn write(&self, html: &mut String) {
        let step = self.moments.len().div_ceil(MOST).max(1);
        let moments: Vec<Moment> = self.moments.iter().copied().step_by(step).collect();
        let (Some(first), Some(last)) = (moments.first(), moments.last()) else { return };
        let axes = Axes { from_s: first.time_s, to_s: last.time_s, farthest_m: farthest(&moments) };
        let [left, right, top, bottom] = FIELD;
        // Writing to a String cannot fail.
        let _ = write!(
            html,
            "<figure>\n<h3>{}</h3>\n<svg class=\"timeline\" viewBox=\"0 0 {} {}\" data-left=\"{left}\" data-right=\"{right}\" \
             data-from=\"{}\" data-to=\"{}\">\n",
            escaped(&self.title),
            SIZE.0,
            SIZE.1,
            axes.from_s,
            axes.to_s
        );
        axes.write(html);
        for run in runs(&moments) {
            let near = run.iter().map(|(at, near_m, _)| axes.point(at.time_s, *near_m));
            let far = run
                .iter()
                .rev()
                .map(|(at, _, far_m)| axes.point(at.time_s, far_m.unwrap_or(axes.farthest_m)));
            let _ = writeln!(html, "<path class=\"band\" d=\"M{}Z\"/>", joined(near.chain(far)));
        }
        let truth = moments.iter().map(|at| axes.point(at.time_s, at.truth_m));
        let _ = writeln!(html, "<path class=\"truth\" d=\"M{}\"/>", joined(truth));
        for run in moments.split(|at| at.estimate_m.is_none()).filter(|run| !run.is_empty()) {
            let line = run.iter().filter_map(|at| Some(axes.point(at.time_s, at.estimate_m?)));
            let _ = writeln!(html, "<path class=\"estimate\" d=\"M{}\"/>", joined(line));
        }
        let _ = write!(
            html,
            "<line class=\"cursor\" x1=\"{left}\" x2=\"{left}\" y1=\"{top}\" y2=\"{bottom}\"/>\n</svg>\n<figcaption>\
             <span class=\"key truth\"></span>truth <span class=\"key estimate\"></span>estimate \
             <span class=\"key bounds\"></span>strict bounds, to the upper edge where they are open. Click to go there.\
             </figcaption>\n</figure>\n"
        );
    }
}

/// Where a moment with bounds stands, and the bounds.
type Bounded<'a> = (&'a Moment, f64, Option<f64>);

/// Moments with bounds, cut where there are none.
fn runs(moments: &[Moment]) -> Vec<Vec<Bounded<'_>>> {
    let runs = moments.split(|at| at.bounds_m.is_none());
    let bounded = |run: &[Moment]| run.len() > 1;
    runs.filter(|run| bounded(run))
        .map(|run| {
            run.iter().filter_map(|at| at.bounds_m.map(|(near_m, far_m)| (at, near_m, far_m))).collect()
        })
        .collect()
}

/// The upper end of the axis: every closed bound is shown, unless it is out of all proportion.
fn farthest(moments: &[Moment]) -> f64 {
    let truth_m = moments.iter().map(|at| at.truth_m).fold(0.0, f64::max);
    let bound_m = moments.iter().filter_map(|at| at.bounds_m?.1).fold(0.0, f64::max);
    bound_m.clamp(1.2 * truth_m, (3.0 * truth_m).max(1.0))
}

struct Axes {
    from_s: f64,
    to_s: f64,
    farthest_m: f64,
}

impl Axes {
    fn point(&self, time_s: f64, distance_m: f64) -> (f64, f64) {
        let [left, right, top, bottom] = FIELD;
        let across = (time_s - self.from_s) / (self.to_s - self.from_s).max(1e-9);
        let up = (distance_m / self.farthest_m).clamp(0.0, 1.0);
        (left + across * (right - left), bottom - up * (bottom - top))
    }

    fn write(&self, html: &mut String) {
        let [left, right, ..] = FIELD;
        for distance_m in ticks(0.0, self.farthest_m, 4.0) {
            let (_, y) = self.point(self.from_s, distance_m);
            let _ = writeln!(
                html,
                "<path class=\"axis\" d=\"M{left} {y:.1}H{right}\"/><text x=\"{:.0}\" y=\"{:.1}\" text-anchor=\"end\">\
                 {distance_m} m</text>",
                left - 6.0,
                y + 5.0
            );
        }
        for time_s in ticks(self.from_s, self.to_s, 5.0) {
            let (x, _) = self.point(time_s, 0.0);
            let _ = writeln!(
                html,
                "<text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{time_s} s</text>",
                SIZE.1 - 6.0
            );
        }
    }
}

/// Round numbers between two others, about `count` of them.
fn ticks(from: f64, to: f64, count: f64) -> Vec<f64> {
    let rough = ((to - from) / count).max(1e-6);
    let decade = libm::exp10(libm::floor(libm::log10(rough)));
    let step = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|times| times * decade)
        .find(|&step| step >= rough)
        .unwrap_or(rough);
    let first = (from / step).ceil();
    (0..)
        .map(|number| (first + f64::from(number)) * step)
        .take_while(|&at| at <= to + 1e-9)
        .map(rounded)
        .collect()
}

/// Without the noise of the last digits.
fn rounded(number: f64) -> f64 {
    (number * 1e6).round() / 1e6
}

fn joined(points: impl Iterator<Item = (f64, f64)>) -> String {
    points.map(|(x, y)| format!("{x:.1} {y:.1}")).collect::<Vec<_>>().join("L")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_between() {
        assert_eq!(ticks(0.0, 16.0, 4.0), [0.0, 5.0, 10.0, 15.0]);
        assert_eq!(ticks(0.014, 120.0, 5.0), [50.0, 100.0]);
        assert_eq!(ticks(0.0, 0.35, 4.0), [0.0, 0.1, 0.2, 0.3]);
    }

    #[test]
    fn a_gap_is_a_gap_and_an_open_bound_reaches_the_edge() {
        let moment = |time_s: f64, estimate_m: Option<f64>| Moment {
            time_s,
            truth_m: 5.0,
            estimate_m,
            bounds_m: estimate_m.map(|m| (m - 1.0, None)),
        };
        let seen = [0.0, 1.0, 2.0, 3.0, 4.0].map(|s| moment(s, (!(1.5..=2.5).contains(&s)).then_some(5.0)));
        let mut html = String::new();
        Timeline { title: "d".to_owned(), moments: seen.to_vec() }.write(&mut html);
        assert_eq!(
            (html.matches("class=\"band\"").count(), html.matches("class=\"estimate\"").count()),
            (2, 2)
        );
        assert!(html.contains("100.0 14.0Z"), "the band begins and ends at the upper edge: {html}");
    }
}
