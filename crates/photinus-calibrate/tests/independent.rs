//! An independent implementation ends where this one does: SciPy's least squares and OpenCV's fisheye on the same points.
//! Skips where python3 has no SciPy.

#![allow(clippy::print_stdout, reason = "a test that is skipped says so")]

mod simulation;

use std::io::Write;
use std::process::{Command, Stdio};

use nalgebra::Point3;
use photinus::camera::Model;
use photinus_calibrate::adjust::View;
use photinus_calibrate::camera::{BoardChoice, Choices, Summary, calibrate};
use photinus_calibrate::grid::Grid;
use simulation::{Dice, SIZE_PX, lens, pose, seen};

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

#[test]
fn scipy_and_opencv_agree() {
    let grid = Grid::new(7, 5, 0.05).expect("a grid");
    let views = photos(&grid);
    let choices =
        Choices { models: vec!["kannala-brandt:2".parse().expect("a model")], board: BoardChoice::Flat };
    let ours = calibrate(&views, &grid, SIZE_PX, &choices, |_| ()).expect("a camera");
    let Model::KannalaBrandt(found) = ours.camera().model() else { panic!("another model") };

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
    let centre = found.centre();
    let input = format!(
        "{{\"size\":{SIZE_PX:?},\"board\":{board:?},\"photos\":{pixels:?},\"focal\":{:?},\"centre\":{:?},\"k\":{:?},\"poses\":{poses:?}}}",
        found.focal_px(),
        [centre.u, centre.v],
        &found.k()[..2]
    );
    let Some(theirs) = independent(&input) else { return };
    let number = |key: &str| -> Vec<f64> {
        let from = theirs.find(key).unwrap_or_else(|| panic!("no {key} in {theirs}")) + key.len();
        let text: String = theirs[from..]
            .chars()
            .skip_while(|c| "\": [".contains(*c))
            .take_while(|c| !"]}".contains(*c))
            .collect();
        text.split(',').map_while(|word| word.trim().parse().ok()).collect()
    };
    let sigma = |k: usize| ours.camera().parameter_covariance().expect("a covariance")[(k, k)].sqrt();
    let scipy = number("parameters");
    // ours lets go of long residuals and holds pixels square, so the optima differ by a share of their sigma
    let pairs =
        [(0, 0, found.focal_px()[0]), (1, 1, found.focal_px()[1]), (2, 6, centre.u), (3, 7, centre.v)];
    for (theirs, k, ours) in pairs {
        assert!(
            (scipy[theirs] - ours).abs() < 1.5 * sigma(k),
            "{theirs}: {} {ours} {}",
            scipy[theirs],
            sigma(k)
        );
    }
    let mean_px = Summary::of(ours.residuals().iter().map(|residual| residual.off_px.norm())).mean_px;
    assert!((number("mean_px")[0] / mean_px - 1.0).abs() < 0.01, "{:?} {mean_px}", number("mean_px"));
    if theirs.contains("\"opencv\":") {
        for (theirs, ours) in number("\"focal\"").iter().zip(found.focal_px()) {
            assert!((theirs - ours).abs() < 2.0, "{theirs} {ours}");
        }
    } else {
        println!("skipped OpenCV: {theirs}");
    }
}

/// What the script says; `None`, with a word about it, where it cannot run.
fn independent(input: &str) -> Option<String> {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/independent.py");
    let child = Command::new("python3")
        .arg(script)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn();
    let Ok(mut child) = child else {
        println!("skipped: there is no python3");
        return None;
    };
    // a script that cannot import its modules ends before it reads
    let _ = child.stdin.take()?.write_all(input.as_bytes());
    let output = child.wait_with_output().ok()?;
    if !output.status.success() {
        println!("skipped: python3 has no numpy or SciPy");
        return None;
    }
    String::from_utf8(output.stdout).ok()
}
