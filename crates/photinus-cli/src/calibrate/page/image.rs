//! Figures over the image: columns to the right, rows downwards, one pixel as wide as high, unless the image is so narrow
//! that the figure would have no end.

use std::sync::Arc;

use kuva::prelude::{Layout, Plot, QuiverPlot, TickFormat};

use crate::calibrate::report::CameraReport;
use crate::plots::style::axes;

/// Height over width of the field of a figure, at least and at most.
const SHAPES: [f64; 2] = [0.2, 3.0];

/// Width of a figure, of which the axes and a colour bar take some.
const WIDTH: f64 = 760.0;

/// Axes of the image; rows grow downwards, so what is drawn at row v stands at height -v.
pub(super) fn over_image(plots: &[Plot], report: &CameraReport) -> Layout {
    let (width, height) = (report.width_px as f64, report.height_px as f64);
    let row = |height: f64| format!("{:.0}", height.abs());
    axes(plots, "column (px)", "row (px)")
        .with_width(WIDTH)
        .with_height(170.0 + WIDTH * 0.82 * shape(width, height))
        .with_x_axis_min(-0.5)
        .with_x_axis_max(width - 0.5)
        .with_y_axis_min(0.5 - height)
        .with_y_axis_max(0.5)
        .with_y_tick_format(TickFormat::Custom(Arc::new(row)))
        .with_show_grid(false)
}

/// How high a figure's field is for one that is 1 wide, drawn over something of this width and height.
pub(super) fn shape(width: f64, height: f64) -> f64 {
    let [flattest, tallest] = SHAPES;
    (height / width).clamp(flattest, tallest)
}

/// Arrows from (column, row) along (columns, rows), so long that one of `typical` length is a thirtieth of the image; and how many
/// times as long that is.
pub(super) fn arrows(
    moves: impl Iterator<Item = [f64; 4]>,
    typical: f64,
    width_px: usize,
    colour: &str,
) -> (QuiverPlot, f64) {
    let times = round_down(width_px as f64 / 30.0 / typical.max(1e-9));
    let drawn = moves.map(|[u, v, du, dv]| (u, -v, times * du, -times * dv));
    let plot = QuiverPlot::new().with_arrows(drawn).with_color(colour).with_shaft_width(0.9);
    (plot.with_head_min_px(2.0).with_head_max_px(5.0), times)
}

/// The round number of one digit below: what a reader can take a length by.
pub(super) fn round_down(number: f64) -> f64 {
    let decade = libm::exp10(libm::floor(libm::log10(number)));
    decade * (number / decade).floor()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_has_a_bound_whatever_the_image() {
        assert_eq!(shape(752.0, 480.0).to_bits(), (480.0_f64 / 752.0).to_bits());
        for (width, height, most) in [(1.0, 32_767.0, 3.0), (32_767.0, 1.0, 0.2), (64.0, 4096.0, 3.0)] {
            assert!((shape(width, height) - most).abs() < 1e-12, "{width}x{height}");
        }
    }

    #[test]
    fn factors_are_round() {
        for (number, round) in [(734.2, 700.0), (9.99, 9.0), (1.0, 1.0), (0.037, 0.03)] {
            assert!((round_down(number) - round).abs() < 1e-12, "{number}");
        }
    }
}
