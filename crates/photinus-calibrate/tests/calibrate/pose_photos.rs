//! Poses of a board of 7 x 5 LEDs at a pitch of 50 mm in real photos, with a camera calibrated from photos of it. Skips without
//! the data.
//!
//! How the board is turned and how far it is: by the locator, which knows no correspondences; by a perspective-n-point
//! solution that is told them; by the calibration's own adjustment; and by single pairs. The board is taken as it is drawn,
//! and with its LEDs where the calibration finds them; the camera is that of all photos, and that of half of them for the
//! others. Not checked: the length of the pitch, which is what all distances are measured with.

#![allow(clippy::print_stdout, reason = "its table is for the documentation")]

use std::collections::BTreeSet;
use std::f64::consts::PI;

use crate::grid_photos::{Set, seven_by_five};
use nalgebra::{Isometry3, Matrix3, Rotation3, Unit, UnitQuaternion, Vector3};
use photinus::airframe::{Airframe, Led, Lobe};
use photinus::camera::{Bearing, Camera, Pixel};
use photinus::locator::{Input, Located, Locator, Settings};
use photinus::pose::{Mode, pnp};
use photinus::ranging::Estimate;
use photinus::spots::Reason;
use photinus_calibrate::adjust::View;
use photinus_calibrate::camera::{BoardChoice, Calibration, Choices, calibrate};
use photinus_calibrate::lens::LensModel;
use photinus_calibrate::solve::Board;

/// How far LEDs are off the drawing.
const DRAWN_SIGMA_M: f64 = 1e-3;
const COLUMNS: usize = 7;
const ROWS: usize = 5;
/// How far LEDs are from where a calibration finds them, m, per axis; with it what centres scatter more than by noise.
const FOUND_SIGMA_M: f64 = 1e-4;

/// The calibration that `photinus calibrate camera --model kannala-brandt:2` makes of photos.
fn calibrated(set: &Set, views: &[View]) -> Calibration {
    let models = vec![LensModel::kannala_brandt(2).expect("two terms")];
    let choices = Choices { models, board: BoardChoice::Auto };
    let calibration = calibrate(views, &set.grid, set.photos[0].size_px, &choices, |_| ()).expect("a camera");
    assert_eq!(calibration.board(), Board::Solved);
    assert!(calibration.misfits().is_empty() && calibration.views().len() == views.len());
    calibration
}

/// From a calibration's board (x along columns, y along rows, z away from the camera) to a body that shines along x, z up.
fn body_from_board() -> Rotation3<f64> {
    Rotation3::from_matrix_unchecked(Matrix3::new(0.0, 0.0, -1.0, 1.0, 0.0, 0.0, 0.0, -1.0, 0.0))
}

/// The board as an airframe with its LEDs at these places, row by row.
fn airframe(places_m: &[Vector3<f64>]) -> Airframe {
    let led = |place_m: &Vector3<f64>| Led {
        position_m: body_from_board() * place_m,
        axis: Unit::new_normalize(Vector3::x()),
        lobe: Lobe::Lambertian,
        power: 1.0,
        signal: None,
    };
    Airframe::new("board-7x5", places_m.iter().map(led).collect()).expect("35 markers")
}

/// A board that is looked for with a camera.
struct Search {
    camera: Camera,
    board: Airframe,
    locator: Locator,
}

impl Search {
    fn new(camera: &Camera, places_m: &[Vector3<f64>], marker_sigma_m: f64) -> Self {
        let board = airframe(places_m);
        let mut settings = Settings::default();
        settings.pose.marker_sigma_m = marker_sigma_m;
        settings.pose.scale_sigma = 0.0;
        let locator = Locator::new(camera.clone(), &board, None, settings).expect("a locator");
        Self { camera: camera.clone(), board, locator }
    }

    /// The board as the drawing has it, built to a millimetre.
    fn as_drawn(calibration: &Calibration) -> Self {
        Self::new(calibration.camera(), &calibration.grid().nominal_m(), DRAWN_SIGMA_M)
    }

    /// The board as the calibration found it.
    fn as_found(calibration: &Calibration) -> Self {
        Self::new(calibration.camera(), &calibration.scene().board_m, FOUND_SIGMA_M)
    }

