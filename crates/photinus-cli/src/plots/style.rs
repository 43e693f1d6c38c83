//! How figures look. Colours stay apart for colour-blind eyes (Okabe and Ito 2008); line style or mark tells the same.

use std::sync::Arc;

use kuva::plot::legend::{LegendEntry, LegendShape};
use kuva::plot::scatter::MarkerShape;
use kuva::prelude::{
    BandPlot, Layout, LegendPosition, LinePlot, Plot, ReferenceLine, ScatterPlot, Theme, TickFormat,
};

pub(crate) const TRUTH: &str = "#000000";
pub(crate) const ESTIMATE: &str = "#0072B2";
pub(crate) const BOUNDS: &str = "#56B4E9";
pub(crate) const PERPENDICULAR: &str = "#E69F00";
pub(crate) const INLINE: &str = "#009E73";
pub(crate) const WRONG: &str = "#D55E00";
pub(crate) const FAINT: &str = "#666666";

/// The font of the words, as that of the pages: a browser knows some of these.
const WORDS: &str = "DejaVu Sans, Verdana, Liberation Sans, Arial, sans-serif";

/// Members of a family, in order.
pub(crate) const FAMILY: [&str; 7] = [TRUTH, BOUNDS, WRONG, ESTIMATE, INLINE, PERPENDICULAR, "#CC79A7"];

/// This many points of a kind are drawn at most: more only make the file large.
const MOST_POINTS: usize = 4000;

/// Axes of a figure, with room for the legend below.
pub(crate) fn axes(plots: &[Plot], x_label: &str, y_label: &str) -> Layout {
    Layout::auto_from_plots(plots)
        .with_width(640.0)
        .with_height(400.0)
        .with_theme(Theme::minimal())
        .with_font_family(WORDS)
        .with_tick_font_family(WORDS)
        .with_x_label(x_label)
        .with_y_label(y_label)
        .with_legend_entries(plots.iter().filter_map(entry).collect())
        .with_legend_position(LegendPosition::OutsideBottomColumns)
        .with_legend_box(false)
}

/// What the legend says of a plot: the library leaves out bands.
fn entry(plot: &Plot) -> Option<LegendEntry> {
    let (label, color, shape, dasharray) = match plot {
        Plot::Scatter(points) => {
            (&points.legend_label, &points.color, LegendShape::Marker(points.marker), None)
        }
        Plot::Line(line) => (&line.legend_label, &line.color, LegendShape::Line, line.line_style.dasharray()),
        Plot::Band(band) => (&band.legend_label, &band.color, LegendShape::Rect, None),
        _ => return None,
    };
    Some(LegendEntry { label: label.clone()?, color: color.clone(), shape, dasharray })
}

/// Every n-th, so that no more than a figure can show are left.
pub(crate) fn thinned<T>(points: Vec<T>) -> Vec<T> {
    let step = points.len().div_ceil(MOST_POINTS).max(1);
    points.into_iter().step_by(step).collect()
}

/// Points without a line.
pub(crate) fn points(data: Vec<(f64, f64)>, colour: &str, marker: MarkerShape, legend: &str) -> ScatterPlot {
    ScatterPlot::new()
        .with_data(thinned(data))
        .with_color(colour)
        .with_marker(marker)
        .with_size(2.2)
        .with_marker_opacity(0.55)
        .with_legend(legend)
}

/// A line.
pub(crate) fn line(data: Vec<(f64, f64)>, colour: &str) -> LinePlot {
    LinePlot::new().with_data(data).with_color(colour).with_stroke_width(1.8)
}

/// An area between two lines, of points (x, lower, upper).
pub(crate) fn band(data: &[(f64, f64, f64)], colour: &str) -> BandPlot {
    let column = |of: fn(&(f64, f64, f64)) -> f64| data.iter().map(of).collect::<Vec<f64>>();
    BandPlot::new(column(|point| point.0), column(|point| point.1), column(|point| point.2))
        .with_color(colour)
        .with_opacity(0.3)
}

/// A dashed line across, for what a value should be.
pub(crate) fn level(value: f64) -> ReferenceLine {
    ReferenceLine::horizontal(value).with_color(FAINT)
}

/// Numbers as people write them, 0.1 and not 1e-1.
pub(crate) fn plain() -> TickFormat {
    TickFormat::Custom(Arc::new(|number| format!("{}", (number * 1e6).round() / 1e6)))
}
