//! A camera: its field of view, its resolution, whether pixels come back from their bearings.

use std::path::Path;

use photinus::camera::{Camera, IdealLaw, Model, Pixel};
use photinus_io::{CameraFile, CameraFormat, Result, read_camera};

use super::{Report, optics};

/// Farther than this a pixel must not come back from its own bearing, px.
const ROUND_TRIP_PX: f64 = 1e-6;

pub(super) fn report(path: &Path) -> Result<Report> {
    let CameraFile { camera, format, oddities, inverse, calibration, optics } = read_camera(path)?;
    let mut report = Report::new("a camera");
    let centre = camera.model().centre();
    report.fact("format", format_name(format));
    report.fact("model", model_name(camera.model()));
    report.fact("image", format!("{} x {} px", camera.width(), camera.height()));
    report.fact("optical centre", format!("column {:.2}, row {:.2}", centre.u, centre.v));
    report.fact("field of view", field_of_view(&camera));
    report.fact("field limit", limit(&camera));
    report.fact("resolution", resolution(&camera));
    if let Some(calibration) = calibration {
        report.fact(
            "calibration",
            format!(
                "{} photos, LEDs within {:.3} px in the mean, {:.2} px at most",
                calibration.photos_used, calibration.mean_px, calibration.max_px
            ),
        );
    }
    if let Some(sigma) = calibration_sigma(&camera) {
        report.fact("calibration sigma", sigma);
    }
    if let Some(measured) = camera.optics() {
        optics::report(measured, optics.as_ref(), &mut report);
    }
    if let Some(inverse) = inverse {
        report.fact(
            "inverse polynomial",
            format!(
                "degree {}, {inverse}, worst {:.0}° off the axis; not used",
                inverse.degree,
                inverse.worst_rad.to_degrees()
            ),
        );
    }
    let (worst_px, answered) = round_trip(&camera);
    report.fact(
        "round trip",
        format!(
            "pixel to bearing to pixel within {worst_px:.0e} px, over {:.0} % of the image",
            100.0 * answered
        ),
    );
    if worst_px > ROUND_TRIP_PX {
        report
            .notes
            .push(format!("a pixel comes back from its bearing {worst_px:.1e} px away: report this file"));
    }
    report.notes.extend(oddities);
    Ok(report)
}

/// How far off bearings may be by the calibration, along a row from the centre outwards.
fn calibration_sigma(camera: &Camera) -> Option<String> {
    camera.parameter_covariance()?;
    let centre = camera.model().centre();
    let outwards: Vec<f64> = (0..camera.width())
        .map(|u| Pixel::new(u as f64, centre.v))
        .filter_map(|pixel| camera.calibration_covariance(pixel))
        .map(|covariance| 1e3 * covariance.trace().sqrt())
        .collect();
    let least = outwards.iter().copied().fold(f64::INFINITY, f64::min);
    let most = outwards.iter().copied().fold(0.0, f64::max);
    Some(format!("{least:.2} mrad at best, {most:.2} mrad at worst along the row of the centre"))
}

/// What the format is called.
pub(crate) fn format_name(format: CameraFormat) -> &'static str {
    match format {
        CameraFormat::OcamText => "OCamCalib text",
        CameraFormat::Toml => "Photinus TOML",
        CameraFormat::UvdarYaml => "UVDAR YAML",
        CameraFormat::Kalibr => "Kalibr YAML",
        CameraFormat::CameraInfo => "ROS CameraInfo YAML",
        CameraFormat::Pyocamcalib => "pyocamcalib JSON",
    }
}

fn model_name(model: &Model) -> String {
    let focal = |[x, y]: [f64; 2]| format!("focal length {x:.2}, {y:.2} px");
    match model {
        Model::OCam(lens) => format!("OCam, direct polynomial of degree {}", lens.direct().len() - 1),
        Model::Ideal(lens) => {
            let law = match lens.law() {
                IdealLaw::Equidistant => "equidistant",
                IdealLaw::Equisolid => "equisolid",
                IdealLaw::Stereographic => "stereographic",
                IdealLaw::Orthographic => "orthographic",
            };
            format!("{law}, {}", focal(lens.focal_px()))
        }
        Model::KannalaBrandt(lens) => format!("Kannala-Brandt, {}", focal(lens.focal_px())),
        Model::Pinhole(lens) => format!("pinhole with distortion, {}", focal(lens.focal_px())),
    }
}

