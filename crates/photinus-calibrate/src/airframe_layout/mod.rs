//! Photos taken around an airframe -> where its LEDs sit (structure from bearings).
//!
//! ```text
//! usable   which photos and LEDs tell more than they ask for
//! photo    a first pose for each photo, from the nominal layout: no guess of where photos were taken is needed
//! adjust   LED positions and poses by bundle adjustment of residuals in pixels, past 90 deg too
//! frame    what bearings cannot tell: origin, axes and, without a known distance, scale are those of the nominal layout
//! ```
//!
//! Axes, lobes and signals of the LEDs are not estimated here: they stay as the nominal layout has them.

mod adjust;
mod error;
mod frame;
mod photo;
#[cfg(test)]
mod tests;
mod usable;

use nalgebra::{DMatrix, Matrix3, UnitQuaternion, Vector3};

use crate::resection::Pose;
use crate::robust::{self, Loss};
use crate::sighted::Sighted;
use adjust::Adjustment;
pub use error::LayoutError;

/// An LED in a photo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LedSighting {
    /// Number of the photo, counted from 0.
    pub photo: usize,
    /// Number of the LED in the nominal layout, counted from 0.
    pub led: usize,
    /// Where it is seen.
    pub sighted: Sighted,
}

/// A distance between two LEDs, measured by hand: it gives the scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownDistance {
    /// Between which LEDs.
    pub leds: [usize; 2],
    /// How far they are apart, m.
    pub distance_m: f64,
    /// Standard deviation of that, m.
    pub sigma_m: f64,
}

/// Where a photo was taken from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotoPose {
    /// The rotation body_from_camera.
    pub body_from_camera: UnitQuaternion<f64>,
    /// The camera's centre in the body frame, m.
    pub centre_m: Vector3<f64>,
}

/// The LEDs of an airframe, as photos show them.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// Position of each LED in the body frame, m; `None` where photos do not tell.
    pub positions_m: Vec<Option<Vector3<f64>>>,
    /// Numbers of the LEDs that are placed, ascending: the order of `covariance_m2`.
    pub placed: Vec<usize>,
    /// Joint covariance of the placed LEDs, x, y, z of each, m^2. Origin and axes have none: they are the nominal layout's.
    pub covariance_m2: DMatrix<f64>,
    /// Pose of each photo; `None` for those that were not used.
    pub photos: Vec<Option<PhotoPose>>,
    /// Length of each sighting's residual, in the sigmas that were stated; `None` for those that were not used.
    pub residuals: Vec<Option<f64>>,
    /// Indices of the sightings that deviate too far and were left out.
    pub outliers: Vec<usize>,
    /// Scatter of the residuals along one axis, in the sigmas that were stated: 1 where those were right.
    pub scatter: f64,
}

impl Layout {
    /// Covariance of one LED's position, m^2.
    pub fn covariance_of(&self, led: usize) -> Option<Matrix3<f64>> {
        let place = self.placed.binary_search(&led).ok()?;
        Some(self.covariance_m2.fixed_view::<3, 3>(3 * place, 3 * place).into())
    }
}

/// Fewest LEDs of a photo: three tell no more than the photo's own pose.
pub const FEWEST_LEDS: usize = 4;
const ROUNDS: usize = 6;
/// Scale of the robust loss. Less, and sightings that agree by chance pull the others out.
const CAUCHY_SIGMAS: f64 = 4.0;
/// Residuals below this are rounding, in sigmas.
const LEAST_SIGMA: f64 = 1e-6;

/// Calibrates a layout that is roughly known: `nominal_m` may be off by a fifth of the airframe's size.
///
/// # Errors
/// [`LayoutError`] for LEDs that the nominal layout does not have, for distances that mean nothing, when photos tell too little or
/// contradict each other, and when an LED's place stays unknown.
pub fn calibrate(
    nominal_m: &[Vector3<f64>],
    sightings: &[LedSighting],
    distances: &[KnownDistance],
) -> Result<Layout, LayoutError> {
    error::check(nominal_m, sightings, distances)?;
    let mut used = usable::sightings(sightings, &vec![true; sightings.len()]);
    let mut adjustment = start(nominal_m, sightings, &mut used, distances)?;
    let mut sigma = 0.0;
    for _ in 0..ROUNDS {
        sigma = sigma_of(&adjustment);
        adjustment.weigh_distances(sigma);
        adjustment.refine(Loss::Cauchy(CAUCHY_SIGMAS * sigma));
        photo::retry(&mut adjustment, sigma, Loss::Cauchy(CAUCHY_SIGMAS * sigma));
    }
    let outliers = outliers(&adjustment, &used, sigma);
    if 4 * outliers.len() > used.len() {
        return Err(LayoutError::DoNotFit { outliers: outliers.len(), sightings: used.len() });
    }
    if !outliers.is_empty() {
        let is_good: Vec<bool> = (0..sightings.len()).map(|index| !outliers.contains(&index)).collect();
        used = usable::sightings(sightings, &is_good);
        adjustment = adjustment.with_sightings(sightings, &used);
    }
    adjustment.refine(Loss::Squares);
    finish(nominal_m, sightings, &used, adjustment, outliers)
}

