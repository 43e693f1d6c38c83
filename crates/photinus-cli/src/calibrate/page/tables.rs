//! What is told in words and numbers, as HTML.

use std::fmt::Write;

use crate::calibrate::report::CameraReport;
use crate::page::escaped;

/// What came out, in a few sentences.
pub(super) fn told(report: &CameraReport) -> String {
    let mut told = format!(
        "<p>{} of {} photos of {} x {} px show the grid of {} x {} LEDs, {} mm apart, and fit. The model is <b>{}</b>, the board \
         {}. Over all LEDs used, the distance between seen and expected is <b>{:.4} px</b> in the mean, {:.4} px rms, {:.3} px at \
         most.",
        report.photos_used,
        report.photos_given,
        report.width_px,
        report.height_px,
        report.grid_columns,
        report.grid_rows,
        1e3 * report.pitch_m,
        escaped(&report.model),
        if report.board == "solved" { "was found with it" } else { "was taken as flat" },
        report.mean_px,
        report.rms_px,
        report.max_px
    );
    if let Some(held_out) = &report.held_out {
        let _ = write!(
            told,
            " Photos that were held out give <b>{:.4} px</b> (median of {} halves; worst {:.4} px, {} failed).",
            held_out.median_px,
            2 * held_out.splits,
            held_out.worst_px,
            held_out.failed
        );
    }
    let _ = write!(told, " The camera answers up to {:.1} deg off the axis.", report.field_limit_deg);
    if let Some(mrad) = report.ocam_off_mrad {
        let _ = write!(told, " Written as OCamCalib text it differs by {mrad:.3} mrad at most.");
    }
    told + "</p>"
}

/// What to know or do.
pub(super) fn warnings(report: &CameraReport) -> String {
    let warning = |warning: &String| format!("<p class=\"warning\">{}</p>\n", escaped(warning));
    report.warnings.iter().map(warning).collect()
}

/// The parameters of the camera file.
pub(super) fn parameters(report: &CameraReport) -> String {
    let rows = report.parameters.iter().map(|parameter| {
        let sigma =
            if parameter.sigma > 0.0 { format!("{:.2e}", parameter.sigma) } else { "fixed".to_owned() };
        [escaped(&parameter.name), format!("{:.9}", parameter.value), sigma]
    });
    table(["parameter", "value", "sigma"], rows)
}

/// Every photo.
pub(super) fn photos(report: &CameraReport) -> String {
    let number =
        |value: Option<f64>, digits: usize| value.map_or(String::new(), |value| format!("{value:.digits$}"));
    let rows = report.photos.iter().map(|photo| {
        [
            escaped(file_name(&photo.name)),
            photo.leds.to_string(),
            number(photo.mean_px, 3),
            number(photo.max_px, 3),
            number(photo.distance_m, 2),
            number(photo.off_axis_deg, 0),
            number(photo.tilt_deg, 0),
            photo.reason.as_deref().map_or(String::new(), escaped),
        ]
    });
    table(
        [
            "photo",
            "LEDs",
            "mean (px)",
            "largest (px)",
            "distance (m)",
            "off axis (deg)",
            "tilt (deg)",
            "not used",
        ],
        rows,
    )
}

/// LEDs left out, and why.
pub(super) fn outliers(report: &CameraReport) -> String {
    if report.outliers.is_empty() {
        return "<p>None.</p>".to_owned();
    }
    let rows = report.outliers.iter().map(|outlier| {
        let photo = report.photos.get(outlier.photo).map_or("", |photo| file_name(&photo.name));
        [
            escaped(photo),
            format!("{}, {}", outlier.column, outlier.row),
            format!("{:.1}, {:.1}", outlier.u_px, outlier.v_px),
            outlier.reason.as_deref().map_or(String::new(), escaped),
        ]
    });
    table(["photo", "column, row", "seen at (px)", "why"], rows)
}

/// The name of a photo without its folders, which are the same for all of them.
fn file_name(path: &str) -> &str {
    std::path::Path::new(path).file_name().and_then(|name| name.to_str()).unwrap_or(path)
}

fn table<const N: usize>(heads: [&str; N], rows: impl Iterator<Item = [String; N]>) -> String {
    let head: String = heads.iter().map(|head| format!("<th>{head}</th>")).collect();
    let row = |cells: [String; N]| {
        let cells: String = cells.iter().map(|cell| format!("<td>{cell}</td>")).collect();
        format!("<tr>{cells}</tr>\n")
    };
    format!(
        "<div class=\"wide\"><table>\n<tr>{head}</tr>\n{}</table></div>",
        rows.map(row).collect::<String>()
    )
}
