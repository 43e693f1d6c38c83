//! Markers that are dark, beside others that are seen.

use super::*;

/// Two arms aside are seen as well as two that are next to each other, nearer, with none dark in between: the light alone speaks for the former.
#[test]
fn where_the_front_arm_is_dark_the_true_distance_is_among_the_modes() {
    let airframe = quadrotor();
    let mut rng = Pcg64::new(7, 3);
    let mut locator = Locator::new(camera(), &airframe, None, Settings::default()).unwrap();
    let mut shares = Vec::new();
    for frame in 0..400 {
        let mut uniform = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(&mut rng);
        let place_m = ahead(uniform(3.0, 12.0), uniform(-0.8, 0.8), uniform(-0.3, 0.3));
        let is_dark = frame % 8 == 0;
        let from_front = if is_dark { 0.3 } else { PI };
        // An arm points to the camera.
        let towards = -libm::atan2(place_m.x, place_m.z) + PI / 2.0;
        let placed = Placed::new(place_m, towards + uniform(-from_front, from_front), Vector3::zeros());
        let mut spots = placed.spots(&airframe, &camera(), &mut rng);
        if is_dark {
            assert_eq!(spots.len(), 3);
            spots.sort_by(|a, b| a.centre.u.total_cmp(&b.centre.u));
            spots.remove(1);
        }
        let located = locator.locate(Input::spots(&spots).gravity(Some(&level()))).unwrap();
        if is_dark && frame > 100 {
            let modes = located.neighbours.first().map_or(&[][..], |neighbour| &neighbour.modes);
            let is_true =
                |mode: &&pose::Mode| (mode.pose.position_m.norm() / place_m.norm() - 1.0).abs() < 0.07;
            shares.push(modes.iter().filter(is_true).map(|mode| mode.weight).sum::<f64>());
        }
    }
    let least = shares.iter().copied().fold(1.0, f64::min);
    println!("{shares:.2?}");
    assert!(shares.len() > 30 && least > 0.4, "{shares:.2?}");
}
