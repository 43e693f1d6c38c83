use nalgebra::{Unit, Vector3};

use super::*;
use crate::airframe::{Led, Lobe, LobeTable, Ring};
use crate::ranging::Interval;

fn hexarotor() -> Airframe {
    let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
    Airframe::from_ring("hexarotor", ring).unwrap()
}

fn led(position_m: [f64; 3], axis: [f64; 3], lobe: Lobe) -> Led {
    Led {
        position_m: Vector3::from(position_m),
        axis: Unit::new_normalize(Vector3::from(axis)),
        lobe,
        power: 1.0,
        signal: None,
    }
}

/// Seven by five LEDs, 50 mm apart, all shining forward.
fn board() -> Airframe {
    let place = |i: i32| [0.0, 0.05 * f64::from(i % 7 - 3), 0.05 * f64::from(i / 7 - 2)];
    let leds = (0..35).map(|i| led(place(i), [1.0, 0.0, 0.0], Lobe::Lambertian)).collect();
    Airframe::new("board", leds).unwrap()
}

fn spot(place_m: Vector3<f64>, camera_m: Vector3<f64>, bound_rad: f64) -> BoundedBearing {
    BoundedBearing { bearing: Bearing::new(place_m - camera_m).unwrap(), bound_rad }
}

fn spots_from(airframe: &Airframe, camera_m: Vector3<f64>, bound_rad: f64) -> Vec<BoundedBearing> {
    let seen = airframe.visible(camera_m);
    seen.map(|marker| spot(airframe.markers()[marker].position_m, camera_m, bound_rad)).collect()
}

/// Directions spread evenly over the sphere.
fn directions(count: u32) -> impl Iterator<Item = Vector3<f64>> {
    (0..count).map(move |i| {
        let z = (2.0 * f64::from(i) + 1.0) / f64::from(count) - 1.0;
        let (sin, cos) = libm::sincos(2.399_963 * f64::from(i));
        Vector3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z)
    })
}

fn assert_holds_level(airframe: &Airframe, count: u32) {
    let bounds = DistanceBounds::new(airframe, 0.0);
    let down = Unit::new_unchecked(-Vector3::z());
    let mut asked = 0;
    for direction in directions(count) {
        for distance_m in [bounds.near_m(), 1.3 * bounds.near_m(), 3.0, 17.0, 300.0] {
            let spots = spots_from(airframe, direction * distance_m, 0.0);
            if spots.len() < 2 || distance_m < bounds.near_m() {
                continue;
            }
            asked += 1;
            for spots in [&spots[..], &spots[..2], &spots[spots.len() / 2 - 1..]] {
                for gravity in [Some(&down), None] {
                    let interval = bounds.interval(spots, gravity);
                    let holds = interval.is_some_and(|interval| interval.contains(distance_m));
                    assert!(
                        holds,
                        "{distance_m} m from {direction:?}: {interval:?} of {} spots",
                        spots.len()
                    );
                }
            }
        }
    }
    assert!(asked > count / 4, "only {asked} views");
}

#[test]
fn bounds_hold_for_a_board_of_many_markers_and_are_useful() {
    assert_holds_level(&board(), 150);
    let bounds = DistanceBounds::new(&board(), DistanceBounds::DEFAULT_MAX_TILT_RAD);
    let spots = spots_from(&board(), Vector3::new(3.0, 0.2, 0.1), 0.0);
    assert_eq!(spots.len(), 35);
    let interval = bounds.interval(&spots, None).unwrap();
    assert!(interval.max_m() / interval.min_m() < 2.2, "{interval:?}");
}

#[test]
fn bounds_hold_for_an_airframe_without_any_symmetry() {
    let leds = vec![
        led([0.5, 0.1, 0.0], [1.0, 0.2, 0.1], Lobe::Lambertian),
        led([0.1, 0.45, 0.2], [0.0, 1.0, 0.5], Lobe::Lambertian),
        led([-0.3, 0.2, -0.1], [-1.0, 0.3, -0.4], Lobe::Lambertian),
        led([-0.2, -0.4, 0.05], [0.0, 0.0, 1.0], Lobe::Omni),
        led([0.3, -0.3, -0.2], [0.3, -0.4, -1.0], Lobe::Lambertian),
        led([0.3, -0.3, 0.2], [0.3, -0.4, 1.0], Lobe::Omni),
    ];
    assert_holds_level(&Airframe::new("odd", leds).unwrap(), 2000);
}

#[test]
fn bounds_hold_for_lobes_that_end_before_and_behind_a_right_angle() {
    let table = |ends_deg: f64| {
        let angles_deg = [0.0, 0.5 * ends_deg, ends_deg];
        Lobe::Table(LobeTable::new(&angles_deg.map(f64::to_radians), &[1.0, 0.7, 0.0]).unwrap())
    };
    let ring = hexarotor();
    let leds = ring.leds().iter().zip([70.0, 130.0, 100.0, 60.0, 170.0, 80.0]).map(|(led, ends_deg)| {
        let position_m = led.position_m + Vector3::new(0.0, 0.0, 1e-3 * ends_deg);
        Led { position_m, lobe: table(ends_deg), ..led.clone() }
    });
    assert_holds_level(&Airframe::new("tabled", leds.collect()).unwrap(), 2000);
}

