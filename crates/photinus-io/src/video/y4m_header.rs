//! The first line of a Y4M stream: size, rate, and how a frame is laid out.

use crate::image::{Conversion, check_size};

/// The first word of a stream.
pub(super) const MAGIC: &str = "YUV4MPEG2";

/// What the first line says.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Frames per second; `None` where the stream says it does not know.
    pub(super) rate_hz: Option<f64>,
    pub(super) layout: Layout,
    /// Luma of 16 to 235, said by the stream.
    pub(super) limited_range: bool,
}

/// How the samples of a frame are laid out; luma comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    chroma: Chroma,
    pub(super) bits: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Chroma {
    None,
    Quarter,
    Half,
    QuarterWide,
    Full,
    FullAndOpacity,
}

impl Header {
    pub(super) fn parse(line: &str) -> Result<Self, String> {
        let mut words = line.split(' ');
        if words.next() != Some(MAGIC) {
            return Err(format!("it does not begin with {MAGIC}"));
        }
        let (mut width, mut height, mut rate_hz, mut limited_range) = (None, None, None, false);
        let mut layout = Layout { chroma: Chroma::Quarter, bits: 8 };
        for word in words.filter(|word| !word.is_empty()) {
            let value = word.get(1..).unwrap_or("");
            match word.as_bytes()[0] {
                b'W' => width = Some(side(word, value)?),
                b'H' => height = Some(side(word, value)?),
                b'F' => rate_hz = rate(word, value)?,
                b'C' => layout = Layout::parse(value)?,
                b'I' if matches!(value, "t" | "b" | "m") => {
                    return Err(format!("`{word}`: each frame is woven from two exposures"));
                }
                b'X' if value == "COLORRANGE=LIMITED" => limited_range = true,
                // Aspect ratio, comments and parameters of others change no pixel.
                _ => {}
            }
        }
        let width = width.ok_or("its first line gives no width (W)")?;
        let height = height.ok_or("its first line gives no height (H)")?;
        check_size(width, height)?;
        // Grey tagged as limited comes from converters that copy the tag of the colour video and stretch the pixels.
        let limited_range = limited_range && layout.chroma != Chroma::None;
        Ok(Self { width, height, rate_hz, layout, limited_range })
    }

    /// What is done to each frame.
    pub(super) fn conversions(&self) -> Vec<Conversion> {
        let colour = (self.layout.chroma != Chroma::None).then_some(Conversion::LumaPlane);
        let deep = (self.layout.bits > 8).then(|| Conversion::Maximum(self.layout.maximum()));
        colour.into_iter().chain(deep).chain(self.limited_range.then_some(Conversion::LimitedRange)).collect()
    }

    /// Bytes of a frame: luma, then everything after it.
    pub(super) fn plane_bytes(&self) -> (usize, usize) {
        let (width, height) = (self.width, self.height);
        let chroma = match self.layout.chroma {
            Chroma::None => 0,
            Chroma::Quarter => 2 * width.div_ceil(2) * height.div_ceil(2),
            Chroma::Half => 2 * width.div_ceil(2) * height,
            Chroma::QuarterWide => 2 * width.div_ceil(4) * height,
            Chroma::Full => 2 * width * height,
            Chroma::FullAndOpacity => 3 * width * height,
        };
        let sample_bytes = if self.layout.bits > 8 { 2 } else { 1 };
        (width * height * sample_bytes, chroma * sample_bytes)
    }
}

impl Layout {
    fn parse(name: &str) -> Result<Self, String> {
        if let Some(bits) = name.strip_prefix("mono") {
            return Ok(Self { chroma: Chroma::None, bits: depth(name, bits)? });
        }
        let siting = ["420jpeg", "420mpeg2", "420paldv"];
        if name == "444alpha" {
            return Ok(Self { chroma: Chroma::FullAndOpacity, bits: 8 });
        }
        if siting.contains(&name) {
            return Ok(Self { chroma: Chroma::Quarter, bits: 8 });
        }
        let (planes, bits) = name.split_once('p').unwrap_or((name, ""));
        let chroma = match planes {
            "420" => Chroma::Quarter,
            "422" => Chroma::Half,
            "411" => Chroma::QuarterWide,
            "444" => Chroma::Full,
            _ => return Err(format!("`C{name}` is no colour space that Photinus reads")),
        };
        Ok(Self { chroma, bits: depth(name, bits)? })
    }

    /// The largest sample.
    pub(super) fn maximum(self) -> u32 {
        (1 << self.bits) - 1
    }
}

fn depth(name: &str, bits: &str) -> Result<u32, String> {
    match bits {
        "" => Ok(8),
        _ => bits
            .parse()
            .ok()
            .filter(|bits| (8..=16).contains(bits))
            .ok_or_else(|| format!("`C{name}`: samples have 8 to 16 bit")),
    }
}

fn side(word: &str, value: &str) -> Result<usize, String> {
    value.parse().map_err(|_| format!("`{word}` is no size"))
}

fn rate(word: &str, value: &str) -> Result<Option<f64>, String> {
    let parts =
        value.split_once(':').and_then(|(n, d)| Some((n.parse::<u32>().ok()?, d.parse::<u32>().ok()?)));
    match parts {
        Some((0, 0)) => Ok(None),
        Some((frames, seconds)) if frames > 0 && seconds > 0 => {
            Ok(Some(f64::from(frames) / f64::from(seconds)))
        }
        _ => Err(format!("`{word}` is no frame rate such as F60:1")),
    }
}
