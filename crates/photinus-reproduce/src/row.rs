//! A line of the summary: a number of the paper, the same number from simulation, and whether they agree.

use std::borrow::Cow;
use std::fmt;

/// How far a number may be from the paper's. Stated with the experiment, before it is run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// The ratio to the paper's number is within 1 +- this share.
    Ratio(f64),
    /// The number is this or more.
    AtLeast(f64),
    /// The number is this or less.
    AtMost(f64),
    /// The paper has no number to compare it with.
    None,
}

/// A line of the summary.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// What, with its unit.
    pub quantity: String,
    /// The paper's number, where it gives one.
    pub paper: Option<f64>,
    /// The number from simulation; not a number where the experiment gave none.
    pub reproduced: f64,
    /// How far they may be apart.
    pub tolerance: Tolerance,
    /// Why that tolerance, and what stands behind a difference.
    pub note: Cow<'static, str>,
}

impl Row {
    /// A number of the paper.
    pub fn of_paper(
        quantity: impl Into<String>,
        paper: f64,
        reproduced: f64,
        tolerance: Tolerance,
        note: impl Into<Cow<'static, str>>,
    ) -> Self {
        Self { quantity: quantity.into(), paper: Some(paper), reproduced, tolerance, note: note.into() }
    }

    /// A number that the paper does not give.
    pub fn own(
        quantity: impl Into<String>,
        reproduced: f64,
        tolerance: Tolerance,
        note: impl Into<Cow<'static, str>>,
    ) -> Self {
        Self { quantity: quantity.into(), paper: None, reproduced, tolerance, note: note.into() }
    }

    /// The number over the paper's, where there is one that is not 0.
    pub fn ratio(&self) -> Option<f64> {
        self.paper.filter(|paper| paper.abs() > 0.0).map(|paper| self.reproduced / paper)
    }

    /// Whether it is within the tolerance; `None` where there is none. What is not a number never is.
    pub fn is_within(&self) -> Option<bool> {
        match self.tolerance {
            Tolerance::Ratio(share) => Some(self.ratio().is_some_and(|ratio| (ratio - 1.0).abs() <= share)),
            Tolerance::AtLeast(limit) => Some(self.reproduced >= limit),
            Tolerance::AtMost(limit) => Some(self.reproduced <= limit),
            Tolerance::None => None,
        }
    }
}

impl fmt::Display for Tolerance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ratio(share) => write!(f, "{} %", (share * 1000.0).round() / 10.0),
            Self::AtLeast(limit) => write!(f, ">= {limit}"),
            Self::AtMost(limit) => write!(f, "<= {limit}"),
            Self::None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_within_its_tolerance_or_not() {
        let row = |reproduced, tolerance| Row::of_paper("x (m)", 2.0, reproduced, tolerance, "");
        assert_eq!(row(2.2, Tolerance::Ratio(0.15)).is_within(), Some(true));
        assert_eq!(row(2.4, Tolerance::Ratio(0.15)).is_within(), Some(false));
        assert_eq!(row(2.4, Tolerance::AtLeast(2.0)).is_within(), Some(true));
        assert_eq!(row(2.4, Tolerance::AtMost(2.0)).is_within(), Some(false));
        assert_eq!(row(2.4, Tolerance::None).is_within(), None);
        for tolerance in [Tolerance::Ratio(9.0), Tolerance::AtLeast(0.0), Tolerance::AtMost(9.0)] {
            assert_eq!(row(f64::NAN, tolerance).is_within(), Some(false), "nothing measured is not within");
        }
        assert_eq!(Row::own("x", 1.0, Tolerance::None, "").ratio(), None);
        assert_eq!(Tolerance::Ratio(0.15).to_string(), "15 %");
    }
}
