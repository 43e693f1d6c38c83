//! How far the light of LEDs is from what their airframe says, as those that are seen tell.
//!
//! In: the best mode of a neighbour. Out: [`LightSpread`], to be added up over neighbours and frames.

use super::known::Known;
use super::light::{AS_TOLD, Light};
use super::problem::{Normal, Problem};
use super::refine::Refined;

/// What neighbours tell of how much more the light of their LEDs spreads than is supposed: squares over degrees of freedom, as in [`crate::pose::Tilting`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightSpread {
    /// Degrees of freedom: lights less what of them tells the power of all and the pose.
    pub degrees: f64,
    /// Sum of squares, 1 being the variance that is supposed.
    pub squares: f64,
}

impl Problem<'_> {
    /// What a mode tells; nothing where no light does.
    pub(super) fn light_spread(&self, mode: &Refined) -> LightSpread {
        let lit = self.lit();
        let Some(factor) =
            mode.normal.information.cholesky().filter(|_| self.settings.use_brightness && lit > 1)
        else {
            return LightSpread::default();
        };
        // The light of one vehicle against another's tells of vehicles, not of LEDs.
        let known = Known { power: None, ..*self.known };
        let light = Light::of(&Problem { known: &known, ..*self }, &mode.pose);
        let mut told = Normal::zero();
        light.add_to(&mut told);
        told.finish();
        let of_pose = factor.solve(&told.information).trace();
        let times = self.unit_sigma() / self.settings.unit_sigma;
        LightSpread {
            degrees: (light.independent(lit) - 1.0 - of_pose).max(0.0),
            // Misfit that counts by its logarithm has this slope, however much it is: a light that is no marker's tells no more.
            squares: times * times * light.misfit().min(AS_TOLD),
        }
    }
}
