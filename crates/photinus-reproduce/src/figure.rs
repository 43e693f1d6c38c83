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
