//! The report as lines to read.

use super::report::CameraReport;
use crate::failure::Failure;
use crate::terminal::Terminal;

/// Prints what a person wants to know first.
pub(super) fn print(report: &CameraReport, terminal: &Terminal) -> Result<(), Failure> {
    photos(report, terminal)?;
    let say = |text: std::fmt::Arguments<'_>| terminal.result(text);
    say(format_args!(""))?;
    for model in &report.models {
        let held_out = model.held_out_px.map_or_else(|| "     -".to_owned(), |px| format!("{px:6.4}"));
        let chosen = if model.chosen { "  taken" } else { "" };
        say(format_args!(
            "model {:<17} {:>2} numbers  mean {:6.4} px  held out {held_out} px{chosen}",
            model.model, model.parameters, model.mean_px
        ))?;
    }
    say(format_args!(""))?;
    for parameter in &report.parameters {
        say(format_args!(
            "{:<22} {:>16.8e}  sigma {:.1e}",
            parameter.name, parameter.value, parameter.sigma
        ))?;
    }
    say(format_args!(""))?;
    say(format_args!("off the axis   bearing sigma   bootstrap   halves differ by"))?;
    let mrad = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |mrad| format!("{mrad:.2} mrad"));
    for ring in &report.bearings {
        say(format_args!(
            "{:>3.0} to {:>3.0} deg  {:>13}   {:>9}   {:>16}",
            ring.from_deg,
            ring.to_deg,
            mrad(Some(ring.sigma_mrad)),
            mrad(ring.bootstrap_mrad),
            mrad(ring.half_difference_mrad)
        ))?;
    }
    say(format_args!(""))?;
    if let Some(held_out) = &report.held_out {
        say(format_args!(
            "held out: {:.4} px in the mean (median of {} halves), worst {:.4} px, {} failed",
            held_out.median_px,
            2 * held_out.splits,
            held_out.worst_px,
            held_out.failed
        ))?;
    }
    say(format_args!(
        "{} of {} photos used, board {}: mean {:.4} px, rms {:.4} px, largest {:.3} px; {} spots left out",
        report.photos_used,
        report.photos_given,
        report.board,
        report.mean_px,
        report.rms_px,
        report.max_px,
        report.outliers.len()
    ))
}

fn photos(report: &CameraReport, terminal: &Terminal) -> Result<(), Failure> {
    for photo in &report.photos {
        let name = photo.name.rsplit('/').next().unwrap_or(&photo.name);
        match (photo.mean_px, photo.distance_m, photo.off_axis_deg, photo.tilt_deg) {
            (Some(mean_px), Some(distance_m), Some(off_axis_deg), Some(tilt_deg)) => terminal.result(format_args!(
                "{name:<28} {:>4} LEDs  mean {mean_px:.3} px  {distance_m:5.2} m  {off_axis_deg:4.0} deg off the axis  tilted {tilt_deg:3.0} deg",
                photo.leds
            ))?,
            _ => terminal.result(format_args!("{name:<28} not used: {}", photo.reason.as_deref().unwrap_or("")))?,
        }
    }
    Ok(())
}