    /// The board in a photo of the set: the only neighbour, with all of its LEDs that the camera has a bearing for.
    fn find(&mut self, set: &Set, photo: usize) -> Found<'_> {
        let Self { camera, board, locator } = self;
        let located = locator.locate(Input::frame(&set.images[photo].view())).expect("the camera's size");
        let found = Found::of(located, board, camera);
        let all: BTreeSet<usize> = found.leds.iter().copied().collect();
        let outside = located.rejected.iter().filter(|rejected| rejected.reason == Reason::Outside).count();
        assert_eq!(all.len(), found.leds.len(), "{}: each spot is another LED", set.photos[photo].name);
        // What is beyond the field that photos have calibrated has no bearing.
        assert_eq!(all.len() + outside, COLUMNS * ROWS, "{}: every LED has its spot", set.photos[photo].name);
        found
    }
}

/// What was found in a photo, with the LED that each spot is.
struct Found<'a> {
    camera: &'a Camera,
    board: &'a Airframe,
    estimate: Estimate,
    modes: &'a [Mode],
    /// Of the likeliest mode, camera_from_body.
    pose: Isometry3<f64>,
    /// By spot.
    bearings: Vec<Vector3<f64>>,
    centres: Vec<Pixel>,
    leds: Vec<usize>,
}

impl<'a> Found<'a> {
    fn of(located: &'a Located, board: &'a Airframe, camera: &'a Camera) -> Self {
        let [neighbour] = &located.neighbours[..] else { panic!("{} neighbours", located.neighbours.len()) };
        let modes = &neighbour.modes;
        let pose = isometry(&modes[0]);
        let sightings = || neighbour.sightings.iter().map(|&member| &located.sightings[member]);
        let nearest = |centre: &Pixel| {
            let gap_px = |&led: &usize| off_px(&pose, board, led, centre, camera);
            (0..board.leds().len()).min_by(|a, b| gap_px(a).total_cmp(&gap_px(b))).expect("an LED")
        };
        Self {
            camera,
            board,
            estimate: neighbour.distance.estimate.expect("an estimate"),
            modes,
            pose,
            bearings: sightings().map(|sighting| *sighting.bearing.vector()).collect(),
            centres: sightings().map(|sighting| sighting.spot.centre).collect(),
            leds: sightings().map(|sighting| nearest(&sighting.spot.centre)).collect(),
        }
    }

    /// The perspective-n-point solution of the same spots.
    fn solved(&self) -> Isometry3<f64> {
        let points_m: Vec<Vector3<f64>> =
            self.leds.iter().map(|&led| self.board.leds()[led].position_m).collect();
        pnp(&self.bearings, &points_m).expect("35 bearings")
    }

    /// Root mean square distance of the spots from where a pose shows their LEDs, px.
    fn residual_px(&self, pose: &Isometry3<f64>) -> f64 {
        let square = |(&led, centre)| off_px(pose, self.board, led, centre, self.camera).powi(2);
        let sum: f64 = self.leds.iter().zip(&self.centres).map(square).sum();
        (sum / self.leds.len() as f64).sqrt()
    }

    /// Distances to the board's middle from pairs of LEDs so many columns or rows apart, m, each by itself: the paper's (5),
    /// d/2 cot(alpha/2), where the pair is not square to the line of sight but as the pose has it.
    fn distances_m(&self, apart: usize) -> Vec<f64> {
        let spot_of = |led: usize| self.leds.iter().position(|&other| other == led);
        let mut distances_m = Vec::new();
        for first in 0..self.board.leds().len() {
            let (column, row) = (first % COLUMNS, first / COLUMNS);
            let across = (column + apart < COLUMNS).then(|| first + apart);
            let down = (row + apart < ROWS).then(|| first + apart * COLUMNS);
            for second in [across, down].into_iter().flatten() {
                let (Some(a), Some(b)) = (spot_of(first), spot_of(second)) else { continue };
                let [first_m, second_m] = [first, second].map(|led| self.board.leds()[led].position_m);
                let middle_m = (first_m + second_m) / 2.0;
                let ahead = (self.pose.rotation * middle_m + self.pose.translation.vector).normalize();
                let half_m = self.pose.rotation * (second_m - first_m) / 2.0;
                // With the pair's half length d/2 and what of it is square to the line of sight, h, the middle is at r:
                // tan(alpha) = 2 h r / (r^2 - (d/2)^2).
                let square_m = half_m.cross(&ahead).norm();
                let cot = 1.0 / libm::tan(self.bearings[a].angle(&self.bearings[b]));
                let range_m = square_m * cot + libm::hypot(square_m * cot, half_m.norm());
                distances_m.push((ahead * range_m - self.pose.rotation * middle_m).norm());
            }
        }
        distances_m
    }