/// Angles across the image, through the optical centre.
fn field_of_view(camera: &Camera) -> String {
    let centre = camera.model().centre();
    let (right, bottom) = (camera.width() as f64 - 0.5, camera.height() as f64 - 0.5);
    let to = |u: f64, v: f64| farthest(camera, Pixel::new(u, v)).1;
    let across = |a: f64, b: f64| format!("{:.1}°", (a + b).to_degrees());
    let horizontal = across(to(-0.5, centre.v), to(right, centre.v));
    let vertical = across(to(centre.u, -0.5), to(centre.u, bottom));
    let corners = [to(-0.5, -0.5), to(right, bottom), to(right, -0.5), to(-0.5, bottom)];
    let diagonal = (corners[0] + corners[1]).max(corners[2] + corners[3]).to_degrees();
    let widest = corners.into_iter().fold(0.0, f64::max).to_degrees();
    format!(
        "horizontal {horizontal}, vertical {vertical}, diagonal {diagonal:.1}°, widest {widest:.1}° off the axis"
    )
}

fn limit(camera: &Camera) -> String {
    match camera.stated_limit_rad() {
        Some(stated_rad) => format!("{:.1}° off the axis, as the file says", stated_rad.to_degrees()),
        None => "none in the file: it ends at the farthest corner of the image".to_owned(),
    }
}

fn resolution(camera: &Camera) -> String {
    let per_px = |pixel: Pixel| {
        camera.rad_per_px(pixel).map_or("unknown".to_owned(), |rad| {
            format!("{:.3} mrad ({:.3}°) per px", 1e3 * rad, rad.to_degrees())
        })
    };
    let corner = Pixel::new(camera.width() as f64 - 0.5, camera.height() as f64 - 0.5);
    let rim = farthest(camera, corner).0;
    format!("{} at the centre, {} at the rim", per_px(camera.model().centre()), per_px(rim))
}

/// The last place before `edge`, from the optical centre, that has a bearing, and its angle off the axis, rad.
fn farthest(camera: &Camera, edge: Pixel) -> (Pixel, f64) {
    let centre = camera.model().centre();
    let at = |t: f64| Pixel::new(centre.u + t * (edge.u - centre.u), centre.v + t * (edge.v - centre.v));
    let angle = |t: f64| camera.bearing(at(t)).map(|bearing| bearing.off_axis_rad());
    let (mut inside, mut outside) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = (inside + outside) / 2.0;
        match angle(middle) {
            Some(_) => inside = middle,
            None => outside = middle,
        }
    }
    (at(inside), angle(inside).unwrap_or(0.0))
}

/// The largest distance between a pixel and what its bearing projects to, px, and the share of pixels with a bearing.
fn round_trip(camera: &Camera) -> (f64, f64) {
    const STEP_PX: usize = 4;
    let (mut worst_px, mut answered, mut all) = (0.0_f64, 0, 0);
    for v in (0..camera.height()).step_by(STEP_PX) {
        for u in (0..camera.width()).step_by(STEP_PX) {
            let pixel = Pixel::new(u as f64, v as f64);
            all += 1;
            let Some(bearing) = camera.bearing(pixel) else { continue };
            answered += 1;
            let off_px = camera.pixel(&bearing).map(|back| libm::hypot(back.u - pixel.u, back.v - pixel.v));
            // At the very edge rounding may put the projection outside.
            worst_px = worst_px.max(off_px.unwrap_or(0.0));
        }
    }
    (worst_px, f64::from(answered) / f64::from(all))
}

#[cfg(test)]
mod tests {
    use photinus::camera::Ideal;

    use super::*;

    #[test]
    fn the_papers_camera_has_the_papers_field() {
        // phi = k r with k = 3.767e-3 rad/px: 752 px across are 162.3 deg.
        let lens = Ideal::new(IdealLaw::Equidistant, [1.0 / 3.767e-3; 2], Pixel::new(375.5, 239.5)).unwrap();
        let camera = Camera::new(Model::Ideal(lens.clone()), 752, 480, None).unwrap();
        assert!(
            field_of_view(&camera)
                .starts_with("horizontal 162.3°, vertical 103.6°, diagonal 192.6°, widest 96.3°")
        );
        let limited = Camera::new(Model::Ideal(lens), 752, 480, Some(1.0)).unwrap();
        assert!(field_of_view(&limited).starts_with("horizontal 114.6°, vertical 103.6°, diagonal 114.6°"));
        let (worst_px, answered) = round_trip(&camera);
        assert!(worst_px < 1e-9 && answered > 0.999, "{worst_px} {answered}");
    }
}
