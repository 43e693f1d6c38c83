//! What lies behind the markers: sky, ground or water, the sun with its glare, dark current.

use core::f64::consts::PI;

use nalgebra::{Isometry3, Vector3};
use photinus::camera::{Bearing, Camera, Pixel};

use super::Renderer;
use super::lights::is_hidden;
use crate::background::{Daylight, Water};
use crate::optics::{Lens, PointLight};
use crate::sensor::{Background, hash};
use crate::snapshot::Snapshot;

/// For every node of the background: where it looks, and how much of a radiance it gathers.
#[derive(Clone, Debug)]
pub(super) struct Backdrop {
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    direction: Vector3<f64>,
    place: Pixel,
    /// Solid angle of a pixel times relative illumination, sr; 0 outside the field.
    etendue_sr: f64,
    /// Square of the distance from the middle, 1 in the corners.
    corner: f64,
}

impl Backdrop {
    pub(super) fn new(camera: &Camera, lens: &Lens) -> Self {
        let mut grid = Background::new(camera.width(), camera.height());
        let mut nodes = Vec::with_capacity(grid.nodes());
        grid.fill(|u, v| {
            let place = Pixel::new(u.min(camera.width() - 1) as f64, v.min(camera.height() - 1) as f64);
            let middle = [camera.width(), camera.height()].map(|length| 0.5 * (length as f64 - 1.0));
            let from_middle = libm::hypot(place.u - middle[0], place.v - middle[1]);
            let corner = (from_middle / libm::hypot(middle[0], middle[1]).max(1.0)).powi(2);
            nodes.push(match camera.bearing_with_jacobian(place) {
                Some((bearing, jacobian)) => {
                    let solid_angle_sr = jacobian.column(0).cross(&jacobian.column(1)).norm();
                    let etendue_sr = solid_angle_sr * lens.illumination(bearing.off_axis_rad());
                    Node { direction: *bearing.vector(), place, etendue_sr, corner }
                }
                None => Node { direction: Vector3::z(), place, etendue_sr: 0.0, corner },
            });
            0.0
        });
        Self { nodes }
    }
}

/// The sun as the camera sees it.
struct SunDisc {
    centre: Pixel,
    electrons: f64,
    /// Radius of what is full of its charge, px.
    radius_px: f64,
    /// Radius of its image, px.
    own_px: f64,
}

impl Renderer {
    /// Share of the sun's light that scatters about its image, falling with the square of the distance from it.
    const AUREOLE: f64 = 0.02;

    /// Lays sky, ground, water, dark current and glare under the frame, and the sun's disc into it.
    pub(super) fn lay_background(
        &mut self,
        snapshot: &Snapshot,
        world_from_camera: &Isometry3<f64>,
        marker_e: f64,
    ) {
        let (lens, sensor) = (&self.view.lens, &self.view.sensor);
        let exposure_s = snapshot.exposure.length_s;
        let sun = self.sun_disc(snapshot, world_from_camera);
        let all_e = marker_e + sun.as_ref().map_or(0.0, |sun| sun.electrons);
        let pixels = (self.charge.width() * self.charge.height()) as f64;
        let even_e = lens.veiling_glare * all_e / pixels + sensor.dark_current_e_per_s * exposure_s;
        let corner_e = sensor.corner_offset_dn * sensor.electrons_per_dn;
        let electrons = |radiance: f64| {
            let power_w = radiance * lens.pupil_m2 * lens.transmission;
            sensor.photo_electrons(power_w, exposure_s, snapshot.emitter.photon_j())
        };
        let mut nodes = self.backdrop.nodes.iter();
        self.background.fill(|_, _| {
            let Some(node) = nodes.next() else { return 0.0 };
            let radiance = snapshot.daylight.map_or(0.0, |daylight| {
                seen_radiance(&daylight, snapshot.water, &(world_from_camera.rotation * node.direction))
            });
            let corner_e = corner_e * node.corner;
            let aureole_e = sun.as_ref().map_or(0.0, |sun| sun.aureole_e(&node.place));
            (even_e + electrons(radiance) * node.etendue_sr + aureole_e + corner_e) as f32
        });
        self.readout.smear_background(&mut self.background, self.charge.height());
        if let Some(sun) = sun {
            let (first, columns) = sun.columns(self.charge.width());
            self.readout.smear_columns(&mut self.charge, first, &columns);
            self.fill_disc(&sun);
        }
    }

    /// Draws the sun's glints on water; gives their photo-electrons.
    pub(super) fn draw_glints(
        &mut self,
        snapshot: &Snapshot,
        world_from_camera: &Isometry3<f64>,
        key: u64,
    ) -> f64 {
        let (Some(water), Some(daylight)) = (snapshot.water, snapshot.daylight) else { return 0.0 };
        let Some(sun) = daylight.sun() else { return 0.0 };
        if world_from_camera.translation.z <= water.level_m {
            return 0.0;
        }
        let mut all_e = 0.0;
        for index in 0..Water::GLINTS {
            let Some((direction, share)) = water.glint(sun, index, hash(key ^ 0x6117)) else { continue };
            let seen = world_from_camera.rotation.inverse() * direction;
            let Some(bearing) = Bearing::new(seen) else { continue };
            let Some(place) = self.view.camera.pixel(&bearing) else { continue };
            let electrons = share * self.sun_electrons(snapshot, &daylight, bearing.off_axis_rad());
            let light = PointLight {
                u_px: place.u,
                v_px: place.v,
                electrons,
                off_axis_rad: bearing.off_axis_rad(),
                radius_px: 0.0,
                among: 1.0,
                outward: PointLight::outward([place.u, place.v], self.axis_px),
            };
            self.view.lens.spread.draw(&light, &mut self.charge);
            all_e += electrons;
        }
        all_e
    }

