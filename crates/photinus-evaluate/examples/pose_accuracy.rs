//! How good poses are, against the information bound: through rendered frames, and in pure geometry with a known pixel sigma.
//!
//! `cargo run --release -p photinus-evaluate --example pose_accuracy [neighbours per range] [sigma in px, 0 renders]`
//!
//! Single neighbours at a few ranges, any yaw, elevations to 20 deg, tilted by 4 deg (one sigma per axis), gravity known to
//! 0.3 deg. Beside each error stands the Cramer-Rao bound of the same views, with the priors as information: what is
//! possible, if which spot is which marker were known.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::path::Path;

use nalgebra::{Matrix2, Matrix6, Rotation3, Unit, UnitQuaternion, Vector3, Vector6};
use photinus::airframe::{Airframe, Ring};
use photinus::camera::{Bearing, Camera, Ideal, IdealLaw, Model, Pixel};
use photinus::locator::{Located, Locator, Settings, Sighting};
use photinus::pose;
use photinus::spots::{Extent, Spot};
use photinus_io::image::GreyImage;
use photinus_sim::motion::{Motion, Recorded};
use photinus_sim::{Scene, Simulator};
use rand_distr::{Distribution, StandardNormal, Uniform};
use rand_pcg::Pcg64;

const TILT_RAD: f64 = 4.0 * TAU / 360.0;
const GRAVITY_RAD: f64 = 0.3 * TAU / 360.0;
const UNIT_SIGMA: f64 = 0.1;
/// Light of an LED straight ahead at 1 m, and the least that is found, grey levels.
const POWER: f64 = 40_000.0;
const FAINTEST: f64 = 60.0;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let count = arguments.next().and_then(|text| text.parse().ok()).unwrap_or(2000);
    let sigma_px = arguments.next().and_then(|text| text.parse().ok()).unwrap_or(0.1);
    let hexarotor = Ring { arms: 6, radius_m: 0.4, leds_per_arm: 1, splay_rad: 0.0 };
    let quadrotor = Ring { arms: 4, radius_m: 0.245, leds_per_arm: 2, splay_rad: FRAC_PI_2 };
    println!("pixel sigma {sigma_px} px, {count} neighbours per range");
    println!(
        "airframe   range spots     n  distance RMSE    bound  ratio  bias    NEES(3)  in 95 %   yaw NEES  bounds"
    );
    for (name, ring) in [("hexarotor", hexarotor), ("quadrotor", quadrotor)] {
        let airframe = Airframe::from_ring(name, ring).expect("a ring");
        for distance_m in [2.0, 5.0, 10.0, 15.0] {
            row(&airframe, distance_m, sigma_px, count);
        }
    }
}

fn camera(sigma_px: f64) -> Camera {
    if sigma_px == 0.0 {
        return scene("time_s,x_m,y_m,z_m,qx,qy,qz,qw\n0,9,0,0,0,0,0,1\n", "hexarotor-0.4", 0).cameras[0]
            .camera
            .clone();
    }
    let lens =
        Ideal::new(IdealLaw::Equidistant, [1.0 / 3.7673e-3; 2], Pixel::new(375.5, 239.5)).expect("a lens");
    Camera::new(Model::Ideal(lens), 752, 480, None).expect("a camera")
}

#[derive(Default, Clone, Copy)]
struct Tally {
    count: f64,
    square: f64,
    bias: f64,
    bound: f64,
    nees: f64,
    inside: f64,
    yaw: f64,
    held: f64,
}

