//! The photos of a board of 7 x 5 LEDs at a pitch of 50 mm, taken for an airframe: one neighbour per photo, as far away as
//! an independent calibration study found it; and taken for a quadrotor, which it is not. Skipped, and said so, without the
//! photos.

use nalgebra::{Unit, Vector3};
use photinus::airframe::{Airframe, Led, Lobe, Ring};
use photinus::camera::{Camera, KannalaBrandt, Model, Pixel};
use photinus::locator::{Input, Locator, Settings};
use photinus_io::image::read_image;
use photinus_testing::real_data;

/// Photo, and metres to the board from a bundle adjustment over all photos with the board's true shape.
const PHOTOS: [(&str, f64); 20] = [
    ("01", 1.66),
    ("02", 1.68),
    ("04", 1.33),
    ("05", 1.38),
    ("06", 1.25),
    ("07", 1.27),
    ("09", 0.92),
    ("10", 1.08),
    ("11", 0.93),
    ("12", 1.17),
    ("14", 1.18),
    ("16", 0.98),
    ("18", 1.47),
    ("19", 1.33),
    ("20", 0.94),
    ("21", 0.82),
    ("22", 0.68),
    ("23", 0.52),
    ("25", 0.70),
    ("26", 0.42),
];

/// LEDs on the plane x = 0, shining along x.
fn board() -> Airframe {
    let led = |column: i32, row: i32| Led {
        position_m: Vector3::new(0.0, 0.05 * f64::from(column - 3), 0.05 * f64::from(row - 2)),
        axis: Unit::new_normalize(Vector3::x()),
        lobe: Lobe::Lambertian,
        power: 1.0,
        signal: None,
    };
    let leds = (0..7).flat_map(|column| (0..5).map(move |row| led(column, row))).collect();
    Airframe::new("board-7x5", leds).expect("35 markers")
}

/// The lens of these photos, from the same study.
fn camera() -> Camera {
    let lens = KannalaBrandt::new([463.96; 2], Pixel::new(509.598, 275.744), [-0.19069, 0.01731, 0.0, 0.0]);
    Camera::new(Model::KannalaBrandt(lens.expect("a lens")), 960, 600, Some(1.2)).expect("a camera")
}

#[test]
fn a_board_of_leds_is_one_neighbour_at_its_distance() {
    let Some(photos) = real_data("grid-960x600") else { return };
    let mut locator = Locator::new(camera(), &board(), None, Settings::default()).expect("a locator");
    for (photo, distance_m) in PHOTOS {
        let file = photos.join(format!("grid_{photo}.png"));
        let image = read_image(&file).expect("a photo").image;
        let located = locator.locate(Input::frame(&image.view())).expect("the camera's size");
        assert_eq!(located.neighbours.len(), 1, "photo {photo}");
        let neighbour = &located.neighbours[0];
        assert_eq!(neighbour.sightings.len(), 35, "photo {photo}");
        let estimate = neighbour.distance.estimate.expect("an estimate");
        println!(
            "photo {photo}: {distance_m} m, estimate {estimate:.3?}, bounds {:.3?}",
            neighbour.distance.bounds
        );
        assert!(
            neighbour.distance.bounds.contains(distance_m),
            "photo {photo}: {:?}",
            neighbour.distance.bounds
        );
        let relative = estimate.distance_m / distance_m - 1.0;
        assert!(relative.abs() < 0.15, "photo {photo}: {} m for {distance_m} m", estimate.distance_m);
        assert_eq!(neighbour.distance.perpendicular_m, None, "a board is no ring");
    }
}

/// None is right; these are as many as the program is at least kept from exceeding: the limit reached.
const AS_QUADROTORS: usize = 85;

#[test]
fn a_board_of_leds_is_no_quadrotor() {
    let Some(photos) = real_data("grid-960x600") else { return };
    let ring = Ring { arms: 4, radius_m: 0.245, leds_per_arm: 2, splay_rad: std::f64::consts::FRAC_PI_2 };
    let quadrotor = Airframe::from_ring("quadrotor", ring).expect("a quadrotor");
    let mut settings = Settings::default();
    settings.min_probability = 0.01;
    let mut told = Vec::new();
    for (photo, _) in PHOTOS {
        let image = read_image(photos.join(format!("grid_{photo}.png"))).expect("a photo").image;
        // Each alone: the boards of the photos before would tell how dense clutter is.
        let mut locator = Locator::new(camera(), &quadrotor, None, settings).expect("a locator");
        let located = locator.locate(Input::frame(&image.view())).expect("the camera's size");
        told.extend(located.neighbours.iter().map(|neighbour| {
            let (probability, members) = (neighbour.probability, neighbour.sightings.len());
            let spots = located.sightings.len();
            let misfit = neighbour.misfit;
            format!(
                "{photo}: {probability:.3} likely, {members} of {spots} spots, {misfit:.1?}, {:.2?}",
                neighbour.distance.estimate
            )
        }));
    }
    assert!(told.len() <= AS_QUADROTORS, "{} neighbours over 1 %:\n{}", told.len(), told.join("\n"));
}
