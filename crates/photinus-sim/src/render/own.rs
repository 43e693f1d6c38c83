//! The observer's own airframe in the image: pixels that it hides, and its shining edges.
//!
//! It does not move against the camera, so both are found once.

use std::sync::Arc;

use nalgebra::Isometry3;
use photinus::camera::{Bearing, Camera, Pixel};

use super::Renderer;
use crate::occlusion::OwnAirframe;
use crate::optics::PointLight;
use crate::source::Emitter;

/// What the camera sees of its own vehicle.
#[derive(Clone, Debug, Default)]
pub(super) struct Own {
    width: usize,
    /// Pixel by pixel, whether it is hidden; empty where nothing is.
    hidden: Arc<[bool]>,
    edges: Arc<[EdgeLight]>,
}

/// A place of an edge, and its irradiance at the camera over the intensity of an LED, 1/m^2.
#[derive(Clone, Copy, Debug)]
struct EdgeLight {
    place: Pixel,
    off_axis_rad: f64,
    per_m2: f64,
}

/// Places of an edge are not farther apart than this, px.
const STEP_PX: f64 = 0.3;
/// Places of an edge whose light one pixel gets.
const AMONG: f64 = 18.0;

impl Own {
    fn new(camera: &Camera, airframe: &OwnAirframe, body_from_camera: &Isometry3<f64>) -> Self {
        let width = camera.width();
        let hides = |index: usize| {
            let bearing = camera.bearing(Pixel::new((index % width) as f64, (index / width) as f64));
            bearing.is_some_and(|bearing| airframe.hides(body_from_camera, bearing.vector()))
        };
        let hidden = if airframe.solids.is_empty() {
            Arc::default()
        } else {
            (0..width * camera.height()).map(hides).collect()
        };
        let mut edges = Vec::new();
        for edge in &airframe.edges {
            let seen = |count: usize| {
                let places = OwnAirframe::places(edge, body_from_camera, count).into_iter();
                places.filter_map(|(place_m, power)| {
                    let bearing = Bearing::new(place_m)?;
                    let place = camera.pixel(&bearing)?;
                    let per_m2 = power / place_m.norm_squared();
                    Some(EdgeLight { place, off_axis_rad: bearing.off_axis_rad(), per_m2 })
                })
            };
            let coarse: Vec<EdgeLight> = seen(64).collect();
            let gap = |pair: &[EdgeLight]| {
                libm::hypot(pair[1].place.u - pair[0].place.u, pair[1].place.v - pair[0].place.v)
            };
            let longest_px = coarse.windows(2).map(gap).fold(0.0, f64::max);
            edges.extend(seen(64 * (longest_px / STEP_PX).ceil().clamp(1.0, 200.0) as usize));
        }
        Self { width, hidden, edges: edges.into() }
    }

    /// Whether the airframe stands before a place of the image.
    pub(super) fn hides(&self, place: &Pixel) -> bool {
        if self.hidden.is_empty() {
            return false;
        }
        let (u, v) = (place.u.round().max(0.0) as usize, place.v.round().max(0.0) as usize);
        u < self.width && self.hidden.get(v * self.width + u).is_some_and(|hidden| *hidden)
    }
}

impl Renderer {
    /// The same camera on a vehicle of which it sees something; the pose is body_from_camera.
    #[must_use]
    pub fn with_own_airframe(mut self, airframe: &OwnAirframe, body_from_camera: Isometry3<f64>) -> Self {
        if !airframe.is_none() {
            self.own = Own::new(&self.view.camera, airframe, &body_from_camera);
            self.readout.hide(&self.view.sensor, self.own.width, &self.own.hidden, airframe.brightness);
        }
        self
    }

    /// Draws the edges of the observer's own airframe; gives the photo-electrons.
    pub(super) fn draw_own_edges(&mut self, emitter: &Emitter, length_s: f64) -> f64 {
        let edges = Arc::clone(&self.own.edges);
        let mut drawn_e = 0.0;
        for edge in edges.iter() {
            let power_w = self.view.lens.gathered_w(emitter.peak_w_per_sr * edge.per_m2, edge.off_axis_rad);
            let electrons = self.view.sensor.photo_electrons(power_w, length_s, emitter.photon_j());
            let (u_px, v_px) = (edge.place.u, edge.place.v);
            let outward = PointLight::outward([u_px, v_px], self.axis_px);
            let off_axis_rad = edge.off_axis_rad;
            let light =
                PointLight { u_px, v_px, electrons, off_axis_rad, radius_px: 0.0, among: AMONG, outward };
            self.view.lens.spread.draw(&light, &mut self.charge);
            drawn_e += electrons;
        }
        drawn_e
    }
}
