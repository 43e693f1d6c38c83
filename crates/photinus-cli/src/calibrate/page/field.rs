//! How sure bearings are over the field, and where photos are missing.

use std::sync::Arc;

use kuva::plot::scatter::MarkerShape;
use kuva::prelude::{ColorMap, Heatmap, Plot, TextAnnotation};
use photinus_calibrate::camera::STRIP;

use super::Shown;
use super::image::{arrows, over_image};
use crate::calibrate::report::{CameraReport, MoveReport, RingReport};
use crate::plots::Figure;
use crate::plots::style::{BOUNDS, ESTIMATE, INLINE, PERPENDICULAR, axes, line, points};

/// All figures of the field.
pub(super) fn figures(report: &CameraReport) -> Vec<Shown> {
    let mut figures = Vec::new();
    figures.extend(sigma_map(report));
    figures.push(rings(report));
    figures.extend(halves(report));
    figures.push(coverage(report));
    figures
}

/// Sigma of bearings as a map; cells without an answer stay white.
fn sigma_map(report: &CameraReport) -> Option<Shown> {
    let step =
        report.sigma_map.windows(2).map(|pair| pair[1].u_px - pair[0].u_px).find(|step| *step > 0.0)?;
    let count = |side: usize| (side as f64 / step).ceil() as usize;
    let (columns, rows) = (count(report.width_px), count(report.height_px));
    let mut data = vec![vec![f64::NAN; columns]; rows];
    for cell in &report.sigma_map {
        let place = |at: f64, count: usize| (((at + 0.5) / step) as usize).min(count - 1);
        // The first row of cells is the lowest.
        data[rows - 1 - place(cell.v_px, rows)][place(cell.u_px, columns)] = cell.sigma_mrad;
    }
    let white = |share: f64| if share.is_nan() { "#ffffff".to_owned() } else { ColorMap::Viridis.map(share) };
    let map = Heatmap::new()
        .with_data(data)
        .with_color_map(ColorMap::Custom(Arc::new(white)))
        .with_x_range(-0.5, columns as f64 * step - 0.5)
        .with_y_range(0.5 - rows as f64 * step, 0.5)
        .with_cell_size(1.0)
        .with_legend("sigma (mrad)");
    let plots: Vec<Plot> = vec![map.into()];
    let layout = over_image(&plots, report);
    Some(Shown {
        title: "Sigma of bearings (mrad)",
        caption: format!(
            "Standard deviation of the bearing of a pixel, both axes together, by the camera file; a common turn of all bearings is \
             not in it. White: the camera gives no answer there. LEDs were seen up to {:.0} deg off the axis.",
            report.reach_deg
        ),
        figure: Figure { name: "bearing-sigma".to_owned(), plots, layout },
    })
}

fn rings(report: &CameraReport) -> Shown {
    let along = |value: fn(&RingReport) -> Option<f64>| -> Vec<(f64, f64)> {
        let middle = |ring: &RingReport| 0.5 * (ring.from_deg + ring.to_deg);
        report.bearings.iter().filter_map(|ring| Some((middle(ring), value(ring)?))).collect()
    };
    let kinds = [
        (along(|ring| Some(ring.sigma_mrad)), ESTIMATE, MarkerShape::Circle, "camera file"),
        (along(|ring| ring.bootstrap_mrad), INLINE, MarkerShape::Triangle, "photos drawn with replacement"),
        (
            along(|ring| ring.half_difference_mrad.map(|mrad| 0.5 * mrad)),
            PERPENDICULAR,
            MarkerShape::Square,
            "half the difference of two halves",
        ),
    ];
    let mut plots: Vec<Plot> = Vec::new();
    for (data, colour, marker, name) in kinds.into_iter().filter(|kind| !kind.0.is_empty()) {
        plots.push(line(data.clone(), colour).into());
        plots.push(points(data, colour, marker, name).with_size(4.5).with_marker_opacity(1.0).into());
    }
    let layout = axes(&plots, "angle off the axis (deg)", "sigma of bearings (mrad)").with_y_axis_min(0.0);
    Shown {
        title: "Sigma of bearings off the axis",
        caption: "Three answers to the same question: by the covariance in the camera file, by calibrating from photos drawn with \
                  replacement, and by calibrating from two halves of the photos. They should agree within a factor of two."
            .to_owned(),
        figure: Figure { name: "bearing-sigma-by-angle".to_owned(), plots, layout },
    }
}