fn row(airframe: &Airframe, distance_m: f64, sigma_px: f64, count: usize) {
    let mut rng = Pcg64::new(7, 11);
    let camera = camera(sigma_px);
    let settings = Settings {
        pose: pose::Settings {
            tilt_sigma_rad: libm::hypot(TILT_RAD, GRAVITY_RAD),
            marker_sigma_m: 0.0,
            unit_sigma: if sigma_px == 0.0 { 0.06 } else { UNIT_SIGMA },
            ..pose::Settings::default()
        },
        ..Settings::default()
    };
    let mut locator = Locator::new(camera.clone(), airframe, None, settings).expect("a locator");
    let mut tallies = [Tally::default(); 8];
    let mut frames = Vec::new();
    let mut missed = 0;
    for number in 0..count {
        if sigma_px == 0.0 && frames.is_empty() {
            frames = render(airframe, distance_m, number as u64, &mut rng);
        }
        let rendered = frames.pop();
        let (view, located, markers) = if let Some((view, image)) = &rendered {
            let located = locator.locate(&image.view(), Some(&view.gravity), &mut |_| ()).expect("a frame");
            (view, located, view.matched(airframe, located))
        } else {
            let view = View::draw(distance_m, &mut rng);
            let (spots, markers) = view.spots(airframe, &camera, sigma_px, &mut rng);
            let located = locator.locate_spots(&spots, Some(&view.gravity), &mut |_| ());
            (&*Box::leak(Box::new(view)), located, markers)
        };
        if located.neighbours.is_empty() {
            missed += 1;
            continue;
        }
        let bound_m2 = view.bound_m2(airframe, &markers);
        let of_most = located.neighbours.iter().max_by_key(|neighbour| located.members(neighbour).len());
        if let Some((view, _)) = &rendered {
            if std::env::var("SPOTS").is_ok() {
                for (i, s) in located.sightings.iter().enumerate() {
                    let at = |m: &usize| {
                        camera
                            .pixel(
                                &Bearing::new(
                                    view.camera_from_body * airframe.markers()[*m].position_m
                                        + view.position_m,
                                )
                                .unwrap(),
                            )
                            .unwrap()
                    };
                    let gap = |m: &usize| {
                        let p = at(m);
                        (p.u - s.spot.centre.u).hypot(p.v - s.spot.centre.v)
                    };
                    let m = (0..airframe.markers().len()).min_by(|a, b| gap(a).total_cmp(&gap(b))).unwrap();
                    let p = at(&m);
                    let near = located
                        .sightings
                        .iter()
                        .enumerate()
                        .filter(|(j, _)| *j != i)
                        .map(|(_, o)| {
                            (
                                (o.spot.centre.u - s.spot.centre.u).hypot(o.spot.centre.v - s.spot.centre.v),
                                o.spot.flux / s.spot.flux,
                            )
                        })
                        .min_by(|a, b| a.0.total_cmp(&b.0))
                        .unwrap_or((99.0, 0.0));
                    let c = -(view.camera_from_body.inverse() * view.position_m);
                    let light =
                        airframe.intensity(m, &c) / (c - airframe.markers()[m].position_m).norm_squared();
                    eprintln!(
                        "S,{distance_m},{},{},{},{:.4},{:.4},{:.4},{:.2},{:.3},{:.1},{:.1},{:.6},{:.6}",
                        s.spot.area_px,
                        s.spot.peak,
                        s.spot.saturated_px,
                        s.spot.centre.u - p.u,
                        s.spot.centre.v - p.v,
                        s.spot.sigma_px(),
                        near.0,
                        near.1,
                        s.spot.flux,
                        s.spot.background,
                        light,
                        airframe.intensity(m, &c)
                    );
                }
            }
        }
        let neighbour = of_most.expect("no view without an answer");
        let used = located.members(neighbour).len();
        let (Some(estimate), Some(position), Some(orientation)) =
            (neighbour.distance.estimate, neighbour.position, neighbour.orientation)
        else {
            continue;
        };
        let tally = &mut tallies[used];
        let off = position.mean_m - view.position_m;
        let nees =
            position.covariance_m2.cholesky().map_or(f64::INFINITY, |factor| off.dot(&factor.solve(&off)));
        tally.count += 1.0;
        if std::env::var("DBG").is_ok() && used == 2 && tally.count < 12.0 {
            eprintln!(
                "true {:.3} est {:.3} sigma {:.3}",
                view.position_m.norm(),
                estimate.distance_m,
                estimate.sigma_m
            );
            for m in located.modes(neighbour) {
                let a = m.pose.position_m.normalize();
                eprintln!(
                    "   w {:.4} d {:.3} sd {:.4} yaw sd {:.3}",
                    m.weight,
                    m.pose.position_m.norm(),
                    (a.dot(&(m.position_covariance_m2 * a))).sqrt(),
                    m.orientation_covariance_rad2[(2, 2)].sqrt()
                );
            }
        }
        if std::env::var("OUT").is_ok() && nees > 25.0 {
            eprintln!(
                "nees {nees:.0} spots {used} of {} true {:.3} est {:.3} sigma {:.3} bound {:.3}",
                located.sightings.len(),
                view.position_m.norm(),
                estimate.distance_m,
                estimate.sigma_m,
                bound_m2.sqrt()
            );
            let camera_m = -(view.camera_from_body.inverse() * view.position_m);
            for s in &located.sightings {
                let gap = |m: &usize| {
                    s.bearing.angle_to(
                        &Bearing::new(
                            view.camera_from_body * airframe.markers()[*m].position_m + view.position_m,
                        )
                        .unwrap(),
                    )
                };
                let m = (0..airframe.markers().len()).min_by(|a, b| gap(a).total_cmp(&gap(b))).unwrap();
                let truth = camera
                    .pixel(
                        &Bearing::new(
                            view.camera_from_body * airframe.markers()[m].position_m + view.position_m,
                        )
                        .unwrap(),
                    )
                    .unwrap();
                eprintln!(
                    "  at {:.3} {:.3} truth {:.3} {:.3}",
                    s.spot.centre.u, s.spot.centre.v, truth.u, truth.v
                );
                if let Some((_, image)) = &rendered {
                    let f = image.view();
                    for v in (truth.v.round() as usize - 4)..=(truth.v.round() as usize + 4) {
                        let row: Vec<_> = ((truth.u.round() as usize - 4)..=(truth.u.round() as usize + 4))
                            .map(|u| f.row(v)[u])
                            .collect();
                        eprintln!("      {row:?}");
                    }
                }
                eprintln!(
                    "   spot area {} peak {} sat {} flux {:.0} sigma {:.3} px; marker {m} I {:.3} off {:.2} sigma",
                    s.spot.area_px,
                    s.spot.peak,
                    s.spot.saturated_px,
                    s.spot.flux,
                    s.spot.sigma_px(),
                    airframe.intensity(m, &camera_m),
                    gap(&m) / (s.covariance_rad2.trace() / 2.0).sqrt()
                );
            }
            for m in 0..airframe.markers().len() {
                eprint!(" I{m}={:.3}", airframe.intensity(m, &camera_m));
            }
            eprintln!(
                " rejected {:?}",
                located.rejected.iter().map(|r| (r.reason, r.peak)).collect::<Vec<_>>()
            );
            for m in located.modes(neighbour).iter().take(3) {
                let a = m.pose.position_m.normalize();
                eprintln!(
                    "   w {:.4} d {:.3} sd {:.4} yaw sd {:.3}",
                    m.weight,
                    m.pose.position_m.norm(),
                    (a.dot(&(m.position_covariance_m2 * a))).sqrt(),
                    m.orientation_covariance_rad2[(2, 2)].sqrt()
                );
            }
        }
        let distance_off = estimate.distance_m - view.position_m.norm();
        tally.square += distance_off * distance_off;
        tally.bias += distance_off;
        tally.bound += bound_m2;
        tally.nees += nees.min(1000.0);
        tally.inside += f64::from(u8::from(nees < 7.815));
        tally.held += f64::from(u8::from(neighbour.distance.bounds.contains(view.position_m.norm())));
        let sector = TAU / if airframe.markers().len() == 6 { 6.0 } else { 4.0 };
        let turn = (orientation.camera_from_body.inverse() * view.camera_from_body).scaled_axis().z;
        let turn = turn - (turn / sector).round() * sector;
        tally.yaw += turn * turn / orientation.covariance_rad2[(2, 2)];
    }
    if missed > 0 {
        println!("{:9} {distance_m:5.0} m nothing found {missed} times", airframe.name());
    }
    for (spots, tally) in tallies.iter().enumerate().filter(|(_, tally)| tally.count > 0.0) {
        let n = tally.count;
        println!(
            "{:9} {distance_m:5.0} m {spots:5} {n:5.0} {:11.4} m {:8.4} {:6.2} {:+6.3} {:9.2} {:9.1} {:9.2} {:8.1}",
            airframe.name(),
            (tally.square / n).sqrt(),
            (tally.bound / n).sqrt(),
            (tally.square / tally.bound).sqrt(),
            tally.bias / n,
            tally.nees / n,
            100.0 * tally.inside / n,
            tally.yaw / n,
            100.0 * tally.held / n,
        );
    }
}

