//! Markers that must show and do not, as often as frames tell.

use super::*;

/// The mean of what a locator believes of how often markers are missed, where so many are, over the frames after the first hundred.
fn learned(missed: f64) -> f64 {
    let (airframe, down) = (hexarotor(), level());
    let mut locator = locator(&airframe);
    let mut rng = Pcg64::new(29, 31);
    let (mut sum, mut count) = (0.0, 0.0);
    for frame in 0..400 {
        let mut uniform = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(&mut rng);
        let place_m = ahead(uniform(2.0, 6.0), uniform(-0.8, 0.8), uniform(-0.3, 0.3));
        let tilt = Vector3::new(uniform(-0.1, 0.1), 0.0, uniform(-0.1, 0.1));
        let placed = Placed::new(place_m, uniform(0.0, TAU), tilt);
        let mut spots = placed.spots(&airframe, &camera(), &mut rng);
        spots.retain(|_| Uniform::new(0.0, 1.0).unwrap().sample(&mut rng) >= missed);
        let rate = locator.locate(Input::spots(&spots).gravity(Some(&down))).unwrap().miss_rate.unwrap();
        if frame >= 100 {
            sum += rate;
            count += 1.0;
        }
    }
    sum / count
}

#[test]
fn frames_tell_how_often_markers_are_missed() {
    let [none, few, many] = [0.0, 0.05, 0.2].map(learned);
    // As sure as 50 markers are the 2 % beforehand, and 200 tell: of 20 % missed 16 %, but for those that a nearer or turned vehicle explains.
    assert!(none < 0.015 && (0.03..0.08).contains(&few) && (0.1..0.2).contains(&many), "{none} {few} {many}");
}
