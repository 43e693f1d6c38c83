//! From robots to points of light on the sensor.

use nalgebra::{Isometry3, Point3, Vector3};
use photinus::airframe::Led;
use photinus::camera::{Bearing, Pixel};
use photinus_io::dataset::{TruthLed, TruthNeighbour};

use super::{Exposure, Simulator};
use crate::background::Water;
use crate::optics::PointLight;
use crate::scene::Target;
use crate::source::Blink;

/// A robot and the camera at the three instants of an exposure.
struct Instants {
    world_from_camera: [Isometry3<f64>; 3],
    world_from_body: [Isometry3<f64>; 3],
    exposure: Exposure,
}

/// An LED during an exposure.
struct Source<'a> {
    led: &'a Led,
    /// How bright this unit is against the mean one.
    factor: f64,
    blink: Option<Blink>,
    /// Where it is at the middle, world frame, m.
    place_m: Vector3<f64>,
}

/// Light that goes from an LED to the camera, by whichever way.
struct Ray {
    /// Where the camera sees the LED, world frame, at each instant, m.
    seen_m: [Vector3<f64>; 3],
    /// Where the LED sees the camera, world frame, at the middle, m.
    camera_m: Vector3<f64>,
    /// Share that a reflection leaves.
    reflected: f64,
}

