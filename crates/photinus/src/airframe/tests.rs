use core::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Unit, Vector3};

use super::*;

fn led(position_m: [f64; 3], axis: [f64; 3]) -> Led {
    Led {
        position_m: Vector3::from(position_m),
        axis: Unit::new_normalize(Vector3::from(axis)),
        lobe: Lobe::Lambertian,
        power: 1.0,
        signal: None,
    }
}

fn ring(arms: usize, radius_m: f64, leds_per_arm: usize, splay_deg: f64) -> Result<Airframe, AirframeError> {
    Airframe::from_ring("ring", Ring { arms, radius_m, leds_per_arm, splay_rad: splay_deg.to_radians() })
}

/// A camera so far away that only its direction matters, `yaw_deg` from straight ahead.
fn far(yaw_deg: f64) -> Vector3<f64> {
    let (sin, cos) = libm::sincos(yaw_deg.to_radians());
    Vector3::new(cos, sin, 0.0) * 1e9
}

#[test]
fn hexarotor_has_its_first_led_forward_and_is_a_ring() {
    let hexarotor = ring(6, 0.4, 1, 0.0).unwrap();
    assert_eq!(hexarotor.markers().len(), 6);
    assert_eq!(hexarotor.leds()[0].position_m, Vector3::new(0.4, 0.0, 0.0));
    assert_eq!(*hexarotor.leds()[0].axis, Vector3::x());
    assert!(hexarotor.leds()[1].position_m.y > 0.0, "counter-clockwise from above");
    let geometry = hexarotor.ring().unwrap();
    assert_eq!(geometry.markers, 6);
    assert!((geometry.radius_m - 0.4).abs() < 1e-12);
    assert!((hexarotor.max_radius_m() - 0.4).abs() < 1e-12);
}

#[test]
fn two_leds_splayed_by_120_deg_shine_ahead_like_one() {
    let quadrotor = ring(4, 0.25, 2, 120.0).unwrap();
    assert_eq!((quadrotor.leds().len(), quadrotor.markers().len()), (8, 4));
    assert!((quadrotor.intensity(0, &far(0.0)) - 1.0).abs() < 1e-8);
}

#[test]
fn one_led_keeps_half_out_to_60_deg_and_nothing_past_90() {
    let hexarotor = ring(6, 0.4, 1, 0.0).unwrap();
    assert!((hexarotor.intensity(0, &far(60.0)) - 0.5).abs() < 1e-8);
    assert!(hexarotor.intensity(0, &far(59.0)) > 0.5);
    assert!(!hexarotor.is_visible(0, &far(91.0)));
    assert_eq!(hexarotor.visible(far(1.0)).collect::<Vec<_>>(), [0, 1, 5]);
}

#[test]
fn near_the_camera_an_led_is_seen_along_its_own_ray() {
    let pair = Airframe::new(
        "pair",
        vec![led([0.5, 0.0, 0.0], [0.0, 1.0, 0.0]), led([-0.5, 0.0, 0.0], [1.0, 0.0, 0.0])],
    );
    let camera_m = Vector3::new(0.0, 0.5, 0.0);
    let half = core::f64::consts::FRAC_1_SQRT_2;
    let pair = pair.unwrap();
    assert!((pair.intensity(0, &camera_m) - half).abs() < 1e-12);
    assert!((pair.intensity(1, &camera_m) - half).abs() < 1e-12);
}

