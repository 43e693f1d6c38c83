//! What the user may choose about spots, the same for every command that finds them.

use std::path::PathBuf;

use photinus::frame::Mask;
use photinus::spots::{Brightness, Settings, Shape};
use photinus_io::dataset::DatasetCamera;
use photinus_io::mask::{MaskFile, read_mask};

use crate::failure::Failure;
use crate::input::Input;
use crate::number;
use crate::terminal::Terminal;

/// What is bright, and where not to look.
#[derive(Debug, clap::Args)]
pub(crate) struct SpotArgs {
    /// A pixel is bright if it is N grey levels above the background around it [default: 20]
    #[arg(long, value_name = "N", value_parser = number::level, conflicts_with = "threshold")]
    contrast: Option<u8>,
    /// A pixel is bright from grey level N on; the paper's rule is 200
    #[arg(long, value_name = "N", value_parser = number::level)]
    threshold: Option<u8>,
    /// A spot with less than this share of the brightest spot's light is more likely its reflection than a marker; with 0 nothing reflects
    #[arg(long, value_name = "SHARE", default_value_t = Shape::default().reflection_ratio, value_parser = share, alias = "faintest")]
    reflection_ratio: f64,
    /// A mask: an image of the frames' size whose pixels are 0 where nothing is looked for [default: that of the dataset, if any]
    #[arg(long, value_name = "FILE")]
    mask: Option<PathBuf>,
}

impl SpotArgs {
    /// The mask that was named.
    pub(crate) fn file(&self) -> Option<PathBuf> {
        self.mask.clone()
    }

    /// The settings of the detector.
    pub(crate) fn settings(&self) -> Settings {
        let mut settings = Settings::default();
        settings.brightness = match (self.threshold, self.contrast) {
            (Some(level), _) => Brightness::Threshold(level),
            (None, Some(step)) => Brightness::Contrast(step),
            (None, None) => Brightness::default(),
        };
        settings.shape.reflection_ratio = self.reflection_ratio;
        settings
    }

    /// The masks of an input's cameras: the one that was named, or those of the dataset.
    ///
    /// # Errors
    /// [`Failure`] when a mask cannot be read, or one is named for several cameras.
    pub(crate) fn masks(&self, input: &Input, terminal: &Terminal) -> Result<Vec<Option<MaskFile>>, Failure> {
        let Some(dataset) = &input.dataset else { return Ok(vec![self.mask(None, terminal)?]) };
        if self.mask.is_some() {
            input.one_camera()?;
        }
        let of = |camera: &DatasetCamera| camera.mask.as_ref().map(|named| dataset.path(named));
        input.cameras.iter().map(|camera| self.mask(of(camera), terminal)).collect()
    }

    /// The mask that was named, or that of the dataset.
    pub(crate) fn mask(
        &self,
        of_dataset: Option<PathBuf>,
        terminal: &Terminal,
    ) -> Result<Option<MaskFile>, Failure> {
        let Some(path) = self.mask.clone().or(of_dataset) else { return Ok(None) };
        let file = read_mask(&path).map_err(Failure::input)?;
        for note in &file.notes {
            terminal.warning(format_args!("{}: {note}", path.display()));
        }
        Ok(Some(file))
    }
}

/// The mask of a file, where there is one.
pub(crate) fn mask_of(file: Option<&MaskFile>) -> Option<&Mask> {
    file.map(|file| &file.mask)
}

fn share(text: &str) -> Result<f64, String> {
    number::within(text, 0.0..=1.0, "a share")
}
