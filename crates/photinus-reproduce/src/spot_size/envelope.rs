//! Figure 11: spot area at 1000 us, and the fit of its upper envelope, S = a + b / (l + c)^2 (paper (13)).

use std::collections::BTreeMap;

use photinus::ranging::Envelope;

use super::{FAR_M, NEAR_M, PRINTED, Shot, farthest_m};
use crate::statistics::{deviation, mean, share, slope};
use crate::{Figure, Kind, Panel, Report, Role, Row, Tolerance};

/// Width of the classes of distance whose largest spots are fitted, m: as even as an LED recedes, and with enough spots in each
/// for the largest to be near the envelope.
const CLASS_M: f64 = 0.25;
/// Largest shift that is tried, m, and the step.
const SHIFTS: (f64, f64) = (0.15, 5e-4);
/// Classes in which shares are counted, equally wide on a logarithmic axis.
const SHARE_CLASSES: usize = 30;

pub(super) fn report(repeats: &[Vec<Shot>]) -> Report {
    let all: Vec<Shot> = repeats.concat();
    let envelopes: Vec<Envelope> = repeats.iter().filter_map(|shots| fit(&largest(shots))).collect();
    let held = with_shift(&largest(&all), PRINTED.shift_m);
    let of = |number: fn(&Envelope) -> f64| envelopes.iter().map(number).collect::<Vec<f64>>();
    let numbers = [of(|e| e.offset_px), of(|e| e.scale_px_m2), of(|e| e.shift_m)];
    let [offset_px, scale_px_m2, shift_m] = numbers.each_ref().map(|values| mean(values.iter().copied()));
    let own = Envelope { offset_px, scale_px_m2, shift_m };
    Report {
        figure: Figure::Envelope,
        panels: areas(&all, &own).into_iter().chain([found(&all)]).collect(),
        rows: rows(&all, &own, held, numbers.each_ref().map(|values| deviation(values))),
    }
}

/// The largest area at a distance before it is rounded, px.
fn envelope_px(envelope: &Envelope, distance_m: f64) -> f64 {
    let shifted_m = distance_m + envelope.shift_m;
    envelope.offset_px + envelope.scale_px_m2 / (shifted_m * shifted_m)
}

/// The largest spot of each class of distance that has one.
fn largest(shots: &[Shot]) -> Vec<(f64, f64)> {
    let mut classes = BTreeMap::<usize, Shot>::new();
    for shot in shots.iter().filter(|shot| shot.area_px > 0) {
        let class = ((shot.distance_m - NEAR_M) / CLASS_M) as usize;
        let largest = classes.entry(class).or_insert(*shot);
        if shot.area_px > largest.area_px {
            *largest = *shot;
        }
    }
    classes.into_values().map(|shot| (shot.distance_m, f64::from(shot.area_px))).collect()
}

/// Least squares over shifts of +- [`SHIFTS`]; `None` for fewer than four points.
fn fit(points: &[(f64, f64)]) -> Option<Envelope> {
    let steps = (SHIFTS.0 / SHIFTS.1) as i32;
    let candidates = (-steps..=steps).filter_map(|step| with_shift(points, f64::from(step) * SHIFTS.1));
    let cost = |envelope: &Envelope| -> f64 {
        points.iter().map(|(l, s)| envelope_px(envelope, *l) - s).map(|error| error * error).sum()
    };
    let best = candidates.min_by(|a, b| cost(a).total_cmp(&cost(b)));
    best.filter(|_| points.len() >= 4)
}

/// Least squares for a given shift: a straight line over 1 / (l + c)^2; `None` where that is not a curve.
fn with_shift(points: &[(f64, f64)], shift_m: f64) -> Option<Envelope> {
    let line: Vec<(f64, f64)> =
        points.iter().map(|(l, s)| (1.0 / ((l + shift_m) * (l + shift_m)), *s)).collect();
    let scale_px_m2 = slope(&line);
    let offset_px = mean(line.iter().map(|p| p.1)) - scale_px_m2 * mean(line.iter().map(|p| p.0));
    scale_px_m2.is_finite().then_some(Envelope { offset_px, scale_px_m2, shift_m })
}

fn areas(all: &[Shot], own: &Envelope) -> [Panel; 2] {
    let curve = |envelope: &Envelope| -> Vec<(f64, f64)> {
        let distances = (0..=1450).map(|step| NEAR_M + 0.01 * f64::from(step));
        distances.map(|l| (l, envelope_px(envelope, l))).collect()
    };
    let spots = all.iter().filter(|shot| shot.area_px > 0);
    let spots = spots.map(|shot| (shot.distance_m, f64::from(shot.area_px))).collect();
    let (first_m, last_m) = (first_single_m(all), farthest_m(all, |shot| shot.area_px > 1));
    let numbers = format!("{:.4} + {:.4} / (l {:+.4})^2", own.offset_px, own.scale_px_m2, own.shift_m);
    let whole = Panel::new("Spot area at 1000 us, threshold 200", "distance (m)", "spot area (px)")
        .with_ranges([0.0, FAR_M], [0.0, 140.0])
        .with("spots", Kind::Points, Role::Own, spots)
        .with(format!("fit: {numbers}"), Kind::Line, Role::Perpendicular, curve(own))
        .with("(13) as printed", Kind::Dashed, Role::Printed, curve(&PRINTED))
        .with_upright(format!("{first_m:.2} m (paper 3.14)"), first_m, Some(6))
        .with_upright(format!("{last_m:.2} m (paper 6.62)"), last_m, Some(4));
    let enlarged = Panel { title: "The same, enlarged", y_range: Some([0.0, 16.0]), ..whole.clone() };
    [whole, enlarged]
}

