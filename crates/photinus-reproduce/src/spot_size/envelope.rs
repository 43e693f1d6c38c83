//! Figure 11: spot area at 1000 us, and the fit of its upper envelope, S = a + b / (l + c)^2 (paper (13)).

use photinus::ranging::Envelope;

use super::{FAR_M, NEAR_M, PRINTED, Shot, farthest_m};
use crate::statistics::{deviation, mean, share};
use crate::{Figure, Kind, Panel, Report, Role, Row, Tolerance};

/// Classes of distance, equally wide on a logarithmic axis, whose largest spots are fitted.
const CLASSES: usize = 48;
/// Largest shift that is tried, m, and the step.
const SHIFTS: (f64, f64) = (0.15, 5e-4);
/// Classes in which shares are counted.
const SHARE_CLASSES: usize = 30;

pub(super) fn report(repeats: &[Vec<Shot>]) -> Report {
    let all: Vec<Shot> = repeats.concat();
    let envelopes: Vec<Envelope> = repeats.iter().filter_map(|shots| fit(&largest(shots))).collect();
    let of = |number: fn(&Envelope) -> f64| envelopes.iter().map(number).collect::<Vec<f64>>();
    let numbers = [of(|e| e.offset_px), of(|e| e.scale_px_m2), of(|e| e.shift_m)];
    let [offset_px, scale_px_m2, shift_m] = numbers.each_ref().map(|values| mean(values.iter().copied()));
    let own = Envelope { offset_px, scale_px_m2, shift_m };
    Report {
        figure: Figure::Envelope,
        panels: vec![areas(&all, &own), found(&all)],
        rows: rows(&all, &own, numbers.each_ref().map(|values| deviation(values))),
    }
}

/// The largest area at a distance before it is rounded, px.
fn envelope_px(envelope: &Envelope, distance_m: f64) -> f64 {
    let shifted_m = distance_m + envelope.shift_m;
    envelope.offset_px + envelope.scale_px_m2 / (shifted_m * shifted_m)
}

/// The largest spot of each class of distance that has one.
fn largest(shots: &[Shot]) -> Vec<(f64, f64)> {
    let mut classes = [None::<Shot>; CLASSES];
    for shot in shots.iter().filter(|shot| shot.area_px > 0) {
        let class = class(shot.distance_m, CLASSES);
        if classes[class].is_none_or(|largest| shot.area_px > largest.area_px) {
            classes[class] = Some(*shot);
        }
    }
    classes.into_iter().flatten().map(|shot| (shot.distance_m, f64::from(shot.area_px))).collect()
}

fn class(distance_m: f64, classes: usize) -> usize {
    let share = libm::log(distance_m / NEAR_M) / libm::log(FAR_M / NEAR_M);
    ((share * classes as f64) as usize).min(classes - 1)
}

/// Least squares: for every shift the other two follow from a straight line; `None` for fewer than four points.
fn fit(points: &[(f64, f64)]) -> Option<Envelope> {
    if points.len() < 4 {
        return None;
    }
    let steps = (SHIFTS.0 / SHIFTS.1) as i32;
    let candidates = (-steps..=steps).map(|step| {
        let shift_m = f64::from(step) * SHIFTS.1;
        let x = |l: f64| 1.0 / ((l + shift_m) * (l + shift_m));
        let (x_mean, y_mean) = (mean(points.iter().map(|p| x(p.0))), mean(points.iter().map(|p| p.1)));
        let products: f64 = points.iter().map(|(l, s)| (x(*l) - x_mean) * (s - y_mean)).sum();
        let squares: f64 = points.iter().map(|(l, _)| (x(*l) - x_mean) * (x(*l) - x_mean)).sum();
        let scale_px_m2 = products / squares;
        let envelope = Envelope { offset_px: y_mean - scale_px_m2 * x_mean, scale_px_m2, shift_m };
        let cost: f64 =
            points.iter().map(|(l, s)| envelope_px(&envelope, *l) - s).map(|error| error * error).sum();
        (cost, envelope)
    });
    candidates.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, envelope)| envelope)
}

fn areas(all: &[Shot], own: &Envelope) -> Panel {
    let curve = |envelope: &Envelope| -> Vec<(f64, f64)> {
        let distances = (0..=290).map(|step| NEAR_M + 0.05 * f64::from(step));
        distances.map(|l| (l, envelope_px(envelope, l))).filter(|point| point.1 <= 140.0).collect()
    };
    let spots =
        all.iter().filter(|shot| shot.area_px > 0).map(|shot| (shot.distance_m, f64::from(shot.area_px)));
    let first_m = first_single_m(all);
    let last_m = farthest_m(all, |shot| shot.area_px > 1);
    Panel::new("Spot area at 1000 us, threshold 200", "distance (m)", "spot area (px)")
        .with_ranges([0.0, FAR_M], [0.0, 140.0])
        .with("spots", Kind::Points, Role::Own, spots.collect())
        .with(
            format!("fit: {:.4} + {:.4} / (l {:+.4})^2", own.offset_px, own.scale_px_m2, own.shift_m),
            Kind::Line,
            Role::Perpendicular,
            curve(own),
        )
        .with("(13) as printed", Kind::Dashed, Role::Printed, curve(&PRINTED))
        .with_upright(format!("{first_m:.2} m"), first_m, Some(6))
        .with_upright(format!("{last_m:.2} m"), last_m, Some(2))
}

fn found(all: &[Shot]) -> Panel {
    let over_distance = |holds: fn(&Shot) -> bool| -> Vec<(f64, f64)> {
        let of =
            |number: usize| all.iter().filter(move |shot| class(shot.distance_m, SHARE_CLASSES) == number);
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

fn rows(all: &[Shot], own: &Envelope, spread: [f64; 3]) -> Vec<Row> {
    let stated = "stated before: our own fit to the largest spots within 10 %";
    let coefficient = |name: &str, paper: f64, value: f64, spread: f64, why: &str| {
        let note = format!("{stated}; +- {spread:.4} (1 sigma of 10 recordings){why}");
        Row::of_paper(format!("(13): {name}"), paper, value, Tolerance::Ratio(0.1), note)
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
            "fitted without noise; the nearest of so many noisy ones is a little nearer",
        ),
        Row::of_paper(
            "last spot of 2 px at 1000 us (m)",
            6.62,
            farthest_m(all, |shot| shot.area_px > 1),
            Tolerance::Ratio(0.05),
            "fitted without noise; the farthest of so many noisy ones is a little farther",
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
