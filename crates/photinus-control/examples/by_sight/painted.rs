//! A frame of one hexarotor, painted without a simulator: small round spots where its LEDs are.

use nalgebra::{Rotation3, Vector3};
use photinus::airframe::{Airframe, Ring};
use photinus::camera::{Bearing, Camera, Ideal, IdealLaw, Model, Pixel};

/// A fisheye of 752x480 pixels.
pub(crate) fn camera() -> Result<Camera, Box<dyn std::error::Error>> {
    let lens = Ideal::new(IdealLaw::Equidistant, [265.4; 2], Pixel::new(375.5, 239.5))?;
    Ok(Camera::new(Model::Ideal(lens), 752, 480, None)?)
}

/// The founding paper's hexarotor: arms of 0.4 m, an LED on each.
pub(crate) fn hexarotor() -> Result<Airframe, Box<dyn std::error::Error>> {
    let ring = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
    Ok(Airframe::from_ring("hexarotor", ring)?)
}

/// The frame of a camera that looks along x of the level frame at a level hexarotor at `place`, m, turned by `yaw_rad`.
pub(crate) fn paint(camera: &Camera, airframe: &Airframe, place: &Vector3<f64>, yaw_rad: f64) -> Vec<u8> {
    let level_from_body = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw_rad);
    let mut light = vec![0.0; 752 * 480];
    for marker in airframe.visible(level_from_body.inverse() * -place) {
        let at = place + level_from_body * airframe.markers()[marker].position_m;
        let Some(pixel) = Bearing::new(level_from_camera().inverse() * at).and_then(|b| camera.pixel(&b))
        else {
            continue;
        };
        for (index, pixel_light) in light.iter_mut().enumerate() {
            let (u, v) = ((index % 752) as f64, (index / 752) as f64);
            let off2 = (u - pixel.u) * (u - pixel.u) + (v - pixel.v) * (v - pixel.v);
            if off2 < 16.0 {
                *pixel_light += 250.0 * libm::exp(-off2 / (2.0 * 0.7 * 0.7));
            }
        }
    }
    light.into_iter().map(|light: f64| light.min(255.0) as u8).collect()
}

/// The camera looks ahead: its x is to the right, its y down, its z forward.
pub(crate) fn level_from_camera() -> Rotation3<f64> {
    Rotation3::from_matrix_unchecked(nalgebra::Matrix3::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0))
}