fn found(all: &[Shot]) -> Panel {
    let class = |shot: &Shot| {
        let share = libm::log(shot.distance_m / NEAR_M) / libm::log(FAR_M / NEAR_M);
        ((share * SHARE_CLASSES as f64) as usize).min(SHARE_CLASSES - 1)
    };
    let over_distance = |holds: fn(&Shot) -> bool| -> Vec<(f64, f64)> {
        let of = |number: usize| all.iter().filter(move |shot| class(shot) == number);
        (0..SHARE_CLASSES)
            .map(|number| {
                (mean(of(number).map(|shot| shot.distance_m)), 100.0 * share(of(number).map(holds)))
            })
            .filter(|point| point.1.is_finite())
            .collect()
    };
    Panel::new("Frames in which the LED is found", "distance (m)", "share (%)")
        .with_ranges([0.0, FAR_M], [0.0, 105.0])
        .with("Photinus, contrast", Kind::Line, Role::Own, over_distance(|shot| shot.is_found_by_contrast))
        .with("threshold 50", Kind::Dashed, Role::Inline, over_distance(|shot| shot.is_found_outdoors))
        .with(
            "threshold 200, the paper's",
            Kind::Line,
            Role::Perpendicular,
            over_distance(|shot| shot.area_px > 0),
        )
}

fn first_single_m(shots: &[Shot]) -> f64 {
    shots.iter().filter(|shot| shot.area_px == 1).map(|shot| shot.distance_m).fold(f64::INFINITY, f64::min)
}

fn rows(all: &[Shot], own: &Envelope, held: Option<Envelope>, spread: [f64; 3]) -> Vec<Row> {
    let stated = "stated before: our own fit to the largest spots within 10 %";
    let coefficient = |name: &str, paper: f64, value: f64, spread: f64, why: &str| {
        let note = format!("{stated}; +- {spread:.4} (1 sigma of 10 recordings){why}");
        Row::of_paper(format!("(13): {name}"), paper, value, Tolerance::Ratio(0.1), note)
    };
    let held_coefficient = |name: &str, paper: f64, value: Option<f64>| {
        let note = "the same with the printed shift: the three coefficients trade with each other";
        Row::of_paper(format!("(13): {name}"), paper, value.unwrap_or(f64::NAN), Tolerance::Ratio(0.1), note)
    };
    // where (13) is no larger than two pixels both say next to nothing
    let steps = (0..=80).map(|step| 0.6 + 0.03 * f64::from(step));
    let worst =
        steps.map(|l| (envelope_px(own, l) / envelope_px(&PRINTED, l) - 1.0).abs()).fold(0.0, f64::max);
    #[allow(clippy::approx_constant, reason = "a distance, not a ratio")]
    let first_paper_m = 3.14;
    vec![
        coefficient(
            "offset (px)",
            PRINTED.offset_px,
            own.offset_px,
            spread[0],
            "; what is left far away: (13) leaves two pixels out to 14 m where figure 11 has one past 6.62 m",
        ),
        coefficient("scale (px m^2)", PRINTED.scale_px_m2, own.scale_px_m2, spread[1], ""),
        coefficient(
            "shift (m)",
            PRINTED.shift_m,
            own.shift_m,
            spread[2],
            "; a few centimetres of an LED's face and skirt; the paper prints either sign",
        ),
        held_coefficient(
            "offset, shift held at -0.0154 m (px)",
            PRINTED.offset_px,
            held.map(|held| held.offset_px),
        ),
        held_coefficient(
            "scale, shift held at -0.0154 m (px m^2)",
            PRINTED.scale_px_m2,
            held.map(|held| held.scale_px_m2),
        ),
        Row::own(
            "largest difference between the fit and (13), 0.6 m to 3 m, share",
            worst,
            Tolerance::AtMost(0.1),
            "the curve itself, where it tells distance: its three coefficients trade with each other",
        ),
        Row::of_paper(
            "first spot of 1 px at 1000 us (m)",
            first_paper_m,
            first_single_m(all),
            Tolerance::Ratio(0.1),
            "the preset was fitted without noise, over a raster of places in a pixel",
        ),
        Row::of_paper(
            "last spot of 2 px at 1000 us (m)",
            6.62,
            farthest_m(all, |shot| shot.area_px > 1),
            Tolerance::Ratio(0.05),
            "the preset was fitted without noise; only a point on the very border of pixels gets there",
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fit_gives_back_what_the_points_were_made_of() {
        let made = Envelope { offset_px: 1.2, scale_px_m2: 30.0, shift_m: 0.02 };
        let points: Vec<_> =
            (5..150).map(|l| 0.1 * f64::from(l)).map(|l| (l, envelope_px(&made, l))).collect();
        let found = fit(&points).unwrap();
        assert!((found.offset_px - 1.2).abs() < 1e-9 && (found.scale_px_m2 - 30.0).abs() < 1e-9);
        assert!((found.shift_m - 0.02).abs() < 1e-12);
        assert_eq!(fit(&points[..3]), None);
    }
}
