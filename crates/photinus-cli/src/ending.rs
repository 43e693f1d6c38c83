//! What the name of an output says about it: enters a path and what will be written there, leaves why they do not agree.
//!
//! An ending that nobody else claims says nothing, and no ending says nothing either.

use std::path::Path;

/// What is written to a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Content {
    /// A line of JSON per frame.
    JsonLines,
    /// A table.
    Csv,
    /// One JSON value.
    Json,
    /// A camera, an airframe, a curve, a mounting.
    Toml,
    /// A camera as OCamCalib text.
    OcamText,
    /// An airframe as LED layout text.
    Layout,
    /// A camera in a YAML format.
    Yaml,
    /// A book of blink words.
    Codes,
    /// A video.
    Y4m,
    /// An MCAP recording.
    Recording,
    /// A mask.
    Png,
    /// A folder of files.
    Folder,
}

/// Endings that say what a file is.
const CLAIMED: [&str; 27] = [
    "mcap", "y4m", "mp4", "mov", "mkv", "avi", "webm", "gif", "png", "apng", "jpg", "jpeg", "bmp", "tif",
    "tiff", "pgm", "ppm", "svg", "html", "pdf", "csv", "json", "jsonl", "toml", "yaml", "yml", "txt",
];

impl Content {
    /// Why a name does not fit, and what to do; `None` where it fits.
    pub(crate) fn disagreement(self, path: &Path) -> Option<(String, String)> {
        let ending = path.extension()?.to_str()?.to_lowercase();
        if !CLAIMED.contains(&ending.as_str()) || self.endings().contains(&ending.as_str()) {
            return None;
        }
        let advice = match self.endings() {
            [] if ["mp4", "mov", "mkv", "avi", "webm"].contains(&ending.as_str()) => {
                "name a folder, without that ending; where a video can be written, it ends in .y4m".to_owned()
            }
            [] => "name a folder, without that ending".to_owned(),
            [ending, ..] => format!("end it in .{ending}"),
        };
        Some((format!("its name ends in .{ending}, but {} is written there", self.what()), advice))
    }

    /// The endings of such a file, the usual one first; none of a folder.
    fn endings(self) -> &'static [&'static str] {
        match self {
            Self::JsonLines => &["jsonl", "json", "txt"],
            Self::Csv => &["csv", "txt"],
            Self::Json => &["json", "txt"],
            Self::Toml => &["toml"],
            Self::Yaml => &["yaml", "yml"],
            Self::OcamText | Self::Layout | Self::Codes => &["txt"],
            Self::Y4m => &["y4m"],
            Self::Recording => &["mcap"],
            Self::Png => &["png"],
            Self::Folder => &[],
        }
    }

    fn what(self) -> &'static str {
        match self {
            Self::JsonLines => "a file of JSON lines",
            Self::Csv => "a CSV table",
            Self::Json => "a JSON file",
            Self::Toml => "a TOML file",
            Self::Yaml => "a YAML file",
            Self::OcamText => "OCamCalib text",
            Self::Layout => "an LED layout",
            Self::Codes => "a book of blink words",
            Self::Y4m => "a Y4M video",
            Self::Recording => "an MCAP recording",
            Self::Png => "a PNG image",
            Self::Folder => "a folder",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_may_say_nothing_but_nothing_wrong() {
        let told = |content: Content, path: &str| content.disagreement(Path::new(path));
        for (content, path) in [
            (Content::JsonLines, "r.jsonl"),
            (Content::JsonLines, "r"),
            (Content::JsonLines, "r.part"),
            (Content::Toml, "a.b/camera.TOML"),
            (Content::Folder, "rec.2026"),
        ] {
            assert_eq!(told(content, path), None, "{path}");
        }
        let (reason, advice) = told(Content::Toml, "x.txt").unwrap();
        assert_eq!(reason, "its name ends in .txt, but a TOML file is written there");
        assert_eq!(advice, "end it in .toml");
        let (reason, advice) = told(Content::Folder, "rec.mp4").unwrap();
        assert_eq!(reason, "its name ends in .mp4, but a folder is written there");
        assert!(advice.starts_with("name a folder, without that ending; where a video"), "{advice}");
    }
}
