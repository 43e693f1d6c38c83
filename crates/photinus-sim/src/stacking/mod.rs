//! A point spread from photos: many far LEDs, each at a place of its own in its pixel, stacked to one table.
//!
//! ```text
//! photos, linear -> spots apart from others (spots.rs) -> table and places in turn (epsf.rs) -> SampledSpread
//! ```
//! The method is the effective point spread of J. Anderson and I. King (PASP 112, 2000): from places that are about right comes
//! a table, from the table come better places, and so on. No shape is assumed, and nothing is taken from the detector.

mod epsf;
mod spots;

pub use epsf::{Stacked, stack};
pub use spots::{Spot, Wanted, find};

/// A photo whose numbers are in proportion to light; a pixel that tells nothing (saturated) is not finite.
#[derive(Clone, Debug)]
pub struct Photo {
    width: usize,
    levels: Vec<f64>,
}

impl Photo {
    /// A photo from its rows one after the other; `None` unless they are whole rows.
    pub fn new(levels: Vec<f64>, width: usize) -> Option<Self> {
        (width > 0 && levels.len().is_multiple_of(width)).then_some(Self { width, levels })
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.levels.len() / self.width
    }

    fn at(&self, u: usize, v: usize) -> f64 {
        self.levels[v * self.width + u]
    }
}
