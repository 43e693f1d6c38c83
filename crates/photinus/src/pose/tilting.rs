//! How far neighbours tilt, as those that are seen tell.
//!
//! In: the best mode of a neighbour. Out: [`Tilting`], to be added up over neighbours and frames.

use super::problem::Problem;
use super::refine::Refined;

/// What neighbours tell of the variance of tilts: squares over degrees of freedom.
///
/// Of a residual of unit variance r that has f degrees of freedom left once the pose is fitted, the likelihood's logarithm has the slope (r^2 - f) / 2 by
/// the logarithm of the variance, and the bend -f / 2 on average: a step of Fisher's scoring takes the variance times r^2 / f.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tilting {
    /// Degrees of freedom, up to two for each neighbour.
    pub degrees: f64,
    /// Sum of squares, rad^2.
    pub squares_rad2: f64,
}

impl Problem<'_> {
    /// What a mode tells; nothing where gravity is not known.
    pub(super) fn tilting(&self, mode: &Refined) -> Tilting {
        let mut all = Tilting::default();
        let (Some(tilted), Some(factor)) = (self.tilted(&mode.pose), mode.normal.information.cholesky())
        else {
            return all;
        };
        let sigma_rad = self.tilt_sigma_rad();
        for (residual, row) in tilted {
            all.degrees += (1.0 - row.dot(&factor.solve(&row))).max(0.0);
            all.squares_rad2 += (sigma_rad * residual) * (sigma_rad * residual);
        }
        all
    }
}
