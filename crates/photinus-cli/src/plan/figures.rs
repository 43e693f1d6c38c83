//! Figures of a plan.

use kuva::plot::LineStyle;
use kuva::prelude::{LinePlot, Plot};
use photinus_plan::{AtAspect, AtRange, Plan};

use crate::plots::Figure;
use crate::plots::style::{BOUNDS, ESTIMATE, INLINE, PERPENDICULAR, WRONG, axes, level, line, plain};

/// A figure and what there is to see in it.
pub(super) struct Drawn {
    pub(super) figure: Figure,
    pub(super) caption: &'static str,
}

/// Dash and gap, px: apart also in print.
const DASHES: &str = "10 6";

/// All figures.
pub(super) fn all(plan: &Plan) -> Vec<Drawn> {
    vec![found(plan), distance_error(plan), bearing_error(plan), aspects(plan)]
}

fn over(plan: &Plan, value: impl Fn(&AtRange) -> Option<f64>) -> Vec<(f64, f64)> {
    plan.over_distance.iter().filter_map(|at| Some((at.distance_m, value(at)?))).collect()
}

fn named(data: Vec<(f64, f64)>, colour: &str, legend: &str) -> LinePlot {
    line(data, colour).with_legend(legend)
}

fn dashed(plot: LinePlot) -> LinePlot {
    plot.with_line_style(LineStyle::Custom(DASHES.to_owned()))
}

const DISTANCE: &str = "distance (m)";

fn found(plan: &Plan) -> Drawn {
    let one = named(over(plan, |at| Some(100.0 * at.one)), BOUNDS, "one spot or more: a direction");
    let two = named(over(plan, |at| Some(100.0 * at.two)), ESTIMATE, "two or more: a distance");
    let plots: Vec<Plot> = vec![dashed(one).into(), two.into()];
    let layout = axes(&plots, DISTANCE, "share of frames (%)")
        .with_y_axis_min(0.0)
        .with_y_axis_max(105.0)
        .with_reference_line(level(50.0));
    Drawn {
        figure: Figure { name: "found".to_owned(), plots, layout },
        caption: "How often frames show spots, over all headings. Near by, markers may leave the image.",
    }
}

fn distance_error(plan: &Plan) -> Drawn {
    let half = named(over(plan, |at| at.distance_error_m), ESTIMATE, "half of the errors are below");
    let rms = named(over(plan, |at| at.distance_rms_m), WRONG, "root mean square");
    let plots: Vec<Plot> = vec![half.into(), dashed(rms).into()];
    let layout =
        axes(&plots, DISTANCE, "least error of distance (m)").with_log_y().with_y_tick_format(plain());
    Drawn {
        figure: Figure { name: "distance-error".to_owned(), plots, layout },
        caption: "The least error of distance that light, pixels and what is believed of airframes allow. Where the two part, a few \
                  headings are far worse than the others.",
    }
}

fn bearing_error(plan: &Plan) -> Drawn {
    let rms = named(over(plan, |at| at.bearing_rms_rad.map(|rad| 1e3 * rad)), ESTIMATE, "bearing, per axis");
    let plots: Vec<Plot> = vec![rms.into()];
    let layout = axes(&plots, DISTANCE, "least error of bearing (mrad)").with_y_axis_min(0.0);
    Drawn {
        figure: Figure { name: "bearing-error".to_owned(), plots, layout },
        caption: "The least error of the direction towards the airframe's origin.",
    }
}

fn aspects(plan: &Plan) -> Drawn {
    let colours = [INLINE, ESTIMATE, PERPENDICULAR];
    let curve = |((distance_m, aspects), colour): (&(f64, Vec<AtAspect>), &&str)| {
        let point = |at: &AtAspect| Some((at.yaw_rad.to_degrees(), 100.0 * at.distance_m? / distance_m));
        named(aspects.iter().filter_map(point).collect(), colour, &format!("at {distance_m:.1} m")).into()
    };
    let plots: Vec<Plot> = plan.over_aspect.iter().zip(&colours).map(curve).collect();
    let layout = axes(&plots, "heading (deg), over one turn of the symmetry", "sigma of distance (%)")
        .with_log_y()
        .with_y_tick_format(plain());
    Drawn {
        figure: Figure { name: "aspects".to_owned(), plots, layout },
        caption: "The least error of distance over the heading of a neighbour that is level and straight ahead, at a quarter, a half and \
                  three quarters of the range. A gap is a heading at which fewer than two spots are found.",
    }
}
