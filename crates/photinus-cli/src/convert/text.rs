//! Cameras, airframes and results.

use std::path::Path;

use photinus_calibrate::camera::{Export, ExportError, kannala_brandt_of, ocam_of};
use photinus_io::Error;
use photinus_io::airframe::{AirframeFile, Tolerances, layout_text, toml_text};
use photinus_io::camera::{
    CameraFile, CameraYaml, InverseReport, write_calibrated_camera_toml, write_camera_yaml, write_ocam_text,
};
use photinus_io::results::{CsvWriter, read_results};

use crate::beforehand;
use crate::failure::Failure;
use crate::targets::FileTarget;
use crate::terminal::Terminal;

/// An inverse polynomial farther than this from the direct one is worth a warning, px.
const POOR_INVERSE_PX: f64 = 0.1;

pub(super) fn camera_to_ocam(path: &Path, target: &FileTarget, terminal: &Terminal) -> Result<(), Failure> {
    let file = beforehand::camera(path, terminal).map_err(Failure::input)?;
    let export = ocam_of(&file.camera).map_err(|error| no_such_model(path, error))?;
    let mut text = Vec::new();
    let inverse = write_ocam_text(&export.camera, &mut text, target.path()).map_err(Failure::input)?;
    target.write(&text).map_err(Failure::running)?;
    tell_loss(&file, &export, Some(inverse), target.path(), terminal);
    Ok(())
}

pub(super) fn camera_to_kalibr(path: &Path, target: &FileTarget, terminal: &Terminal) -> Result<(), Failure> {
    camera_to_yaml(path, CameraYaml::Kalibr, target, terminal)
}

pub(super) fn camera_to_ros(path: &Path, target: &FileTarget, terminal: &Terminal) -> Result<(), Failure> {
    camera_to_yaml(path, CameraYaml::CameraInfo, target, terminal)
}

pub(super) fn camera_to_uvdar(path: &Path, target: &FileTarget, terminal: &Terminal) -> Result<(), Failure> {
    camera_to_yaml(path, CameraYaml::Uvdar, target, terminal)
}

/// The camera as it is where the format has its model, else the nearest of the widest model that it has.
fn camera_to_yaml(
    path: &Path,
    format: CameraYaml,
    target: &FileTarget,
    terminal: &Terminal,
) -> Result<(), Failure> {
    let file = beforehand::camera(path, terminal).map_err(Failure::input)?;
    let export = match format {
        _ if format.holds(file.camera.model()) => {
            Ok(Export { camera: file.camera.clone(), max_off_rad: 0.0 })
        }
        CameraYaml::Uvdar => ocam_of(&file.camera),
        CameraYaml::Kalibr | CameraYaml::CameraInfo => kannala_brandt_of(&file.camera),
    };
    let export = export.map_err(|error| no_such_model(path, error))?;
    let mut text = Vec::new();
    let inverse =
        write_camera_yaml(&export.camera, format, &mut text, target.path()).map_err(Failure::input)?;
    target.write(&text).map_err(Failure::running)?;
    tell_loss(&file, &export, inverse, target.path(), terminal);
    Ok(())
}

fn no_such_model(path: &Path, error: ExportError) -> Failure {
    Failure::input(Error::format(path, error.to_string()).advise("write it as Photinus TOML"))
}

/// What the new file does not say as the old one did.
fn tell_loss(
    file: &CameraFile,
    export: &Export,
    inverse: Option<InverseReport>,
    out: &Path,
    terminal: &Terminal,
) {
    let out = out.display();
    if export.max_off_rad > 0.0 {
        let off_mrad = 1e3 * export.max_off_rad;
        terminal.note(format_args!(
            "{out}: the model is another one: bearings differ by {off_mrad:.3} mrad at most"
        ));
    }
    if file.camera.parameter_covariance().is_some() {
        terminal.note(format_args!("{out}: the covariance of the calibration is not kept"));
    }
    if file.camera.optics().is_some() {
        terminal.note(format_args!("{out}: the optics are not kept"));
    }
    let Some(InverseReport { degree, max_px, .. }) = inverse else { return };
    let told = format!(
        "{out}: the inverse polynomial is a new one of degree {degree}, within {max_px:.2e} px of the direct one"
    );
    if max_px > POOR_INVERSE_PX {
        terminal.warning(format_args!("{told}; use the direct one where you can"));
    } else {
        terminal.note(told);
    }
}