/// What the calibrations from two halves of the photos differ by.
fn halves(report: &CameraReport) -> Option<Shown> {
    let moves = &report.half_difference;
    let squares = moves.iter().map(|at| at.move_mrad.iter().map(|part| part * part).sum::<f64>());
    let rms_mrad = (squares.sum::<f64>() / moves.len() as f64).sqrt();
    if moves.is_empty() || !rms_mrad.is_finite() {
        return None;
    }
    let drawn = moves.iter().map(|at| [at.u_px, at.v_px, at.move_mrad[0], at.move_mrad[1]]);
    let (arrows, _) = arrows(drawn, rms_mrad, report.width_px, ESTIMATE);
    let plots: Vec<Plot> = vec![Plot::Quiver(arrows)];
    let layout = over_image(&plots, report);
    // As long as the rms is: all three parts of the turn, of which two are drawn.
    let length = |at: &MoveReport| at.move_mrad.iter().map(|part| part * part).sum::<f64>().sqrt();
    let most_mrad = moves.iter().map(length).fold(0.0, f64::max);
    Some(Shown {
        title: "From one half of the photos to the other",
        caption: format!(
            "How bearings move from the calibration of one half of the photos to that of the other, a common turn taken out: rms \
             {rms_mrad:.2} mrad, at most {most_mrad:.2} mrad. Two independent calibrations differ by about one and a half \
             to two sigmas of one."
        ),
        figure: Figure { name: "halves".to_owned(), plots, layout },
    })
}

fn coverage(report: &CameraReport) -> Shown {
    let (width, height) = (report.width_px as f64, report.height_px as f64);
    let places = report.residuals.iter().map(|residual| (residual.u_px, -residual.v_px)).collect();
    let mut plots: Vec<Plot> = vec![points(places, BOUNDS, MarkerShape::Circle, "LEDs seen").into()];
    for share in [STRIP, 1.0 - STRIP] {
        plots.push(
            line(vec![(share * width, 0.0), (share * width, -height)], "#999999")
                .with_stroke_width(0.7)
                .into(),
        );
        plots.push(
            line(vec![(0.0, -share * height), (width, -share * height)], "#999999")
                .with_stroke_width(0.7)
                .into(),
        );
    }
    let mut layout = over_image(&plots, report);
    let middle = [0.5 * STRIP, 0.5, 1.0 - 0.5 * STRIP];
    for part in &report.coverage {
        let (x, y) = (middle[part.column] * width, -middle[part.row] * height);
        let text = match part.more_wanted {
            0 => part.photos.to_string(),
            more => format!("{}: take {more} more", part.photos),
        };
        layout = layout.with_annotation(TextAnnotation::new(text, x, y).with_font_size(15));
    }
    let thin = report.coverage.iter().filter(|part| part.photos == 1).count();
    let wanted = report.coverage.iter().map(|part| part.more_wanted).sum::<usize>();
    Shown {
        title: "Photos of each part of the image",
        caption: match wanted {
            0 if thin == 0 => "How many photos show the grid in each part of the image. Every part is covered.".to_owned(),
            0 => format!(
                "How many photos show the grid in each part of the image. No part is empty, but {thin} of them have one photo only: \
                 there the calibration rests on little."
            ),
            _ => "How many photos show the grid in each part of the image, and where more should be taken: beyond the outermost LED \
                  the calibration is not known."
                .to_owned(),
        },
        figure: Figure { name: "coverage".to_owned(), plots, layout },
    }
}