/// Every photo posed by the nominal layout; those that cannot be are not `used` any more.
fn start(
    nominal_m: &[Vector3<f64>],
    sightings: &[LedSighting],
    used: &mut Vec<usize>,
    distances: &[KnownDistance],
) -> Result<Adjustment, LayoutError> {
    let count = 1 + sightings.iter().map(|sighting| sighting.photo).max().unwrap_or(0);
    let mut of_photo = vec![Vec::new(); count];
    for &index in used.iter() {
        of_photo[sightings[index].photo].push(sightings[index]);
    }
    let pose = |seen: &Vec<LedSighting>| {
        photo::pose(&photo::observations(seen, nominal_m), Loss::Squares).map(|found| found.pose)
    };
    let poses: Vec<Option<Pose>> = of_photo.iter().map(pose).collect();
    used.retain(|&index| poses[sightings[index].photo].is_some());
    let chosen: Vec<LedSighting> = used.iter().map(|&index| sightings[index]).collect();
    usable::check(&chosen, distances)?;
    Ok(Adjustment::new(nominal_m.to_vec(), poses, chosen, distances.to_vec()))
}

/// Sigma of the residuals: that of their median, and of what the unknowns have taken up.
fn sigma_of(adjustment: &Adjustment) -> f64 {
    let measured = (2 * adjustment.sightings().len()) as f64;
    let freedom = usable::freedom(adjustment.sightings(), adjustment.distances()) as f64;
    let sigma = robust::sigma(adjustment.lengths().into_iter()) * (measured / freedom).sqrt();
    sigma.max(LEAST_SIGMA)
}

/// Indices, among all sightings, of those used that deviate too far.
fn outliers(adjustment: &Adjustment, used: &[usize], sigma: f64) -> Vec<usize> {
    let lengths = adjustment.lengths();
    let far = used.iter().zip(lengths).filter(|(_, length)| robust::is_outlier(*length, sigma));
    far.map(|(&index, _)| index).collect()
}

fn finish(
    nominal_m: &[Vector3<f64>],
    sightings: &[LedSighting],
    used: &[usize],
    mut adjustment: Adjustment,
    outliers: Vec<usize>,
) -> Result<Layout, LayoutError> {
    let placed = adjustment.placed();
    usable::check(adjustment.sightings(), adjustment.distances())?;
    let lengths = adjustment.lengths();
    let squared = lengths.iter().map(|length| length * length).sum::<f64>();
    let freedom = usable::freedom(adjustment.sightings(), adjustment.distances());
    let variance = squared / freedom as f64;
    if !variance.is_finite() {
        return Err(LayoutError::DoNotFit { outliers: lengths.len(), sightings: lengths.len() });
    }
    adjustment.weigh_distances(variance.sqrt().max(LEAST_SIGMA));
    adjustment.refine(Loss::Squares);

    let has_scale = !adjustment.distances().is_empty();
    frame::align(&mut adjustment, nominal_m, &placed, has_scale);
    let constraints = frame::constraints(&adjustment, nominal_m, &placed, has_scale);
    let unit = adjustment
        .covariance(&placed, &constraints)
        .ok_or(LayoutError::Undetermined { led: placed[0], sigma_m: f64::INFINITY })?;
    let covariance_m2 = unit * if variance > 0.0 { variance } else { 1.0 };
    error::check_placed(&adjustment, &placed, &covariance_m2)?;

    let mut residuals = vec![None; sightings.len()];
    for (&index, length) in used.iter().zip(adjustment.lengths()) {
        residuals[index] = Some(length);
    }
    let place = |led: usize| placed.binary_search(&led).ok().map(|_| adjustment.leds_m[led]);
    let pose = |pose: &Pose| PhotoPose { body_from_camera: pose.body_from_camera, centre_m: pose.centre_m };
    Ok(Layout {
        positions_m: (0..nominal_m.len()).map(place).collect(),
        covariance_m2,
        photos: adjustment.used_poses().map(|used| used.map(pose)).collect(),
        residuals,
        outliers,
        scatter: variance.sqrt(),
        placed,
    })
}
