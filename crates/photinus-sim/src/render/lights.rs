//! From vehicles to points of light on the sensor.

use nalgebra::{Isometry3, Point3, Vector3};
use photinus::airframe::Led;
use photinus::camera::{Bearing, Pixel};
use photinus_io::dataset::{TruthLed, TruthNeighbour};

use super::Renderer;
use crate::background::Water;
use crate::optics::PointLight;
use crate::snapshot::{LedLight, Snapshot, Vehicle};
use crate::source::{Lobe, lobe};

/// A vehicle and the camera at the three instants of the exposure of the rows that show it.
pub(super) struct Instants {
    pub(super) world_from_camera: [Isometry3<f64>; 3],
    pub(super) world_from_body: [Isometry3<f64>; 3],
    /// How much later than the first row these rows are exposed, s.
    delay_s: f64,
}

/// An LED during an exposure.
struct Source<'a> {
    led: &'a Led,
    lobe: Option<&'a Lobe>,
    light: &'a LedLight,
    /// Where it is at the middle, world frame, m.
    place_m: Vector3<f64>,
}

/// Light that goes from an LED to the camera, by whichever way.
pub(super) struct Ray {
    /// Where the camera sees the LED, world frame, at each instant, m.
    pub(super) seen_m: [Vector3<f64>; 3],
    /// Where the LED sees the camera, world frame, at the middle, m.
    pub(super) camera_m: Vector3<f64>,
    /// Share that a reflection leaves, against light that comes from where it is seen.
    pub(super) reflected: f64,
}

/// What shines during an exposure.
struct Streak {
    /// Where the camera sees it, world frame, at each instant, m.
    seen_m: [Vector3<f64>; 3],
    /// Intensity towards the camera against that of the mean part on its axis.
    power: f64,
    radius_m: f64,
}

impl Source<'_> {
    /// Intensity towards a place of the body frame against that of the mean part on its axis.
    fn power(&self, towards_m: Vector3<f64>) -> f64 {
        let ray_m = towards_m - self.led.position_m;
        let cos = self.led.axis.dot(&ray_m) / ray_m.norm();
        let lobe = self.lobe.map_or_else(|| lobe::told(&self.led.lobe, cos), |own| own.intensity(cos));
        lobe * self.led.power * self.light.power
    }
}

impl Renderer {
    /// Samples along a streak are not farther apart than this, px.
    const STREAK_STEP_PX: f64 = 0.25;
    /// Samples of a streak that is hardly one.
    const SHORT_STREAK: f64 = 18.0;
    /// Most samples of a streak: a thousand pixels of it.
    const MOST_SAMPLES: f64 = 4000.0;

    /// Draws all markers; gives the truth and the photo-electrons in all.
    pub(crate) fn draw_markers(&mut self, snapshot: &Snapshot) -> (Vec<TruthNeighbour>, f64) {
        let mut electrons = 0.0;
        let mut neighbours = Vec::with_capacity(snapshot.vehicles.len());
        let exposure = snapshot.exposure;
        let middle = exposure.share(0.5 * exposure.length_s);
        let camera_from_world = snapshot.camera.pose(middle).inverse();
        let span_s = exposure.span_s();
        for vehicle in &snapshot.vehicles {
            let camera_from_body = camera_from_world * vehicle.motion.pose(middle);
            let position_m = camera_from_body.translation.vector;
            let instants = self.instants(snapshot, vehicle, &position_m);
            let leds = self.draw_vehicle(snapshot, vehicle, &instants, &mut electrons);
            let q = camera_from_body.rotation.coords;
            let way_m = vehicle.motion.way_m() - snapshot.camera.way_m();
            let velocity_m_s = camera_from_world.rotation * way_m / span_s;
            neighbours.push(TruthNeighbour {
                id: vehicle.id,
                position_m: position_m.into(),
                orientation_xyzw: [q.x, q.y, q.z, q.w],
                distance_m: position_m.norm(),
                velocity_m_s: Some(velocity_m_s.into()),
                leds,
            });
        }
        (neighbours, electrons)
    }

    /// The poses at the instants at which the rows that show a vehicle are exposed.
    fn instants(&self, snapshot: &Snapshot, vehicle: &Vehicle, position_m: &Vector3<f64>) -> Instants {
        let row = Bearing::new(*position_m).and_then(|bearing| self.view.camera.pixel(&bearing));
        let delay_s = self.view.delay_s(row.map_or(0.0, |pixel| pixel.v));
        let exposure = snapshot.exposure;
        let shares = [0.0, 0.5, 1.0].map(|share| exposure.share(delay_s + share * exposure.length_s));
        Instants {
            world_from_camera: shares.map(|share| snapshot.camera.pose(share)),
            world_from_body: shares.map(|share| vehicle.motion.pose(share)),
            delay_s,
        }
    }