const BATCH: usize = 50;

fn scene(poses: &str, airframe: &str, seed: u64) -> Scene {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes"));
    let text = format!(
        r#"name = "poses"
        seed = {seed}
        preset = "bluefox-dsl215-bp365"
        rate_hz = 1.0
        duration_s = {BATCH}.0
        exposure_us = 1000.0
        [observer]
        motion = {{ hover = {{ position_m = [0.0, 0.0, 0.0] }} }}
        wind_m_s = 0.0
        heading_deg = 0.0
        [[camera]]
        name = "front"
        file = "cameras/bluefox-dsl215.toml"
        position_m = [0.0, 0.0, 0.0]
        [[target]]
        id = 1
        airframe = "airframes/{airframe}.toml"
        motion = {{ hover = {{ position_m = [5.0, 0.0, 0.0] }} }}
        solid = [{{ cylinder = {{ centre_m = [0.0, 0.0, 0.0], radius_m = 0.12, half_height_m = 0.08 }} }}]
        "#
    );
    let mut scene = Scene::parse(&text, folder.join("poses.toml")).expect("a scene");
    scene.targets[0].motion =
        Motion::Recorded(Recorded::parse(poses, Path::new("poses.csv")).expect("poses"));
    scene
}

/// Frames with a neighbour each, of a batch of poses with LEDs of their own.
fn render(airframe: &Airframe, distance_m: f64, seed: u64, rng: &mut Pcg64) -> Vec<(View, GreyImage)> {
    let world_from_camera = Rotation3::from_basis_unchecked(&[-Vector3::y(), -Vector3::z(), Vector3::x()]);
    let mut poses = String::from("time_s,x_m,y_m,z_m,qx,qy,qz,qw\n");
    let views: Vec<View> = (0..BATCH).map(|_| View::draw(distance_m, rng)).collect();
    for (second, view) in views.iter().enumerate() {
        let place = world_from_camera * view.position_m;
        let turn = UnitQuaternion::from_rotation_matrix(&(world_from_camera * view.camera_from_body));
        for time_s in [second as f64, second as f64 + 0.9] {
            let row = [time_s, place.x, place.y, place.z, turn.i, turn.j, turn.k, turn.w];
            poses += &row.map(|number| number.to_string()).join(",");
            poses.push('\n');
        }
    }
    let name = if airframe.markers().len() == 6 { "hexarotor-0.4" } else { "quadrotor-0.245" };
    let scene = scene(&poses, name, seed);
    let mut simulator = Simulator::new(&scene, 0).expect("a camera");
    let rendered: Vec<_> = simulator.frames().map(|frame| frame.image).collect();
    views.into_iter().zip(rendered).collect()
}

