//! A frame -> spots: what is bright, what belongs together, where its centre is, and what is not a marker.
//!
//! The stages, a module each, in the order of the flow:
//!
//! ```text
//! tiles          brightest and darkest pixel of each tile, noise  -> bytes per tile
//! background     the level of the surroundings, tile by tile      -> a threshold per tile
//! runs           rows of pixels at or above their threshold       -> runs
//! grouping       runs that touch, also by a corner                -> components
//! splitting      one component with several summits (summits)     -> parts
//! part           size, shape and first guess of a part; ledge: whether it goes on where the threshold is higher
//! rejection      what is not a marker by its outline, and why
//! neighbourhood  how far a part's light is its own                -> room for a window
//! cut_off        what noisy pixels read where darkness is cut off at 0
//! lessons        what the frame tells of the camera (telling), kept as pixels (album)
//!                                                                -> point spread (learning), noise (noise_bins), full_level
//! fitting        a window on each part, less its background (window, patch), and the camera's point spread in it (fit), along a segment where it moved (smear)
//!                two at once where neither is seen alone (pairs); what full pixels say of its light (limits)
//!                -> centre and light of a point, with covariances
//! measuring      spots of those; what is no point's light by its wings (wings) or a balanced window (centroid)
//!                -> spots
//! hot_pixel      single pixels that are narrower than a point's light can be
//! odds           how likely each spot is a marker's light
//! detection_limit  how much light a point needs to be found
//! ```
//!
//! Every pixel at or above its threshold belongs to exactly one part, and every part is either a [`Spot`] or a
//! [`Rejected`] with its [`Reason`]; nothing is dropped in silence. What may be a marker is a spot, however unlikely:
//! whoever looks at a frame as a whole decides.

mod album;
mod background;
mod beside;
mod breadth;
mod centroid;
mod cut_off;
mod detection_limit;
mod detector;
mod fit;
mod fitting;
mod full_level;
mod grouping;
mod hot_pixel;
mod learning;
mod ledge;
mod lessons;
mod limits;
mod measuring;
mod neighbourhood;
mod noise_bins;
mod odds;
mod pairs;
mod part;
mod patch;
mod rejection;
mod ring;
mod runs;
mod settings;
mod smear;
mod splitting;
mod summits;
mod telling;
mod tiles;
mod window;
mod wings;

use alloc::vec::Vec;

use nalgebra::Matrix2;

use crate::camera::Pixel;
#[cfg(not(feature = "std"))]
use crate::float::Float as _;
use crate::optics::Measured;

pub(crate) use detection_limit::ANY_SIGMA as ANY_LIMIT_SIGMA;
pub use detector::Detector;
pub(crate) use hot_pixel::BEFOREHAND as HOT_BEFOREHAND;
pub(crate) use measuring::{HIDDEN_LOG, HIDDEN_SIGMA};
pub use rejection::Reason;
pub use settings::{Brightness, Noise, Settings, SettingsError, Shape};

/// One bright spot that may be a marker.
#[derive(Clone, Debug, PartialEq)]
pub struct Spot {
    /// Where the light fell: sub-pixel, background subtracted, aware of saturation.
    pub centre: Pixel,
    /// Covariance of `centre` in (u, v), px^2: of the estimate, not the extent of the spot.
    pub covariance_px2: Matrix2<f64>,
    /// Pixels at or above the threshold (the paper's S).
    pub area_px: u32,
    /// Highest value, 0 to 255.
    pub peak: u8,
    /// Pixels at 255.
    pub saturated_px: u32,
    /// Signal above the background in the window around the spot, grey levels; a lower limit when saturated.
    pub flux: f64,
    /// All of its light, grey levels: with what full pixels hide and what falls outside the window where the point spread tells it, else as much
    /// as the window shows, with a sigma that says how little that tells. `None` where nothing is fitted (fixed threshold), and of what is
    /// full without a point spread.
    pub light: Option<Measured>,
    /// Level of the surroundings, grey levels.
    pub background: f64,
    /// Natural logarithm of the odds that this is the light of one or more markers and not clutter (a reflection of a brighter spot, a hot
    /// pixel, a glint, glare), from how it looks in its frame alone; beforehand the two are taken as equally likely.
    pub marker_log_odds: f64,
    /// The paper's position: the middle pixel (column, row) in the order of a scan-line fill.
    pub middle: (u32, u32),
    /// Columns and rows that the spot spans, for drawing and for masks.
    pub extent: Extent,
}

impl Spot {
    /// One number for the uncertainty of the centre: root of the mean variance of the two axes, px.
    pub fn sigma_px(&self) -> f64 {
        (self.covariance_px2.trace() / 2.0).sqrt()
    }

    /// The probability that it is the light of markers: what [`Self::marker_log_odds`] says of it.
    pub fn probability(&self) -> f64 {
        1.0 / (1.0 + libm::exp(-self.marker_log_odds))
    }
}

/// A box of pixels, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// First column.
    pub left: u32,
    /// First row.
    pub top: u32,
    /// Last column.
    pub right: u32,
    /// Last row.
    pub bottom: u32,
}

impl Extent {
    /// Columns spanned.
    pub fn width(&self) -> u32 {
        self.right - self.left + 1
    }

    /// Rows spanned.
    pub fn height(&self) -> u32 {
        self.bottom - self.top + 1
    }

    /// How far a place is from the nearest of these pixels, px; 0 among them.
    pub(crate) fn gap_px(&self, place: Pixel) -> f64 {
        let gap = |at: f64, first: u32, last: u32| (f64::from(first) - at).max(at - f64::from(last)).max(0.0);
        libm::hypot(gap(place.u, self.left, self.right), gap(place.v, self.top, self.bottom))
    }
}

/// A bright region that is not a marker, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Rejected {
    /// Its middle, px.
    pub centre: Pixel,
    /// Pixels at or above the threshold.
    pub area_px: u32,
    /// Highest value, 0 to 255.
    pub peak: u8,
    /// Why.
    pub reason: Reason,
    /// Columns and rows that it spans.
    pub extent: Extent,
}

/// What one frame holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Detections {
    /// In the order of a scan by rows of their first pixel.
    pub spots: Vec<Spot>,
    /// By the first row, then the first column, that they span.
    pub rejected: Vec<Rejected>,
}
