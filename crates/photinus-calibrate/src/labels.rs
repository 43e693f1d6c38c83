//! Which way round each photo holds the grid.
//!
//! A perfect grid looks the same turned by half; a real one does not. What is left of each photo after a flat adjustment,
//! taken back to the board, is a picture of where the LEDs really are: photos that hold the grid the same way
//! round agree in it, those that hold it the other way agree after a turn.

use nalgebra::{Isometry3, Matrix2, UnitQuaternion, Vector2, Vector3};

use crate::adjust::{Observation, Scene, View};
use crate::grid::Grid;

/// How the photos agree.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    /// Which turn of the grid each view's labels need.
    pub turns: Vec<usize>,
    /// Mean correlation of each view's picture of the board with that of the others, 1 to -1.
    pub correlation: f64,
    /// The correlation that pictures of pure noise reach by the best choice of turns.
    pub chance: f64,
}

/// A view's picture of the board: the LEDs' offsets in its plane, 0 where unseen.
type Picture = Vec<Option<Vector2<f64>>>;

/// Finds the turn of each view relative to the first that agrees with most others.
pub(crate) fn agreement(views: &[View], scene: &Scene, grid: &Grid) -> Agreement {
    let pictures: Vec<Picture> = views
        .iter()
        .zip(&scene.camera_from_board)
        .map(|(view, pose)| picture(view, pose, scene, grid))
        .collect();
    let turned: Vec<Vec<Picture>> = pictures
        .iter()
        .map(|picture| (0..grid.turns()).map(|turn| turn_picture(picture, grid, turn)).collect())
        .collect();
    let best = (0..views.len())
        .map(|reference| settle(&turned, reference))
        .max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
    let (turns, correlation) = best.unwrap_or((Vec::new(), 0.0));
    let freedom = (views.len() * 2 * grid.leds()) as f64;
    // the best of random signs over M views of 2 L numbers each: sqrt(M / (2 L)) / M per pair, with room for luck
    let chance = 2.0 * (views.len() as f64 / freedom).sqrt();
    Agreement { turns, correlation, chance }
}

/// Turns that agree with each other, starting from the picture of `reference`.
fn settle(turned: &[Vec<Picture>], reference: usize) -> (Vec<usize>, f64) {
    let mut turns: Vec<usize> = turned.iter().map(|of| best_turn(of, &turned[reference][0])).collect();
    for _ in 0..20 {
        let mut next = turns.clone();
        for (view, of) in turned.iter().enumerate() {
            let rest = mean(turned, &next, view);
            next[view] = best_turn(of, &rest);
        }
        if next == turns {
            break;
        }
        turns = next;
    }
    let agreed =
        (0..turned.len()).map(|view| correlation(&turned[view][turns[view]], &mean(turned, &turns, view)));
    let correlation = agreed.sum::<f64>() / turned.len().max(1) as f64;
    (turns, correlation)
}

fn best_turn(of: &[Picture], rest: &Picture) -> usize {
    let score = |turn: usize| correlation(&of[turn], rest);
    (0..of.len()).max_by(|&a, &b| score(a).total_cmp(&score(b)).then(b.cmp(&a))).unwrap_or(0)
}

/// The mean picture of all views but one.
fn mean(turned: &[Vec<Picture>], turns: &[usize], without: usize) -> Picture {
    let leds = turned.first().map_or(0, |of| of[0].len());
    let of_led = |led: usize| {
        let (mut sum, mut count) = (Vector2::zeros(), 0.0);
        for (view, of) in turned.iter().enumerate().filter(|(view, _)| *view != without) {
            if let Some(offset) = of[turns[view]][led] {
                sum += offset;
                count += 1.0;
            }
        }
        (count > 0.0).then(|| sum / count)
    };
    (0..leds).map(of_led).collect()
}

fn correlation(a: &Picture, b: &Picture) -> f64 {
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        if let (Some(x), Some(y)) = (x, y) {
            ab += x.dot(y);
            aa += x.norm_squared();
            bb += y.norm_squared();
        }
    }
    if aa > 0.0 && bb > 0.0 { ab / (aa * bb).sqrt() } else { 0.0 }
}

/// The picture after turning the grid: offsets move to other LEDs and turn with the board.
fn turn_picture(picture: &Picture, grid: &Grid, turn: usize) -> Picture {
    let mut turned = vec![None; picture.len()];
    let rotation = turn_matrix(grid, turn);
    for (led, offset) in picture.iter().enumerate() {
        turned[grid.turned(led, turn)] = offset.map(|offset| rotation * offset);
    }
    turned
}

/// The turn of the board's axes.
fn turn_matrix(grid: &Grid, turn: usize) -> Matrix2<f64> {
    let quarters = if grid.turns() == 4 { turn % 4 } else { 2 * (turn % 2) };
    let mut matrix = Matrix2::identity();
    for _ in 0..quarters {
        matrix = Matrix2::new(0.0, -1.0, 1.0, 0.0) * matrix;
    }
    matrix
}

/// Residuals of one view, taken back to the plane of the board.
fn picture(view: &View, pose: &Isometry3<f64>, scene: &Scene, grid: &Grid) -> Picture {
    let mut picture = vec![None; grid.leds()];
    for (seen, residual) in view.observations.iter().zip(scene.residuals_px(view, pose)) {
        let point = pose * nalgebra::Point3::from(scene.board_m[seen.led]);
        let Some(projection) = scene.lens.project(&point.coords) else { continue };
        let by_board = projection.by_point * pose.rotation.to_rotation_matrix().matrix();
        let flat: Matrix2<f64> = by_board.fixed_columns::<2>(0).into_owned();
        picture[seen.led] = flat.try_inverse().map(|inverse| inverse * residual);
    }
    picture
}

/// A view with its labels turned, and the pose that goes with them.
pub(crate) fn turn_view(
    view: &View,
    pose: &Isometry3<f64>,
    grid: &Grid,
    turn: usize,
) -> (View, Isometry3<f64>) {
    let observations = view
        .observations
        .iter()
        .map(|seen| Observation { led: grid.turned(seen.led, turn), pixel: seen.pixel });
    let matrix = turn_matrix(grid, turn);
    let angle = libm::atan2(matrix.m21, matrix.m11);
    let board_turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -angle);
    let turned = Isometry3::from_parts(pose.translation, pose.rotation * board_turn);
    (View { photo: view.photo, observations: observations.collect() }, turned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_labels_and_pose_together_changes_nothing() {
        for grid in [Grid::new(7, 5, 0.05).unwrap(), Grid::new(4, 4, 0.1).unwrap()] {
            let nominal = grid.nominal_m();
            let pose = Isometry3::new(Vector3::new(0.1, 0.2, 1.0), Vector3::new(0.3, -0.2, 0.5));
            let observations = (0..grid.leds())
                .map(|led| Observation {
                    led,
                    pixel: (pose * nalgebra::Point3::from(nominal[led])).coords.xy(),
                })
                .collect();
            let view = View { photo: 3, observations };
            for turn in 0..grid.turns() {
                let (turned, pose) = turn_view(&view, &pose, &grid, turn);
                for seen in &turned.observations {
                    let place = (pose * nalgebra::Point3::from(nominal[seen.led])).coords.xy();
                    assert!((place - seen.pixel).norm() < 1e-12, "{turn}");
                }
            }
        }
    }
}
