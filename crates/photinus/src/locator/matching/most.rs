//! The most that a handful can be worth as one neighbour, from the angles between its spots and how sure they are: nothing is compared with views.
//!
//! The first two spots, the farthest apart of all, are anywhere even over the logarithm of their distance and within the tilt of where the markers are:
//! together a density of no more than 1 / gap^2 times the peak of the tilt's. Every further spot has no more than the peak of its own density, as has every
//! light but the first. Each order of as many markers as can show may add as much.

use alloc::vec::Vec;
use core::f64::consts::TAU;

use crate::locator::Sighting;
use crate::locator::context::Context;
use crate::locator::matching::ordered::GRID_ERROR;
use crate::locator::posing::LOG_RANGE;
use crate::normal::ROOT_OF_TAU;
use crate::pose::{self, LogLight, POWER_RANGE};

/// Without gravity the image tells upright as a sine of this sigma, as [`crate::pose`] has it.
const IMAGE_TILT_SIGMA: f64 = 1.0;

/// First looks agree with each other and with full ones to within this, nats, the grid of views being coarse: of 4,028 groups of crowds and of clutter that
/// a full look had for likelier than 10 nats below clutter none was taken for more than 4.7 nats less likely by a look in any light.
pub(super) const GRID_NATS: f64 = 5.0;

/// What the densities of spots of one kind cannot exceed.
#[derive(Clone, Debug)]
pub(super) struct Most {
    /// By number of spots: the logarithm of how many orders of as many markers show.
    log_orders: Vec<f64>,
    /// Logarithm of the width of the tilt's distribution with gravity, and of upright's in the image without it.
    log_tilt: [f64; 2],
    /// Logarithm of the range of the logarithm of distance.
    log_of_range: f64,
    /// Variance of a light for its LED alone.
    unit_variance: f64,
    /// Logarithm of the peak density of a light in a first look.
    light_of_look: f64,
    /// What it costs at most that a marker that shows is not seen, nats.
    unseen_nats: f64,
    /// Standard deviation of a marker's place over how far the outermost can be apart.
    marker_share: f64,
}

/// Logarithms of the largest densities of a spot's direction and of its light, or of those of several spots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Peak {
    direction: f64,
    light: f64,
    /// Whether it has one, or all of them.
    is_lit: bool,
}

impl Peak {
    /// Of no spot.
    pub(super) const NONE: Self =
        Self { direction: f64::NEG_INFINITY, light: f64::NEG_INFINITY, is_lit: true };

    /// The higher one of each.
    pub(super) fn max(self, other: Self) -> Self {
        Self {
            direction: self.direction.max(other.direction),
            light: self.light.max(other.light),
            is_lit: self.is_lit && other.is_lit,
        }
    }
}

impl Most {
    /// For an airframe of this reach of which so many markers show at most.
    pub(super) fn new(
        (most_visible, reach_m): (usize, f64),
        believed: &pose::Settings,
        log_flux_sigma: f64,
        unseen_nats: f64,
    ) -> Self {
        let log_orders =
            |spots: usize| (0..spots).map(|taken| libm::log((most_visible - taken) as f64)).sum();
        Self {
            log_orders: (0..=most_visible).map(log_orders).collect(),
            log_tilt: [believed.tilt_sigma_rad, IMAGE_TILT_SIGMA].map(|sigma| libm::log(ROOT_OF_TAU * sigma)),
            log_of_range: libm::log(LOG_RANGE),
            unit_variance: believed.unit_sigma * believed.unit_sigma,
            light_of_look: -0.5 * libm::log(TAU * (log_flux_sigma * log_flux_sigma)),
            unseen_nats,
            marker_share: believed.marker_sigma_m / (2.0 * reach_m),
        }
    }

    /// The peaks of a spot of a handful that is at least so wide, rad.
    pub(super) fn peak(&self, sighting: &Sighting, width_rad: f64) -> Peak {
        let covariance = &sighting.spot_covariance_rad2;
        let (sum, squares) = (covariance.trace(), covariance.norm_squared());
        let product = (0.5 * (sum * sum - squares)).max(0.0);
        // From so near that it is seen that wide.
        let marker_rad = self.marker_share * width_rad / (1.0 + 0.5 * width_rad);
        let marker_rad2 = marker_rad * marker_rad + 1e-12;
        let area_rad4 = product + sum * marker_rad2 + marker_rad2 * marker_rad2;
        let light = sighting.log_light.map_or(0.0, |LogLight { sigma, .. }| {
            -0.5 * libm::log(TAU * (sigma * sigma + self.unit_variance))
        });
        Peak {
            direction: -0.5 * libm::log(TAU * TAU * area_rad4),
            light,
            is_lit: sighting.log_light.is_some(),
        }
    }

    /// The peaks that a spot of a handful as wide as this has in a first look, where the grid of views is as coarse as it is.
    pub(super) fn peak_of_look(&self, widest2_rad2: f64, is_lit: bool) -> Peak {
        // The two spots farthest apart make half of its squared size, at least.
        let variance_rad2 = GRID_ERROR * GRID_ERROR * 0.5 * widest2_rad2 + 1e-12;
        let light = self.light_of_look;
        Peak {
            direction: -libm::log(TAU * variance_rad2),
            light: if is_lit { light } else { light.max(0.0) },
            is_lit,
        }
    }

    /// How much a further spot can add to a first look at others of a handful: the density of its own, and that it is seen.
    pub(super) fn further(&self, peak: Peak) -> f64 {
        peak.direction + peak.light + self.unseen_nats + GRID_NATS
    }

    /// The most that the density of so many spots, at least two, can be that have no higher peaks, the farthest apart at this squared gap.
    pub(super) fn log_density(
        &self,
        context: &Context<'_>,
        spots: usize,
        widest2_rad2: f64,
        peak: Peak,
    ) -> f64 {
        let Some(log_orders) = self.log_orders.get(spots) else { return f64::NEG_INFINITY };
        let [of_gravity, of_image] = self.log_tilt;
        let log_tilt = if context.gravity.is_some() { of_gravity } else { of_image };
        let first_light = first_light(context);
        let first_light = if peak.is_lit { first_light } else { first_light.max(0.0) };
        let further = spots as f64 - 2.0;
        log_orders - libm::log(widest2_rad2) - log_tilt
            + further * peak.direction
            + first_light
            + (further + 1.0) * peak.light
            - self.log_of_range
    }

    /// The most that the density of the lights of a group can be.
    pub(super) fn log_light(&self, context: &Context<'_>, group: &[usize]) -> f64 {
        match group.iter().filter(|&&spot| context.sightings[spot].log_light.is_some()).count() {
            0 => 0.0,
            lit => first_light(context) - 0.5 * (lit - 1) as f64 * libm::log(TAU * self.unit_variance),
        }
    }
}

/// The most that the first light can be, which tells the power of the LEDs where that is not known.
pub(super) fn first_light(context: &Context<'_>) -> f64 {
    match context.power {
        Some(LogLight { sigma, .. }) => -libm::log(ROOT_OF_TAU * sigma),
        None => -libm::log(POWER_RANGE),
    }
}
