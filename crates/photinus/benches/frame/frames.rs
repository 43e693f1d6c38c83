//! Frames to time: saturated spots with soft edges on a dark, noisy background.

use nalgebra::{Matrix2, Rotation3, Vector3};
use photinus::airframe::{Airframe, Marker};
use photinus::camera::{Bearing, Camera};
use photinus::ranging::SpotCurve;
use photinus::spots::{Extent, Spot};
use rand_distr::{Distribution, Normal, Uniform};
use rand_pcg::Pcg64;

/// The camera of the paper.
pub(crate) const PAPER: Size = Size { width: 752, height: 480 };
/// Frames of each scene.
pub(crate) const FRAMES: usize = 8;

/// Sides of a frame, px.
#[derive(Clone, Copy)]
pub(crate) struct Size {
    pub(crate) width: usize,
    pub(crate) height: usize,
}

impl Size {
    pub(crate) fn pixels(self) -> usize {
        self.width * self.height
    }
}

/// So many spots at least 16 px apart, with the sun on demand.
#[derive(Clone, Copy)]
pub(crate) struct Scene {
    pub(crate) size: Size,
    pub(crate) markers: usize,
    pub(crate) look: Look,
    pub(crate) sun: bool,
}

#[derive(Clone, Copy)]
pub(crate) enum Look {
    /// Saturated discs of 1 to 30 px (log-uniform).
    Disc,
    /// Points behind a lens with a core and a halo, whose summits are [`SUMMIT_DN`] (log-uniform): from what is barely seen to what is full.
    Point,
}

/// Summits of points, grey levels above darkness.
const SUMMIT_DN: [f64; 2] = [20.0, 4000.0];
/// Core and halo: shares of the summit, and sigmas, px.
const LENS: [(f64, f64); 2] = [(0.97, 0.6), (0.03, 1.8)];

/// Frames of a scene, each with its own places and noise.
pub(crate) fn markers(scene: &Scene) -> Vec<Vec<u8>> {
    (0..FRAMES as u64).map(|seed| frame(scene, &mut Pcg64::new(seed.into(), 5))).collect()
}

fn frame(&Scene { size, markers, look, sun }: &Scene, rng: &mut Pcg64) -> Vec<u8> {
    let background = Normal::new(5.0, 2.0).expect("a distribution");
    let mut light: Vec<f64> = (0..size.pixels()).map(|_| background.sample(rng)).collect();
    let (across, down) = (
        Uniform::new(20.0, size.width as f64 - 20.0).expect("a distribution"),
        Uniform::new(20.0, size.height as f64 - 20.0).expect("a distribution"),
    );
    let log_area = Uniform::new(0.0, libm::log(30.0)).expect("a distribution");
    let [low, high] = SUMMIT_DN.map(libm::log);
    let log_summit = Uniform::new(low, high).expect("a distribution");
    let mut places: Vec<(f64, f64)> = Vec::new();
    if sun {
        places.push((560.0, 120.0));
        add_sun(&mut light, size.width, places[0]);
    }
    while places.len() < markers + usize::from(sun) {
        let place = (across.sample(rng), down.sample(rng));
        let clear = if sun { 120.0 } else { 16.0 };
        let free = places.iter().enumerate().all(|(i, other)| {
            libm::hypot(place.0 - other.0, place.1 - other.1) > if i == 0 { clear } else { 16.0 }
        });
        if free {
            match look {
                Look::Disc => {
                    let radius = (libm::exp(log_area.sample(rng)) / std::f64::consts::PI).sqrt();
                    add_disc(&mut light, size.width, place, radius, 1.0);
                }
                Look::Point => {
                    add_point(&mut light, size.width, place, libm::exp(log_summit.sample(rng)));
                }
            }
            places.push(place);
        }
    }
    light.into_iter().map(|light| light.round().clamp(0.0, 255.0) as u8).collect()
}

/// A saturated disc whose edge falls off over `edge` px.
fn add_disc(light: &mut [f64], width: usize, (u, v): (f64, f64), radius: f64, edge: f64) {
    let reach = (radius + 4.0 * edge).ceil() as usize;
    for row in (v as usize).saturating_sub(reach)..(v as usize + reach + 1).min(light.len() / width) {
        for column in (u as usize).saturating_sub(reach)..(u as usize + reach + 1).min(width) {
            let beyond = libm::hypot(column as f64 - u, row as f64 - v) - radius;
            light[row * width + column] += 300.0 / (1.0 + libm::exp(beyond / (0.35 * edge)));
        }
    }
}

fn add_point(light: &mut [f64], width: usize, (u, v): (f64, f64), summit_dn: f64) {
    let reach = 9;
    for row in (v as usize).saturating_sub(reach)..(v as usize + reach + 1).min(light.len() / width) {
        for column in (u as usize).saturating_sub(reach)..(u as usize + reach + 1).min(width) {
            let (du, dv) = (column as f64 - u, row as f64 - v);
            let of_summit = |&(share, sigma): &(f64, f64)| {
                share * libm::exp(-0.5 * (du * du + dv * dv) / (sigma * sigma))
            };
            light[row * width + column] += summit_dn * LENS.iter().map(of_summit).sum::<f64>();
        }
    }
}

