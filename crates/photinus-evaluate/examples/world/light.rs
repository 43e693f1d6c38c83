//! Measured light against the light that fell -> squared error over the claim, by what a spot looks like.
//!
//! A frame tells light up to a factor that all of its spots share; the factor of a row is the median of all its spots, each
//! counted by one over its claimed sigma.

use nalgebra::{Isometry3, Point3, Translation3};
use photinus::camera::Bearing;
use photinus::locator::Sighting;
use photinus_evaluate::SpotClass;
use photinus_io::dataset::TruthFrame;
use photinus_io::results::SpotRecord;
use photinus_sim::Snapshot;
use photinus_sim::optics::Lens;

use crate::priors::world_from_camera;

/// A spot is of an LED that is no further away, px.
const GATE_PX: f64 = 3.0;
/// LEDs no further apart are one source of light; further, up to the next, they disturb each other, px.
const SAME_PX: f64 = 0.05;
const MELTED_PX: f64 = 4.0;

/// An LED in the image: where, and its light in units of nobody's.
pub(crate) struct Fallen {
    u_px: f64,
    v_px: f64,
    light: f64,
}

/// The light of every LED that shone into the image.
pub(crate) fn fallen(snapshot: &Snapshot, truth: &TruthFrame, lens: &Lens) -> Vec<Fallen> {
    let world_from_camera = Isometry3::from_parts(Translation3::identity(), world_from_camera().into());
    let mut all = Vec::new();
    for (vehicle, neighbour) in snapshot.vehicles.iter().zip(&truth.neighbours) {
        let body_from_camera = vehicle.motion.pose(0.5).inverse() * world_from_camera;
        let camera_m = body_from_camera.translation.vector;
        for seen in &neighbour.leds {
            let Some(number) = seen.led.map(|led| led as usize) else { continue };
            let led = &vehicle.airframe.leds()[number];
            let there = body_from_camera.inverse() * Point3::from(led.position_m);
            let Some(bearing) = Bearing::new(there.coords) else { continue };
            let source = &vehicle.leds[number];
            let power = source.power * source.lit.share(0.0, snapshot.exposure.length_s);
            let gathered = lens.gathered_w(led.intensity(&camera_m), bearing.off_axis_rad());
            let light = power * gathered / there.coords.norm_squared();
            all.push(Fallen { u_px: seen.u_px, v_px: seen.v_px, light });
        }
    }
    all
}

/// Errors of light of a row.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lights(Vec<(SpotClass, f64, f64)>);

impl Lights {
    /// Adds the spots of a frame that are of one source of light alone.
    pub(crate) fn add(&mut self, sightings: &[Sighting], spots: &[SpotRecord], fallen: &[Fallen]) {
        for (index, sighting) in sightings.iter().enumerate() {
            let centre = sighting.spot.centre;
            let gap = |led: &Fallen, u_px: f64, v_px: f64| libm::hypot(led.u_px - u_px, led.v_px - v_px);
            let to_spot = |led: &&Fallen| gap(led, centre.u, centre.v);
            let Some(own) = fallen.iter().min_by(|a, b| to_spot(a).total_cmp(&to_spot(b))) else { continue };
            let apart = |led: &Fallen| gap(led, own.u_px, own.v_px);
            let is_merged = fallen.iter().any(|led| (SAME_PX..MELTED_PX).contains(&apart(led)));
            let light: f64 = fallen.iter().filter(|led| apart(led) < SAME_PX).map(|led| led.light).sum();
            if let Some(measured) = sighting.log_light.filter(|_| to_spot(&own) < GATE_PX && !is_merged) {
                let off = measured.value - libm::log(light);
                self.0.push((SpotClass::of(index, spots), off, measured.sigma));
            }
        }
    }

    /// Mean squared error over the claimed variance of a class, 1 where claims are right.
    pub(crate) fn of(&self, class: SpotClass) -> Option<f64> {
        let factor = self.factor()?;
        let squares: Vec<f64> = self
            .0
            .iter()
            .filter(|(of, ..)| *of == class)
            .map(|(_, off, sigma)| ((off - factor) / sigma) * ((off - factor) / sigma))
            .collect();
        (!squares.is_empty()).then(|| squares.iter().sum::<f64>() / squares.len() as f64)
    }

    /// The factor that all spots share, its logarithm.
    fn factor(&self) -> Option<f64> {
        let mut offs: Vec<(f64, f64)> = self.0.iter().map(|(_, off, sigma)| (*off, 1.0 / sigma)).collect();
        offs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let half = 0.5 * offs.iter().map(|(_, weight)| weight).sum::<f64>();
        let mut sum = 0.0;
        offs.into_iter().find_map(|(off, weight)| {
            sum += weight;
            (sum >= half).then_some(off)
        })
    }
}