impl Simulator<'_> {
    /// Samples along a streak are not farther apart than this, px.
    const STREAK_STEP_PX: f64 = 0.25;

    /// Draws all markers; gives the truth and the photo-electrons in all.
    pub(super) fn draw_markers(&mut self, exposure: Exposure) -> (Vec<TruthNeighbour>, f64) {
        let scene = self.scene;
        let mut electrons = 0.0;
        let mut neighbours = Vec::with_capacity(scene.targets.len());
        let middle_s = exposure.instants_s()[1];
        let world_from_camera = exposure.instants_s().map(|time_s| self.world_from_camera(time_s));
        let bodies: Vec<Isometry3<f64>> =
            scene.targets.iter().map(|target| target.motion.pose(middle_s)).collect();
        for (index, target) in scene.targets.iter().enumerate() {
            let camera_from_body = world_from_camera[1].inverse() * bodies[index];
            let position_m = camera_from_body.translation.vector;
            let instants = self.instants(target, exposure, &position_m);
            let leds = self.draw_target(index, &instants, &bodies, &mut electrons);
            let q = camera_from_body.rotation.coords;
            neighbours.push(TruthNeighbour {
                id: target.id,
                position_m: position_m.into(),
                orientation_xyzw: [q.x, q.y, q.z, q.w],
                distance_m: position_m.norm(),
                leds,
            });
        }
        (neighbours, electrons)
    }

    /// The poses at the instants at which the rows that show a target are exposed.
    fn instants(&self, target: &Target, exposure: Exposure, position_m: &Vector3<f64>) -> Instants {
        let row = Bearing::new(*position_m).and_then(|bearing| self.mounted.camera.pixel(&bearing));
        let exposure = exposure.delayed(self.delay_s(row.map_or(0.0, |pixel| pixel.v)));
        let instants_s = exposure.instants_s();
        Instants {
            world_from_camera: instants_s.map(|time_s| self.world_from_camera(time_s)),
            world_from_body: instants_s.map(|time_s| target.motion.pose(time_s)),
            exposure,
        }
    }

    fn draw_target(
        &mut self,
        index: usize,
        instants: &Instants,
        bodies: &[Isometry3<f64>],
        electrons: &mut f64,
    ) -> Vec<TruthLed> {
        let target = &self.scene.targets[index];
        let mut seen = Vec::new();
        for (number, led) in target.airframe.leds().iter().enumerate() {
            let led_m = instants.world_from_body.map(|body| (body * Point3::from(led.position_m)).coords);
            let camera_m = instants.world_from_camera[1].translation.vector;
            let blink = target.blink.as_ref().and_then(|plan| plan.of(led));
            let light = Source { led, factor: self.unit_factors[index][number], blink, place_m: led_m[1] };
            let direct = Ray { seen_m: led_m, camera_m, reflected: 1.0 };
            if let Some((pixel, drawn_e)) = self.draw_led(&light, &direct, instants, bodies) {
                *electrons += drawn_e;
                seen.push(TruthLed { u_px: pixel.u, v_px: pixel.v, led: u32::try_from(number).ok() });
            }
            let over_water = self.scene.water.and_then(|water| mirrored(&water, &led_m, &camera_m));
            let drawn = over_water.and_then(|ray| self.draw_led(&light, &ray, instants, bodies));
            *electrons += drawn.map_or(0.0, |(_, drawn_e)| drawn_e);
        }
        seen
    }

    /// Draws the light of an LED along a ray; gives where and how much, or `None` when nothing arrives.
    fn draw_led(
        &mut self,
        source: &Source<'_>,
        ray: &Ray,
        instants: &Instants,
        bodies: &[Isometry3<f64>],
    ) -> Option<(Pixel, f64)> {
        let body_from_world = instants.world_from_body[1].inverse();
        let lobe = source.led.intensity(&(body_from_world * Point3::from(ray.camera_m)).coords);
        let exposure = instants.exposure;
        let lit = |from: f64, to: f64| {
            let at = |share: f64| exposure.start_s + share * exposure.length_s;
            source.blink.as_ref().map_or(1.0, |blink| blink.share(at(from), at(to)))
        };
        if lobe <= 0.0 || lit(0.0, 1.0) <= 0.0 || self.is_hidden(&ray.camera_m, &source.place_m, bodies) {
            return None;
        }
        let path = self.path(ray, instants)?;
        let camera_from_world = instants.world_from_camera[1].inverse();
        let seen_m = camera_from_world * Point3::from(ray.seen_m[1]);
        let bearing = Bearing::new(seen_m.coords)?;
        let distance_m = seen_m.coords.norm();
        let preset = &self.scene.preset;
        let irradiance = preset.emitter.irradiance_w_m2(lobe * source.factor * ray.reflected, distance_m);
        let off_axis_rad = bearing.off_axis_rad();
        let power_w = preset.lens.gathered_w(irradiance, off_axis_rad);
        let all_e = preset.sensor.photo_electrons(power_w, exposure.length_s, preset.emitter.photon_j());
        let rad_per_px = self.mounted.camera.rad_per_px(path[1])?;
        let radius_px = preset.emitter.radius_m / distance_m / rad_per_px;
        let length_px = distance_px(&path[0], &path[1]) + distance_px(&path[1], &path[2]);
        let samples = (length_px / Self::STREAK_STEP_PX).ceil().clamp(1.0, 400.0);
        let mut drawn_e = 0.0;
        for sample in 0..samples as usize {
            let (from, to) = (sample as f64 / samples, (sample as f64 + 1.0) / samples);
            let electrons = all_e * lit(from, to) / samples;
            let place = along(&path, 0.5 * (from + to));
            let outward = PointLight::outward([place.u, place.v], self.axis_px);
            let light =
                PointLight { u_px: place.u, v_px: place.v, electrons, off_axis_rad, radius_px, outward };
            preset.lens.spread.draw(&light, &mut self.charge);
            drawn_e += electrons;
        }
        Some((path[1], drawn_e))
    }

    /// Where the LED is seen at the three instants; the middle one must be in the image.
    fn path(&self, ray: &Ray, instants: &Instants) -> Option<[Pixel; 3]> {
        let pixel = |instant: usize| {
            let seen_m = instants.world_from_camera[instant].inverse() * Point3::from(ray.seen_m[instant]);
            Bearing::new(seen_m.coords).and_then(|bearing| self.mounted.camera.pixel(&bearing))
        };
        let middle = pixel(1)?;
        Some([pixel(0).unwrap_or(middle), middle, pixel(2).unwrap_or(middle)])
    }

    /// Whether an airframe stands in the way.
    fn is_hidden(&self, camera_m: &Vector3<f64>, led_m: &Vector3<f64>, bodies: &[Isometry3<f64>]) -> bool {
        self.scene.targets.iter().zip(bodies).any(|(target, world_from_body)| {
            if target.solids.is_empty() {
                return false;
            }
            let reach_m = target.solids.iter().map(crate::occlusion::Solid::reach_m).fold(0.0, f64::max);
            let to_body = |point_m: &Vector3<f64>| {
                world_from_body.inverse_transform_point(&Point3::from(*point_m)).coords
            };
            let (camera_m, led_m) = (to_body(camera_m), to_body(led_m));
            let along = led_m - camera_m;
            let nearest = camera_m - along * (camera_m.dot(&along) / along.norm_squared()).clamp(-1.0, 0.0);
            nearest.norm() <= reach_m && target.solids.iter().any(|solid| solid.cuts(&camera_m, &led_m))
        })
    }
}

impl crate::scene::BlinkPlan {
    /// The signal of an LED.
    fn of(&self, led: &Led) -> Option<Blink> {
        let word = self.codes.words().get(self.first_word + led.signal.unwrap_or(0) as usize)?;
        Blink::new(word.clone(), self.rate_hz, self.shift_s)
    }
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
