//! What was measured, as a figure: sections, widths, background; PNG and SVG.

use std::path::Path;

use kuva::prelude::{Layout, LegendPosition, LinePlot, Plot, Theme};
use kuva::render::figure::Figure;
use photinus_io::{Error, Result};

use crate::measure::Measured;

const SIZE: (f64, f64) = (720.0, 340.0);
const BLACK: &str = "#000000";
const BLUE: &str = "#0072B2";
/// Narrowest and widest spot that is shown, and the width of a class, px.
const WIDTHS_PX: (f64, f64) = (2.0, 8.0);
const CLASS_PX: f64 = 0.25;
/// Grey levels that are shown: those past them are spots.
const BACKGROUND: (usize, usize) = (15, 35);

/// Writes `photo-and-simulated.svg` into `folder`.
pub(crate) fn save(folder: &Path, photo: &Measured, simulated: &Measured) -> Result<()> {
    let panels = [sections(photo, simulated), widths(photo, simulated), backgrounds(photo, simulated)];
    let (plots, layouts): (Vec<_>, Vec<_>) = panels.into_iter().unzip();
    let figure =
        Figure::new(3, 1).with_cell_size(SIZE.0, SIZE.1).with_plots(plots).with_layouts(layouts).render();
    let svg = kuva::backend::svg::SvgBackend::new().render_scene(&figure);
    let path = folder.join("photo-and-simulated.svg");
    std::fs::write(&path, svg).map_err(|error| Error::io(&path, error))
}

fn line(data: Vec<(f64, f64)>, colour: &str, label: &str) -> LinePlot {
    LinePlot::new().with_data(data).with_color(colour).with_stroke_width(1.8).with_legend(label)
}

fn panel(lines: Vec<LinePlot>, [least, most]: [f64; 2], x_label: &str, y_label: &str) -> (Vec<Plot>, Layout) {
    let plots: Vec<Plot> = lines.into_iter().map(Plot::from).collect();
    let layout = Layout::auto_from_plots(&plots)
        .with_width(SIZE.0)
        .with_height(SIZE.1)
        .with_theme(Theme::minimal())
        .with_x_label(x_label)
        .with_y_label(y_label)
        .with_x_axis_min(least)
        .with_x_axis_max(most)
        .with_y_axis_min(0.0)
        .with_legend_position(LegendPosition::InsideTopRight)
        .with_legend_box(false);
    (plots, layout)
}

fn sections(photo: &Measured, simulated: &Measured) -> (Vec<Plot>, Layout) {
    let lines = vec![
        line(photo.along_rows.clone(), BLACK, "photo, along rows"),
        line(photo.along_columns.clone(), BLACK, "photo, along columns").with_dashed(),
        line(simulated.along_rows.clone(), BLUE, "simulated, along rows"),
        line(simulated.along_columns.clone(), BLUE, "simulated, along columns").with_dashed(),
    ];
    panel(lines, [-10.0, 10.0], "from the centre of a spot (px)", "mean grey level")
}

fn widths(photo: &Measured, simulated: &Measured) -> (Vec<Plot>, Layout) {
    let histogram = |measured: &Measured| -> Vec<(f64, f64)> {
        let count = |class: u32| {
            let is_in = |width_px: &&f64| (**width_px / CLASS_PX) as u32 == class;
            measured.widths_px.iter().filter(is_in).count() as f64
        };
        let classes = (WIDTHS_PX.0 / CLASS_PX) as u32..=(WIDTHS_PX.1 / CLASS_PX) as u32;
        classes.map(|class| (CLASS_PX * f64::from(class), count(class))).collect()
    };
    let lines = vec![
        line(histogram(photo), BLACK, "photo").with_step(),
        line(histogram(simulated), BLUE, "simulated").with_step(),
    ];
    panel(lines, [WIDTHS_PX.0, WIDTHS_PX.1], "full width of a spot at half height (px)", "spots")
}

fn backgrounds(photo: &Measured, simulated: &Measured) -> (Vec<Plot>, Layout) {
    let histogram = |measured: &Measured| -> Vec<(f64, f64)> {
        (BACKGROUND.0..=BACKGROUND.1).map(|level| (level as f64, 100.0 * measured.levels[level])).collect()
    };
    let lines = vec![
        line(histogram(photo), BLACK, "photo").with_step(),
        line(histogram(simulated), BLUE, "simulated").with_step(),
    ];
    panel(lines, [BACKGROUND.0 as f64, BACKGROUND.1 as f64], "grey level", "share of pixels (%)")
}
