//! An independent implementation ends where this one does: SciPy's least squares and OpenCV's fisheye on the same points.
//! Needs a Python with SciPy, and one with OpenCV 4 or 5: that of the environment variable PHOTINUS_PYTHON, else `python3`.

#![allow(clippy::print_stdout, reason = "the measured numbers are worth reading")]

use std::io::Write;
use std::process::{Command, Stdio};

use crate::simulation::{Dice, SIZE_PX, lens, pose, seen};
use nalgebra::Point3;
use photinus::camera::Model;
use photinus_calibrate::adjust::View;
use photinus_calibrate::camera::{BoardChoice, Calibration, Choices, calibrate};
use photinus_calibrate::grid::Grid;
use photinus_testing::python_with;

/// Photos of an exact board.
fn photos(grid: &Grid) -> Vec<View> {
    let (mut dice, camera, board_m) = (Dice::new(5), lens(), grid.nominal_m());
    let mut views = Vec::new();
    while views.len() < 8 {
        let pose = pose(&mut dice, 0.7, 0.6);
        let Some(pixels) = seen(&camera, &board_m, &pose) else { continue };
        let observations = pixels.into_iter().enumerate().map(|(led, pixel)| {
            let pixel = pixel + nalgebra::Vector2::from_fn(|_, _| dice.normal(0.02));
            photinus_calibrate::adjust::Observation { led, pixel }
        });
        views.push(View { photo: views.len(), observations: observations.collect() });
    }
    views
}

/// The camera that Photinus makes of photos of an exact board, and the same points for another implementation, as JSON.
fn calibrated() -> (Calibration, String) {
    let grid = Grid::new(7, 5, 0.05).expect("a grid");
    let views = photos(&grid);
    let choices =
        Choices { models: vec!["kannala-brandt:2".parse().expect("a model")], board: BoardChoice::Flat };
    let ours = calibrate(&views, &grid, SIZE_PX, &choices, |_| ()).expect("a camera");
    let board: Vec<[f64; 3]> = grid.nominal_m().iter().map(|place| (*place).into()).collect();
    let pixels: Vec<Vec<[f64; 2]>> = ours
        .views()
        .iter()
        .map(|view| {
            let at =
                |led: usize| view.observations.iter().find(|seen| seen.led == led).expect("every LED").pixel;
            (0..grid.leds()).map(|led| at(led).into()).collect()
        })
        .collect();
    let poses: Vec<[f64; 6]> = ours
        .poses()
        .iter()
        .map(|pose| {
            let (turn, shift) = (pose.rotation.scaled_axis(), pose * Point3::origin());
            [turn.x, turn.y, turn.z, shift.x, shift.y, shift.z]
        })
        .collect();
    let [fx, fy, u, v, k1, k2] = parameters(&ours);
    let points = format!(
        "{{\"size\":{SIZE_PX:?},\"board\":{board:?},\"photos\":{pixels:?},\"focal\":[{fx},{fy}],\
         \"centre\":[{u},{v}],\"k\":[{k1},{k2}],\"poses\":{poses:?}}}"
    );
    (ours, points)
}

/// Where the parameters stand in a camera's covariance: focal lengths, four coefficients, centre.
const PLACES: [usize; 6] = [0, 1, 6, 7, 2, 3];

/// Focal lengths and centre, px, and the two coefficients.
fn parameters(calibration: &Calibration) -> [f64; 6] {
    let Model::KannalaBrandt(lens) = calibration.camera().model() else { panic!("another model") };
    let ([fx, fy], centre) = (lens.focal_px(), lens.centre());
    [fx, fy, centre.u, centre.v, lens.k()[0], lens.k()[1]]
}

/// What a method of the script makes of the points.
fn by(mut python: Command, method: &str, points: &str) -> Theirs {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/calibrate/independent.py");
    let piped = python.args([script, method]).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = piped.spawn().expect("a Python that ran before");
    // The script reads everything before it writes; what it did not read shows in how it ends.
    let _ = child.stdin.take().expect("a pipe").write_all(points.as_bytes());
    let output = child.wait_with_output().expect("the script ends");
    assert!(output.status.success(), "{script} {method} failed: its words stand above");
    serde_json::from_slice(&output.stdout).expect("the script's JSON")
}

/// What the script says.
#[derive(serde::Deserialize)]
struct Theirs {
    focal: [f64; 2],
    centre: [f64; 2],
    k: [f64; 2],
    rms_px: f64,
}

/// Ours lets go of long residuals, so the optima differ: each parameter by so many sigmas at most, the residual by such a share.
fn agree(ours: &Calibration, theirs: &Theirs, most_sigmas: f64, most_share: f64) {
    let ([fx, fy], [u, v], [k1, k2]) = (theirs.focal, theirs.centre, theirs.k);
    let covariance = ours.camera().parameter_covariance().expect("a covariance");
    let names = ["fx", "fy", "u", "v", "k1", "k2"];
    for (index, (ours, theirs)) in parameters(ours).into_iter().zip([fx, fy, u, v, k1, k2]).enumerate() {
        let place = PLACES[index];
        let off_sigmas = (ours - theirs) / covariance[(place, place)].sqrt();
        println!("{}: {ours} {theirs}, {off_sigmas:.3} sigmas apart", names[index]);
        assert!(
            off_sigmas.abs() < most_sigmas,
            "{}: {ours} {theirs}, {off_sigmas} sigmas apart",
            names[index]
        );
    }
    let squares: Vec<f64> = ours.residuals().iter().map(|residual| residual.off_px.norm_squared()).collect();
    let rms_px = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    println!("rms {rms_px} {}", theirs.rms_px);
    assert!((theirs.rms_px / rms_px - 1.0).abs() < most_share, "{rms_px} {}", theirs.rms_px);
}

#[test]
fn scipy_agrees() {
    let Some(python) = python_with(&["numpy", "scipy"]) else { return };
    let (ours, points) = calibrated();
    agree(&ours, &by(python, "scipy", &points), 0.15, 0.001);
}

#[test]
fn opencv_agrees() {
    let Some(python) = python_with(&["numpy", "cv2"]) else { return };
    let (ours, points) = calibrated();
    // OpenCV's pixels have no shear as ours do, only right angles.
    agree(&ours, &by(python, "opencv", &points), 0.7, 0.01);
}
