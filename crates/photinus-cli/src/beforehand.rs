//! What the method is told beforehand: enters the files that the user named, leaves camera, airframe and spot curve; what
//! is odd about the files is told.

use std::path::Path;

use photinus::spots::Brightness;
use photinus_io::airframe::{AirframeFile, read_airframe};
use photinus_io::spot_curve::{SpotCurveFile, read_spot_curve};
use photinus_io::{CameraFile, Result, read_camera};

use crate::terminal::{Terminal, input_name};

/// Exposures that differ by less make spots of the same size.
const SAME_EXPOSURE: f64 = 0.01;

/// Reads a camera file of any format and tells its oddities.
///
/// # Errors
/// As [`read_camera`].
pub(crate) fn camera(path: &Path, terminal: &Terminal) -> Result<CameraFile> {
    let file = read_camera(path)?;
    tell(path, &file.oddities, terminal);
    Ok(file)
}

/// Reads an airframe of either format and tells where reading departed from what the file says.
///
/// # Errors
/// As [`read_airframe`].
pub(crate) fn airframe(path: &Path, terminal: &Terminal) -> Result<AirframeFile> {
    let file = read_airframe(path)?;
    tell(path, &file.notes, terminal);
    Ok(file)
}

/// Reads a spot curve; the word `paper` stands for the paper's.
///
/// # Errors
/// As [`read_spot_curve`].
pub(crate) fn spot_curve(path: &Path) -> Result<SpotCurveFile> {
    match path.as_os_str() == "paper" {
        true => Ok(SpotCurveFile::paper_1000_us()),
        false => read_spot_curve(path),
    }
}

/// How frames are taken and spots found, as far as that is known.
pub(crate) struct Conditions {
    /// The rule of the detector; of another program's it is not known.
    pub(crate) brightness: Option<Brightness>,
    /// Exposure of the frames, us.
    pub(crate) exposure_us: Option<f64>,
}

/// Where a curve was measured under other conditions than it is used with, a sentence each.
pub(crate) fn differences(curve: &SpotCurveFile, now: &Conditions) -> Vec<String> {
    const WRONG: &str = "bounds that come from spot sizes are wrong";
    let mut differences = Vec::new();
    if let (Some(threshold), Some(brightness)) = (curve.threshold, now.brightness)
        && brightness != Brightness::Threshold(threshold)
    {
        differences.push(format!(
            "the spot curve was measured with a threshold of {threshold}: give --threshold {threshold}, or {WRONG}"
        ));
    }
    if let (Some(measured_us), Some(now_us)) = (curve.exposure_us, now.exposure_us)
        && (measured_us - now_us).abs() > SAME_EXPOSURE * now_us
    {
        differences.push(format!(
            "the spot curve was measured with an exposure of {measured_us} us, the frames have {now_us} us: give a \
             curve for that exposure, or {WRONG}"
        ));
    }
    differences
}

fn tell(path: &Path, notes: &[String], terminal: &Terminal) {
    for note in notes {
        terminal.note(format_args!("{}: {note}", input_name(path)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_known_of_both_can_differ() {
        let paper = SpotCurveFile::paper_1000_us();
        let unknown = SpotCurveFile { exposure_us: None, threshold: None, ..paper };
        let now = |brightness, exposure_us| Conditions { brightness, exposure_us };
        let as_measured = now(Some(Brightness::Threshold(200)), Some(1000.0));
        let otherwise = now(Some(Brightness::Contrast(200)), Some(500.0));
        assert!(differences(&paper, &as_measured).is_empty());
        assert!(differences(&paper, &now(None, None)).is_empty());
        assert!(differences(&unknown, &otherwise).is_empty());
        let [threshold, exposure] = &differences(&paper, &otherwise)[..] else { panic!("two differ") };
        assert!(
            threshold.contains("give --threshold 200")
                && exposure.contains("1000 us, the frames have 500 us")
        );
    }
}