    /// Median of those distances and root mean square spread about it, as shares of the distance from all LEDs.
    fn pairs(&self, apart: usize) -> [f64; 2] {
        let (whole_m, mut values_m) = (self.estimate.distance_m, self.distances_m(apart));
        values_m.sort_unstable_by(f64::total_cmp);
        let median_m = values_m[values_m.len() / 2];
        let square: f64 = values_m.iter().map(|value_m| (value_m - median_m).powi(2)).sum();
        [median_m / whole_m - 1.0, (square / values_m.len() as f64).sqrt() / whole_m]
    }
}

fn isometry(mode: &Mode) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_rotation_matrix(&mode.pose.camera_from_body);
    Isometry3::from_parts(mode.pose.position_m.into(), turn)
}

/// How far a spot is from where a pose shows an LED, px.
fn off_px(pose: &Isometry3<f64>, board: &Airframe, led: usize, centre: &Pixel, camera: &Camera) -> f64 {
    let place_m = pose.rotation * board.leds()[led].position_m + pose.translation.vector;
    let seen = Bearing::new(place_m).and_then(|bearing| camera.pixel(&bearing));
    seen.map_or(f64::INFINITY, |seen| libm::hypot(seen.u - centre.u, seen.v - centre.v))
}

/// How much `other` is turned against `pose`, rad, and how far it is moved, as a share of the distance.
fn between(pose: &Isometry3<f64>, other: &Isometry3<f64>) -> [f64; 2] {
    let moved_m = (other.translation.vector - pose.translation.vector).norm();
    [other.rotation.angle_to(&pose.rotation), moved_m / pose.translation.vector.norm()]
}

/// The same board upside down.
fn upside_down(pose: &Isometry3<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(
        pose.translation,
        pose.rotation * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI),
    )
}

/// Limits of the pose of one photo.
struct Limits {
    residual_px: f64,
    /// From the perspective-n-point solution: rad, share of the distance.
    solved: [f64; 2],
    /// Pairs of neighbours, and of LEDs four apart: of the median, of the spread, shares of the distance.
    beside: [f64; 2],
    apart: [f64; 2],
}

/// As drawn, LEDs are off by tenths of a millimetre; as found, by what is left of the spots.
const AS_DRAWN: Limits =
    Limits { residual_px: 0.4, solved: [0.02, 2e-3], beside: [5e-3, 0.015], apart: [1.5e-3, 5e-3] };
const AS_FOUND: Limits =
    Limits { residual_px: 0.12, solved: [4e-3, 5e-4], beside: [2e-3, 6e-3], apart: [1e-3, 2e-3] };

/// Holds a photo to what must be true whatever the camera is made of; prints the first part of its line.
fn check(name: &str, found: &Found<'_>, limits: &Limits) {
    let solved = found.solved();
    let [own_px, solved_px] = [&found.pose, &solved].map(|pose| found.residual_px(pose));
    let [turned_rad, moved] = between(&found.pose, &solved);
    let [beside, apart] = [1, 4].map(|apart| found.pairs(apart));
    let Estimate { distance_m, sigma_m } = found.estimate;
    print!(
        "{name} {distance_m:7.4} m {:4.1} mm {own_px:6.3} px {solved_px:6.3} px {:6.3} % {:5.2} deg {:+7.3} +-{:6.3} % {:+7.3} +-{:6.3} %",
        1e3 * sigma_m,
        100.0 * moved,
        turned_rad.to_degrees(),
        100.0 * beside[0],
        100.0 * beside[1],
        100.0 * apart[0],
        100.0 * apart[1],
    );
    assert!(
        own_px < limits.residual_px && own_px < solved_px + 0.02,
        "{name}: {own_px} px, solved {solved_px} px"
    );
    let [most_rad, most] = limits.solved;
    assert!(moved < most && turned_rad < most_rad, "{name}: {moved}, {turned_rad} rad");
    assert!((distance_m / found.pose.translation.vector.norm() - 1.0).abs() < 1e-3, "{name}");
    for (what, [median, spread], most) in
        [("neighbours", beside, limits.beside), ("LEDs 4 apart", apart, limits.apart)]
    {
        assert!(median.abs() < most[0] && spread < most[1], "{name}, pairs of {what}: {median} +- {spread}");
    }
}

