//! Faults as words of a command line: `noise=8`, `lamp=25px-beside`, `mirrored`; and back.

use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

use super::{Fault, Lamp};

/// A word that is no fault.
#[derive(Clone, Debug, PartialEq)]
pub struct WordError {
    word: String,
    must: String,
}

impl fmt::Display for WordError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}`: {}", self.word, self.must)
    }
}

impl std::error::Error for WordError {}

impl Fault {
    /// One word of each kind, and what it means.
    pub const WORDS: [(&'static str, &'static str); 18] = [
        ("gain=0.5", "grey levels times this"),
        ("noise=8", "normal noise of this sigma, grey levels"),
        ("jpeg=50", "JPEG of this quality, 1 to 100"),
        ("blur=1.5", "a Gaussian blur of this sigma, px"),
        ("smear=6@90", "light drawn out over so many px, so many degrees from right towards down"),
        ("hot=30", "so many hot pixels, the same in every frame"),
        ("lamp=fixed", "a foreign lamp, somewhere, the same place in every frame"),
        ("lamp=400,200", "a foreign lamp at this column and row"),
        ("lamp=25px-beside", "a foreign lamp so far beside the first neighbour (by the truth)"),
        ("dead-led=2", "the LED of this number of every neighbour painted out (by the truth)"),
        ("gravity=20", "gravity off by so many degrees"),
        ("airframe=1.02", "the airframe's file larger than the airframe by this factor"),
        ("focal=1.02", "the camera's file of a longer focal length by this factor"),
        ("mirrored", "left and right exchanged"),
        ("dropped=0.1", "this share of the frames lost"),
        ("duplicated=0.1", "this share of the frames shows the one before"),
        ("swapped=0.1", "with this probability a frame exchanges its pixels with the next"),
        ("torn=0.1", "this share of the frames ends as the one before"),
    ];
}

impl FromStr for Fault {
    type Err = WordError;

    fn from_str(word: &str) -> Result<Self, WordError> {
        let refuse = |must: String| WordError { word: word.to_owned(), must };
        let (name, value) = word.split_once('=').unwrap_or((word, ""));
        let number = |limits: RangeInclusive<f64>| {
            let given: Option<f64> = value.parse().ok().filter(|number| limits.contains(number));
            given.ok_or_else(|| {
                refuse(format!("give {name}= a number from {} to {}", limits.start(), limits.end()))
            })
        };
        let whole = |limits: RangeInclusive<usize>| {
            let given: Option<usize> = value.parse().ok().filter(|number| limits.contains(number));
            given.ok_or_else(|| {
                refuse(format!("give {name}= a whole number from {} to {}", limits.start(), limits.end()))
            })
        };
        Ok(match name {
            "gain" => Self::Gain(number(0.0..=255.0)?),
            "noise" => Self::Noise(number(0.0..=255.0)?),
            "jpeg" => Self::Jpeg(whole(1..=100)? as u8),
            "blur" => Self::Blur(number(0.05..=20.0)?),
            "smear" => smear(value).ok_or_else(|| {
                refuse(
                    "give a length of 0.1 to 200 px, and after @ a direction in degrees: smear=6@90"
                        .to_owned(),
                )
            })?,
            "hot" => Self::Hot(whole(1..=1_000_000)?),
            "lamp" => Self::Lamp(lamp(value).ok_or_else(|| {
                refuse("give lamp=fixed, a column and a row as lamp=400,200, or lamp=25px-beside".to_owned())
            })?),
            "dead-led" => Self::DeadLed(whole(0..=255)? as u32),
            "gravity" => Self::Gravity(number(0.0..=180.0)?.to_radians()),
            "airframe" => Self::Airframe(number(0.1..=10.0)?),
            "focal" => Self::Focal(number(0.1..=10.0)?),
            "mirrored" if word == "mirrored" => Self::Mirrored,
            "mirrored" => return Err(refuse("it takes no number".to_owned())),
            "dropped" => Self::Dropped(number(0.0..=1.0)?),
            "duplicated" => Self::Duplicated(number(0.0..=1.0)?),
            "swapped" => Self::Swapped(number(0.0..=1.0)?),
            "torn" => Self::Torn(number(0.0..=1.0)?),
            _ => {
                let words: Vec<&str> = Self::WORDS.iter().map(|(word, _)| *word).collect();
                return Err(refuse(format!("no such fault; there is {}", words.join(" "))));
            }
        })
    }
}

fn smear(value: &str) -> Option<Fault> {
    let (length, direction) = value.split_once('@').unwrap_or((value, "0"));
    let length_px = length.parse().ok().filter(|px| (0.1..=200.0).contains(px))?;
    let direction_deg: f64 = direction.parse().ok().filter(|deg| (-360.0..=360.0).contains(deg))?;
    Some(Fault::Smear { length_px, direction_rad: direction_deg.to_radians() })
}

fn lamp(value: &str) -> Option<Lamp> {
    let place = |text: &str| text.parse().ok().filter(|px| (-0.5..=1e5).contains(px));
    if value == "fixed" {
        return Some(Lamp::Somewhere);
    }
    if let Some(gap) = value.strip_suffix("px-beside") {
        return Some(Lamp::Beside { gap_px: gap.parse().ok().filter(|px| (0.0..=1e5).contains(px))? });
    }
    let (u, v) = value.split_once(',')?;
    Some(Lamp::Fixed { u_px: place(u)?, v_px: place(v)? })
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Degrees as they were given: a conversion there and back is off in the last digit.
        let degrees = |rad: f64| (rad.to_degrees() * 1e9).round() / 1e9;
        match *self {
            Self::Gain(factor) => write!(f, "gain={factor}"),
            Self::Noise(sigma_dn) => write!(f, "noise={sigma_dn}"),
            Self::Jpeg(quality) => write!(f, "jpeg={quality}"),
            Self::Blur(sigma_px) => write!(f, "blur={sigma_px}"),
            Self::Smear { length_px, direction_rad } => {
                write!(f, "smear={length_px}@{}", degrees(direction_rad))
            }
            Self::Hot(count) => write!(f, "hot={count}"),
            Self::Lamp(Lamp::Somewhere) => write!(f, "lamp=fixed"),
            Self::Lamp(Lamp::Fixed { u_px, v_px }) => write!(f, "lamp={u_px},{v_px}"),
            Self::Lamp(Lamp::Beside { gap_px }) => write!(f, "lamp={gap_px}px-beside"),
            Self::DeadLed(led) => write!(f, "dead-led={led}"),
            Self::Gravity(angle_rad) => write!(f, "gravity={}", degrees(angle_rad)),
            Self::Airframe(factor) => write!(f, "airframe={factor}"),
            Self::Focal(factor) => write!(f, "focal={factor}"),
            Self::Mirrored => write!(f, "mirrored"),
            Self::Dropped(share) => write!(f, "dropped={share}"),
            Self::Duplicated(share) => write!(f, "duplicated={share}"),
            Self::Swapped(share) => write!(f, "swapped={share}"),
            Self::Torn(share) => write!(f, "torn={share}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_is_read_and_written_back() {
        for (word, _) in Fault::WORDS {
            let fault: Fault = word.parse().unwrap();
            assert_eq!(fault.to_string(), word);
        }
        assert_eq!("smear=6".parse(), Ok(Fault::Smear { length_px: 6.0, direction_rad: 0.0 }));
        assert_eq!("gravity=90".parse(), Ok(Fault::Gravity(core::f64::consts::FRAC_PI_2)));
    }

    #[test]
    fn what_is_no_fault_is_refused_with_what_to_give() {
        for (word, part) in [
            ("", "no such fault; there is gain=0.5 "),
            ("fog", "no such fault"),
            ("noise", "give noise= a number from 0 to 255"),
            ("noise=nan", "a number from 0 to 255"),
            ("noise=-1", "a number from 0 to 255"),
            ("jpeg=0", "a whole number from 1 to 100"),
            ("hot=1.5", "a whole number"),
            ("mirrored=1", "it takes no number"),
            ("dropped=1.1", "0 to 1"),
            ("smear=6@", "smear=6@90"),
            ("lamp=25", "lamp=400,200"),
            ("lamp=inf,0", "lamp=400,200"),
            ("blur=inf", "0.05 to 20"),
        ] {
            let message = word.parse::<Fault>().unwrap_err().to_string();
            assert!(message.contains(part) && message.starts_with(&format!("`{word}`: ")), "{message}");
        }
    }
}
