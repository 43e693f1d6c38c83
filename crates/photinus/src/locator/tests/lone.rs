//! Vehicles that show one LED each: nothing but how rare clutter is tells them from it.

use super::*;

/// Probabilities of what is told of a vehicle of one LED, in each of so many frames, where it is where `place` tells.
fn told(frames: usize, rng: &mut Pcg64, place: impl Fn(usize, &mut Pcg64) -> Vector3<f64>) -> Vec<f64> {
    let airframe = lamp(Vector3::zeros());
    let mut locator = locator(&airframe);
    let mut of_frame = |frame: usize| {
        let placed = Placed::new(place(frame, rng), 0.0, Vector3::zeros());
        let spots = placed.spots(&airframe, &camera(), rng);
        let located = locator.locate(Input::spots(&spots).gravity(Some(&level()))).unwrap();
        located.neighbours.first().map_or(0.0, |neighbour| neighbour.probability)
    };
    (0..frames).map(&mut of_frame).collect()
}

#[test]
fn in_the_dark_one_led_stays_a_vehicle_however_it_flies() {
    let mut rng = Pcg64::new(24, 3);
    let on_a_path = told(200, &mut rng, |frame, _| {
        let angle = 0.05 * frame as f64;
        ahead(5.0 + libm::sin(0.7 * angle), 0.2 * libm::cos(angle) - 0.3, 0.15 * libm::sin(angle))
    });
    let anywhere = told(200, &mut rng, |_, rng| {
        let mut uniform = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(rng);
        ahead(uniform(2.0, 6.0), uniform(-0.8, 0.8), uniform(-0.3, 0.3))
    });
    for told in [on_a_path, anywhere] {
        let least = told.iter().fold(1.0_f64, |least, told| least.min(*told));
        assert!(least > 0.9, "{told:.2?}");
    }
}
