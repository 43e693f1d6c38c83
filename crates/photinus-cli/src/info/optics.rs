//! The optics of a camera: what was measured, and what was not.

use photinus::optics::{Measured, Optics, SourceSize, SpreadField};
use photinus_io::camera::OpticsSummary;

use super::Report;
use crate::calibrate::Width;

pub(super) fn report(optics: &Optics, summary: Option<&OpticsSummary>, report: &mut Report) {
    let sensor = &optics.sensor;
    let error = 100.0 * optics.spread.shape_error();
    let beside = known_beside_summit(&optics.spread);
    let known = format!("known to {error:.2} % of a pixel's light, beside its summit {beside}");
    report.fact("point spread", format!("{}, {known}", widths(optics)));
    let place_px = optics.spread.place_error_px();
    if place_px > 0.0 {
        report.fact("places", format!("{place_px:.4} px off, depending on where in a pixel a spot is"));
    }
    report.fact("sources", sources(optics.spread.source_size()));
    let plain = |measured: Measured| format!("{:.4} ± {:.4}", measured.value, measured.sigma);
    let levels = |measured: Measured| format!("{:.2} ± {:.2} grey levels", measured.value, measured.sigma);
    report.fact("read noise", levels(sensor.read_noise_dn));
    report.fact("shot noise", format!("{} grey levels^2 per grey level", plain(sensor.shot)));
    if let Some(dark) = sensor.dark_dn {
        report.fact("darkness", levels(dark));
    }
    let saturation = &sensor.saturation;
    report.fact(
        "full pixels read",
        format!("{:.1}, spread {:.1} grey levels", saturation.level_dn, saturation.spread_dn),
    );
    report.fact("spill of excess", plain(sensor.spill));
    if let Some(well) = sensor.full_well_dn {
        report.fact("full well", levels(well));
    }
    if let Some(smear) = sensor.column_smear {
        report.fact("column smear", format!("{:.1e} ± {:.1e}", smear.value, smear.sigma));
    }
    if let Some(vignetting) = &optics.vignetting {
        let (angles_rad, shares, _) = vignetting.table();
        if let (Some(rad), Some(share)) = (angles_rad.last(), shares.last()) {
            let deg = rad.to_degrees();
            report.fact("vignetting", format!("{:.0} % of the light passes at {deg:.0}°", 100.0 * share));
        }
    }
    if let Some(response) = &sensor.response {
        let Measured { value, sigma } = response.missing_share(200.0);
        let shape = if response.is_bent() { "bent" } else { "straight" };
        let missing = format!("{:.2} ± {:.2} % less than in proportion at 200", 100.0 * value, 100.0 * sigma);
        report.fact("response", format!("{shape}: {missing}"));
    }
    let hot = optics.hot_pixels.iter();
    if hot.len() > 0 {
        let (count, brightest) = (hot.len(), hot.map(|hot| hot.level_dn.value).fold(0.0, f64::max));
        report.fact("hot pixels", format!("{count}, up to {brightest:.0} grey levels"));
    }
    let Some(summary) = summary else { return };
    if summary.spots > 0 {
        report.fact("optics rest on", format!("{} spots of {} frames", summary.spots, summary.frames));
    }
    if !summary.unseen.is_empty() {
        report.fact("unseen", format!("{}: believed, not measured", summary.unseen.join(", ")));
    }
}

/// How wide sources are.
pub(crate) fn sources(size: &SourceSize) -> String {
    let SourceSize { light_dn, growth_px2: Measured { value, sigma }, scatter_px2 } = size;
    let (value, sigma, scatter) = (1e3 * value, 1e3 * sigma, 1e3 * scatter_px2);
    format!(
        "wider by {value:.1} ± {sigma:.1}e-3 px^2 with every {light_dn:.0} grey levels of light, scatter {scatter:.1}e-3"
    )
}

/// How well a point spread is known where all of a saturated spot that can be seen lies.
pub(crate) fn known_beside_summit(spread: &SpreadField) -> String {
    let (wings, below) = (100.0 * spread.wings_error(), 100.0 * spread.unknown_below());
    let faint =
        if below > 0.0 { format!(", not at all below {below:.1e} % of the light") } else { String::new() };
    format!("to {wings:.1} %{faint}")
}

/// Widths of the point spread over the image.
fn widths(optics: &Optics) -> String {
    let mut widths: Vec<Width> = optics.spread.zones().iter().map(Width::of).collect();
    widths.sort_by(|a, b| a.rms_px.total_cmp(&b.rms_px));
    match widths.as_slice() {
        [only] => format!("{only}"),
        [least, .., most] => format!("{least} at best, {most} at worst"),
        [] => String::new(),
    }
}