    pub(super) fn sun_electrons(&self, snapshot: &Snapshot, daylight: &Daylight, off_axis_rad: f64) -> f64 {
        let power_w = self.view.lens.gathered_w(daylight.sun_w_m2(), off_axis_rad);
        let (exposure_s, photon_j) = (snapshot.exposure.length_s, snapshot.emitter.photon_j());
        self.view.sensor.photo_electrons(power_w, exposure_s, photon_j)
    }

    /// The sun where it stands in the image, with the light that no vehicle keeps from the camera. It overflows so far that its
    /// size is a matter of charge: the disc that its photo-electrons fill (see `sensor/overflow.rs`), not less than the sun
    /// itself.
    fn sun_disc(&self, snapshot: &Snapshot, world_from_camera: &Isometry3<f64>) -> Option<SunDisc> {
        let daylight = snapshot.daylight?;
        let bearing = Bearing::new(world_from_camera.rotation.inverse() * daylight.sun()?.into_inner())?;
        let centre = self.view.camera.pixel(&bearing)?;
        let seen = visible_share(snapshot, &world_from_camera.translation.vector, daylight.sun()?);
        if seen <= 0.0 || self.own.hides(&centre) {
            return None;
        }
        let electrons = seen * self.sun_electrons(snapshot, &daylight, bearing.off_axis_rad());
        let own_px = Daylight::SUN_RADIUS_RAD / self.view.camera.rad_per_px(centre)?;
        let full_px = self.view.sensor.overflow.full_radius_px(electrons / self.view.sensor.full_well_e);
        Some(SunDisc { centre, electrons, radius_px: full_px.max(own_px), own_px })
    }

    fn fill_disc(&mut self, sun: &SunDisc) {
        let well = self.view.sensor.full_well_e as f32;
        let reach_px = sun.radius_px + 1.0;
        let (width, height) = (self.charge.width() as f64, self.charge.height() as f64);
        let rows =
            (sun.centre.v - reach_px).max(0.0) as usize..(sun.centre.v + reach_px + 1.0).min(height) as usize;
        let columns =
            (sun.centre.u - reach_px).max(0.0) as usize..(sun.centre.u + reach_px + 1.0).min(width) as usize;
        for v in rows {
            for u in columns.clone() {
                let from_px = libm::hypot(u as f64 - sun.centre.u, v as f64 - sun.centre.v);
                let covered = (sun.radius_px + 0.5 - from_px).clamp(0.0, 1.0) as f32;
                if covered > 0.0 {
                    self.charge.add(u, v, well * covered);
                }
            }
        }
    }
}

/// Share of the sun's disc that vehicles leave free, of nineteen places of it that stand for equal parts.
fn visible_share(snapshot: &Snapshot, camera_m: &Vector3<f64>, sun: &Vector3<f64>) -> f64 {
    const FAR_M: f64 = 1e4;
    let side = sun.cross(&Vector3::new(0.0, 0.0, 1.0)).try_normalize(1e-6).unwrap_or_else(Vector3::x);
    let up = side.cross(sun);
    let rings = [(1, 0.0), (6, 0.55), (12, 0.88)];
    let places = rings.into_iter().flat_map(|(count, radius)| {
        (0..count).map(move |index| (radius, PI * 2.0 * f64::from(index) / f64::from(count)))
    });
    let free = places.filter(|(radius, angle)| {
        let (sin, cos) = libm::sincos(*angle);
        let aside = (side * cos + up * sin) * (radius * Daylight::SUN_RADIUS_RAD);
        !is_hidden(snapshot, camera_m, &(camera_m + (sun + aside) * FAR_M))
    });
    free.count() as f64 / 19.0
}

impl SunDisc {
    /// The light of its image column by column, from a first column on.
    fn columns(&self, width: usize) -> (usize, Vec<f32>) {
        let reach_px = self.own_px.max(0.5);
        let first = (self.centre.u - reach_px).round().clamp(0.0, width as f64 - 1.0);
        let last = (self.centre.u + reach_px).round().clamp(0.0, width as f64 - 1.0);
        // of a disc, the share to the left of a line
        let left = |u_px: f64| {
            let x = ((u_px - self.centre.u) / reach_px).clamp(-1.0, 1.0);
            0.5 + (x * (1.0 - x * x).sqrt() + libm::asin(x)) / PI
        };
        let share = |u: usize| left(u as f64 + 0.5) - left(u as f64 - 0.5);
        let columns = (first as usize..=last as usize).map(|u| (self.electrons * share(u)) as f32);
        (first as usize, columns.collect())
    }

    fn aureole_e(&self, place: &Pixel) -> f64 {
        let (du, dv) = (place.u - self.centre.u, place.v - self.centre.v);
        let core_px = self.radius_px.max(Background::STEP_PX as f64);
        Renderer::AUREOLE * self.electrons / (2.0 * PI * (du * du + dv * dv + core_px * core_px))
    }
}

/// Radiance from a direction of the world, over water where there is some.
fn seen_radiance(daylight: &Daylight, water: Option<Water>, direction: &Vector3<f64>) -> f64 {
    if water.is_some() && direction.z < 0.0 {
        let mirrored = Vector3::new(direction.x, direction.y, -direction.z);
        return Water::reflectance(-direction.z) * daylight.radiance(&mirrored);
    }
    daylight.radiance(direction)
}
