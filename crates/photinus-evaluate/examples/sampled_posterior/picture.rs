//! Samples as dots in the horizontal plane, modes as ellipses of two standard deviations, truth as a cross.

use std::f64::consts::TAU;
use std::path::Path;

use kuva::plot::scatter::MarkerShape;
use kuva::prelude::{Layout, LegendPosition, LinePlot, Plot, ScatterPlot, Theme};
use kuva::render::figure::Figure;
use nalgebra::{Matrix2x3, Vector2};
use photinus_io::{Error, Result};

use crate::compare::Part;
use crate::experiment::{Experiment, Plane};

const SIZE: (f64, f64) = (480.0, 360.0);
/// So many samples are drawn.
const DOTS: usize = 2500;
/// Modes with less weight are not drawn.
const LIGHT: f64 = 0.005;

/// Writes a picture (SVG) with a panel per experiment, two in a row.
pub(crate) fn draw(file: &Path, experiments: &[(String, Experiment)]) -> Result<()> {
    let panels = experiments.iter().map(|(title, experiment)| panel(title, experiment));
    let (plots, layouts): (Vec<_>, Vec<_>) = panels.unzip();
    let figure = Figure::new(experiments.len().div_ceil(2), 2)
        .with_cell_size(SIZE.0, SIZE.1)
        .with_plots(plots)
        .with_layouts(layouts)
        .render();
    let svg = kuva::backend::svg::SvgBackend::new().render_scene(&figure);
    std::fs::write(file, svg).map_err(|error| Error::io(file, error))
}

fn panel(title: &str, experiment: &Experiment) -> (Vec<Plot>, Layout) {
    let Plane { ahead, across } = experiment.plane();
    let flat = Matrix2x3::from_rows(&[ahead.transpose(), across.transpose()]);
    let place = |part: &Part| (ahead.dot(&part.mean_m), across.dot(&part.mean_m));
    let step = experiment.samples.len().div_ceil(DOTS);
    let dots = experiment.samples.iter().step_by(step).map(place).collect();
    let mut plots: Vec<Plot> = vec![scatter(dots, "#999999", MarkerShape::Circle, 1.5, "samples").into()];
    for (number, mode) in experiment.modes.iter().filter(|mode| mode.weight > LIGHT).enumerate() {
        let line = LinePlot::new()
            .with_data(ellipse(&flat, mode))
            .with_color("#0072B2")
            .with_stroke_width(0.6 + 4.0 * mode.weight);
        plots.push(if number == 0 { line.with_legend("modes").into() } else { line.into() });
    }
    let truth = (ahead.dot(&experiment.truth_m), across.dot(&experiment.truth_m));
    plots.push(scatter(vec![truth], "#D55E00", MarkerShape::Cross, 8.0, "truth").into());
    let layout = Layout::auto_from_plots(&plots)
        .with_width(SIZE.0)
        .with_height(SIZE.1)
        .with_theme(Theme::minimal())
        .with_title(title)
        .with_title_size(14)
        .with_x_label("along the line of sight (m)")
        .with_y_label("across, to the right (m)")
        .with_legend_position(LegendPosition::OutsideBottomColumns)
        .with_legend_box(false);
    (plots, layout)
}

/// Two standard deviations around a mode, where the plane cuts through.
fn ellipse(flat: &Matrix2x3<f64>, mode: &Part) -> Vec<(f64, f64)> {
    let spread = (flat * mode.covariance_m2 * flat.transpose()).symmetric_eigen();
    let sigmas_m = spread.eigenvalues.map(|value| 2.0 * value.max(0.0).sqrt());
    let on = |point: i32| {
        let (sin, cos) = libm::sincos(TAU * f64::from(point) / 48.0);
        let off_m = spread.eigenvectors * Vector2::new(sigmas_m.x * cos, sigmas_m.y * sin);
        let place_m = flat * mode.mean_m + off_m;
        (place_m.x, place_m.y)
    };
    (0..=48).map(on).collect()
}

fn scatter(data: Vec<(f64, f64)>, colour: &str, marker: MarkerShape, size: f64, legend: &str) -> ScatterPlot {
    ScatterPlot::new()
        .with_data(data)
        .with_color(colour)
        .with_marker(marker)
        .with_size(size)
        .with_legend(legend)
}
