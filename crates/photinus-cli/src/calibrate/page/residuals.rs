//! How far LEDs are from where the calibration expects them.

use kuva::plot::scatter::MarkerShape;
use kuva::prelude::{BarPlot, Heatmap, Histogram, Plot, QuiverPlot, TextAnnotation};

use super::Shown;
use super::image::{arrows, over_image, round_down, shape};
use crate::calibrate::report::{CameraReport, ModelReport};
use crate::plots::Figure;
use crate::plots::style::{BOUNDS, ESTIMATE, INLINE, TRUTH, WRONG, axes, line, plain, points};

/// All figures of residuals.
pub(super) fn figures(report: &CameraReport) -> Vec<Shown> {
    let mut figures = vec![by_photo(report), over_the_image(report), histogram(report), by_led(report)];
    figures.extend(board(report));
    figures.extend(models(report));
    figures
}

fn by_photo(report: &CameraReport) -> Shown {
    let mut bars = BarPlot::new().with_legend(vec!["largest", "mean"]);
    for photo in &report.photos {
        if let (Some(mean_px), Some(max_px)) = (photo.mean_px, photo.max_px) {
            bars = bars.with_group(stem(&photo.name), vec![(max_px, BOUNDS), (mean_px, ESTIMATE)]);
        }
    }
    let plots: Vec<Plot> = vec![bars.into()];
    let layout = kuva::prelude::Layout::auto_from_plots(&plots)
        .with_width(900.0)
        .with_height(380.0)
        .with_theme(kuva::prelude::Theme::minimal())
        .with_y_label("residual (px)")
        .with_x_tick_rotate(-60.0)
        .with_legend_position(kuva::prelude::LegendPosition::OutsideBottomColumns)
        .with_legend_box(false);
    Shown {
        title: "Residuals by photo",
        caption: "Distance between an LED as seen and as expected. A photo that stands out is blurred, or shows the grid very \
                  near."
            .to_owned(),
        figure: Figure { name: "residuals-by-photo".to_owned(), plots, layout },
    }
}

/// The name of a photo without folder and ending.
fn stem(name: &str) -> String {
    let path = std::path::Path::new(name);
    path.file_stem().map_or_else(|| name.to_owned(), |stem| stem.to_string_lossy().into_owned())
}

fn over_the_image(report: &CameraReport) -> Shown {
    let moves = |residual: &crate::calibrate::report::ResidualReport| {
        [residual.u_px, residual.v_px, residual.du_px, residual.dv_px]
    };
    let kept = report.residuals.iter().map(moves);
    let (arrows, times) = arrows(kept, report.rms_px, report.width_px, ESTIMATE);
    let mut plots: Vec<Plot> = vec![Plot::Quiver(arrows)];
    if !report.outliers.is_empty() {
        let places = report.outliers.iter().map(|outlier| (outlier.u_px, -outlier.v_px)).collect();
        plots.push(points(places, WRONG, MarkerShape::Cross, "left out").with_size(4.0).into());
    }
    let layout = over_image(&plots, report);
    Shown {
        title: "Residuals over the image",
        caption: format!(
            "As seen minus as expected, drawn {times} times as long. Arrows that point the same way over a part of the image are \
             what the model cannot follow; arrows that point everywhere are noise."
        ),
        figure: Figure { name: "residuals-over-image".to_owned(), plots, layout },
    }
}

fn histogram(report: &CameraReport) -> Shown {
    const BINS: usize = 48;
    let reach_px = round_down(7.0 * report.sigma_px.max(1e-6));
    let both = report.residuals.iter().flat_map(|residual| [residual.du_px, residual.dv_px]);
    let values: Vec<f64> = both.filter(|value| value.abs() < reach_px).collect();
    let count = 2.0 * report.residuals.len() as f64;
    let normal = (0..=200).map(|step| {
        let value = reach_px * (step as f64 / 100.0 - 1.0);
        let ratio = value / report.sigma_px;
        let height = libm::exp(-0.5 * ratio * ratio) / (report.sigma_px * std::f64::consts::TAU.sqrt());
        (value, height * count * 2.0 * reach_px / BINS as f64)
    });
    let outside = 2 * report.residuals.len() - values.len();
    let bars = Histogram::new()
        .with_data(values)
        .with_bins(BINS)
        .with_range((-reach_px, reach_px))
        .with_color(BOUNDS);
    let normal =
        line(normal.collect(), TRUTH).with_legend(format!("normal, sigma {:.3} px", report.sigma_px));
    let plots: Vec<Plot> = vec![bars.into(), normal.into()];
    let layout = axes(&plots, "residual along an axis (px)", "count");
    Shown {
        title: "Histogram of residuals",
        caption: format!(
            "Both axes together. {outside} lie farther out than {reach_px} px, outside this figure."
        ),
        figure: Figure { name: "residuals-histogram".to_owned(), plots, layout },
    }
}

fn by_led(report: &CameraReport) -> Shown {
    let (columns, rows) = (report.grid_columns, report.grid_rows);
    let value = |row: usize, column: usize| {
        let led = report.leds.iter().find(|led| led.row == row && led.column == column);
        led.map_or(f64::NAN, |led| led.mean_px)
    };
    // The first row of cells is the lowest.
    let data: Vec<Vec<f64>> =
        (0..rows).rev().map(|row| (0..columns).map(|column| value(row, column)).collect()).collect();
    let plots: Vec<Plot> = vec![Heatmap::new().with_data(data).with_legend("mean residual (px)").into()];
    let names = |count: usize| (0..count).map(|number| number.to_string());
    let layout = axes(&plots, "column of the grid", "row of the grid")
        .with_x_categories(names(columns).collect())
        .with_y_categories(names(rows).rev().collect());
    Shown {
        title: "Mean residual by LED (px)",
        caption: "Mean over the photos, on the board. One LED that stands out sits elsewhere than thought, or is partly hidden."
            .to_owned(),
        figure: Figure { name: "residuals-by-led".to_owned(), plots, layout },
    }
}

