//! What vehicles tell each other, and what comes of it.

use core::fmt;

use crate::{Heading, Normal};

/// One vehicle's view of another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// Who it is, where its code was read.
    pub identity: Option<u32>,
    /// Where it is in the level frame of the one who sees, m.
    pub position_m: Normal,
}

/// What one vehicle sees at a time: a message of a dozen numbers a sight.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Who sees.
    pub from: u32,
    /// Whom.
    pub sights: Vec<Sight>,
}

/// Where a vehicle is and how it is turned, in the level frame of the one who asks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Who.
    pub identity: u32,
    /// Where its origin is, m.
    pub position_m: Normal,
    /// How far its level frame is turned.
    pub heading: Heading,
}

/// The whole group.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// Those who are determined, in the order of their reports.
    pub placed: Vec<Placed>,
    /// Those who are not: nobody sees them, they see nobody, or they are straight above or below whom they see.
    pub undetermined: Vec<u32>,
    /// Sum of squared residuals, weighed by their covariances.
    pub misfit: f64,
    /// What the misfit is expected to be: three per sight less what was determined.
    pub freedom: usize,
}

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unclear {
    /// Sights fit to those who report in several ways, about as well.
    Ambiguous {
        /// In how many; 2 may stand for more where a constellation has very many.
        ways: usize,
    },
    /// No way in which sights are those who report agrees with all of them.
    NoAgreement,
    /// Nobody who reports is connected with the vehicle by sights.
    NoConnection,
    /// One vehicle reported twice.
    TwoReportsFrom(u32),
}

impl fmt::Display for Unclear {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ambiguous { ways } => {
                write!(f, "the constellation fits in {ways} ways: move, or let vehicles blink their codes")
            }
            Self::NoAgreement => write!(f, "no way in which sights are vehicles agrees with all reports"),
            Self::NoConnection => write!(f, "no sights connect the vehicle with any that reports"),
            Self::TwoReportsFrom(id) => write!(f, "two reports are from vehicle {id}: keep the newest"),
        }
    }
}

impl core::error::Error for Unclear {}
