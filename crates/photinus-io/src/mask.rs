//! Masks: enters an image of the camera's size, leaves the pixels to ignore and what looks odd about them.

use std::path::{Path, PathBuf};

use photinus::frame::{FrameView, Mask};

use crate::image::{ImageFile, read_image};
use crate::{Error, Result};

/// A mask that ignores a larger share of the image is likely the wrong way round.
const MOST_IGNORED: f64 = 0.6;

/// A mask as read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MaskFile {
    /// The pixels to ignore.
    pub mask: Mask,
    /// What is odd about the file, a sentence each.
    pub notes: Vec<String>,
    path: PathBuf,
}

impl MaskFile {
    /// Checks that the mask belongs to frames of this size, px.
    ///
    /// # Errors
    /// [`Error`] when it has another size.
    pub fn check_size(&self, width: usize, height: usize) -> Result<()> {
        self.mask.check_size(width, height).map_err(|error| {
            Error::new(&self.path, error)
                .advise("use the mask of this camera, or draw one on a frame of it; masks are not scaled")
        })
    }
}

/// Reads a mask from any image that Photinus reads: 0 means ignore, anything else look.
///
/// # Errors
/// [`Error`] when the image cannot be read, or when it ignores every pixel.
pub fn read_mask(path: impl AsRef<Path>) -> Result<MaskFile> {
    let path = path.as_ref();
    let ImageFile { image, .. } = read_image(path)?;
    let mask = Mask::from_frame(&image.view());
    let (ignored, all) = (mask.ignored_px(), image.pixels().len());
    if ignored == all {
        return Err(Error::format(path, "the mask ignores every pixel")
            .advise("paint 0 what to ignore and 255 what to look at"));
    }
    Ok(MaskFile { notes: oddities(&image.view(), ignored), mask, path: path.to_owned() })
}

fn oddities(frame: &FrameView<'_>, ignored: usize) -> Vec<String> {
    let between =
        (0..frame.height()).flat_map(|v| frame.row(v)).filter(|&&pixel| pixel != 0 && pixel != 255).count();
    let mut notes = Vec::new();
    if between > 0 {
        notes.push(format!(
            "{between} pixels of the mask are neither 0 nor 255: they are looked at, only 0 is ignored"
        ));
    }
    let all = frame.width() * frame.height();
    if ignored as f64 > MOST_IGNORED * all as f64 {
        notes.push(format!(
            "the mask ignores {:.0} % of the image, where it is 0: if that is what should be looked at, invert it",
            100.0 * ignored as f64 / all as f64
        ));
    }
    if ignored == 0 {
        notes.push("the mask ignores nothing: no pixel of it is 0".to_owned());
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{GreyImage, write_png};
    use crate::scratch::{Folder, files_in};
    use photinus_testing::real_data;

    fn mask(pixels: [u8; 6]) -> Result<MaskFile> {
        let folder = Folder::new(&format!("mask-{pixels:?}"));
        let path = folder.path().join("mask.png");
        write_png(&path, &GreyImage::new(pixels.to_vec(), 3, 2).unwrap().view()).unwrap();
        read_mask(path)
    }

    #[test]
    fn zero_is_ignored_and_the_size_is_checked() {
        let file = mask([0, 255, 255, 255, 255, 0]).unwrap();
        assert_eq!((file.mask.ignored_px(), file.notes.len()), (2, 0));
        assert!(file.mask.ignores(2, 1) && !file.mask.ignores(1, 0));
        file.check_size(3, 2).unwrap();
        let message = file.check_size(752, 480).unwrap_err().to_string();
        assert!(
            message.contains("mask.png: the mask is 3x2, the frame 752x480; use the mask of this camera")
        );
    }

    #[test]
    fn oddities_are_told() {
        assert!(
            mask([0, 1, 254, 255, 0, 0]).unwrap().notes[0].starts_with("2 pixels of the mask are neither")
        );
        assert!(mask([255; 6]).unwrap().notes[0].starts_with("the mask ignores nothing"));
        assert!(mask([0; 6]).unwrap_err().to_string().contains("the mask ignores every pixel; paint 0"));
    }

    #[test]
    fn real_masks_are_read() {
        let Some(masks) = real_data("masks") else { return };
        for path in files_in(&masks) {
            let file = read_mask(&path).unwrap();
            file.check_size(752, 480).unwrap();
            assert!(file.mask.ignored_px() > 1000 && file.notes.is_empty(), "{path:?} {:?}", file.notes);
        }
    }
}