    fn draw_vehicle(
        &mut self,
        snapshot: &Snapshot,
        vehicle: &Vehicle,
        instants: &Instants,
        electrons: &mut f64,
    ) -> Vec<TruthLed> {
        let mut seen = Vec::new();
        for (number, (led, light)) in vehicle.airframe.leds().iter().zip(&vehicle.leds).enumerate() {
            let led_m = instants.world_from_body.map(|body| (body * Point3::from(led.position_m)).coords);
            let camera_m = instants.world_from_camera[1].translation.vector;
            let lobe = vehicle.looks.lobe.as_ref();
            let source = Source { led, lobe, light, place_m: led_m[1] };
            let direct = Ray { seen_m: led_m, camera_m, reflected: 1.0 };
            if let Some((pixel, drawn_e)) = self.draw_led(snapshot, &source, &direct, instants) {
                *electrons += drawn_e;
                seen.push(TruthLed { u_px: pixel.u, v_px: pixel.v, led: u32::try_from(number).ok() });
            }
            let over_water = snapshot.water.and_then(|water| mirrored(&water, &led_m, &camera_m));
            let drawn = over_water.and_then(|ray| self.draw_led(snapshot, &source, &ray, instants));
            *electrons += drawn.map_or(0.0, |(_, drawn_e)| drawn_e);
            for ray in self.mirrored(vehicle, &led_m[1], instants, snapshot) {
                let drawn = self.draw_led(snapshot, &source, &ray, instants);
                *electrons += drawn.map_or(0.0, |(_, drawn_e)| drawn_e);
            }
        }
        *electrons += self.draw_sun_in_mirrors(snapshot, vehicle, instants);
        seen
    }

    /// Draws the light of an LED along a ray; gives where and how much, or `None` when nothing arrives.
    fn draw_led(
        &mut self,
        snapshot: &Snapshot,
        source: &Source<'_>,
        ray: &Ray,
        instants: &Instants,
    ) -> Option<(Pixel, f64)> {
        let body_from_world = instants.world_from_body[1].inverse();
        let power = source.power((body_from_world * Point3::from(ray.camera_m)).coords);
        let length_s = snapshot.exposure.length_s;
        let lit = |from: f64, to: f64| {
            let at_s = |share: f64| instants.delay_s + share * length_s;
            source.light.lit.share(at_s(from), at_s(to))
        };
        if power <= 0.0 || lit(0.0, 1.0) <= 0.0 || is_hidden(snapshot, &ray.camera_m, &source.place_m) {
            return None;
        }
        let light =
            Streak { seen_m: ray.seen_m, power: power * ray.reflected, radius_m: snapshot.emitter.radius_m };
        self.draw_streak(snapshot, &light, &instants.world_from_camera, lit)
    }

    /// Draws what shines, and maybe moves, during an exposure; gives where it is at the middle and how much light came.
    fn draw_streak(
        &mut self,
        snapshot: &Snapshot,
        streak: &Streak,
        world_from_camera: &[Isometry3<f64>; 3],
        lit: impl Fn(f64, f64) -> f64,
    ) -> Option<(Pixel, f64)> {
        let path = self.path(&streak.seen_m, world_from_camera)?;
        let camera_from_world = world_from_camera[1].inverse();
        let seen_m = camera_from_world * Point3::from(streak.seen_m[1]);
        let bearing = Bearing::new(seen_m.coords)?;
        let distance_m = seen_m.coords.norm();
        let (lens, sensor, emitter) = (&self.view.lens, &self.view.sensor, &snapshot.emitter);
        let irradiance = emitter.irradiance_w_m2(streak.power, distance_m);
        let off_axis_rad = bearing.off_axis_rad();
        let power_w = lens.gathered_w(irradiance, off_axis_rad);
        let all_e = sensor.photo_electrons(power_w, snapshot.exposure.length_s, emitter.photon_j());
        let rad_per_px = self.view.camera.rad_per_px(path[1])?;
        let radius_px = streak.radius_m / distance_m / rad_per_px;
        let length_px = distance_px(&path[0], &path[1]) + distance_px(&path[1], &path[2]);
        let samples = (length_px / Self::STREAK_STEP_PX).ceil().clamp(1.0, Self::MOST_SAMPLES);
        // a short streak's samples are bright ones; those of a long one overlap in every pixel
        let among = samples / Self::SHORT_STREAK;
        let mut drawn_e = 0.0;
        for sample in 0..samples as usize {
            let (from, to) = (sample as f64 / samples, (sample as f64 + 1.0) / samples);
            let electrons = all_e * lit(from, to) / samples;
            let place = along(&path, 0.5 * (from + to));
            if self.own.hides(&place) {
                continue;
            }
            let outward = PointLight::outward([place.u, place.v], self.axis_px);
            let (u_px, v_px) = (place.u, place.v);
            let light = PointLight { u_px, v_px, electrons, off_axis_rad, radius_px, among, outward };
            lens.spread.draw(&light, &mut self.charge);
            drawn_e += electrons;
        }
        (drawn_e > 0.0).then_some((path[1], drawn_e))
    }

