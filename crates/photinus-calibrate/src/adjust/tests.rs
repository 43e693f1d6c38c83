use nalgebra::{DVector, Isometry3, Point3, Vector3};

use super::*;
use crate::grid::Grid;
use crate::lens::{CENTRE, LensModel};

/// A scene, its views, and the first guess of a scene that is off.
fn scene() -> (Grid, Scene, Vec<View>) {
    let grid = Grid::new(5, 4, 0.05).unwrap();
    let model = LensModel::kannala_brandt(1).unwrap();
    let lens = Lens::equidistant(250.0, 260.0, [376.0, 240.0]).in_model(model, 1.0);
    let mut board_m = grid.nominal_m();
    for (led, place) in board_m.iter_mut().enumerate() {
        *place += 0.0004
            * Vector3::new(libm::sin(led as f64), libm::cos(2.0 * led as f64), libm::sin(3.0 * led as f64));
    }
    let camera_from_board: Vec<_> = (0..8)
        .map(|i| {
            let (sin, cos) = libm::sincos(f64::from(i));
            Isometry3::new(
                Vector3::new(0.4 * sin, 0.2 * cos, 0.5),
                Vector3::new(0.4 * cos, 0.5 * sin, f64::from(i)),
            )
        })
        .collect();
    let views = camera_from_board
        .iter()
        .enumerate()
        .map(|(photo, pose)| {
            let pixel = |led: usize| lens.pixel(&(pose * Point3::from(board_m[led])).coords).unwrap();
            let observations = (0..grid.leds()).map(|led| Observation { led, pixel: pixel(led) }).collect();
            View { photo, observations }
        })
        .collect();
    (grid, Scene { lens, board_m, camera_from_board }, views)
}

fn task<'a>(views: &'a [View], scene: &Scene, nominal_m: &'a [Vector3<f64>]) -> Task<'a> {
    Task {
        views,
        weights: None,
        free: all_of(&scene.lens),
        pulls: vec![Pull { parameter: CENTRE, to: 377.0, px_per_unit: 0.02 }],
        board: Some(FreeBoard { nominal_m, pull_px_per_m: 20.0 }),
        loss: Loss::Cauchy(0.7),
        most_steps: 60,
    }
}

/// What the derivative of the cost by a shared unknown is, is what the normal equations say it is.
#[test]
fn the_gradient_is_that_of_finite_differences() {
    let (grid, mut scene, views) = scene();
    let nominal_m = grid.nominal_m();
    for (index, pose) in scene.camera_from_board.iter_mut().enumerate() {
        pose.translation.vector.x += 0.001 * index as f64;
    }
    let task = task(&views, &scene, &nominal_m);
    let normal = Normal::of(&task, &scene).unwrap();
    let step = 1e-6;
    for k in [CENTRE, CENTRE + 1, 2, 3, 4, 5, MOST_PARAMETERS, MOST_PARAMETERS + 7, MOST_PARAMETERS + 20] {
        let cost = |sign: f64| {
            let mut moved = scene.clone();
            if k < MOST_PARAMETERS {
                let mut parameters = *scene.lens.all_parameters();
                parameters[k] += sign * step;
                moved.lens = scene.lens.with_parameters(parameters);
            } else {
                let at = k - MOST_PARAMETERS;
                moved.board_m[at / 3][at % 3] += sign * step;
            }
            task.cost(&moved).unwrap()
        };
        let expected = -(cost(1.0) - cost(-1.0)) / (2.0 * step);
        let found = normal.gradient[k];
        assert!((found - expected).abs() < 1e-4 * (1.0 + expected.abs()), "{k}: {found} {expected}");
    }
}

#[test]
fn a_disturbed_scene_comes_back_with_the_board_as_far_as_it_can_be_known() {
    let (grid, truth, views) = scene();
    let nominal_m = grid.nominal_m();
    let mut first = truth.clone();
    let mut parameters = *first.lens.all_parameters();
    parameters[CENTRE] += 3.0;
    parameters[4] *= 1.03;
    first.lens = first.lens.with_parameters(parameters);
    first.board_m.clone_from(&nominal_m);
    let task = Task {
        pulls: Vec::new(),
        board: Some(FreeBoard { nominal_m: &nominal_m, pull_px_per_m: 1.0 }),
        ..task(&views, &truth, &nominal_m)
    };
    let found = task.adjust(&first).unwrap();
    assert!(found.cost < 1e-5, "{}", found.cost);
    for angle in [0.1, 0.5, 0.9] {
        let off = found.scene.lens.radius_px(angle).unwrap() - truth.lens.radius_px(angle).unwrap();
        assert!(off.abs() < 0.01, "{angle}: {off}");
    }
    // the board neither moved, nor turned, nor grew against the drawing
    let (mut moved, mut turned, mut grown) = (Vector3::zeros(), Vector3::zeros(), 0.0);
    for (nominal, place) in nominal_m.iter().zip(&found.scene.board_m) {
        moved += place - nominal;
        turned += nominal.cross(&(place - nominal));
        grown += place.dot(&(place - nominal));
    }
    assert!(moved.norm() < 1e-5 && turned.norm() < 1e-6 && grown.abs() < 1e-6, "{moved} {turned} {grown}");
}

#[test]
fn a_view_that_does_not_count_changes_nothing() {
    let (grid, truth, mut views) = scene();
    let nominal_m = grid.nominal_m();
    for seen in &mut views[2].observations {
        seen.pixel.x += 50.0;
    }
    let weights: Vec<f64> = (0..views.len()).map(|view| if view == 2 { 0.0 } else { 1.0 }).collect();
    let task = Task { weights: Some(&weights), pulls: Vec::new(), ..task(&views, &truth, &nominal_m) };
    let normal = Normal::of(&task, &truth).unwrap();
    assert_eq!(normal.photos().count(), views.len() - 1);
    let steps = normal.pose_steps(0.0, &DVector::zeros(task.shared())).unwrap();
    assert!(steps[2].norm() < 1e-300);
}

#[test]
fn one_view_alone_finds_its_pose() {
    let (_, truth, views) = scene();
    let mut near = truth.camera_from_board[1];
    near.translation.vector += Vector3::new(0.05, -0.02, 0.04);
    let (pose, cost) = fit_pose(&truth.lens, &truth.board_m, &views[1], &near, Loss::SoftL1(3.0)).unwrap();
    assert!(
        cost < 1e-12
            && (pose.translation.vector - truth.camera_from_board[1].translation.vector).norm() < 1e-8
    );
}