/// A saturated disc of 20 px, a halo, and six streaks.
fn add_sun(light: &mut [f64], width: usize, (u, v): (f64, f64)) {
    add_disc(light, width, (u, v), 20.0, 2.0);
    for (i, light) in light.iter_mut().enumerate() {
        let (du, dv) = ((i % width) as f64 - u, (i / width) as f64 - v);
        let distance = libm::hypot(du, dv);
        *light += 120.0 * libm::exp(-distance / 25.0);
        let angle = libm::atan2(dv, du) * 6.0 / std::f64::consts::TAU;
        let off = (angle - angle.round()).abs() * distance;
        *light += 200.0 * libm::exp(-off * off - distance / 40.0);
    }
}

/// Eight frames of `count` level hexarotors at random yaws, 2 to 8 m away (more than a dozen 5 to 10 m), spread over the
/// field.
pub(crate) fn hexarotors(count: usize, camera: &Camera, airframe: &Airframe) -> Vec<Vec<u8>> {
    let frame = |seed: u64| vehicles(count, camera, airframe, &mut Pcg64::new(seed.into(), 9), |_, _| true);
    (0..FRAMES as u64).map(frame).collect()
}

/// A frame of level vehicles as [`hexarotors`] has them, of which only those markers shine that are lit: asked by vehicle and marker.
pub(crate) fn vehicles(
    count: usize,
    camera: &Camera,
    airframe: &Airframe,
    rng: &mut Pcg64,
    is_lit: impl Fn(usize, usize) -> bool,
) -> Vec<u8> {
    let mut light = vec![5.0; PAPER.pixels()];
    let uniform = |low: f64, high: f64| Uniform::new(low, high).expect("a range");
    for index in 0..count {
        let few = count <= 12;
        let (across, step_rad) = if few { (6, 0.44) } else { (10, 0.24) };
        let (column, row) = (index % across, index / across);
        let azimuth = -1.1 + step_rad * column as f64;
        let lowest = if few { 0.0 } else { -0.6 };
        let elevation = lowest + 0.3 * row as f64 + uniform(-0.05, 0.05).sample(rng);
        let distance_m = if few { uniform(2.0, 8.0) } else { uniform(5.0, 10.0) }.sample(rng);
        let ahead = Vector3::new(
            libm::cos(elevation) * libm::sin(azimuth),
            -libm::sin(elevation),
            libm::cos(elevation) * libm::cos(azimuth),
        );
        let upright = Rotation3::from_basis_unchecked(&[Vector3::x(), Vector3::z(), -Vector3::y()]);
        let turn =
            Rotation3::from_axis_angle(&Vector3::z_axis(), uniform(0.0, std::f64::consts::TAU).sample(rng));
        add_airframe(&mut light, camera, airframe, &(upright * turn), ahead * distance_m, |marker| {
            is_lit(index, marker)
        });
    }
    light.into_iter().map(|light| light.round().clamp(0.0, 255.0) as u8).collect()
}

fn add_airframe(
    light: &mut [f64],
    camera: &Camera,
    airframe: &Airframe,
    camera_from_body: &Rotation3<f64>,
    place_m: Vector3<f64>,
    is_lit: impl Fn(usize) -> bool,
) {
    let camera_m = camera_from_body.inverse() * -place_m;
    for (marker, seen) in airframe.markers().iter().enumerate() {
        let marker_m = camera_from_body * seen.position_m + place_m;
        let intensity = airframe.intensity(marker, &camera_m);
        let pixel = Bearing::new(marker_m).and_then(|bearing| camera.pixel(&bearing));
        if let Some(pixel) = pixel.filter(|_| intensity > 0.05 && is_lit(marker)) {
            let area_px = intensity * f64::from(SpotCurve::paper_1000_us().max_area_px(marker_m.norm()));
            let radius = (area_px.max(1.0) / std::f64::consts::PI).sqrt();
            add_disc(light, PAPER.width, (pixel.u, pixel.v), radius, 1.0);
        }
    }
}

/// The spots of a level airframe straight ahead whose light is found, unsaturated.
pub(crate) fn spots(camera: &Camera, airframe: &Airframe, yaw_rad: f64, distance_m: f64) -> Vec<Spot> {
    let upright = Rotation3::from_basis_unchecked(&[Vector3::x(), Vector3::z(), -Vector3::y()]);
    let camera_from_body = upright * Rotation3::from_axis_angle(&Vector3::z_axis(), yaw_rad);
    let place_m = Vector3::new(0.0, 0.0, distance_m);
    let camera_m = camera_from_body.inverse() * -place_m;
    let spot = |(marker, seen): (usize, &Marker)| {
        let centre = camera.pixel(&Bearing::new(camera_from_body * seen.position_m + place_m)?)?;
        let intensity = airframe.intensity(marker, &camera_m);
        let (u, v) = (centre.u.round() as u32, centre.v.round() as u32);
        (intensity > 0.2).then_some(Spot {
            centre,
            covariance_px2: Matrix2::identity() * 0.0025,
            area_px: 4,
            peak: 180,
            saturated_px: 0,
            flux: 20_000.0 * intensity / (distance_m * distance_m),
            light: None,
            background: 5.0,
            marker_log_odds: 3.0,
            middle: (u, v),
            extent: Extent { left: u - 1, top: v - 1, right: u + 1, bottom: v + 1 },
        })
    };
    airframe.markers().iter().enumerate().filter_map(spot).collect()
}