fn print_heading(what: &str, more: &str) {
    println!("\n{what}");
    println!(
        "       from all LEDs   residual: own, PnP       against PnP    pairs of neighbours       of LEDs 4 apart{more}"
    );
}

/// The number of a photo in the name of its file.
fn number(set: &Set, photo: usize) -> &str {
    let (_, end) = set.photos[photo].name.rsplit_once('_').expect("grid_NN.png");
    end.trim_end_matches(".png")
}

#[test]
fn the_board_is_where_independent_solutions_have_it() {
    let Some(set) = seven_by_five() else { return };
    let calibration = calibrated(&set, &set.views);
    let mut drawn = Search::as_drawn(&calibration);
    print_heading("Camera of all photos, board as drawn", "");
    for photo in 0..set.photos.len() {
        let (name, found) = (number(&set, photo), drawn.find(&set, photo));
        assert_eq!(found.leds.len(), COLUMNS * ROWS, "{name}: all of them within its own field");
        check(name, &found, &AS_DRAWN);
        println!();
        // The board and the board upside down look the same; where nothing tells what is up, both are told.
        let [_, other] = found.modes else { panic!("{name}: {} modes", found.modes.len()) };
        let [turned_rad, moved] = between(&found.pose, &upside_down(&isometry(other)));
        assert!(moved < 1e-3 && turned_rad < 0.02, "{name}, upside down: {moved} {turned_rad} rad");
    }

    let mut found = Search::as_found(&calibration);
    print_heading("Camera of all photos, board as found", "     against the adjustment");
    for (view, adjusted) in calibration.views().iter().zip(calibration.poses()) {
        let (name, found) = (number(&set, view.photo), found.find(&set, view.photo));
        check(name, &found, &AS_FOUND);
        let turn = UnitQuaternion::from_rotation_matrix(&body_from_board().inverse());
        let adjusted = Isometry3::from_parts(adjusted.translation, adjusted.rotation * turn);
        // Where LEDs are not quite on the grid, the board tells what is up.
        let [turned_rad, moved] = between(&found.pose, &adjusted);
        println!("  {:6.3} % {:5.2} deg", 100.0 * moved, turned_rad.to_degrees());
        assert!(moved < 1e-3 && turned_rad < 0.01, "{name}, adjusted: {moved} {turned_rad} rad");
    }
}

#[test]
fn photos_that_did_not_make_the_camera_agree() {
    let Some(set) = seven_by_five() else { return };
    let all = calibrated(&set, &set.views);
    let is_own = |half: usize, photo: usize| photo % 2 == half;
    let halves = [0, 1].map(|half| {
        let own: Vec<View> = set.views.iter().filter(|view| is_own(half, view.photo)).cloned().collect();
        calibrated(&set, &own)
    });
    let as_drawn = (Search::as_drawn as fn(&Calibration) -> Search, "drawn", &AS_DRAWN);
    let as_found = (Search::as_found as fn(&Calibration) -> Search, "found", &AS_FOUND);
    for (search, what, limits) in [as_drawn, as_found] {
        print_heading(
            &format!("Camera of the other half of the photos, board as {what}"),
            "     against the camera of all",
        );
        let mut by_all = search(&all);
        let mut by_half = halves.each_ref().map(search);
        for photo in 0..set.photos.len() {
            let name = number(&set, photo);
            let whole_m = by_all.find(&set, photo).estimate.distance_m;
            let found = by_half[usize::from(is_own(0, photo))].find(&set, photo);
            check(name, &found, limits);
            let Estimate { distance_m, sigma_m } = found.estimate;
            let off_m = distance_m - whole_m;
            println!("  {:+6.3} % {:+5.2} sigma", 100.0 * off_m / whole_m, off_m / sigma_m);
            assert!(off_m.abs() < 3.0 * sigma_m, "{name}: {off_m} m against {sigma_m} m");
        }
    }
}
