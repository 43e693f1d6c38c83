//! One view: what the locator tells of it, and what the walk over its model does.

use nalgebra::Vector3;
use photinus::airframe::Airframe;
use photinus::locator::Locator;
use rand_pcg::Pcg64;

use crate::chain;
use crate::compare::{Difference, Part};
use crate::view::View;

/// Samples and modes of one view.
pub(crate) struct Experiment {
    pub(crate) truth_m: Vector3<f64>,
    /// The main parts.
    pub(crate) samples: Vec<Part>,
    pub(crate) modes: Vec<Part>,
    /// What weight the rest has, of the samples and of the modes.
    pub(crate) rest: [f64; 2],
}

/// Level directions along and across the line of sight.
#[derive(Clone, Copy)]
pub(crate) struct Plane {
    pub(crate) ahead: Vector3<f64>,
    pub(crate) across: Vector3<f64>,
}

impl Experiment {
    /// A random view from a distance that shows two markers, and so many steps of the walk.
    pub(crate) fn run(
        airframe: &Airframe,
        locator: &mut Locator,
        distance_m: f64,
        steps: usize,
        rng: &mut Pcg64,
    ) -> Self {
        let view = View::draw(airframe, distance_m, rng);
        let located = view.locate(locator);
        let walked = chain::walk(&view.model(airframe, located), steps, rng);
        let told = &located.neighbours[0].modes;
        let main_m = told[0].pose.position_m.norm();
        let [samples, modes] = [
            walked.iter().map(Part::of_sample).collect::<Vec<_>>(),
            told.iter().map(Part::of_mode).collect(),
        ];
        let (samples, far_samples): (Vec<_>, Vec<_>) =
            samples.into_iter().partition(|part| part.is_main(main_m));
        let (modes, far_modes): (Vec<_>, Vec<_>) = modes.into_iter().partition(|part| part.is_main(main_m));
        let rest =
            [far_samples.len() as f64 / walked.len() as f64, far_modes.iter().map(|mode| mode.weight).sum()];
        Self { truth_m: view.position_m(), samples, modes, rest }
    }

    pub(crate) fn plane(&self) -> Plane {
        let ahead = Vector3::new(self.truth_m.x, 0.0, self.truth_m.z).normalize();
        Plane { ahead, across: Vector3::y().cross(&ahead) }
    }

    pub(crate) fn difference(&self, direction: &Vector3<f64>) -> Difference {
        Difference::along(direction, &self.samples, &self.modes)
    }
}
