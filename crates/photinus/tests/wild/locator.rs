//! Any spots of a frame.

use std::cell::RefCell;
use std::f64::consts::PI;

use nalgebra::{Matrix2, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::{Camera, Ideal, IdealLaw, Model, Pixel};
use photinus::locator::{Input, Located, Locator, Settings};
use photinus::pose::Pose;
use photinus::ranging::SpotCurve;
use photinus::spots::{Extent, Spot};
use proptest::prelude::*;
use proptest::sample::Index;
use proptest::test_runner::TestCaseError;

use crate::airframes::airframes;
use crate::any::{finite, scale, signal, up, with_twins};
use crate::meaning::{check_modes, check_told};
use crate::{MOST_SPOTS, runner};

/// What rounding may take from a covariance.
const SHARE: f64 = 1e-6;
const SIDE_PX: usize = 900;

fn camera() -> Camera {
    let lens = Ideal::new(IdealLaw::Equidistant, [265.0; 2], Pixel::new(449.5, 449.5)).expect("a lens");
    Camera::new(Model::Ideal(lens), SIDE_PX, SIDE_PX, Some(100.0 * PI / 180.0)).expect("a camera")
}

/// A positive definite matrix: sensible, or of absurd size and shape.
fn covariance2() -> impl Strategy<Value = Matrix2<f64>> {
    let sensible = (scale(-3.0..1.0), prop::array::uniform4(-1.0f64..1.0)).prop_map(|(sigma, n)| {
        let root = Matrix2::from_row_slice(&n) * sigma;
        root * root.transpose() + Matrix2::identity() * (1e-3 * sigma * sigma)
    });
    let any = prop::array::uniform2(scale(-300.0..300.0)).prop_map(|[uu, vv]| Matrix2::new(uu, 0.0, 0.0, vv));
    prop_oneof![4 => sensible, 1 => any]
}

/// A spot beside one of three places, somewhere in the image, or anywhere.
fn spot() -> impl Strategy<Value = (Spot, Option<u32>)> {
    let side_px = SIDE_PX as f64;
    let near = (prop_oneof![Just(200.0), Just(450.0), Just(460.0)], prop::array::uniform2(-50.0f64..50.0))
        .prop_map(|(at, [u, v])| Pixel::new(at + u, 450.0 + v));
    let within = prop::array::uniform2(-1.0..side_px).prop_map(|[u, v]| Pixel::new(u, v));
    let anywhere = prop::array::uniform2(finite()).prop_map(|[u, v]| Pixel::new(u, v));
    let flux = prop_oneof![4 => scale(1.0..5.0), 1 => finite()];
    let pixels = prop_oneof![4 => 0u32..60, 1 => any::<u32>()];
    let level = prop_oneof![4 => 0.0f64..255.0, 1 => finite()];
    let corners = prop_oneof![4 => prop::array::uniform4(0u32..4), 1 => prop::array::uniform4(0u32..60_000)];
    (
        (prop_oneof![6 => near, 2 => within, 1 => anywhere], covariance2(), flux, level),
        (pixels, any::<u8>(), prop_oneof![4 => Just(0), 1 => any::<u32>()], corners, signal()),
    )
        .prop_map(
            |((centre, covariance_px2, flux, background), (area_px, peak, saturated_px, corners, signal))| {
                // The cast keeps within the numbers that there are.
                let (u, v) = (centre.u as u32 % 60_000, centre.v as u32 % 60_000);
                let [left, top, right, bottom] = corners;
                let extent = Extent {
                    left: u.saturating_sub(left),
                    top: v.saturating_sub(top),
                    right: u + right,
                    bottom: v + bottom,
                };
                let spot = Spot {
                    centre,
                    covariance_px2,
                    area_px,
                    peak,
                    saturated_px,
                    flux,
                    light: None,
                    background,
                    marker_log_odds: 3.0,
                    middle: (u, v),
                    extent,
                };
                (spot, signal)
            },
        )
}

fn check_located(located: &Located) -> Result<(), TestCaseError> {
    for sighting in &located.sightings {
        prop_assert!(sighting.covariance_rad2.iter().all(|number| number.is_finite()), "{sighting:?}");
        prop_assert!((0.0..=PI).contains(&sighting.bound_rad), "{sighting:?}");
    }
    let mut members: Vec<usize> =
        located.neighbours.iter().flat_map(|neighbour| &neighbour.sightings).copied().collect();
    members.sort_unstable();
    prop_assert!(members.windows(2).all(|pair| pair[0] < pair[1]), "a spot of two neighbours: {members:?}");
    for neighbour in &located.neighbours {
        let bounds = neighbour.distance.bounds;
        let Some(estimate) = neighbour.distance.estimate else {
            prop_assert!(neighbour.position.is_none() && neighbour.orientation.is_none());
            prop_assert!(neighbour.modes.is_empty());
            continue;
        };
        prop_assert!(
            bounds.contains(estimate.distance_m) && estimate.distance_m.is_finite(),
            "{neighbour:?}"
        );
        prop_assert!(estimate.sigma_m.is_finite() && estimate.sigma_m >= 0.0, "{neighbour:?}");
        let (Some(position), Some(orientation)) = (neighbour.position, neighbour.orientation) else {
            return Err(TestCaseError::fail("a distance without a pose"));
        };
        let away_m = position.mean_m.norm();
        prop_assert!(
            away_m >= bounds.min_m() * (1.0 - 1e-12) && away_m <= bounds.max_m() * (1.0 + 1e-12),
            "{neighbour:?}"
        );
        let pose = Pose { position_m: position.mean_m, camera_from_body: orientation.camera_from_body };
        check_told(&pose, &position.covariance_m2, &orientation.covariance_rad2, SHARE)?;
        check_modes(&neighbour.modes, SHARE)?;
    }
    Ok(())
}

/// A locator per airframe, of all beliefs that there are.
fn locators() -> Vec<Locator> {
    let usual = Settings::default();
    let mut loose = usual;
    loose.max_tilt_rad = PI;
    loose.pose.tilt_sigma_rad = 3.2;
    loose.pose.marker_sigma_m = 1.0;
    loose.pose.scale_sigma = 1.0;
    loose.pose.unit_sigma = 10.0;
    loose.pose.lobe_sigma = 1.0;
    loose.pose.missed = 0.5;
    loose.pose.use_brightness = false;
    let mut strict = usual;
    strict.max_tilt_rad = 0.0;
    strict.pose.tilt_sigma_rad = 1e-4;
    strict.pose.marker_sigma_m = 0.0;
    strict.pose.scale_sigma = 0.0;
    strict.pose.unit_sigma = 1e-3;
    strict.pose.lobe_sigma = 0.0;
    strict.pose.missed = 1e-9;
    strict.pose.use_brightness = true;
    let curves = [None, Some(SpotCurve::paper_1000_us())];
    let locator = |(number, airframe): (usize, &Airframe)| {
        let settings = [usual, loose, strict][number % 3];
        Locator::new(camera(), airframe, curves[number % 2], settings).expect("a locator")
    };
    airframes().iter().enumerate().map(locator).collect()
}

#[test]
fn a_locator_tells_numbers_within_bounds_or_nothing() {
    let locators = RefCell::new(locators());
    let told = RefCell::new([0; 2]);
    let inputs = (any::<Index>(), with_twins(spot(), MOST_SPOTS), up());
    let outcome = runner(800).run(&inputs, |(which, spots, down)| {
        let mut locators = locators.borrow_mut();
        let which = which.index(locators.len());
        let located = locators[which]
            .locate(Input::signalled(&spots).gravity(down.as_ref()))
            .expect("spots have no size");
        for neighbour in &located.neighbours {
            told.borrow_mut()[usize::from(neighbour.distance.estimate.is_some())] += 1;
        }
        prop_assert_eq!(located.sightings.len() + located.rejected.len(), spots.len());
        check_located(located)
    });
    let [without, with] = told.into_inner();
    println!("{with} neighbours with a pose, {without} without");
    outcome.unwrap_or_else(|error| panic!("{error}"));
    assert!(with > 10 * without, "{with} with a pose, {without} without");
}

#[test]
fn spots_all_in_one_place_tell_numbers_or_nothing() {
    // Rounding leaves three spots in this place a shape of their own.
    let one = Spot {
        centre: Pixel::new(453.17772437562195, 476.42743007739676),
        covariance_px2: Matrix2::new(
            0.2413099317347277,
            0.3817888475197341,
            0.3817888475197341,
            2.5437977732589285,
        ),
        area_px: 2,
        peak: 0,
        saturated_px: 0,
        flux: 10.0,
        light: None,
        background: 0.0,
        marker_log_odds: 3.0,
        middle: (453, 476),
        extent: Extent { left: 453, top: 476, right: 453, bottom: 480 },
    };
    for mut locator in locators() {
        for copies in 2..=5 {
            for down in [None, Some(Vector3::y_axis())] {
                let located = locator
                    .locate(Input::spots(&vec![one.clone(); copies]).gravity(down.as_ref()))
                    .expect("spots have no size");
                check_located(located).unwrap_or_else(|error| panic!("{copies} copies: {error}"));
            }
        }
    }
}