#[test]
fn bounds_hold_when_only_one_led_of_a_wide_marker_shines_this_way() {
    let corner = |x: f64, y: f64| {
        [
            led([x, y * 0.99, 0.0], [x, 0.0, 0.0], Lobe::Lambertian),
            led([x * 0.99, y * 1.05, 0.0], [0.0, y, 0.0], Lobe::Lambertian),
        ]
    };
    let corners = [(0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2)];
    let airframe = Airframe::new("wide", corners.iter().flat_map(|&(x, y)| corner(x, y)).collect()).unwrap();
    assert_eq!(airframe.markers().len(), 4);
    let bounds = DistanceBounds::new(&airframe, 0.0);
    for direction in directions(2000) {
        let camera_m = direction * 0.8;
        let brightest = |marker: &crate::airframe::Marker| {
            let lit = marker.leds.iter().map(|&led| &airframe.leds()[led]);
            let best = lit.max_by(|a, b| a.intensity(&camera_m).total_cmp(&b.intensity(&camera_m)));
            best.filter(|led| led.intensity(&camera_m) > 0.0)
        };
        let seen = airframe.markers().iter().filter_map(brightest);
        let spots: Vec<_> = seen.map(|led| spot(led.position_m, camera_m, 0.0)).collect();
        if spots.len() >= 2 {
            let interval = bounds.interval(&spots, None).unwrap();
            assert!(interval.contains(0.8), "{interval:?} from {direction:?}");
        }
    }
}

#[test]
fn spots_that_cannot_be_one_airframe_have_no_distance() {
    let bounds = DistanceBounds::new(&hexarotor(), DistanceBounds::DEFAULT_MAX_TILT_RAD);
    let camera_m = Vector3::new(0.0, 0.0, -5.0);
    let row = |y: f64| spot(Vector3::new(0.0, y, 0.0), camera_m, 1e-3);
    let near_and_far = [row(0.0), row(0.05), row(4.0)];
    assert_eq!(bounds.interval(&near_and_far, None), None, "two at 20 m or more, one at 1 m or less");
    let seven: Vec<_> = (0..7).map(|i| row(0.1 * f64::from(i))).collect();
    assert_eq!(bounds.interval(&seven, None), None, "more spots than markers");
    assert_eq!(bounds.pair_interval(3.0, 0.01), None, "nearer than the near limit");
}

#[test]
fn few_spots_or_wide_bounds_leave_the_distance_open() {
    let bounds = DistanceBounds::new(&hexarotor(), DistanceBounds::DEFAULT_MAX_TILT_RAD);
    let open = Interval::new(bounds.near_m(), f64::INFINITY);
    let camera_m = Vector3::new(5.0, 0.5, 0.0);
    let spots = spots_from(&hexarotor(), camera_m, 0.2);
    assert_eq!(bounds.interval(&[], None), open);
    assert_eq!(bounds.interval(&spots[..1], None), open);
    assert!(bounds.interval(&spots, None).unwrap().max_m().is_infinite());
    assert!(bounds.pair_interval(0.0, 1e-3).unwrap().max_m().is_infinite());
}

#[test]
fn numbers_that_are_none_widen_and_never_panic() {
    let bounds = DistanceBounds::new(&hexarotor(), f64::NAN);
    let camera_m = Vector3::new(5.0, 0.5, 0.3);
    let perfect = spots_from(&hexarotor(), camera_m, 0.0);
    let unknown_attitude = bounds.interval(&perfect, None).unwrap();
    let down = Unit::new_unchecked(-Vector3::z());
    assert_eq!(bounds.interval(&perfect, Some(&down)), Some(unknown_attitude), "any tilt is any attitude");
    let broken = Unit::new_unchecked(Vector3::new(f64::NAN, 0.0, 1.0));
    assert_eq!(bounds.interval(&perfect, Some(&broken)), Some(unknown_attitude));
    for bound_rad in [f64::NAN, f64::INFINITY, -1.0, 1e300] {
        let interval = bounds.interval(&spots_from(&hexarotor(), camera_m, bound_rad), Some(&down)).unwrap();
        assert!(interval.max_m().is_infinite());
        let pair = bounds.pair_interval(0.1, bound_rad).unwrap();
        assert!(pair.max_m().is_infinite());
        assert!(bounds.pair_interval(bound_rad, 0.1).unwrap().max_m().is_infinite());
    }
}

#[test]
fn wider_bounds_and_fewer_known_facts_never_narrow() {
    let bounds = DistanceBounds::new(&hexarotor(), DistanceBounds::DEFAULT_MAX_TILT_RAD);
    let down = Unit::new_unchecked(-Vector3::z());
    for direction in directions(300) {
        let camera_m = direction * 4.0;
        let tight = spots_from(&hexarotor(), camera_m, 1e-3);
        if tight.len() < 2 {
            continue;
        }
        let wide = spots_from(&hexarotor(), camera_m, 5e-3);
        let interval = bounds.interval(&tight, Some(&down)).unwrap();
        for wider in [bounds.interval(&wide, Some(&down)), bounds.interval(&tight, None)] {
            assert_eq!(wider.unwrap().intersect(&interval), Some(interval));
        }
    }
}
