//! Panels as figures: each a column of axes, PNG and SVG.

use std::path::Path;

use kuva::plot::scatter::MarkerShape;
use kuva::prelude::{Layout, Plot, ReferenceLine, ScatterPlot};
use kuva::render::figure::Figure as Columns;
use photinus_io::Result;
use photinus_reproduce::{Kind, Mark, Panel, Report, Role, Series};

use crate::plots;
use crate::plots::style::{
    BOUNDS, ESTIMATE, FAINT, FAMILY, INLINE, PERPENDICULAR, TRUTH, WRONG, axes, line, points,
};

/// Size of a panel, px of the SVG.
const SIZE: (f64, f64) = (720.0, 400.0);

/// Draws a report's panels, one below the other, into `folder`.
///
/// # Errors
/// [`photinus_io::Error`] when the figure cannot be drawn or written.
pub(super) fn save(folder: &Path, report: &Report) -> Result<()> {
    let (plots, layouts): (Vec<_>, Vec<_>) = report.panels.iter().map(draw).unzip();
    let figure = Columns::new(report.panels.len(), 1)
        .with_cell_size(SIZE.0, SIZE.1)
        .with_plots(plots)
        .with_layouts(layouts);
    plots::save(folder, &format!("figure-{}", report.figure.name()), &figure.render())
}

fn draw(panel: &Panel) -> (Vec<Plot>, Layout) {
    let plots: Vec<Plot> = panel.series.iter().map(|series| plot(panel, series)).collect();
    let mut layout = axes(&plots, panel.x_label, panel.y_label)
        .with_width(SIZE.0)
        .with_height(SIZE.1)
        .with_title(panel.title)
        .with_title_size(14);
    if let Some([least, most]) = panel.x_range {
        layout = layout.with_x_axis_min(least).with_x_axis_max(most);
    }
    if let Some([least, most]) = panel.y_range {
        layout = layout.with_y_axis_min(least).with_y_axis_max(most);
    }
    if panel.is_log_y {
        layout = layout.with_log_y();
    }
    let layout = panel.marks.iter().fold(layout, |layout, mark| layout.with_reference_line(reference(mark)));
    (plots, layout)
}

fn reference(mark: &Mark) -> ReferenceLine {
    let line =
        if mark.is_upright { ReferenceLine::vertical(mark.at) } else { ReferenceLine::horizontal(mark.at) };
    let colour = mark.member.map_or(FAINT, |member| FAMILY[member % FAMILY.len()]);
    let line = line.with_color(colour);
    if mark.label.is_empty() { line } else { line.with_label(mark.label.clone()) }
}

fn plot(panel: &Panel, series: &Series) -> Plot {
    let (colour, marker) = look(series.role);
    let is_shown = |point: &(f64, f64)| within(panel.x_range, point.0) && within(panel.y_range, point.1);
    let shown: Vec<(f64, f64)> = series.points.iter().copied().filter(is_shown).collect();
    if series.kind == Kind::Points {
        let drawn: ScatterPlot = points(shown, colour, marker, &series.label);
        return drawn.into();
    }
    let drawn = line(shown, colour);
    let drawn = if series.kind == Kind::Dashed { drawn.with_dashed() } else { drawn };
    let is_named = !series.label.is_empty();
    if is_named { drawn.with_legend(series.label.clone()).into() } else { drawn.into() }
}

fn within(range: Option<[f64; 2]>, value: f64) -> bool {
    value.is_finite() && range.is_none_or(|[least, most]| (least..=most).contains(&value))
}

/// Colour and mark of what numbers mean.
fn look(role: Role) -> (&'static str, MarkerShape) {
    match role {
        Role::Truth => (TRUTH, MarkerShape::Circle),
        Role::Own => (ESTIMATE, MarkerShape::Circle),
        Role::Perpendicular => (PERPENDICULAR, MarkerShape::TriangleDown),
        Role::Inline => (INLINE, MarkerShape::Triangle),
        Role::Bound => (BOUNDS, MarkerShape::Circle),
        Role::Printed => (WRONG, MarkerShape::Diamond),
        Role::Member(number) => (FAMILY[number % FAMILY.len()], MarkerShape::Circle),
    }
}
