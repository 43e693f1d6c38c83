//! Accuracy as it was committed, number for number: the example `world` with the argument `snapshot`.

use photinus::camera::{Camera, Pixel};
use photinus_io::dataset::{TruthFrame, TruthLed, TruthNeighbour};
use photinus_sim::optics::{Lens, PointLight};
use photinus_sim::sensor::Charge;

use crate::{calibrated, cameras, row, snapshot};

#[test]
fn accuracy_is_what_was_committed() {
    let committed = std::fs::read_to_string(snapshot::FILE).unwrap_or_default();
    let today = snapshot::text();
    let pairs = committed.lines().zip(today.lines()).filter(|(committed, today)| committed != today);
    let changed: Vec<String> = pairs.map(|(committed, today)| format!("- {committed}\n+ {today}")).collect();
    assert!(
        committed == today,
        "accuracy has changed; if that is meant, run\n{}\n\n{}\n\nall of it:\n{today}",
        snapshot::UPDATE,
        changed.join("\n")
    );
}

#[test]
fn the_camera_that_is_told_maps_where_the_light_falls() {
    for name in ["coma", "coma-off-centre", "gaussian-0.6"] {
        let row::Eye { camera, preset, .. } = cameras::named(name);
        let told = calibrated::calibrated(&camera, &preset.lens);
        for (share_u, share_v) in [(0.5, 0.5), (0.2, 0.4), (0.7, 0.8), (0.55, 0.3)] {
            let chief = Pixel::new(
                (share_u * camera.width() as f64).round(),
                (share_v * camera.height() as f64).round(),
            );
            let bearing = camera.bearing(chief).unwrap();
            let seen = told.pixel(&bearing).unwrap();
            let light = centroid(&camera, &preset.lens, chief);
            let off_px = libm::hypot(seen.u - light[0], seen.v - light[1]);
            assert!(off_px < 2e-3, "{name}: {seen:?} not {light:?}");

            let mut truth = truth_of(chief);
            calibrated::to_centroids(&mut truth, &camera, &preset.lens);
            let led = &truth.neighbours[0].leds[0];
            assert!(
                libm::hypot(led.u_px - light[0], led.v_px - light[1]) < 2e-3,
                "{name}: {led:?} not {light:?}"
            );
        }
    }
}

/// The centroid of what the lens draws of a point.
fn centroid(camera: &Camera, lens: &Lens, place: Pixel) -> [f64; 2] {
    let mut charge = Charge::new(camera.width(), camera.height());
    let axis = camera.model().centre();
    let light = PointLight {
        u_px: place.u,
        v_px: place.v,
        electrons: 1e6,
        off_axis_rad: camera.bearing(place).unwrap().off_axis_rad(),
        radius_px: 0.0,
        among: 1.0,
        outward: PointLight::outward([place.u, place.v], [axis.u, axis.v]),
    };
    lens.spread.draw(&light, &mut charge);
    let (mut sum, mut moments) = (0.0, [0.0; 2]);
    for v in 0..charge.height() {
        for (u, &electrons) in charge.row(v).iter().enumerate() {
            sum += f64::from(electrons);
            moments[0] += f64::from(electrons) * u as f64;
            moments[1] += f64::from(electrons) * v as f64;
        }
    }
    moments.map(|moment| moment / sum)
}

fn truth_of(place: Pixel) -> TruthFrame {
    let led = TruthLed { u_px: place.u, v_px: place.v, led: Some(0) };
    let neighbour = TruthNeighbour {
        id: 1,
        position_m: [0.0, 0.0, 5.0],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        distance_m: 5.0,
        velocity_m_s: None,
        leds: vec![led],
    };
    TruthFrame { neighbours: vec![neighbour], ..TruthFrame::default() }
}
