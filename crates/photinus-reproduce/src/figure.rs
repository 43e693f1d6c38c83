//! Which figures there are.

use crate::Experiment;

/// A figure of the paper, or a comparison that its text makes in words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Figure {
    /// 4: the solar spectrum, and what the UV band buys.
    Spectrum,
    /// 7: layouts of markers, seen from every direction.
    Layouts,
    /// 8: intensity of two LEDs side by side.
    Lobes,
    /// 10: spot area over distance for seven exposures.
    Exposures,
    /// 11: spot area at 1000 us with its envelope (13).
    Envelope,
    /// 12: bearing error over distance.
    Bearings,
    /// 13: the two distances over the true one.
    Distances,
    /// 14: their relative errors.
    RelativeErrors,
    /// 15: the outdoor flight.
    Flight,
    /// 16: the same with the angle widened.
    Widened,
    /// 17: where the neighbour can be, frame by frame.
    Overlay,
    /// The range outdoors, against printed circles.
    Range,
    /// Heading from bearing, against a compass.
    Heading,
}

impl Figure {
    /// All of them, in the order of the paper.
    pub const ALL: [Self; 13] = [
        Self::Spectrum,
        Self::Layouts,
        Self::Lobes,
        Self::Exposures,
        Self::Envelope,
        Self::Bearings,
        Self::Distances,
        Self::RelativeErrors,
        Self::Flight,
        Self::Widened,
        Self::Overlay,
        Self::Range,
        Self::Heading,
    ];

    /// Its number in the paper, or a word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Spectrum => "4",
            Self::Layouts => "7",
            Self::Lobes => "8",
            Self::Exposures => "10",
            Self::Envelope => "11",
            Self::Bearings => "12",
            Self::Distances => "13",
            Self::RelativeErrors => "14",
            Self::Flight => "15",
            Self::Widened => "16",
            Self::Overlay => "17",
            Self::Range => "range",
            Self::Heading => "heading",
        }
    }

    /// What it shows, in a few words.
    pub fn title(self) -> &'static str {
        match self {
            Self::Spectrum => "sunlight, and what the ultraviolet band buys",
            Self::Layouts => "layouts of markers, seen from every side",
            Self::Lobes => "intensity of two LEDs side by side",
            Self::Exposures => "spot area over distance for seven exposures",
            Self::Envelope => "spot area at 1000 us and its envelope",
            Self::Bearings => "bearing error over distance",
            Self::Distances => "the two distances over the true one",
            Self::RelativeErrors => "relative errors of the two distances",
            Self::Flight => "the outdoor flight",
            Self::Widened => "the outdoor flight with the angle widened",
            Self::Overlay => "where the neighbour can be, frame by frame",
            Self::Range => "range outdoors, beside printed circles",
            Self::Heading => "heading from the bearing, beside a compass",
        }
    }

    /// What to look for in it.
    pub fn caption(self) -> &'static str {
        match self {
            Self::Spectrum => {
                "The band of the filter gets a small share of the sunlight: that is why LEDs of little power stand out."
            }
            Self::Layouts => {
                "How many markers show from each direction, and how bright: a layout without dark sides is wanted."
            }
            Self::Lobes => "Two LEDs at an angle to each other shine evenly between them up to 120 degrees.",
            Self::Exposures => {
                "The longer the exposure, the larger the spot and the farther away it becomes a single pixel."
            }
            Self::Envelope => {
                "Every spot lies below the envelope, from which a strict bound of the distance follows."
            }
            Self::Bearings => "Most errors lie below what the paper derives from the size of a pixel.",
            Self::Distances => {
                "Truth lies between the two estimates, l_A and l_B, which assume the extreme ways a pair can be turned."
            }
            Self::RelativeErrors => {
                "How far l_A and l_B are off, as shares of the distance, beside what geometry predicts."
            }
            Self::Flight => {
                "While the target spins, l_A and l_B swap roles; the estimate of Photinus follows truth."
            }
            Self::Widened => {
                "With the angle widened by the size of the spots, truth leaves the interval far less often."
            }
            Self::Overlay => {
                "The path of the neighbour from above, in the frame of the camera, and where each frame by itself puts it."
            }
            Self::Range => "How many markers of the airframe are found at which distance.",
            Self::Heading => {
                "Where the bearing alone tells how the neighbour is turned, beside the true heading."
            }
        }
    }

    /// The figure of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|figure| figure.name() == name)
    }

    /// The experiment that it is drawn from.
    pub fn experiment(self) -> Experiment {
        match self {
            Self::Spectrum => Experiment::Sunlight,
            Self::Layouts | Self::Lobes => Experiment::Lobes,
            Self::Exposures | Self::Envelope => Experiment::RecedingLed,
            Self::Bearings | Self::Distances | Self::RelativeErrors => Experiment::RandomPoses,
            Self::Flight | Self::Widened | Self::Overlay | Self::Heading => Experiment::Flight,
            Self::Range => Experiment::Range,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_told_apart_and_found_again() {
        for figure in Figure::ALL {
            assert_eq!(Figure::named(figure.name()), Some(figure));
        }
        assert_eq!(Figure::named("9"), None, "a drawing of the geometry");
    }
}
