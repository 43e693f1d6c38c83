//! Panels as figures: each a column of axes, PNG and SVG.

use std::path::Path;

use kuva::plot::LineStyle;
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
    plots::save(folder, &format!("figure-{}", report.figure.name()), &figure.render()).map(drop)
}

/// Dash and gap, px: apart also in print.
const DASHES: &str = "10 6";

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
    if series.kind == Kind::Points {
        let is_shown = |p: &(f64, f64)| within(panel.x_range, p.0) && within(panel.y_range, p.1);
        let shown = series.points.iter().copied().filter(is_shown).collect();
        let drawn: ScatterPlot = points(shown, colour, marker, &series.label);
        return drawn.into();
    }
    let drawn = line(clipped(&series.points, panel.x_range, panel.y_range), colour);
    let dashes = || LineStyle::Custom(DASHES.to_owned());
    let drawn = if series.kind == Kind::Dashed { drawn.with_line_style(dashes()) } else { drawn };
    let is_named = !series.label.is_empty();
    if is_named { drawn.with_legend(series.label.clone()).into() } else { drawn.into() }
}

/// The part of a line that lies within its axes; where it leaves them it ends on the border.
fn clipped(points: &[(f64, f64)], x_range: Option<[f64; 2]>, y_range: Option<[f64; 2]>) -> Vec<(f64, f64)> {
    let is_shown = |point: &(f64, f64)| within(x_range, point.0) && within(y_range, point.1);
    let mut shown = Vec::new();
    for (index, point) in points.iter().enumerate() {
        let neighbour = |other: Option<&(f64, f64)>| other.filter(|other| is_shown(other)).copied();
        if is_shown(point) {
            shown.push(*point);
        } else if let Some(inside) =
            neighbour(points.get(index + 1)).or_else(|| neighbour(points.get(index.wrapping_sub(1))))
        {
            let border = y_range.map_or(point.1, |[least, most]| point.1.clamp(least, most));
            let share = (border - inside.1) / (point.1 - inside.1);
            if within(x_range, point.0) && share.is_finite() {
                shown.push((inside.0 + share * (point.0 - inside.0), border));
            }
        }
    }
    shown
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_ends_on_the_border_of_its_axes() {
        let line = [(0.0, 4.0), (1.0, 0.0), (2.0, 1.0), (3.0, 5.0), (4.0, 9.0)];
        let shown = clipped(&line, Some([0.0, 9.0]), Some([0.0, 2.0]));
        assert_eq!(shown, [(0.5, 2.0), (1.0, 0.0), (2.0, 1.0), (2.25, 2.0)]);
        assert_eq!(clipped(&line, None, None), line);
        assert!(clipped(&[(0.0, f64::NAN), (1.0, f64::INFINITY)], None, Some([0.0, 1.0])).is_empty());
    }
}
