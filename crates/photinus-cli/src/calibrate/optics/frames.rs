//! Every frame of the input, and the camera that took them.

use std::path::Path;

use photinus::camera::Camera;
use photinus::frame::Mask;
use photinus_calibrate::optics::Collection;
use photinus_io::mask::read_mask;
use photinus_io::{CameraFile, Error};

use crate::beforehand;
use crate::failure::Failure;
use crate::input::Input;
use crate::interrupt;
use crate::terminal::Terminal;

/// The camera that was named, or that of the first dataset.
pub(super) fn camera(
    inputs: &[Input],
    named: Option<&Path>,
    terminal: &Terminal,
) -> Result<CameraFile, Failure> {
    let mut of_dataset = None;
    for input in inputs {
        if let (Some(dataset), Some(camera), None) = (&input.dataset, input.one_camera()?, &of_dataset) {
            of_dataset = Some(dataset.path(&camera.camera));
        }
    }
    let Some(path) = named.map(Path::to_owned).or(of_dataset) else {
        let advice = "give its calibration with --camera; the optics are written beside it";
        let name = inputs.first().map_or("no input", |input| input.name.as_str());
        return Err(Failure::Input(format!("{name}: which camera took these frames is not known; {advice}")));
    };
    beforehand::camera(&path, terminal).map_err(Failure::input)
}

/// The mask that was named, or that of the dataset.
pub(super) fn mask(
    input: &Input,
    named: Option<&Path>,
    terminal: &Terminal,
) -> Result<Option<Mask>, Failure> {
    let of_dataset = match (&input.dataset, input.one_camera()?) {
        (Some(dataset), Some(camera)) => camera.mask.as_ref().map(|mask| dataset.path(mask)),
        _ => None,
    };
    let Some(path) = named.map(Path::to_owned).or(of_dataset) else { return Ok(None) };
    let file = read_mask(&path).map_err(Failure::input)?;
    file.notes.iter().for_each(|note| terminal.warning(format_args!("{}: {note}", path.display())));
    Ok(Some(file.mask))
}

/// Takes from every frame what tells of optics. A frame that cannot be read is reported and skipped.
pub(super) fn collect(
    input: Input,
    camera: &Camera,
    mask: Option<&Mask>,
    collection: &mut Collection,
    terminal: &mut Terminal,
) -> Result<(), Failure> {
    let (before, mut failed) = (collection.frames(), 0_u64);
    terminal.start(input.count);
    for entry in input.entries {
        if interrupt::is_asked() {
            break;
        }
        let taken = entry.and_then(|entry| {
            let Some(image) = &entry.image else { return Ok(()) };
            let frame = image.view();
            let (width, height) = (camera.width(), camera.height());
            if [frame.width(), frame.height()] != [width, height] {
                let reason = format!(
                    "it has {} x {} px, the camera {width} x {height}",
                    frame.width(),
                    frame.height()
                );
                return Err(
                    Error::format(&entry.record.source, reason).advise("give the camera that took it")
                );
            }
            if let Some(mask) = mask {
                mask.check_size(width, height).map_err(|error| Error::new(&entry.record.source, error))?;
            }
            collection.add(&frame, mask);
            Ok(())
        });
        if let Err(error) = taken {
            failed += 1;
            terminal.error(error);
        }
        terminal.frame_done();
    }
    terminal.finish();
    match collection.frames() - before {
        0 if failed > 0 => Err(Failure::Frames { all: true }),
        0 => Err(Failure::Input(format!("{}: it holds no frame", input.name))),
        _ => Ok(()),
    }
}
