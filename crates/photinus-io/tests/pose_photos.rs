//! The photos of a board of 7 x 5 LEDs at a pitch of 50 mm: how it is turned and how far it is, by the estimator that knows
//! no correspondences, by a perspective-n-point solution that is told them, and by single pairs. Skipped, and said so,
//! without the photos.
//!
//! Checked: the pose of every photo is that of the independent solution, spots are where it shows LEDs, and what single
//! pairs tell by the paper's (5) agrees. Not checked: the camera, which is the same for all three.

use std::collections::BTreeSet;
use std::path::PathBuf;

use nalgebra::{Isometry3, Unit, UnitQuaternion, Vector3};
use photinus::airframe::{Airframe, Led, Lobe};
use photinus::camera::{Bearing, Camera, KannalaBrandt, Model, Pixel};
use photinus::locator::{Located, Locator, Settings};
use photinus::pose::pnp;
use photinus_io::image::read_image;

const PHOTOS: [&str; 20] = [
    "01", "02", "04", "05", "06", "07", "09", "10", "11", "12", "14", "16", "18", "19", "20", "21", "22",
    "23", "25", "26",
];
const COLUMNS: usize = 7;
const ROWS: usize = 5;
const PITCH_M: f64 = 0.05;

fn data() -> Option<PathBuf> {
    let beside = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"));
    let folder = std::env::var_os("PHOTINUS_DATA").map_or(beside, PathBuf::from);
    folder.is_dir().then_some(folder)
}

/// LEDs on the plane x = 0, shining along x, column by column.
fn board() -> Airframe {
    let led = |column: usize, row: usize| Led {
        position_m: Vector3::new(0.0, column as f64 - 3.0, row as f64 - 2.0) * PITCH_M,
        axis: Unit::new_normalize(Vector3::x()),
        lobe: Lobe::Lambertian,
        signal: None,
    };
    let leds = (0..COLUMNS).flat_map(|column| (0..ROWS).map(move |row| led(column, row))).collect();
    Airframe::new("board-7x5", leds).expect("35 markers")
}

/// The lens of these photos: its calibration stands here, and only here.
fn camera() -> Camera {
    let lens = KannalaBrandt::new([463.96; 2], Pixel::new(509.598, 275.744), [-0.19069, 0.01731, 0.0, 0.0]);
    Camera::new(Model::KannalaBrandt(lens.expect("a lens")), 960, 600, Some(1.2)).expect("a camera")
}

/// What was found in a photo, with the LED that each spot is.
struct Found {
    /// Of the likeliest mode, camera_from_body.
    pose: Isometry3<f64>,
    /// By spot.
    bearings: Vec<Vector3<f64>>,
    centres: Vec<Pixel>,
    leds: Vec<usize>,
}

impl Found {
    fn of(located: &Located, board: &Airframe, camera: &Camera) -> Self {
        let [neighbour] = &located.neighbours[..] else { panic!("{} neighbours", located.neighbours.len()) };
        let mode = &located.modes(neighbour)[0];
        let turn = UnitQuaternion::from_rotation_matrix(&mode.pose.camera_from_body);
        let pose = Isometry3::from_parts(mode.pose.position_m.into(), turn);
        let sightings = || located.members(neighbour).iter().map(|&member| &located.sightings[member]);
        let nearest = |centre: &Pixel| {
            let gap_px = |&led: &usize| off_px(&pose, board, led, centre, camera);
            (0..board.leds().len()).min_by(|a, b| gap_px(a).total_cmp(&gap_px(b))).expect("an LED")
        };
        Self {
            pose,
            bearings: sightings().map(|sighting| *sighting.bearing.vector()).collect(),
            centres: sightings().map(|sighting| sighting.spot.centre).collect(),
            leds: sightings().map(|sighting| nearest(&sighting.spot.centre)).collect(),
        }
    }

    /// Root mean square distance of the spots from their LEDs, px.
    fn residual_px(&self, pose: &Isometry3<f64>, board: &Airframe, camera: &Camera) -> f64 {
        let square = |(led, centre): (&usize, &Pixel)| off_px(pose, board, *led, centre, camera).powi(2);
        let sum: f64 = self.leds.iter().zip(&self.centres).map(square).sum();
        (sum / self.leds.len() as f64).sqrt()
    }