/// Where the LEDs are off the grid, when that was found.
fn board(report: &CameraReport) -> Option<Shown> {
    let is_solved = report.leds.iter().any(|led| led.offset_mm.iter().any(|offset| offset.abs() > 0.0));
    if !is_solved {
        return None;
    }
    const TIMES: f64 = 20.0;
    let pitch_mm = 1e3 * report.pitch_m;
    let place = |led: &crate::calibrate::report::LedReport| {
        (led.column as f64 * pitch_mm, -(led.row as f64) * pitch_mm)
    };
    let arrow = |led: &crate::calibrate::report::LedReport| {
        let (x, y) = place(led);
        (x, y, TIMES * led.offset_mm[0], -TIMES * led.offset_mm[1])
    };
    let arrows = QuiverPlot::new()
        .with_arrows(report.leds.iter().map(arrow))
        .with_color(ESTIMATE)
        .with_shaft_width(1.4);
    let dots = report.leds.iter().map(place).collect();
    let plots: Vec<Plot> =
        vec![points(dots, TRUTH, MarkerShape::Circle, "on the grid").into(), Plot::Quiver(arrows)];
    let reach = |count: usize| (count as f64 - 0.4) * pitch_mm;
    let down = |height: f64| format!("{:.0}", -height + 0.0);
    let mut layout = axes(&plots, "across the board (mm)", "down the board (mm)")
        .with_width(720.0)
        .with_height(160.0 + 620.0 * shape(report.grid_columns as f64, report.grid_rows as f64))
        .with_x_axis_min(-0.6 * pitch_mm)
        .with_x_axis_max(reach(report.grid_columns))
        .with_y_axis_min(-reach(report.grid_rows))
        .with_y_axis_max(0.6 * pitch_mm)
        .with_y_tick_format(kuva::prelude::TickFormat::Custom(std::sync::Arc::new(down)))
        .with_show_grid(false);
    for led in &report.leds {
        let (x, y) = place(led);
        let text = format!("{:+.2}", led.offset_mm[2]);
        layout = layout.with_annotation(
            TextAnnotation::new(text, x + 0.24 * pitch_mm, y - 0.05 * pitch_mm).with_font_size(10),
        );
    }
    Some(Shown {
        title: "The board as found",
        caption: format!(
            "Where each LED is off the grid, drawn {TIMES} times as long; the number is how far it stands out of the board's plane, \
             mm. The distance between columns over that between rows is {:.5}: 1 if the given pitch agrees with itself. Photos \
             agree on these places with a correlation of {:.2}; noise would give {:.2}.",
            report.pitch_ratio, report.board_agreement, report.board_agreement_by_chance
        ),
        figure: Figure { name: "board".to_owned(), plots, layout },
    })
}

/// Errors of the models over their number of parameters; nothing where only one was tried.
fn models(report: &CameraReport) -> Option<Shown> {
    if report.models.len() < 2 {
        return None;
    }
    let families: [(&str, &str, MarkerShape, &str); 3] = [
        ("equidistant", TRUTH, MarkerShape::Square, "equidistant"),
        ("kannala-brandt", ESTIMATE, MarkerShape::Circle, "Kannala-Brandt"),
        ("ocam", INLINE, MarkerShape::Triangle, "OCamCalib"),
    ];
    let mut plots: Vec<Plot> = Vec::new();
    for (prefix, colour, marker, name) in families {
        let of_family = || report.models.iter().filter(|model| model.model.starts_with(prefix));
        let data = |value: fn(&ModelReport) -> Option<f64>| -> Vec<(f64, f64)> {
            of_family().filter_map(|model| Some((model.parameters as f64, value(model)?))).collect()
        };
        let (fitted, held_out) = (data(|model| Some(model.mean_px)), data(|model| model.held_out_px));
        if !fitted.is_empty() {
            plots.push(line(fitted, colour).with_dashed().into());
        }
        if !held_out.is_empty() {
            plots.push(line(held_out.clone(), colour).into());
            plots.push(points(held_out, colour, marker, name).with_size(5.0).with_marker_opacity(1.0).into());
        }
    }
    let chosen = report.models.iter().find(|model| model.chosen);
    let at =
        chosen.and_then(|model| Some((model.parameters as f64, model.held_out_px.or(Some(model.mean_px))?)));
    if let Some(at) = at {
        plots.push(
            points(vec![at], WRONG, MarkerShape::Cross, "taken")
                .with_size(8.0)
                .with_marker_opacity(1.0)
                .into(),
        );
    }
    let layout =
        axes(&plots, "number of parameters", "mean residual (px)").with_log_y().with_y_tick_format(plain());
    Some(Shown {
        title: "Residuals of the models",
        caption: "Mean residual of photos that were held out (with marks) and of those fitted (without). More parameters always fit \
                  better; the fewest within 5 % of the best on photos held out are taken."
            .to_owned(),
        figure: Figure { name: "models".to_owned(), plots, layout },
    })
}
