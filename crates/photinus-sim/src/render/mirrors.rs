//! Light that comes by way of a vehicle's own parts: its LEDs once more, the sun in a ball.

use nalgebra::{Isometry3, Point3, Vector3};
use photinus::camera::Bearing;

use super::Renderer;
use super::lights::{Instants, Ray, is_hidden};
use crate::occlusion::{Image, Mirror};
use crate::optics::PointLight;
use crate::snapshot::{Snapshot, Vehicle};

/// How far above its mirror light starts, m: it is not hidden by the part that mirrors it.
const CLEAR_M: f64 = 1e-3;

impl Renderer {
    /// Draws an LED, at `led_m` in the world, as every mirror of its vehicle shows it; gives the photo-electrons.
    pub(super) fn mirrored(
        &self,
        vehicle: &Vehicle,
        led_m: &Vector3<f64>,
        instants: &Instants,
        snapshot: &Snapshot,
    ) -> Vec<Ray> {
        let world_from_body = &instants.world_from_body[1];
        let camera_m = instants.world_from_camera[1].translation.vector;
        let by_way_of = |mirror: &Mirror| {
            let image =
                mirror.image(&to_body(world_from_body, led_m), &to_body(world_from_body, &camera_m))?;
            let on_m = clear_of(&image, world_from_body);
            let way_m = (camera_m - on_m).norm();
            let seen_m = instants.world_from_body.map(|pose| (pose * Point3::from(image.place_m)).coords);
            (!is_hidden(snapshot, &camera_m, &on_m)).then_some(Ray {
                seen_m,
                camera_m: on_m,
                reflected: image.per_m2 * way_m * way_m,
            })
        };
        vehicle.looks.mirrors.iter().filter_map(by_way_of).collect()
    }

    /// Draws the sun as the balls of a vehicle show it; gives the photo-electrons.
    pub(super) fn draw_sun_in_mirrors(
        &mut self,
        snapshot: &Snapshot,
        vehicle: &Vehicle,
        instants: &Instants,
    ) -> f64 {
        let Some((daylight, sun)) = snapshot.daylight.and_then(|light| Some((light, *light.sun()?))) else {
            return 0.0;
        };
        let world_from_body = &instants.world_from_body[1];
        let camera_m = instants.world_from_camera[1].translation.vector;
        let camera_from_world = instants.world_from_camera[1].inverse();
        let sun_in_body = world_from_body.rotation.inverse() * sun.into_inner();
        let mut drawn_e = 0.0;
        for mirror in &vehicle.looks.mirrors {
            let glint = mirror.glint(&sun_in_body, &to_body(world_from_body, &camera_m));
            let Some(image) = glint else { continue };
            let on_m = clear_of(&image, world_from_body);
            let bearing = Bearing::new((camera_from_world * Point3::from(on_m)).coords);
            let Some(bearing) = bearing else { continue };
            let Some(place) = self.view.camera.pixel(&bearing) else { continue };
            let shaded = is_hidden(snapshot, &(on_m + sun.into_inner() * 1e3), &on_m);
            if shaded || is_hidden(snapshot, &camera_m, &on_m) || self.own.hides(&place) {
                continue;
            }
            let off_axis_rad = bearing.off_axis_rad();
            let electrons = image.per_m2 * self.sun_electrons(snapshot, &daylight, off_axis_rad);
            let (u_px, v_px) = (place.u, place.v);
            let outward = PointLight::outward([u_px, v_px], self.axis_px);
            let light = PointLight { u_px, v_px, electrons, off_axis_rad, outward, ..PointLight::default() };
            self.view.lens.spread.draw(&light, &mut self.charge);
            drawn_e += electrons;
        }
        drawn_e
    }
}

fn to_body(world_from_body: &Isometry3<f64>, point_m: &Vector3<f64>) -> Vector3<f64> {
    world_from_body.inverse_transform_point(&Point3::from(*point_m)).coords
}

/// The place of an image in the world, a little above the surface.
fn clear_of(image: &Image, world_from_body: &Isometry3<f64>) -> Vector3<f64> {
    (world_from_body * Point3::from(image.place_m + image.normal * CLEAR_M)).coords
}
