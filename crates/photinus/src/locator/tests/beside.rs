//! A lamp that goes along beside a neighbour, where a marker could be.

use super::*;

/// Light of the lamp: that of a marker 6 m away; and the least that is found here, so that most neighbours show two markers.
const LAMP: f64 = 2_700.0;
const LEAST: f64 = 1_000.0;
const GAP_PX: f64 = 25.0;

#[test]
fn a_lamp_beside_neighbours_does_not_teach_that_leds_are_fainter() {
    let (airframe, down) = (quadrotor(), level());
    let mut locator = Locator::new(camera(), &airframe, None, Settings::default()).unwrap();
    let mut rng = Pcg64::new(7, 47);
    let (mut told, mut wrong) = (0, 0);
    for _ in 0..300 {
        let mut uniform = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(&mut rng);
        let distance_m = 2.0 * libm::exp(uniform(0.0, libm::log(7.5)));
        let place_m = ahead(distance_m, uniform(-0.8, 0.8), uniform(-0.3, 0.3));
        let tilt = Vector3::new(uniform(-0.1, 0.1), 0.0, uniform(-0.1, 0.1));
        let placed = Placed::new(place_m, uniform(0.0, TAU), tilt);
        let mut spots = placed.spots(&airframe, &camera(), &mut rng);
        spots.retain(|spot| spot.flux > LEAST);
        let rightmost = spots.iter().map(|spot| spot.centre).max_by(|a, b| a.u.total_cmp(&b.u));
        let Some(Pixel { u, v }) = rightmost else { continue };
        spots.push(super::spot(Pixel::new(u + GAP_PX, v), 1.0, (POWER / LAMP).sqrt()));
        let located = locator.locate(Input::spots(&spots).gravity(Some(&down))).unwrap();
        for neighbour in located.neighbours.iter().filter(|neighbour| neighbour.probability > 0.9) {
            told += 1;
            let estimate = neighbour.distance.estimate.unwrap();
            wrong += usize::from((estimate.distance_m / distance_m - 1.0).abs() > 0.15);
        }
    }
    // 4 of 190; 50 of 168 where the lamp teaches.
    assert!(told > 150 && 20 * wrong < told, "{wrong} of {told} are wrong");
}