pub(super) fn camera_to_toml(path: &Path, target: &FileTarget, terminal: &Terminal) -> Result<(), Failure> {
    let out = target.path();
    let file = beforehand::camera(path, terminal).map_err(Failure::input)?;
    let mut text = Vec::new();
    write_calibrated_camera_toml(
        &file.camera,
        file.calibration.as_ref(),
        file.optics.as_ref(),
        &mut text,
        out,
    )
    .map_err(Failure::running)?;
    target.write(&text).map_err(Failure::running)?;
    if file.inverse.is_some() {
        terminal.note(format_args!(
            "{}: the file's inverse polynomial is not kept; Photinus inverts the direct one itself",
            out.display()
        ));
    }
    Ok(())
}

pub(super) fn airframe_to_layout(
    path: &Path,
    target: &FileTarget,
    terminal: &Terminal,
) -> Result<(), Failure> {
    let out = target.path();
    let AirframeFile { airframe, tolerances, .. } =
        beforehand::airframe(path, terminal).map_err(Failure::input)?;
    let text = layout_text(&airframe, out).map_err(Failure::input)?;
    target.write(text.as_bytes()).map_err(Failure::running)?;
    if tolerances != Tolerances::default() || airframe.leds().iter().any(|led| (led.power - 1.0).abs() > 0.0)
    {
        terminal.note(format_args!(
            "{}: powers of LEDs and how well they and the positions are known are not kept; a layout has no place for them",
            out.display()
        ));
    }
    if out.file_stem().is_none_or(|stem| stem.to_string_lossy() != airframe.name()) {
        terminal.note(format_args!(
            "{}: the name `{}` is not kept; a layout is named by its file",
            out.display(),
            airframe.name()
        ));
    }
    let without = airframe.leds().iter().filter(|led| led.signal.is_none()).count();
    if without > 0 {
        terminal.note(format_args!(
            "{}: {without} of {} LEDs have no signal; a layout cannot say so, they get 0",
            out.display(),
            airframe.leds().len()
        ));
    }
    Ok(())
}

pub(super) fn airframe_to_toml(path: &Path, target: &FileTarget, terminal: &Terminal) -> Result<(), Failure> {
    let AirframeFile { airframe, tolerances, .. } =
        beforehand::airframe(path, terminal).map_err(Failure::input)?;
    target.write(toml_text(&airframe, &tolerances).as_bytes()).map_err(Failure::running)
}

pub(super) fn results_to_csv(path: &Path, target: &FileTarget, terminal: &Terminal) -> Result<(), Failure> {
    let out = target.path();
    let records = read_results(path).map_err(Failure::input)?;
    let mut file = target.whole().map_err(Failure::running)?;
    let mut table = CsvWriter::new(&mut file, out).map_err(Failure::running)?;
    let (mut good, mut failed, mut spots, mut rejected, mut empty) = (0_u64, 0_u64, 0, 0, 0);
    for record in records {
        match record {
            Ok(record) => {
                good += 1;
                spots += record.spots.len();
                rejected += record.rejected.len();
                empty += u64::from(record.neighbours.is_empty());
                table.write(&record).map_err(Failure::running)?;
            }
            Err(error) => {
                failed += 1;
                terminal.error(error);
            }
        }
    }
    drop(table);
    file.keep().map_err(Failure::running)?;
    terminal.note(format_args!(
        "{}: a row is a neighbour; {spots} spots, {rejected} rejected ones and {empty} frames without neighbours are not kept",
        out.display()
    ));
    if failed > 0 { Err(Failure::Frames { all: good == 0 }) } else { Ok(()) }
}
