//! What was learned as a page that opens anywhere: one file, its figures within; each figure also as PNG and SVG beside it.

use std::path::Path;
use std::sync::Arc;

use kuva::plot::scatter::MarkerShape;
use kuva::prelude::{BarPlot, Heatmap, Plot, TickFormat};
use photinus::camera::Pixel;
use photinus::optics::PointSpread;
use photinus_calibrate::optics::Learned;
use photinus_io::Result;

use super::table;
use crate::page::Page;
use crate::plots::style::{BOUNDS, ESTIMATE, INLINE, TRUTH, axes, level, line, plain, points};
use crate::plots::{Figure, FigureFolder};

/// A figure with what there is to see in it.
struct Shown {
    title: &'static str,
    caption: &'static str,
    figure: Figure,
}

/// Writes `index.html` and the figures into `folder`.
///
/// # Errors
/// [`Error`] when something cannot be drawn or written.
pub(super) fn write(folder: &Path, learned: &Learned, size_px: [usize; 2]) -> Result<()> {
    let figures = FigureFolder::new(folder);
    let mut page = Page::new("Optics of a camera").lines(&table::Told(learned).to_string());
    for Shown { title, caption, mut figure } in
        [over_the_image(learned, size_px), by_phase(learned), noise(learned), summits(learned)]
    {
        let name = figure.name.clone();
        figure.layout = figure.layout.with_title(title);
        page = page.svg(&figures.write(figure)?, &name, caption);
    }
    page.write(folder)
}

/// The point spread at nine places of the image, side by side.
fn over_the_image(learned: &Learned, [width, height]: [usize; 2]) -> Shown {
    const PLACES: [f64; 3] = [0.1, 0.5, 0.9];
    const HALF_PX: i32 = 4;
    let steps: Vec<f64> = (-2 * HALF_PX..=2 * HALF_PX).map(|step| 0.5 * f64::from(step)).collect();
    let spread = |x: f64, y: f64| learned.optics.spread.at(Pixel::new(x * width as f64, y * height as f64));
    let line_of = |y: f64, down: f64| -> Vec<f64> {
        let at = |x: f64| steps.iter().map(move |&right| seen(spread(x, y), right, down));
        PLACES.into_iter().flat_map(at).collect()
    };
    // the first row of cells is the lowest
    let rows = PLACES.into_iter().flat_map(|y| steps.iter().map(move |&down| (y, down)));
    let mut data: Vec<Vec<f64>> = rows.map(|(y, down)| line_of(y, down)).collect();
    data.reverse();
    let (tile, side) = (steps.len() as f64, (PLACES.len() * steps.len()) as f64);
    let map = Heatmap::new()
        .with_data(data)
        .with_x_range(0.0, side)
        .with_y_range(0.0, side)
        .with_cell_size(1.0)
        .with_legend("root of the share");
    let plots: Vec<Plot> = vec![map.into()];
    let nameless = || TickFormat::Custom(Arc::new(|_| String::new()));
    let layout = axes(&plots, "left, middle, right of the image", "bottom, middle, top")
        .with_width(640.0)
        .with_height(600.0)
        .with_clamp_axis()
        .with_x_axis_max(side)
        .with_y_axis_max(side)
        .with_x_tick_step(tile)
        .with_y_tick_step(tile)
        .with_x_tick_format(nameless())
        .with_y_tick_format(nameless());
    Shown {
        title: "Point spread over the image",
        caption: "Share of the light that a pixel gets, by how far its centre is from the point, 4 px to every side, at nine \
                  places of the image: its square root, so that faint wings show. Away from the middle it may be longer, wider \
                  or bent to one side.",
        figure: Figure { name: "point-spread".to_owned(), plots, layout },
    }
}

fn seen(spread: &PointSpread, right: f64, down: f64) -> f64 {
    spread.share(right, down).max(0.0).sqrt()
}

fn by_phase(learned: &Learned) -> Shown {
    let data = |values: &[f64]| -> Vec<(f64, f64)> {
        let count = values.len() as f64;
        values.iter().enumerate().map(|(index, value)| ((index as f64 + 0.5) / count, *value)).collect()
    };
    let [columns, rows] = &learned.evidence.phases;
    let plots: Vec<Plot> = vec![
        line(data(columns), ESTIMATE).with_legend("along columns").into(),
        line(data(rows), INLINE).with_dashed().with_legend("along rows").into(),
    ];
    let layout = axes(&plots, "place of the spot within its pixel (px)", "squared residual over variance");
    Shown {
        title: "Residuals by place within a pixel",
        caption: "Pixels within 1.5 px of a spot. 1 where table and noise are right; a wave says that places are uneven or too few.",
        figure: Figure {
            name: "phases".to_owned(),
            plots,
            layout: layout.with_y_axis_min(0.0).with_reference_line(level(1.0)),
        },
    }
}

fn noise(learned: &Learned) -> Shown {
    let sensor = &learned.optics.sensor;
    let shape = learned.optics.spread.shape_error();
    let read = sensor.read_noise_dn.value;
    let expected =
        |light: f64| read * read + 1.0 / 12.0 + sensor.shot.value * light + shape * shape * light * light;
    let seen: Vec<(f64, f64)> =
        learned.evidence.noise.iter().map(|bin| (bin.light_dn, bin.variance_dn2)).collect();
    let last = seen.last().map_or(10.0, |bin| bin.0);
    let curve = (0..=100).map(|step| libm::pow(last.max(1.0), f64::from(step) / 100.0));
    let curve: Vec<(f64, f64)> = curve.map(|light| (light, expected(light))).collect();
    let plots: Vec<Plot> = vec![
        line(curve, ESTIMATE).with_legend("read noise, rounding, shot noise, error of the shape").into(),
        points(seen, TRUTH, MarkerShape::Circle, "what fits leave")
            .with_size(4.0)
            .with_marker_opacity(1.0)
            .into(),
    ];
    let layout = axes(&plots, "light in a pixel (grey levels)", "variance (grey levels squared)");
    let layout = layout.with_log_x().with_log_y().with_x_tick_format(plain()).with_y_tick_format(plain());
    Shown {
        title: "Noise against light",
        caption: "Flat where reading and rounding make the noise, rising with the light where its own does, with its square where \
                  the table of the point spread is wrong.",
        figure: Figure { name: "noise".to_owned(), plots, layout },
    }
}

fn summits(learned: &Learned) -> Shown {
    const BIN: usize = 5;
    let mut bars = BarPlot::new();
    for (index, counts) in learned.evidence.summits.chunks(BIN).enumerate() {
        let count: u32 = counts.iter().sum();
        bars = bars.with_group(format!("{}", index * BIN), vec![(f64::from(count), BOUNDS)]);
    }
    let plots: Vec<Plot> = vec![bars.into()];
    let layout = axes(&plots, "grey level", "spots").with_width(900.0).with_x_tick_rotate(-60.0);
    Shown {
        title: "Brightest pixels of spots",
        caption: "Full pixels pile up at one level; without a pile nothing was full, and where that happens is not known.",
        figure: Figure { name: "summits".to_owned(), plots, layout },
    }
}
