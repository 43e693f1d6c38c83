//! Bundle adjustment: lens, board and a pose per photo that bring the LEDs nearest to where the photos show them.
//!
//! Views and a first guess enter, the adjusted [`Scene`] leaves. Residuals are in pixels; the poses are eliminated from the
//! normal equations (Schur complement), so that a step costs what the lens and the board cost. The board's freedom to
//! move, turn and grow together with the poses is taken away by a weak pull of every LED to its nominal place: of all
//! boards that explain the photos equally it takes the one nearest to the drawing.

mod cholesky;
mod loss;
mod normal;
mod pose;
mod step;

use nalgebra::{Isometry3, Vector2, Vector3};
use photinus::solve::descend;

use crate::lens::{Lens, MOST_PARAMETERS};

pub(crate) use cholesky::Cholesky;
pub(crate) use loss::Loss;
pub(crate) use normal::{Normal, hold};
pub(crate) use pose::{fit_pose, pose_cost};

/// Where a photo shows an LED of the board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Which LED: row by row, `row * columns + column`.
    pub led: usize,
    /// Where, (u, v) in px.
    pub pixel: Vector2<f64>,
}

/// The LEDs of the board that one photo shows.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Which photo, by its place in the input.
    pub photo: usize,
    /// Each LED at most once.
    pub observations: Vec<Observation>,
}

/// All that is adjusted.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The lens.
    pub lens: Lens,
    /// Where the LEDs are on the board: x along its columns, y along its rows, z away from the camera, m.
    pub board_m: Vec<Vector3<f64>>,
    /// A pose per view.
    pub camera_from_board: Vec<Isometry3<f64>>,
}

/// What is free in an adjustment, and how residuals count.
#[derive(Clone, Debug)]
pub(crate) struct Task<'a> {
    /// Photos.
    pub(crate) views: &'a [View],
    /// How often each view counts: 0 leaves it out.
    pub(crate) weights: Option<&'a [f64]>,
    /// Which parameters of the lens are free.
    pub(crate) free: [bool; MOST_PARAMETERS],
    /// What holds parameters of the lens near a value.
    pub(crate) pulls: Vec<Pull>,
    /// Nominal places of the LEDs, m, where the board is free.
    pub(crate) board: Option<FreeBoard<'a>>,
    pub(crate) loss: Loss,
    pub(crate) most_steps: u32,
}

/// A board whose LEDs may leave their nominal places.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FreeBoard<'a> {
    pub(crate) nominal_m: &'a [Vector3<f64>],
    /// What a metre off the nominal place costs, px: far less than any observation.
    pub(crate) pull_px_per_m: f64,
}

/// What holds a parameter of the lens near a value, as one more residual does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pull {
    /// Which parameter.
    pub(crate) parameter: usize,
    /// The value.
    pub(crate) to: f64,
    /// What a unit off the value costs, px.
    pub(crate) px_per_unit: f64,
}

/// What an adjustment came to.
#[derive(Clone, Debug)]
pub(crate) struct Adjusted {
    pub(crate) scene: Scene,
    /// Half the sum of squared residuals, as the loss counts them, with the pulls.
    pub(crate) cost: f64,
}

impl Task<'_> {
    pub(crate) fn weight(&self, view: usize) -> f64 {
        self.weights.map_or(1.0, |weights| weights[view])
    }

    /// Unknowns that all photos share: the lens's, then three for each LED of a free board.
    pub(crate) fn shared(&self) -> usize {
        MOST_PARAMETERS + self.board.map_or(0, |board| 3 * board.nominal_m.len())
    }

    /// Adjusts `first`; `None` when it cannot even be evaluated.
    pub(crate) fn adjust(&self, first: &Scene) -> Option<Adjusted> {
        let (scene, cost) = descend(self, first.clone(), self.most_steps)?;
        Some(Adjusted { scene, cost })
    }

    /// The cost of a scene; `None` where a point has no image.
    pub(crate) fn cost(&self, scene: &Scene) -> Option<f64> {
        let mut cost = self.pulled(scene);
        for (index, (view, pose)) in self.views.iter().zip(&scene.camera_from_board).enumerate() {
            let weight = self.weight(index);
            if weight > 0.0 {
                cost += weight * pose_cost(&scene.lens, &scene.board_m, view, pose, self.loss)?;
            }
        }
        cost.is_finite().then_some(cost)
    }

    fn pulled(&self, scene: &Scene) -> f64 {
        let off = |pull: &Pull| pull.px_per_unit * (scene.lens.all_parameters()[pull.parameter] - pull.to);
        let lens: f64 = self.pulls.iter().map(|pull| off(pull) * off(pull)).sum();
        let board = self.board.map_or(0.0, |board| {
            let off: f64 =
                board.nominal_m.iter().zip(&scene.board_m).map(|(a, b)| (a - b).norm_squared()).sum();
            board.pull_px_per_m * board.pull_px_per_m * off
        });
        0.5 * (lens + board)
    }
}

impl Scene {
    /// Residuals (seen minus predicted) of one view, px; not a number where the lens has no answer.
    pub fn residuals_px(&self, view: &View, pose: &Isometry3<f64>) -> Vec<Vector2<f64>> {
        let residual = |seen: &Observation| {
            let point = pose * nalgebra::Point3::from(self.board_m[seen.led]);
            match self.lens.pixel(&point.coords) {
                Some(pixel) => seen.pixel - pixel,
                None => Vector2::repeat(f64::NAN),
            }
        };
        view.observations.iter().map(residual).collect()
    }
}

/// All parameters that a lens has are free.
pub(crate) fn all_of(lens: &Lens) -> [bool; MOST_PARAMETERS] {
    std::array::from_fn(|k| k < lens.model().parameters())
}

#[cfg(test)]
mod tests;