    /// Draws the lamps that are no markers; gives the photo-electrons.
    pub(super) fn draw_lamps(&mut self, snapshot: &Snapshot) -> f64 {
        let (exposure, mut drawn_e) = (snapshot.exposure, 0.0);
        for lamp in &snapshot.lamps {
            let shares = [0.0, 0.5, 1.0].map(|share| exposure.share(share * exposure.length_s));
            let seen_m = shares.map(|share| lamp.motion.pose(share).translation.vector);
            let world_from_camera = shares.map(|share| snapshot.camera.pose(share));
            if is_hidden(snapshot, &world_from_camera[1].translation.vector, &seen_m[1]) {
                continue;
            }
            let streak = Streak { seen_m, power: lamp.power, radius_m: lamp.radius_m };
            let drawn = self.draw_streak(snapshot, &streak, &world_from_camera, |_, _| 1.0);
            drawn_e += drawn.map_or(0.0, |(_, drawn_e)| drawn_e);
        }
        drawn_e
    }

    /// Where the LED is seen at the three instants; the middle one must be in the image.
    fn path(
        &self,
        seen_m: &[Vector3<f64>; 3],
        world_from_camera: &[Isometry3<f64>; 3],
    ) -> Option<[Pixel; 3]> {
        let pixel = |instant: usize| {
            let seen_m = world_from_camera[instant].inverse() * Point3::from(seen_m[instant]);
            Bearing::new(seen_m.coords).and_then(|bearing| self.view.camera.pixel(&bearing))
        };
        let middle = pixel(1)?;
        Some([pixel(0).unwrap_or(middle), middle, pixel(2).unwrap_or(middle)])
    }
}

/// Whether an airframe stands in the way, at the middle of the exposure.
pub(super) fn is_hidden(snapshot: &Snapshot, camera_m: &Vector3<f64>, led_m: &Vector3<f64>) -> bool {
    let exposure = snapshot.exposure;
    let middle = exposure.share(0.5 * exposure.length_s);
    snapshot.vehicles.iter().any(|vehicle| {
        if vehicle.solids.is_empty() {
            return false;
        }
        let world_from_body = vehicle.motion.pose(middle);
        let reach_m = vehicle.solids.iter().map(crate::occlusion::Solid::reach_m).fold(0.0, f64::max);
        let to_body =
            |point_m: &Vector3<f64>| world_from_body.inverse_transform_point(&Point3::from(*point_m)).coords;
        let (camera_m, led_m) = (to_body(camera_m), to_body(led_m));
        let along = led_m - camera_m;
        let nearest = camera_m - along * (camera_m.dot(&along) / along.norm_squared()).clamp(-1.0, 0.0);
        nearest.norm() <= reach_m && vehicle.solids.iter().any(|solid| solid.cuts(&camera_m, &led_m))
    })
}

/// The way over a water surface, when both ends are above it.
fn mirrored(water: &Water, led_m: &[Vector3<f64>; 3], camera_m: &Vector3<f64>) -> Option<Ray> {
    if led_m[1].z <= water.level_m || camera_m.z <= water.level_m {
        return None;
    }
    let seen_m = led_m.map(|led_m| water.mirrored(&led_m));
    let way_m = camera_m - seen_m[1];
    let reflected = Water::reflectance(way_m.z / way_m.norm());
    Some(Ray { seen_m, camera_m: water.mirrored(camera_m), reflected })
}

fn distance_px(a: &Pixel, b: &Pixel) -> f64 {
    libm::hypot(a.u - b.u, a.v - b.v)
}

/// The parabola through three places, at a share of the way from the first to the last.
fn along(path: &[Pixel; 3], share: f64) -> Pixel {
    let [a, b, c] = path;
    let weights =
        [(1.0 - share) * (1.0 - 2.0 * share), 4.0 * share * (1.0 - share), share * (2.0 * share - 1.0)];
    let mix = |x: f64, y: f64, z: f64| weights[0] * x + weights[1] * y + weights[2] * z;
    Pixel::new(mix(a.u, b.u, c.u), mix(a.v, b.v, c.v))
}
