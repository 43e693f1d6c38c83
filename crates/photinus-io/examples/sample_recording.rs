//! Writes a small recording to try the program on: three hexarotors around a camera, four frames, with truth.
//!
//!     cargo run -p photinus-io --example sample_recording -- FOLDER
//!
//! Markers are Gaussian spots on a dark, noisy background, as bright as inverse squares make them; a real camera does more.

use std::f64::consts::TAU;
use std::fs;
use std::path::PathBuf;

use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::{Bearing, Camera, Ideal, IdealLaw, Model, Pixel};
use photinus::frame::FrameView;
use photinus_io::airframe::parse_airframe;
use photinus_io::camera::write_camera_toml;
use photinus_io::dataset::{DatasetInfo, DatasetWriter, TruthFrame, TruthLed, TruthNeighbour};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

const AIRFRAME: &str = "\
# Six arms of 0.4 m, an LED at the end of each.
name = \"hexarotor-0.4\"
ring = { arms = 6, radius_m = 0.4, leds_per_arm = 1, splay_deg = 0.0 }
";
const WIDTH: usize = 752;
const HEIGHT: usize = 480;
const FRAMES: u32 = 4;
const RATE_HZ: f64 = 5.0;
/// Width (sigma) of a spot, px, and its height at 1 m, grey levels.
const SPOT_PX: f64 = 0.9;
const SPOT_DN: f64 = 6000.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("say which folder to write")?);
    let lens = Ideal::new(IdealLaw::Equidistant, [1.0 / 3.7673e-3; 2], Pixel::new(375.5, 239.5))?;
    let camera = Camera::new(Model::Ideal(lens), WIDTH, HEIGHT, None)?;
    let airframe = parse_airframe(AIRFRAME, folder.join("airframe.toml"))?.airframe;

    fs::create_dir_all(&folder)?;
    write_camera_toml(
        &camera,
        &mut fs::File::create(folder.join("camera.toml"))?,
        &folder.join("camera.toml"),
    )?;
    fs::write(folder.join("airframe.toml"), AIRFRAME)?;
    let info = DatasetInfo::parse(
        "camera = \"camera.toml\"\nairframe = \"airframe.toml\"\nexposure_us = 1000.0\nrate_hz = 5.0\n",
        folder.join("dataset.toml"),
    )?;
    let mut writer = DatasetWriter::create(&folder, &info)?;
    let mut rng = Pcg64::new(2018, 6);
    for index in 0..FRAMES {
        let time_s = f64::from(index) / RATE_HZ;
        let mut light = vec![0.0; WIDTH * HEIGHT];
        let neighbours = (0..3).map(|id| fly(id, time_s, &airframe, &camera, &mut light)).collect();
        let pixels = expose(&light, &mut rng);
        let frame = FrameView::packed(&pixels, WIDTH, HEIGHT)?;
        let number = writer.frame(&frame, time_s, Some(Vector3::y_axis()))?;
        writer.truth(&TruthFrame { frame: number, time_s, neighbours, ..TruthFrame::default() })?;
    }
    Ok(())
}

/// Moves a neighbour along, adds its light, and says where it is.
fn fly(id: u32, time_s: f64, airframe: &Airframe, camera: &Camera, light: &mut [f64]) -> TruthNeighbour {
    let (azimuth, height_m, distance_m) =
        [(-0.75, 0.3, 3.0), (0.12, -0.6, 6.5), (0.65, 0.9, 10.0)][id as usize % 3];
    let azimuth = azimuth + 0.1 * time_s;
    let place_m = Vector3::new(distance_m * libm::sin(azimuth), -height_m, distance_m * libm::cos(azimuth));
    let upright = Rotation3::from_basis_unchecked(&[Vector3::x(), Vector3::z(), -Vector3::y()]);
    let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), f64::from(id) + TAU * 0.1 * time_s);
    let camera_from_body = Rotation3::new(Vector3::new(0.05, 0.0, 0.08)) * upright * yaw;
    let camera_m = camera_from_body.inverse() * -place_m;
    let mut leds = Vec::new();
    for (marker, seen) in airframe.markers().iter().enumerate() {
        let marker_m = camera_from_body * seen.position_m + place_m;
        let intensity = airframe.intensity(marker, &camera_m);
        let pixel = Bearing::new(marker_m).and_then(|bearing| camera.pixel(&bearing));
        if let Some(pixel) = pixel.filter(|_| intensity > 0.0) {
            add_spot(light, pixel, SPOT_DN * intensity / marker_m.norm_squared());
            leds.push(TruthLed { u_px: pixel.u, v_px: pixel.v, led: Some(marker as u32) });
        }
    }
    let turn = UnitQuaternion::from_rotation_matrix(&camera_from_body).coords;
    TruthNeighbour {
        id,
        position_m: place_m.into(),
        orientation_xyzw: turn.into(),
        distance_m: place_m.norm(),
        velocity_m_s: None,
        leds,
    }
}

fn add_spot(light: &mut [f64], centre: Pixel, height: f64) {
    for (i, light) in light.iter_mut().enumerate() {
        let (du, dv) = ((i % WIDTH) as f64 - centre.u, (i / WIDTH) as f64 - centre.v);
        if du.abs() < 9.0 && dv.abs() < 9.0 {
            *light += height * libm::exp(-(du * du + dv * dv) / (2.0 * SPOT_PX * SPOT_PX));
        }
    }
}

fn expose(light: &[f64], rng: &mut Pcg64) -> Vec<u8> {
    let value = |light: &f64| {
        let noise: f64 = StandardNormal.sample(rng);
        (6.0 + light + noise * (0.3 * 0.3 + 0.03 * light).sqrt()).round().clamp(0.0, 255.0) as u8
    };
    light.iter().map(value).collect()
}