#[test]
fn omni_shines_backwards_and_nothing_shines_on_itself_or_nowhere() {
    let mut back = led([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    back.lobe = Lobe::Omni;
    let airframe = Airframe::new("omni", vec![back, led([0.1, 0.0, 0.0], [1.0, 0.0, 0.0])]).unwrap();
    assert!(airframe.is_visible(0, &Vector3::new(-3.0, 0.0, 0.0)));
    assert!(!airframe.is_visible(0, &Vector3::zeros()));
    assert!(!airframe.is_visible(0, &Vector3::new(f64::NAN, 0.0, 0.0)));
    assert!(!airframe.is_visible(7, &far(0.0)), "a marker that does not exist");
}

#[test]
fn leds_within_3_cm_form_one_marker_transitively() {
    let x = [1.0, 0.0, 0.0];
    let leds = vec![
        led([0.0, 0.0, 0.0], x),
        led([0.05, 0.0, 0.0], x),
        led([0.025, 0.0, 0.0], x),
        led([0.2, 0.0, 0.0], x),
    ];
    let airframe = Airframe::new("chain", leds).unwrap();
    assert_eq!(airframe.markers()[0].leds, [0, 1, 2]);
    assert!((airframe.markers()[0].position_m.x - 0.025).abs() < 1e-12);
    assert!((airframe.markers()[0].spread_m - 0.025).abs() < 1e-12);
    assert_eq!(airframe.markers()[1].leds, [3]);
}

#[test]
fn a_list_that_is_a_ring_is_found_at_any_yaw_height_and_order() {
    let at = |yaw_deg: f64| {
        let (sin, cos) = libm::sincos(yaw_deg.to_radians());
        led([0.3 * cos, 0.3 * sin, 0.1], [cos, sin, 0.0])
    };
    let regular = Airframe::new("r", [163.0, -17.0, 73.0, -107.0].map(at).to_vec()).unwrap();
    let geometry = regular.ring().unwrap();
    assert_eq!(geometry.markers, 4);
    assert!((geometry.radius_m - 0.3).abs() < 1e-12);
    let skewed = Airframe::new("s", [160.0, -17.0, 73.0, -107.0].map(at).to_vec()).unwrap();
    assert_eq!(skewed.ring(), None);
    let mut raised = [163.0, -17.0, 73.0, -107.0].map(at).to_vec();
    raised[2].position_m.z = 0.2;
    assert_eq!(Airframe::new("z", raised).unwrap().ring(), None);
}

#[test]
fn impossible_leds_are_refused_by_name() {
    let good = led([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let refuse = |leds: Vec<Led>| Airframe::new("bad", leds).unwrap_err();
    assert_eq!(refuse(vec![]), AirframeError::NoLed);
    let near = led([0.02, 0.0, 0.0], [1.0, 0.0, 0.0]);
    assert_eq!(Airframe::new("lamp", vec![good.clone(), near.clone()]).unwrap().markers().len(), 1);
    assert_eq!(
        refuse(vec![good.clone(), near, good.clone()]),
        AirframeError::Duplicate { first: 0, second: 2 }
    );
    assert_eq!(
        refuse(vec![good.clone(), led([f64::NAN, 0.0, 0.0], [1.0, 0.0, 0.0])]),
        AirframeError::NotFinite { led: 1 }
    );
    assert_eq!(refuse(vec![good.clone(), led([0.0; 3], [0.0; 3])]), AirframeError::NotFinite { led: 1 });
    let stretched = Led { axis: Unit::new_unchecked(Vector3::new(2.0, 0.0, 0.0)), ..good.clone() };
    assert_eq!(refuse(vec![stretched]), AirframeError::Axis { led: 0 });
    let far = led([400.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    assert_eq!(refuse(vec![good.clone(), far]), AirframeError::TooFar { led: 1, distance_m: 400.0 });
    for power in [0.0, -1.0, f64::NAN, 1e4] {
        let weak = Led { power, ..good.clone() };
        assert!(matches!(refuse(vec![weak]), AirframeError::Power { led: 0, .. }));
    }
    let narrow = Led { lobe: Lobe::Cosine { power: -1.0 }, ..good.clone() };
    let error = LobeError::CosinePower { power: -1.0 };
    assert_eq!(refuse(vec![narrow]), AirframeError::Lobe { led: 0, error });
    assert_eq!(refuse(vec![good; 257]), AirframeError::TooManyLeds { leds: 257 });
}

#[test]
fn impossible_rings_are_refused_by_name() {
    assert_eq!(ring(2, 0.4, 1, 0.0), Err(AirframeError::RingArms { arms: 2 }));
    assert_eq!(ring(6, -0.4, 1, 0.0), Err(AirframeError::RingRadius { radius_m: -0.4 }));
    assert!(matches!(ring(6, f64::NAN, 1, 0.0), Err(AirframeError::RingRadius { .. })));
    assert_eq!(ring(6, 0.4, 3, 0.0), Err(AirframeError::RingLeds { leds_per_arm: 3 }));
    assert_eq!(
        ring(4, 0.4, 1, 90.0),
        Err(AirframeError::RingSplay { leds_per_arm: 1, splay_rad: FRAC_PI_2 })
    );
    for splay_deg in [0.0, -10.0, 181.0, f64::NAN] {
        assert!(matches!(ring(4, 0.4, 2, splay_deg), Err(AirframeError::RingSplay { .. })));
    }
    assert!(ring(4, 0.4, 2, PI.to_degrees()).is_ok());
    assert_eq!(ring(usize::MAX, 0.4, 2, 60.0), Err(AirframeError::TooManyLeds { leds: usize::MAX }));
    assert_eq!(ring(100, 0.1, 1, 0.0), Err(AirframeError::TooFewMarkers { leds: 100, markers: 1 }));
}

#[test]
fn power_and_lobe_of_each_led_make_the_light_of_its_marker() {
    let x = [1.0, 0.0, 0.0];
    let narrow = Led { power: 1.5, lobe: Lobe::Cosine { power: 3.0 }, ..led([0.0; 3], x) };
    let table = LobeTable::new(&[0.0, PI / 3.0, FRAC_PI_2], &[1.2, 0.6, 0.0]).unwrap();
    let tabled = Led { power: 0.5, lobe: Lobe::Table(table), ..led([0.0, 0.01, 0.0], x) };
    let airframe = Airframe::new("two kinds", vec![narrow, tabled, led([0.0, 0.5, 0.0], x)]).unwrap();
    assert!((airframe.intensity(0, &far(60.0)) - (1.5 * 0.125 + 0.5 * 0.6)).abs() < 1e-7);
    assert!((airframe.intensity(0, &far(0.0)) - (1.5 + 0.5 * 1.2)).abs() < 1e-7);
    assert!(!airframe.is_visible(0, &far(91.0)));
}
