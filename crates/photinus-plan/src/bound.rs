//! The spots of a neighbour -> the least error of what is told of it.
//!
//! The information about a pose is the core's own (`photinus::pose`), taken where the neighbour truly is: directions with the variance of
//! their spots and of the markers' places, light with that of LEDs and lobes, tilt with its prior, every yaw as likely. Instead of what a
//! detector measured enter the least variances that [`crate::spot`] allows. The scale of airframe and lens, which no picture tells, is added.

use nalgebra::{Matrix2, Unit, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::Bearing;
use photinus::pose::{
    Estimator, Hypotheses, Known, LogLight, Observation, Posterior, Settings, Summary, Visible,
};
use photinus::ranging::Interval;

use crate::setup::Setup;
use crate::spot::SpotTable;
use crate::view::{Lit, RESOLUTION_PX, View};

/// The light of LEDs at 1 m is known to this from frames before, sigma of its logarithm (`photinus::locator`).
const LOG_POWER_SIGMA: f64 = 0.35;

/// LEDs are no more alike than this, sigma of the logarithm of their light: the core's own limit.
const LEAST_SPREAD: f64 = 1e-3;

/// The least errors, standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Of the distance, m.
    pub distance_m: f64,
    /// Of the direction, per axis, rad.
    pub bearing_rad: f64,
    /// Of the yaw, modulo the airframe's symmetry, rad.
    pub yaw_rad: f64,
}

/// Bounds for one airframe.
#[derive(Debug)]
pub struct Bound<'a> {
    setup: &'a Setup,
    estimator: Estimator,
    hypotheses: Hypotheses,
    /// Light at which a marker is found half of the time, in units of an LED of intensity 1 at 1 m.
    detection_limit: LogLight,
}

impl<'a> Bound<'a> {
    /// Bounds for an airframe in front of a set-up's camera.
    pub fn new(setup: &'a Setup, table: &SpotTable, airframe: &Airframe) -> Self {
        // what the core believes of neighbours, but that the spread of LEDs is known of the part
        let mut settings = Settings::default();
        settings.unit_sigma = setup.emitter.unit_spread.max(LEAST_SPREAD);
        let estimator = Estimator::new(airframe, settings).expect("settings within their ranges");
        let hypotheses = Hypotheses::with_room(airframe.markers().len());
        let [half, most] = [0.5, 0.84].map(|share| libm::log(table.found_e(share)));
        let detection_limit =
            LogLight { value: half - libm::log(setup.electrons(1.0, 1.0, 0.0)), sigma: most - half };
        Self { setup, estimator, hypotheses, detection_limit }
    }

    /// Turns about the vertical that nothing tells apart.
    pub fn turns(&self) -> usize {
        self.estimator.symmetry().turns()
    }

    /// The least errors of a neighbour of which these spots are found; `None` for fewer than two.
    pub(crate) fn errors(&mut self, view: &View, seen: &[Lit]) -> Option<Errors> {
        if seen.len() < 2 {
            return None;
        }
        let observations = seen.iter().map(|lit| self.observe(lit)).collect::<Option<Vec<_>>>()?;
        let markers: Vec<Option<u16>> = seen.iter().map(|lit| u16::try_from(lit.marker).ok()).collect();
        self.hypotheses.begin(seen.len());
        self.hypotheses.offer(&markers, 0.0, 0, || view.pose);
        let distance_m = view.pose.position_m.norm();
        let known = Known {
            up: Some(Unit::new_unchecked(-Vector3::y())),
            bounds: Interval::new(0.1 * distance_m, 10.0 * distance_m)?,
            size: None,
            power: Some(LogLight { value: 0.0, sigma: LOG_POWER_SIGMA }),
            tilt_sigma_rad: None,
            unit_sigma: None,
            visible: Visible { detection_limit: Some(self.detection_limit), ..Visible::default() },
        };
        let Posterior { summary, .. } = self.estimator.estimate(&observations, &mut self.hypotheses, &known);
        let Summary { position_covariance_m2, orientation_covariance_rad2, .. } = (*summary)?;
        let ahead = view.pose.position_m / distance_m;
        let along_m2 = ahead.dot(&(position_covariance_m2 * ahead));
        let across_m2 = 0.5 * (position_covariance_m2.trace() - along_m2);
        let scale_m = Settings::default().scale_sigma * distance_m;
        Some(Errors {
            distance_m: (along_m2 + scale_m * scale_m).sqrt(),
            bearing_rad: across_m2.max(0.0).sqrt() / distance_m,
            yaw_rad: orientation_covariance_rad2[(2, 2)].max(0.0).sqrt(),
        })
    }

    /// A spot where its marker is, as exactly as can be.
    fn observe(&self, lit: &Lit) -> Option<Observation> {
        let camera = &self.setup.camera;
        let covariance_px2 = Matrix2::identity() * lit.spot.variance_px2;
        // in units of an LED of intensity 1 at 1 m, wherever in the image it is
        let off_axis_rad = Bearing::new(lit.centre_m)?.off_axis_rad();
        let value = libm::log(lit.electrons / self.setup.electrons(1.0, 1.0, off_axis_rad));
        Some(Observation {
            bearing: Bearing::new(lit.centre_m)?,
            covariance_rad2: camera.tangent_covariance(lit.place, &covariance_px2)?,
            log_light: Some(LogLight { value, sigma: lit.spot.log_light_sigma }),
            resolution_rad: RESOLUTION_PX * camera.rad_per_px(lit.place)?,
            signal: None,
            clutter_log_density: 0.0,
        })
    }
}
