//! What was found: to read, as JSON, and as the file of the curve.

use std::fmt;

use photinus::spots::Brightness;
use photinus_calibrate::spot_size::{Bin, Fit, SpotSize, UNSEEN_PX};
use photinus_io::spot_curve::{SpotCurveFile, text};
use serde_json::{Value, json};

use super::recordings::Recording;

/// This many outliers are listed.
const LISTED: usize = 8;

/// The text for the terminal.
pub(super) struct Told<'a> {
    pub(super) recording: &'a Recording,
    pub(super) found: &'a SpotSize,
    pub(super) brighter_percent: f64,
}

impl fmt::Display for Told<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { recording, found, brighter_percent } = self;
        let spots = recording.samples.iter().filter(|sample| sample.area_px > 0).count();
        writeln!(f, "{}: {spots} spots in {} frames", conditions(recording), recording.samples.len())?;
        writeln!(f, "  distance (m)     frames  unseen   area (px)  min  median    max  bound")?;
        for bin in &found.bins {
            let Bin { from_m, to_m, samples, unseen, min_px, median_px, max_px } = bin;
            let bound = found.curve.max_area_px(from_m.max(found.nearest_m));
            writeln!(
                f,
                "  {from_m:6.2} to {to_m:5.2} {samples:7} {unseen:7}             {min_px:4} {median_px:7} {max_px:6} {bound:6}"
            )?;
        }
        fit(f, "median", &found.median)?;
        fit(f, "envelope", &found.envelope)?;
        writeln!(
            f,
            "  bound     the envelope, {:.1} % by which areas left out of a fit lay above it, {UNSEEN_PX} px for places in a pixel not \
             seen, and {brighter_percent} % of scale for brighter LEDs",
            100.0 * found.margin
        )?;
        writeln!(f, "  above it  {:.2} % of the spots", 100.0 * found.share_above)?;
        if let Some(first_m) = found.first_one_px_m {
            writeln!(f, "  spots of one pixel from {first_m:.2} m on")?;
        }
        if let Some(last_m) = found.last_two_px_m {
            writeln!(f, "  spots of more than one pixel up to {last_m:.2} m")?;
        }
        if !found.outliers.is_empty() {
            let listed: Vec<String> =
                found.outliers.iter().take(LISTED).map(|&i| outlier(recording, i)).collect();
            let more = found.outliers.len().saturating_sub(LISTED);
            let more = if more > 0 { format!(", and {more} more") } else { String::new() };
            writeln!(f, "  not used, far above the median: {}{more}", listed.join(", "))?;
        }
        write!(
            f,
            "  measured from {:.2} m to {:.2} m; nearer than that the bound is not known",
            found.nearest_m, found.farthest_seen_m
        )
    }
}

fn outlier(recording: &Recording, index: usize) -> String {
    let sample = recording.samples[index];
    format!("{} px at {:.2} m", sample.area_px, sample.distance_m)
}

fn fit(f: &mut fmt::Formatter<'_>, name: &str, fit: &Fit) -> fmt::Result {
    let (curve, sigma) = (fit.envelope, fit.sigma);
    writeln!(
        f,
        "  {name:<9} offset {:.2} ± {:.2} px, scale {:.2} ± {:.2} px m^2, shift {:.3} ± {:.3} m",
        curve.offset_px, sigma[0], curve.scale_px_m2, sigma[1], curve.shift_m, sigma[2]
    )
}

/// How it was recorded.
fn conditions(recording: &Recording) -> String {
    let exposure = recording.exposure_us.map(|us| format!("{us} us"));
    let rule = recording.brightness.map(|brightness| match brightness {
        Brightness::Threshold(level) => format!("threshold {level}"),
        Brightness::Contrast(step) => format!("contrast {step}"),
    });
    let known: Vec<String> = exposure.into_iter().chain(rule).collect();
    if known.is_empty() { "exposure not stated".to_owned() } else { known.join(", ") }
}

/// The file that ranging reads.
pub(super) fn curve_file(recording: &Recording, found: &SpotSize, brighter_percent: f64) -> String {
    let threshold = match recording.brightness {
        Some(Brightness::Threshold(level)) => Some(level),
        _ => None,
    };
    let file = SpotCurveFile { curve: found.curve, exposure_us: recording.exposure_us, threshold };
    let [_, scale, _] = found.envelope.sigma;
    format!(
        "# photinus calibrate spot-size: {}, {:.2} m to {:.2} m.\n\
         # Raised by {:.1} % and {UNSEEN_PX} px over the areas measured (scale {:.3} +- {scale:.3} px m^2), and by {brighter_percent} % of \
         scale for brighter LEDs.\n{}",
        conditions(recording),
        found.nearest_m,
        found.farthest_seen_m,
        100.0 * found.margin,
        found.envelope.envelope.scale_px_m2,
        text(&file)
    )
}

/// Every number.
pub(super) fn json(recording: &Recording, found: &SpotSize) -> Value {
    let curve = |fit: &Fit| {
        json!({
            "offset_px": fit.envelope.offset_px, "scale_px_m2": fit.envelope.scale_px_m2, "shift_m": fit.envelope.shift_m,
            "sigma": { "offset_px": fit.sigma[0], "scale_px_m2": fit.sigma[1], "shift_m": fit.sigma[2] },
        })
    };
    let bin = |bin: &Bin| {
        json!({
            "from_m": bin.from_m, "to_m": bin.to_m, "frames": bin.samples, "unseen": bin.unseen,
            "min_px": bin.min_px, "median_px": bin.median_px, "max_px": bin.max_px,
        })
    };
    let upper = found.curve.upper();
    json!({
        "exposure_us": recording.exposure_us,
        "frames": recording.samples.len(),
        "curve": { "offset_px": upper.offset_px, "scale_px_m2": upper.scale_px_m2, "shift_m": upper.shift_m },
        "envelope": curve(&found.envelope),
        "median": curve(&found.median),
        "margin": found.margin,
        "share_above": found.share_above,
        "outliers": found.outliers,
        "first_one_px_m": found.first_one_px_m,
        "last_two_px_m": found.last_two_px_m,
        "nearest_m": found.nearest_m,
        "farthest_seen_m": found.farthest_seen_m,
        "bins": found.bins.iter().map(bin).collect::<Vec<_>>(),
    })
}
