//! Frames in which nothing can be found, whatever is there: enters a frame, leaves what is the matter with it.

use std::fmt;

use photinus_io::image::GreyImage;

/// A frame with more saturated pixels than this share shows no markers, but light everywhere.
const SATURATED_SHARE: f64 = 0.5;

/// What is the matter with a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Oddity {
    /// Most of it is saturated: this share.
    Saturated(f64),
    /// Every pixel has this level, which no camera gives.
    Flat(u8),
}

impl Oddity {
    /// What is the matter, if anything. Black alone is nothing odd: a dark scene clips there.
    pub fn of(image: &GreyImage) -> Option<Self> {
        let pixels = image.pixels();
        let share = pixels.iter().filter(|&&level| level == u8::MAX).count() as f64 / pixels.len() as f64;
        if share > SATURATED_SHARE {
            return Some(Self::Saturated(share));
        }
        let first = *pixels.first()?;
        (first > 0 && pixels.iter().all(|&level| level == first)).then_some(Self::Flat(first))
    }

    /// What kind of it, for the summary.
    pub fn kind(self) -> &'static str {
        match self {
            Self::Saturated(_) => "saturated",
            Self::Flat(_) => "of one level",
        }
    }
}

impl fmt::Display for Oddity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Saturated(share) => write!(
                f,
                "{:.0} % of the pixels are saturated, no marker can be told there; expose less, or check the filter",
                100.0 * share
            ),
            Self::Flat(level) => {
                write!(f, "every pixel is {level}, as no camera sees it; check the camera and its driver")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(pixels: [u8; 4]) -> Option<Oddity> {
        Oddity::of(&GreyImage::new(pixels.to_vec(), 2, 2).unwrap())
    }

    #[test]
    fn light_everywhere_and_light_nowhere() {
        assert_eq!(of([255, 255, 255, 3]), Some(Oddity::Saturated(0.75)));
        assert_eq!(of([255; 4]), Some(Oddity::Saturated(1.0)));
        assert_eq!(of([7; 4]), Some(Oddity::Flat(7)));
        assert_eq!(of([0; 4]), None);
        assert_eq!(of([255, 255, 3, 4]), None);
    }
}
