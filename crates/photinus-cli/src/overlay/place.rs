//! Where pictures go: a PNG per frame in a folder, or all of them as a video in colour.

use std::collections::HashSet;
use std::io::Write;
use std::path::{Path, PathBuf};

use photinus_io::kind::is_named_as_image;
use photinus_io::results::FrameRecord;
use photinus_io::video::ColourY4mWriter;
use photinus_io::whole::{Existing, write_whole};
use photinus_io::{Error, Result};
use tiny_skia::Pixmap;

use super::palette::Palette;

/// Where pictures go.
pub(crate) enum Place {
    /// A PNG per frame, named after the photo or by the number of the frame, in a folder that is there.
    Folder { folder: PathBuf, written: HashSet<String> },
    /// A Y4M video, begun with the first picture.
    Video { sink: Option<Box<dyn Write>>, name: PathBuf, writer: Option<ColourY4mWriter<Box<dyn Write>>> },
}

impl Place {
    /// Pictures into `folder`, which is there.
    pub(crate) fn folder(folder: PathBuf) -> Self {
        Self::Folder { folder, written: HashSet::new() }
    }

    /// A video into `sink`; `name` is for the messages.
    pub(crate) fn video(sink: Box<dyn Write>, name: &Path) -> Self {
        Self::Video { sink: Some(sink), name: name.to_owned(), writer: None }
    }

    /// Writes the picture of a frame; `bytes` is a buffer to be used again.
    ///
    /// # Errors
    /// [`Error`] when it cannot be written, or a picture of a video has another size than the first one.
    pub(super) fn write(
        &mut self,
        picture: &Pixmap,
        palette: &Palette,
        record: &FrameRecord,
        bytes: &mut Vec<u8>,
    ) -> Result<()> {
        let size = (picture.width(), picture.height());
        match self {
            Self::Folder { folder, written } => {
                let mut name = file_name(record);
                if !written.insert(name.clone()) {
                    // Photos of different folders may have one name.
                    name = format!(
                        "{}-{:06}.png",
                        name.trim_end_matches(".png"),
                        record.frame.unwrap_or_default()
                    );
                    written.insert(name.clone());
                }
                let path = folder.join(name);
                palette.entries_of(picture.pixels(), bytes);
                let png =
                    png(bytes, palette, size).map_err(|error| Error::format(&path, error.to_string()))?;
                write_whole(&path, &png, Existing::Replace)
            }
            Self::Video { sink, name, writer } => {
                let size = (size.0 as usize, size.1 as usize);
                if let Some(sink) = sink.take() {
                    *writer = Some(ColourY4mWriter::new(sink, &name, size)?);
                }
                writer.as_mut().map_or(Ok(()), |writer| writer.write(picture.data(), size))
            }
        }
    }
}

/// The bytes of a PNG file, packed for speed: pictures are many, and most rows are like the row above.
fn png(
    entries: &[u8],
    palette: &Palette,
    (width, height): (u32, u32),
) -> std::result::Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(palette.bytes());
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Up);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(entries)?;
    writer.finish()?;
    Ok(bytes)
}

/// What the picture of a frame is called: after its image file, else by its number; with the name of its camera, where there
/// are several.
fn file_name(record: &FrameRecord) -> String {
    let camera = record.camera.as_ref().map_or(String::new(), |name| format!("{name}-"));
    let source = Path::new(&record.source);
    match source.file_stem().filter(|_| is_named_as_image(source)) {
        Some(stem) => format!("overlay-{camera}{}.png", stem.to_string_lossy()),
        None => format!("overlay-{camera}{:06}.png", record.frame.unwrap_or_default()),
    }
}

/// What the picture of a frame is called that has no image file and is of the only camera.
pub(crate) fn numbered(frame: u64) -> String {
    format!("overlay-{frame:06}.png")
}