/// A neighbour, and what is known of the vertical.
struct View {
    position_m: Vector3<f64>,
    camera_from_body: Rotation3<f64>,
    gravity: Unit<Vector3<f64>>,
}

fn normal(rng: &mut Pcg64) -> f64 {
    StandardNormal.sample(rng)
}

fn uniform(rng: &mut Pcg64, low: f64, high: f64) -> f64 {
    Uniform::new(low, high).expect("a range").sample(rng)
}

impl View {
    fn draw(distance_m: f64, rng: &mut Pcg64) -> Self {
        let (azimuth, elevation) = (uniform(rng, -1.0, 1.0), uniform(rng, -0.35, 0.35));
        let ahead = Vector3::new(
            libm::cos(elevation) * libm::sin(azimuth),
            -libm::sin(elevation),
            libm::cos(elevation) * libm::cos(azimuth),
        );
        let upright = Rotation3::from_basis_unchecked(&[Vector3::x(), Vector3::z(), -Vector3::y()]);
        let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), uniform(rng, 0.0, TAU));
        let tilt = Rotation3::new(Vector3::new(normal(rng), 0.0, normal(rng)) * TILT_RAD);
        let off = Rotation3::new(Vector3::new(normal(rng), 0.0, normal(rng)) * GRAVITY_RAD);
        Self {
            position_m: ahead * distance_m,
            camera_from_body: tilt * upright * yaw,
            gravity: Unit::new_normalize(off * Vector3::y()),
        }
    }

    fn spots(
        &self,
        airframe: &Airframe,
        camera: &Camera,
        sigma_px: f64,
        rng: &mut Pcg64,
    ) -> (Vec<Spot>, Vec<(usize, f64)>) {
        let camera_m = -(self.camera_from_body.inverse() * self.position_m);
        let (mut spots, mut markers) = (Vec::new(), Vec::new());
        for marker in 0..airframe.markers().len() {
            let arm_m = airframe.markers()[marker].position_m;
            let flux = POWER * airframe.intensity(marker, &camera_m) / (camera_m - arm_m).norm_squared()
                * libm::exp(UNIT_SIGMA * normal(rng));
            if flux < FAINTEST {
                continue;
            }
            let place = self.camera_from_body * arm_m + self.position_m;
            let Some(pixel) = Bearing::new(place).and_then(|bearing| camera.pixel(&bearing)) else {
                continue;
            };
            let centre = Pixel::new(pixel.u + sigma_px * normal(rng), pixel.v + sigma_px * normal(rng));
            let (u, v) = (pixel.u.round() as u32, pixel.v.round() as u32);
            let extent = Extent { left: u.max(1) - 1, top: v.max(1) - 1, right: u + 1, bottom: v + 1 };
            // An equidistant lens: the same angle per pixel along the radius, nearly so across it.
            markers.push((marker, sigma_px * 3.7673e-3));
            spots.push(Spot {
                centre,
                covariance_px2: Matrix2::identity() * (sigma_px * sigma_px),
                area_px: 4,
                peak: 200,
                saturated_px: 0,
                flux,
                background: 5.0,
                middle: (u, v),
                extent,
            });
        }
        (spots, markers)
    }

    /// The markers behind the spots, each with the sigma of its direction, rad.
    fn matched(&self, airframe: &Airframe, located: &Located) -> Vec<(usize, f64)> {
        let nearest = |sighting: &Sighting| {
            let gap = |marker: &usize| {
                let place = self.camera_from_body * airframe.markers()[*marker].position_m + self.position_m;
                sighting.bearing.angle_to(&Bearing::new(place).expect("a direction"))
            };
            (0..airframe.markers().len()).min_by(|a, b| gap(a).total_cmp(&gap(b))).expect("a marker")
        };
        let sigma_rad = |sighting: &Sighting| (sighting.covariance_rad2.trace() / 2.0).sqrt();
        located.sightings.iter().map(|sighting| (nearest(sighting), sigma_rad(sighting))).collect()
    }

    /// The Cramer-Rao bound of the variance of distance, by numeric derivatives of all that is measured or believed.
    fn bound_m2(&self, airframe: &Airframe, markers: &[(usize, f64)]) -> f64 {
        let measured = |step: &Vector6<f64>| -> Vec<f64> {
            let position_m = self.position_m + step.fixed_rows::<3>(0);
            let turn = Rotation3::new(step.fixed_rows::<3>(3).into_owned());
            let camera_from_body = self.camera_from_body * turn;
            let camera_m = -(camera_from_body.inverse() * position_m);
            let mut numbers = Vec::new();
            let mut lights = Vec::new();
            for &(marker, sigma_rad) in markers {
                let arm_m = airframe.markers()[marker].position_m;
                let seen = (camera_from_body * arm_m + position_m).normalize();
                numbers.extend(seen.iter().map(|number| number / sigma_rad));
                let intensity = airframe.intensity(marker, &camera_m).max(1e-6);
                lights.push(libm::log(intensity) - libm::log((camera_m - arm_m).norm_squared()));
            }
            let mean = lights.iter().sum::<f64>() / lights.len() as f64;
            numbers.extend(lights.iter().map(|light| (light - mean) / UNIT_SIGMA));
            let up = camera_from_body.inverse() * -Vector3::y();
            let tilt = libm::hypot(TILT_RAD, GRAVITY_RAD);
            numbers.extend([up.x / tilt, up.y / tilt]);
            numbers
        };
        let columns: Vec<Vec<f64>> = (0..6)
            .map(|axis| {
                let mut step = Vector6::zeros();
                step[axis] = 1e-6;
                let (ahead, behind) = (measured(&step), measured(&-step));
                ahead.iter().zip(&behind).map(|(a, b)| (a - b) / 2e-6).collect()
            })
            .collect();
        let mut information = Matrix6::from_fn(|row, column| {
            columns[row].iter().zip(&columns[column]).map(|(a, b)| a * b).sum::<f64>()
        });
        // The prior on distance of a lone spot: something has to be believed.
        let ahead = self.position_m.normalize();
        let mut along = Vector6::zeros();
        along.fixed_rows_mut::<3>(0).copy_from(&(ahead / self.position_m.norm() / 0.6));
        if markers.len() == 1 {
            information += along * along.transpose();
            information[(5, 5)] += 1.0;
        }
        let covariance = information.try_inverse().expect("an invertible information");
        let position = covariance.fixed_view::<3, 3>(0, 0);
        ahead.dot(&(position * ahead))
    }
}
