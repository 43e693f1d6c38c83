//! What is learned of a camera's optics, what is not, and why nothing is.

use photinus::optics::{Optics, OpticsError};

use super::evidence::Evidence;

/// What frames did not tell of a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Unseen {
    /// No pixel was dark and not clipped.
    Darkness,
    /// Darkness reads the same everywhere, and little light is left over.
    ReadNoise,
    /// No light strong enough that its noise stands out.
    ShotNoise,
    /// No pixel was full.
    Saturation,
    /// Too few pixels were full to see what their excess does.
    Spill,
    /// Spots that are few, or too much alike in light, to see how sources widen with it.
    Sources,
    /// Too few spots to see how the point spread changes over the image.
    Field,
    /// No LED that moved far over the image, or none that kept its light meanwhile.
    Vignetting,
    /// No light that moved from column to column.
    ColumnSmear,
    /// Spots that are too much alike in light.
    Response,
    /// Too few frames to see what stays.
    HotPixels,
}

impl Unseen {
    /// Its name, as it stands in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Darkness => "darkness",
            Self::ReadNoise => "read_noise",
            Self::ShotNoise => "shot_noise",
            Self::Saturation => "saturation",
            Self::Spill => "spill",
            Self::Sources => "sources",
            Self::Field => "field",
            Self::Vignetting => "vignetting",
            Self::ColumnSmear => "column_smear",
            Self::Response => "response",
            Self::HotPixels => "hot_pixels",
        }
    }
}

/// Why frames make no optics.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LearnError {
    /// Too few spots.
    #[error("{found} spots stand alone and are not full, {needed} are needed")]
    TooFew {
        /// Spots found.
        found: usize,
        /// Spots needed.
        needed: usize,
    },
    /// Numbers that no optics have: the spots are none of one point spread.
    #[error("the spots have no point spread in common: {0}")]
    NoOptics(#[from] OpticsError),
}

/// What was learned of a camera.
#[derive(Clone, Debug)]
pub struct Learned {
    /// Lens and sensor.
    pub optics: Optics,
    /// Standard deviation of the mean level of full pixels, grey levels; `None` where none was full.
    pub saturation_sigma_dn: Option<f64>,
    /// Standard deviation of the error of the point spread, as that is a share of the light.
    pub shape_error_sigma: f64,
    /// What the frames did not tell, in the order of [`Unseen`].
    pub unseen: Vec<Unseen>,
    /// Frames looked at.
    pub frames: u64,
    /// Spots that the point spread rests on.
    pub spots: usize,
    /// What the numbers rest on.
    pub evidence: Evidence,
}
