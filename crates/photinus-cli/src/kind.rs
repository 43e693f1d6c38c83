//! What kind of file a path names: told by the content, never by the name.

use std::io::Read;
use std::path::Path;

use photinus_io::whole::open_regular;
use photinus_io::{Error, Result};

/// As much of a file as tells what it is.
const HEAD_BYTES: u64 = 64 << 10;

/// The kinds of files that Photinus knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Airframe,
    Blink,
    Camera,
    Dataset,
    DatasetTable,
    Image,
    Results,
    SpotCurve,
    Video,
}

/// The kind of a file or folder. What fits nothing else is taken for a camera, whose reader says what cameras look
/// like; what is no text, for an image.
///
/// # Errors
/// [`Error`] when it cannot be read, or is standard input, which can be read only once.
pub(crate) fn kind_of(path: &Path) -> Result<Kind> {
    if path.as_os_str() == "-" {
        return Err(
            Error::format(path, "what it holds can be told of files only").advise("save it to a file first")
        );
    }
    if path.is_dir() {
        return Ok(Kind::Dataset);
    }
    let mut head = Vec::new();
    let file = open_regular(path)?;
    file.take(HEAD_BYTES).read_to_end(&mut head).map_err(|error| Error::io(path, error))?;
    Ok(kind_of_content(&head))
}

fn kind_of_content(head: &[u8]) -> Kind {
    if head.starts_with(b"YUV4MPEG2") {
        return Kind::Video;
    }
    let pictures: [&[u8]; 5] = [b"\x89PNG", b"\xff\xd8\xff", b"BM", b"II*\0", b"MM\0*"];
    let is_pnm = head.len() > 2
        && head[0] == b'P'
        && (b'1'..=b'7').contains(&head[1])
        && head[2].is_ascii_whitespace();
    if is_pnm || head.contains(&0) || pictures.iter().any(|magic| head.starts_with(magic)) {
        return Kind::Image;
    }
    let text = String::from_utf8_lossy(head);
    let mut lines = text.trim_start_matches('\u{feff}').lines().map(str::trim);
    let Some(first) = lines.find(|line| !line.is_empty() && !line.starts_with('#')) else {
        return Kind::Camera;
    };
    if first.starts_with('{') {
        return if first.contains("\"spots\"") { Kind::Results } else { Kind::Camera };
    }
    if first.chars().all(|c| "01, \t".contains(c)) && first.contains(',') {
        return Kind::Blink;
    }
    let words = first.split('#').next().unwrap_or_default().split_whitespace();
    if words.clone().count() == 7
        && words.clone().all(|word| word.parse::<f64>().is_ok())
        && !counts_itself(first)
    {
        return Kind::Airframe;
    }
    kind_of_keys(first, &text)
}

/// OCamCalib text may have seven numbers in its first line, too: the first is how many follow.
fn counts_itself(line: &str) -> bool {
    line.split_whitespace().next() == Some("6")
}

/// The kind of a TOML file, by a key that only that kind has.
fn kind_of_keys(first: &str, text: &str) -> Kind {
    let has = |key: &str| {
        text.lines().any(|line| {
            line.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='))
        })
    };
    let is_toml = first.starts_with('[') || first.contains('=');
    match is_toml {
        true if text.contains("[[led]]") || text.contains("[ring]") || has("ring") => Kind::Airframe,
        true if text.contains("scale_px_m2") => Kind::SpotCurve,
        true if has("exposure_us") || has("airframe") => Kind::DatasetTable,
        true if has("name") && !has("model") => Kind::Airframe,
        _ => Kind::Camera,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_is_told_by_its_content() {
        for (text, kind) in [
            ("YUV4MPEG2 W1 H1\n", Kind::Video),
            ("\u{feff}P5\n1 1\n255\n", Kind::Camera),
            ("P5\n1 1\n255\n", Kind::Image),
            ("{\"spots\":[]}\n", Kind::Results),
            ("{\n\"taylor_coefficient\": [1]}", Kind::Camera),
            ("# words\n0,1,1\n", Kind::Blink),
            ("# X Y Z\n0.1 0.1 0 0 0.0 1.5 0\n", Kind::Airframe),
            ("6 -259.5 0 1.6e-3 -2.3e-6 6.6e-9 1e-12\n", Kind::Camera),
            ("5 -259.5 0 1.6e-3 -2.3e-6 6.6e-9\n", Kind::Camera),
            ("name = \"hexa\"\n[[led]]\n", Kind::Airframe),
            ("name = \"hexa\"\nring = { arms = 6 }\n", Kind::Airframe),
            ("camera = \"c\"\nairframe = \"a\"\nexposure_us = 1.0\n", Kind::DatasetTable),
            ("model = \"ocam\"\n", Kind::Camera),
            ("exposure_us = 1000\n[upper]\nscale_px_m2 = 3\n", Kind::SpotCurve),
            ("image_width: 640\n", Kind::Camera),
            ("", Kind::Camera),
        ] {
            assert_eq!(kind_of_content(text.as_bytes()), kind, "{text}");
        }
    }
}
