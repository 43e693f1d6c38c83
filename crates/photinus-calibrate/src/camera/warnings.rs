//! What a user should know or do about a calibration.

use std::fmt;

use super::{BoardChoice, Calibration, Coverage, Lack, Misfit, MisfitReason};
use crate::photo::Photo;
use crate::solve::Board;

/// What a user should know or do, in one sentence each.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// A photo that was left out.
    LeftOut {
        /// Its name.
        photo: String,
        /// Why.
        misfit: Misfit,
    },
    /// Not many photos.
    FewPhotos {
        /// How many.
        used: usize,
    },
    /// A photo whose spots are wider than those of the others.
    Blurred {
        /// Its name.
        photo: String,
        /// How many times as wide.
        times: f64,
    },
    /// Many spots that are far off.
    ManyOutliers {
        /// How many.
        left_out: usize,
        /// Of how many.
        of: usize,
    },
    /// The board could not be solved and was taken to be flat.
    FlatBoard {
        /// How well photos agree on where the LEDs are.
        correlation: f64,
        /// What chance gives.
        chance: f64,
    },
    /// Bearings that are not sure.
    PoorBearings {
        /// Sigma within 40 deg of the axis, mrad.
        sigma_mrad: f64,
        /// Standard deviation of a residual, px.
        sigma_px: f64,
    },
    /// Columns and rows whose distances do not agree.
    Pitch {
        /// Distance of columns over distance of rows.
        ratio: f64,
    },
    /// Photos are missing somewhere.
    Coverage(Lack),
}

const FEW_PHOTOS: usize = 10;
const BLURRED_TIMES: f64 = 1.6;
const MANY_OUTLIERS: f64 = 0.03;
const POOR_MRAD: f64 = 2.0;
const PITCH_RATIO: f64 = 0.005;

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LeftOut { photo, misfit } => {
                let what = match misfit.reason {
                    MisfitReason::Mirrored => "it is mirrored: save it as the camera took it",
                    MisfitReason::Foreign => {
                        "it shows something else, or comes from another camera, zoom or size: remove it"
                    }
                };
                write!(f, "{photo}: left out, its LEDs are {:.1} px off in the mean; {what}", misfit.mean_px)
            }
            Self::FewPhotos { used } => write!(
                f,
                "{used} photos are few: 15 to 30 with the grid near, far, tilted and at every edge make a good calibration"
            ),
            Self::Blurred { photo, times } => write!(
                f,
                "{photo}: its spots are {times:.1} times as wide as those of the other photos: out of focus, or moved while it was \
                 taken; take it again"
            ),
            Self::ManyOutliers { left_out, of } => write!(
                f,
                "{left_out} of {of} spots were left out as too far off: look at them in the report; reflections, or LEDs that moved?"
            ),
            Self::FlatBoard { correlation, chance } => write!(
                f,
                "the photos do not tell where the LEDs are on the board (they agree by {correlation:.2}, chance gives up to {chance:.2}): \
                 it was taken to be exact, and errors of a board made by hand go into the camera unseen"
            ),
            Self::PoorBearings { sigma_mrad, sigma_px } => write!(
                f,
                "bearings are known to {sigma_mrad:.1} mrad only within 40 deg of the axis (a spot scatters by {sigma_px:.2} px): \
                 take more and sharper photos, with spots of 3 px and more"
            ),
            Self::Pitch { ratio } => write!(
                f,
                "the pitch does not agree with itself: columns are {:.2} % {} apart than rows; measure the board again",
                100.0 * (ratio - 1.0).abs(),
                if *ratio > 1.0 { "farther" } else { "less far" }
            ),
            Self::Coverage(lack) => lack.fmt(f),
        }
    }
}

pub(super) fn of(calibration: &Calibration, photos: &[Photo]) -> Vec<Warning> {
    let name =
        |photo: usize| photos.get(photo).map_or_else(|| format!("photo {photo}"), |photo| photo.name.clone());
    let mut warnings: Vec<Warning> = calibration
        .misfits()
        .iter()
        .map(|misfit| Warning::LeftOut { photo: name(misfit.photo), misfit: misfit.clone() })
        .collect();
    let used = calibration.views().len();
    if used < FEW_PHOTOS {
        warnings.push(Warning::FewPhotos { used });
    }
    warnings.extend(blurred(calibration, photos));
    let left_out = calibration.outliers().len();
    let of = left_out + calibration.residuals().len();
    if left_out as f64 > MANY_OUTLIERS * of as f64 {
        warnings.push(Warning::ManyOutliers { left_out, of });
    }
    if calibration.board() == Board::Flat && calibration.board_choice != BoardChoice::Flat {
        let agreement = calibration.agreement();
        let (correlation, chance) = (agreement.correlation, agreement.chance);
        warnings.push(Warning::FlatBoard { correlation, chance });
    }
    let rings = calibration.field().claimed(calibration.camera());
    let sigma_mrad = rings.iter().take(4).map(|ring| 1e3 * ring.rms_rad).fold(0.0, f64::max);
    if sigma_mrad >= POOR_MRAD {
        warnings.push(Warning::PoorBearings { sigma_mrad, sigma_px: calibration.sigma_px() });
    }
    let ratio = calibration.pitch_ratio();
    if (ratio - 1.0).abs() > PITCH_RATIO {
        warnings.push(Warning::Pitch { ratio });
    }
    let coverage = Coverage::of(calibration.views(), calibration.size_px());
    warnings.extend(coverage.lacks().into_iter().map(Warning::Coverage));
    warnings
}

/// Photos whose spots are wide for how near the board is: width over the width that the spacing of the LEDs lets expect.
fn blurred(calibration: &Calibration, photos: &[Photo]) -> Vec<Warning> {
    let mut widths = Vec::new();
    for (view, pose) in calibration.views().iter().zip(calibration.poses()) {
        if let Some(photo) = photos.get(view.photo)
            && let Some(width_px) = photo.spot_width_px(view)
        {
            widths.push((photo, width_px, pose.translation.vector.norm()));
        }
    }
    let expected = |distance_m: f64, without: usize| {
        // of the photos about as far away, the middle one
        let mut others: Vec<(f64, f64)> = widths
            .iter()
            .enumerate()
            .filter(|(index, _)| *index != without)
            .map(|(_, (_, width_px, distance))| (libm::log(distance / distance_m).abs(), *width_px))
            .collect();
        others.sort_by(|a, b| a.0.total_cmp(&b.0));
        others.truncate(5);
        others.sort_by(|a, b| a.1.total_cmp(&b.1));
        others.get(others.len() / 2).map(|(_, width_px)| *width_px)
    };
    let judge = |(index, (photo, width_px, distance_m)): (usize, &(&Photo, f64, f64))| {
        let times = width_px / expected(*distance_m, index)?;
        (times > BLURRED_TIMES).then(|| Warning::Blurred { photo: photo.name.clone(), times })
    };
    widths.iter().enumerate().filter_map(judge).collect()
}

impl Calibration {
    /// Distance between columns over distance between rows of the board as it was found; 1 when it was taken to be flat.
    pub fn pitch_ratio(&self) -> f64 {
        let nominal_m = self.grid().nominal_m();
        let scale = |axis: usize| {
            let (mut product, mut square) = (0.0, 0.0);
            for (nominal, found) in nominal_m.iter().zip(&self.scene().board_m) {
                product += nominal[axis] * found[axis];
                square += nominal[axis] * nominal[axis];
            }
            product / square
        };
        scale(0) / scale(1)
    }
}
