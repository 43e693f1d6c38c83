//! Figure 10: spot area over distance for seven exposures, and how far the LED is found at all.

use super::{EXPOSURES, FAR_M, Shot, farthest_m};
use crate::statistics::slope;
use crate::{Figure, Kind, Panel, Report, Role, Row, Tolerance};

/// Areas past this are not shown: the paper's axis.
const SHOWN_PX: f64 = 100.0;

pub(super) fn report(by_exposure: &[Vec<Shot>]) -> Report {
    let single_px_m: Vec<f64> =
        by_exposure.iter().map(|shots| farthest_m(shots, |shot| shot.area_px > 1)).collect();
    Report {
        figure: Figure::Exposures,
        panels: vec![areas(by_exposure, &single_px_m), ranges(by_exposure)],
        rows: rows(by_exposure, &single_px_m),
    }
}

fn areas(by_exposure: &[Vec<Shot>], single_px_m: &[f64]) -> Panel {
    let title = "Spot area, threshold 200; past the upright lines spots are single pixels";
    let mut panel =
        Panel::new(title, "distance (m)", "spot area (px)").with_ranges([0.0, FAR_M], [0.0, SHOWN_PX]);
    for (member, (shots, (exposure_us, paper_m))) in by_exposure.iter().zip(EXPOSURES).enumerate() {
        let shown = shots
            .iter()
            .filter(|shot| shot.distance_m <= FAR_M && (1.0..=SHOWN_PX).contains(&f64::from(shot.area_px)));
        let points = shown.map(|shot| (shot.distance_m, f64::from(shot.area_px))).collect();
        panel = panel.with(format!("{exposure_us} us"), Kind::Points, Role::Member(member), points);
        let upright = |at: f64| vec![(at, 0.0), (at, 0.92 * SHOWN_PX)];
        if let Some(paper_m) = paper_m {
            panel = panel.with("", Kind::Dashed, Role::Member(member), upright(paper_m));
        }
        if single_px_m[member] < FAR_M {
            panel = panel.with("", Kind::Line, Role::Member(member), upright(single_px_m[member]));
        }
    }
    // The legend tells exposures in order, then lines: those of the first exposure once more.
    let upright = |at: f64| vec![(at, 0.0), (at, 0.92 * SHOWN_PX)];
    let of_paper = EXPOSURES[0].1.map_or(Vec::new(), upright);
    panel.with("upright lines: the paper", Kind::Dashed, Role::Member(0), of_paper).with(
        "upright lines: here",
        Kind::Line,
        Role::Member(0),
        upright(single_px_m[0]),
    )
}

fn ranges(by_exposure: &[Vec<Shot>]) -> Panel {
    let over_exposure = |holds: fn(&Shot) -> bool| -> Vec<(f64, f64)> {
        let ends = by_exposure.iter().zip(EXPOSURES);
        ends.map(|(shots, (exposure_us, _))| (exposure_us / 1000.0, farthest_m(shots, holds))).collect()
    };
    let mut panel = Panel::new("How far the LED is found at best", "exposure (ms)", "distance (m)")
        .with("Photinus, contrast", Kind::Line, Role::Own, over_exposure(|shot| shot.is_found_by_contrast))
        .with("threshold 50", Kind::Dashed, Role::Inline, over_exposure(|shot| shot.is_found_outdoors))
        .with(
            "threshold 200, the paper's",
            Kind::Line,
            Role::Perpendicular,
            over_exposure(|shot| shot.area_px > 0),
        );
    panel.x_range = Some([0.0, 10.0]);
    panel.y_range = Some([0.0, 80.0]);
    panel
}

fn rows(by_exposure: &[Vec<Shot>], single_px_m: &[f64]) -> Vec<Row> {
    let mut rows = Vec::new();
    for ((exposure_us, paper_m), &found_m) in EXPOSURES.into_iter().zip(single_px_m) {
        let quantity = format!("last spot of 2 px at {exposure_us} us (m)");
        rows.push(match paper_m {
            Some(paper_m) => Row::of_paper(quantity, paper_m, found_m, Tolerance::Ratio(0.15),
                "one set of physical parameters for all exposures; the paper's six scatter by 10 % about the square-root law"),
            None => Row::of_paper(quantity, FAR_M, found_m, Tolerance::AtLeast(FAR_M), "not within the paper's 15 m"),
        });
    }
    let in_order = single_px_m.windows(2).all(|two| two[0] < two[1]);
    rows.push(Row::of_paper(
        "single-pixel distances in the order of the exposures (1 yes)",
        1.0,
        f64::from(u8::from(in_order)),
        Tolerance::AtLeast(1.0),
        "longer exposures gather more light",
    ));
    let logarithms: Vec<(f64, f64)> = EXPOSURES[..6]
        .iter()
        .zip(single_px_m)
        .map(|((exposure_us, _), found_m)| (libm::log(*exposure_us), libm::log(*found_m)))
        .collect();
    let paper_slope = {
        let printed = EXPOSURES.iter().filter_map(|(us, m)| Some((libm::log(*us), libm::log((*m)?))));
        slope(&printed.collect::<Vec<_>>())
    };
    rows.push(Row::of_paper(
        "power of the exposure in the single-pixel distance",
        paper_slope,
        slope(&logarithms),
        Tolerance::Ratio(0.1),
        "0.5 by the inverse square; the paper's own six give what stands beside it",
    ));
    let at_1000_us = &by_exposure[3];
    let (own_m, paper_m) = (
        farthest_m(at_1000_us, |shot| shot.is_found_by_contrast),
        farthest_m(at_1000_us, |shot| shot.area_px > 0),
    );
    rows.push(Row::own(
        "farthest LED at 1000 us by contrast over that at threshold 200",
        own_m / paper_m,
        Tolerance::AtLeast(1.5),
        "Photinus' gain: a spot needs 20 levels above its surroundings in place of 200",
    ));
    rows
}
