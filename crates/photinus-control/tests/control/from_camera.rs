//! From a painted frame to what a controller sees: bounds hold, whatever the place of the camera.

use nalgebra::{UnitVector3, Vector3};
use photinus::frame::FrameView;
use photinus::locator::{Input, Locator, Settings};
use photinus_control::Held;
use rand_pcg::Pcg64Mcg;

use crate::flight::{between, in_ball};

#[path = "../../examples/by_sight/painted.rs"]
mod painted;

#[test]
fn distances_and_bearings_are_bounded_from_the_vehicles_origin() {
    let (camera, airframe) = (painted::camera().unwrap(), painted::hexarotor().unwrap());
    let mut locator = Locator::new(camera.clone(), &airframe, None, Settings::default()).unwrap();
    let gravity = UnitVector3::new_normalize(Vector3::y());
    let mut rng = Pcg64Mcg::new(11);
    let mut found = 0;
    for _ in 0..40 {
        let held = Held { level_from_camera: painted::level_from_camera(), camera_m: in_ball(&mut rng, 0.3) };
        let side = between(&mut rng, -1.0, 1.0);
        let place =
            Vector3::new(1.0, side, between(&mut rng, -0.3, 0.3)).normalize() * between(&mut rng, 2.0, 9.0);
        let pixels =
            painted::paint(&camera, &airframe, &(place - held.camera_m), between(&mut rng, -3.0, 3.0));
        let frame = FrameView::packed(&pixels, 752, 480).unwrap();
        let located = locator.locate(Input::frame(&frame).gravity(&gravity)).unwrap();
        for neighbour in &located.neighbours {
            let members = neighbour.sightings.iter().map(|k| &located.sightings[*k]);
            let seen = held.seen(neighbour, members, airframe.max_radius_m(), 7, None, None);
            assert!(seen.distance.bounds.contains(place.norm()), "{place:?}: {:?}", seen.distance.bounds);
            assert!(seen.bearing.angle(&place) <= seen.bearing_bound_rad, "{place:?}");
            // It says something: less than a quarter of all directions at a few metres.
            assert!(
                seen.bearing_bound_rad < 1.2 || place.norm() < 4.0,
                "{place:?}: {}",
                seen.bearing_bound_rad
            );
            let position = seen.position_m.unwrap();
            let off = (position.mean - place)
                .dot(&(position.covariance.try_inverse().unwrap() * (position.mean - place)));
            assert!(off < 30.0, "{place:?}: {off}");
            found += 1;
        }
    }
    assert!(found >= 35, "{found} of 40");
}