    /// Distances to the board's middle from pairs of LEDs so many columns or rows apart, m, each by itself: the paper's (5),
    /// d/2 cot(alpha/2), where the pair is not square to the line of sight but as the pose has it.
    fn distances_m(&self, board: &Airframe, apart: usize) -> Vec<f64> {
        let spot_of = |led: usize| self.leds.iter().position(|&other| other == led);
        let mut distances_m = Vec::new();
        for first in 0..board.leds().len() {
            let (column, row) = (first / ROWS, first % ROWS);
            let across = (column + apart < COLUMNS).then(|| first + apart * ROWS);
            let down = (row + apart < ROWS).then(|| first + apart);
            for second in [across, down].into_iter().flatten() {
                let (Some(a), Some(b)) = (spot_of(first), spot_of(second)) else { continue };
                let [first_m, second_m] = [first, second].map(|led| board.leds()[led].position_m);
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
}

/// How far a spot is from where a pose shows an LED, px.
fn off_px(pose: &Isometry3<f64>, board: &Airframe, led: usize, centre: &Pixel, camera: &Camera) -> f64 {
    let place_m = pose.rotation * board.leds()[led].position_m + pose.translation.vector;
    let seen = Bearing::new(place_m).and_then(|bearing| camera.pixel(&bearing));
    seen.map_or(f64::INFINITY, |seen| libm::hypot(seen.u - centre.u, seen.v - centre.v))
}

/// Median and root mean square spread about it, as shares of `whole_m`.
fn spread(mut values_m: Vec<f64>, whole_m: f64) -> [f64; 2] {
    values_m.sort_unstable_by(f64::total_cmp);
    let median_m = values_m[values_m.len() / 2];
    let square: f64 = values_m.iter().map(|value_m| (value_m - median_m).powi(2)).sum();
    [median_m / whole_m - 1.0, (square / values_m.len() as f64).sqrt() / whole_m]
}

/// How much `other` is turned against `pose`, rad, and how far it is moved, as a share of the distance.
fn between(pose: &Isometry3<f64>, other: &Isometry3<f64>) -> [f64; 2] {
    let moved_m = (other.translation.vector - pose.translation.vector).norm();
    [other.rotation.angle_to(&pose.rotation), moved_m / pose.translation.vector.norm()]
}

#[test]
fn the_board_is_where_an_independent_solution_has_it() {
    let Some(data) = data() else {
        println!("skipped: no photos (set PHOTINUS_DATA)");
        return;
    };
    let (board, camera) = (board(), camera());
    let mut locator = Locator::new(camera.clone(), &board, None, Settings::default()).expect("a locator");
    println!(
        "                          residual          against PnP         pairs of neighbours   of LEDs 4 apart"
    );
    println!(
        "photo  distance    sigma      own    PnP    moved    turned     median     each       median     each"
    );
    for photo in PHOTOS {
        let image = read_image(data.join(format!("grid-960x600/grid_{photo}.png"))).expect("a photo").image;
        let located = locator.locate(&image.view(), None, &mut |_| ()).expect("the camera's size");
        let found = Found::of(located, &board, &camera);
        let estimate = located.neighbours[0].distance.estimate.expect("an estimate");
        let points_m: Vec<Vector3<f64>> =
            found.leds.iter().map(|&led| board.leds()[led].position_m).collect();
        let solved = pnp(&found.bearings, &points_m).expect("35 bearings");
        let [own_px, solved_px] = [&found.pose, &solved].map(|pose| found.residual_px(pose, &board, &camera));
        let [turned_rad, moved] = between(&found.pose, &solved);
        let [beside, apart] =
            [1, 4].map(|apart| spread(found.distances_m(&board, apart), estimate.distance_m));
        println!(
            "{photo:5} {:8.4} m {:7.4} m {own_px:5.2} px {solved_px:5.2} px {:6.3} % {:5.2} deg   {:+6.2} % +-{:5.2} %   {:+6.2} % +-{:5.2} %",
            estimate.distance_m,
            estimate.sigma_m,
            100.0 * moved,
            turned_rad.to_degrees(),
            100.0 * beside[0],
            100.0 * beside[1],
            100.0 * apart[0],
            100.0 * apart[1],
        );
        let all: BTreeSet<usize> = found.leds.iter().copied().collect();
        assert_eq!(all.len(), COLUMNS * ROWS, "photo {photo}: every LED has its spot");
        assert!(
            own_px < 0.4 && own_px < solved_px + 0.02,
            "photo {photo}: {own_px} px, solved {solved_px} px"
        );
        assert!(moved < 2e-3 && turned_rad < 0.02, "photo {photo}: {moved} {turned_rad} rad");
        assert!(
            (estimate.distance_m / found.pose.translation.vector.norm() - 1.0).abs() < 1e-3,
            "photo {photo}"
        );
        assert!(
            beside[0].abs() < 5e-3 && beside[1] < 0.015,
            "photo {photo}, pairs of neighbours: {beside:?}"
        );
        assert!(apart[0].abs() < 1.5e-3 && apart[1] < 5e-3, "photo {photo}, pairs 4 apart: {apart:?}");

        // The board and the board upside down look the same; where nothing tells what is up, both are told.
        let [_, other] = located.modes(&located.neighbours[0]) else { panic!("photo {photo}: two modes") };
        let half_a_turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        let other = Isometry3::from_parts(
            other.pose.position_m.into(),
            UnitQuaternion::from_rotation_matrix(&other.pose.camera_from_body) * half_a_turn,
        );
        let [turned_rad, moved] = between(&found.pose, &other);
        assert!(moved < 1e-3 && turned_rad < 0.02, "photo {photo}, upside down: {moved} {turned_rad} rad");
    }
}
