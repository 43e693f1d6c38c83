//! Parts of an airframe that mirror: a plate, an upright cylinder, a ball.
//!
//! In: two points of the body frame. Out: where on the part light goes from one to the other, and how it spreads on the way:
//! a bundle of rays from a point that is mirrored by a convex surface is wider than one that went straight. Reflectance is
//! Schlick's (Computer Graphics Forum 13, 1994).

use nalgebra::{Unit, Vector2, Vector3};

/// A part that mirrors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// Its surface.
    pub surface: Surface,
    /// Share of light that it mirrors at normal incidence: 0.04 glossy paint, 0.9 polished metal.
    pub reflectance: f64,
}

/// The surface of a mirror, in the body frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
    /// A round plate, one side of it.
    Plate {
        /// Its centre, m.
        centre_m: Vector3<f64>,
        /// Where it faces.
        normal: Unit<Vector3<f64>>,
        /// Its radius, m.
        radius_m: f64,
    },
    /// The side of a cylinder about a line parallel to the body's z axis.
    Cylinder {
        /// Its centre, m.
        centre_m: Vector3<f64>,
        /// Its radius, m.
        radius_m: f64,
        /// Half its height, m.
        half_height_m: f64,
    },
    /// A ball.
    Sphere {
        /// Its centre, m.
        centre_m: Vector3<f64>,
        /// Its radius, m.
        radius_m: f64,
    },
}

/// Where a mirror shows one point to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Image {
    /// The place on the mirror, m.
    pub place_m: Vector3<f64>,
    /// Outward normal there.
    pub normal: Vector3<f64>,
    /// Irradiance at the receiver is intensity times this, 1/m^2.
    pub per_m2: f64,
}

impl Mirror {
    /// Where it shows a point to a camera, both in the body frame; `None` where it does not.
    pub fn image(&self, from_m: &Vector3<f64>, camera_m: &Vector3<f64>) -> Option<Image> {
        let place_m = self.surface.place(from_m, camera_m)?;
        let normal = self.surface.normal(&place_m);
        let (there_m, back_m) = (from_m - place_m, camera_m - place_m);
        let (there, back) = (there_m.norm(), back_m.norm());
        let (cos, cos_back) = (normal.dot(&there_m) / there, normal.dot(&back_m) / back);
        if !(cos > 1e-6 && cos_back > 1e-6) {
            return None;
        }
        let way = there + back;
        let widened = 2.0 * there * back;
        let spread_m2 = match self.surface {
            Surface::Plate { .. } => way * way,
            Surface::Sphere { radius_m, .. } => {
                (way + widened / (radius_m * cos)) * (way + widened * cos / radius_m)
            }
            // across the axis it is a circle, seen from above; along the axis a plane
            Surface::Cylinder { radius_m, .. } => {
                let (flat_there, flat_back) = (there_m.xy().norm(), back_m.xy().norm());
                let flat_cos = normal.xy().dot(&there_m.xy()) / flat_there;
                let flat = flat_there + flat_back;
                (flat + 2.0 * flat_there * flat_back / (radius_m * flat_cos)) * way * way / flat
            }
        };
        Some(Image { place_m, normal, per_m2: self.reflectance_at(cos) / spread_m2 })
    }

    /// Where a ball shows the sun, far away in a direction, to a camera: irradiance at the camera is that of the sun times
    /// `per_m2`, which has no unit here. Other surfaces show it from next to nowhere.
    pub fn glint(&self, sun: &Vector3<f64>, camera_m: &Vector3<f64>) -> Option<Image> {
        let Surface::Sphere { centre_m, radius_m } = self.surface else { return None };
        let mut place_m = centre_m;
        let mut normal = *sun;
        for _ in 0..20 {
            normal = (sun + (camera_m - place_m).normalize()).try_normalize(1e-9)?;
            place_m = centre_m + normal * radius_m;
        }
        let (cos, back) = (normal.dot(sun), (camera_m - place_m).norm());
        if cos <= 1e-6 {
            return None;
        }
        let spread = (1.0 + 2.0 * back / (radius_m * cos)) * (1.0 + 2.0 * back * cos / radius_m);
        Some(Image { place_m, normal, per_m2: self.reflectance_at(cos) / spread })
    }

    fn reflectance_at(&self, cos: f64) -> f64 {
        self.reflectance + (1.0 - self.reflectance) * (1.0 - cos.min(1.0)).powi(5)
    }
}

impl Surface {
    /// The place at which angles of incidence and reflection are equal.
    fn place(&self, from_m: &Vector3<f64>, to_m: &Vector3<f64>) -> Option<Vector3<f64>> {
        match self {
            Self::Plate { centre_m, normal, radius_m } => {
                let (a, b) = (normal.dot(&(from_m - centre_m)), normal.dot(&(to_m - centre_m)));
                // both points dropped onto the plate, and the place between them by their heights
                let (foot_a, foot_b) = (from_m - normal.into_inner() * a, to_m - normal.into_inner() * b);
                let place_m = foot_a + (foot_b - foot_a) * (a / (a + b));
                (a > 0.0 && b > 0.0 && (place_m - centre_m).norm() <= *radius_m).then_some(place_m)
            }
            Self::Sphere { centre_m, radius_m } => {
                let (a, b) = (from_m - centre_m, to_m - centre_m);
                let along = a.try_normalize(1e-9)?;
                let aside_m = b - along * along.dot(&b);
                let Some(aside) = aside_m.try_normalize(1e-9) else {
                    return (along.dot(&b) > *radius_m).then_some(centre_m + along * *radius_m);
                };
                let flat = |point: &Vector3<f64>| Vector2::new(along.dot(point), aside.dot(point));
                let on = circle(&flat(&a), &flat(&b), *radius_m)?;
                Some(centre_m + along * on.x + aside * on.y)
            }
            Self::Cylinder { centre_m, radius_m, half_height_m } => {
                let (a, b) = (from_m - centre_m, to_m - centre_m);
                let on = circle(&a.xy(), &b.xy(), *radius_m)?;
                let (there, back) = ((a.xy() - on).norm(), (b.xy() - on).norm());
                let z = a.z + (b.z - a.z) * there / (there + back);
                (z.abs() <= *half_height_m).then_some(centre_m + Vector3::new(on.x, on.y, z))
            }
        }
    }

    fn normal(&self, place_m: &Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Plate { normal, .. } => normal.into_inner(),
            Self::Sphere { centre_m, radius_m } => (place_m - centre_m) / *radius_m,
            Self::Cylinder { centre_m, radius_m, .. } => {
                let flat = (place_m - centre_m).xy() / *radius_m;
                Vector3::new(flat.x, flat.y, 0.0)
            }
        }
    }
}

/// The point of a circle about the origin that mirrors one point outside to another (Alhazen's problem), by bisection between
/// their directions; `None` for points inside.
fn circle(a: &Vector2<f64>, b: &Vector2<f64>, radius: f64) -> Option<Vector2<f64>> {
    if a.norm() <= radius || b.norm() <= radius {
        return None;
    }
    let begin = libm::atan2(a.y, a.x);
    let turn = libm::atan2(a.x * b.y - a.y * b.x, a.dot(b));
    let at = |share: f64| {
        let (sin, cos) = libm::sincos(begin + share * turn);
        Vector2::new(cos, sin)
    };
    // positive as long as the way to b leaves the normal farther than that to a
    let off = |share: f64| {
        let normal = at(share);
        let aside = |point: &Vector2<f64>| {
            let ray = point - normal * radius;
            (normal.x * ray.y - normal.y * ray.x) / ray.norm()
        };
        (aside(a) + aside(b)) * turn.signum()
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if off(middle) > 0.0 { low = middle } else { high = middle }
    }
    Some(at(0.5 * (low + high)) * radius)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::hash;

    fn uniform(n: u64) -> f64 {
        (hash(n) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Irradiance at `camera` per intensity at `from`, by sending rays into a small cone and measuring where they pass the camera.
    fn traced(mirror: &Mirror, image: &Image, from_m: &Vector3<f64>, camera_m: &Vector3<f64>) -> f64 {
        let ray = (image.place_m - from_m).normalize();
        let side = ray.cross(&Vector3::new(0.3, 0.5, -0.8)).normalize();
        let up = ray.cross(&side);
        let towards = (camera_m - image.place_m).normalize();
        // where the ray that leaves by a small angle passes the plane through the camera
        let pass = |x: f64, y: f64| {
            let ray = (ray + side * x + up * y).normalize();
            let (place_m, normal) = match mirror.surface {
                Surface::Plate { centre_m, normal, .. } => {
                    let t = normal.dot(&(centre_m - from_m)) / normal.dot(&ray);
                    (from_m + ray * t, normal.into_inner())
                }
                Surface::Sphere { centre_m, radius_m } => {
                    let start = from_m - centre_m;
                    let b = start.dot(&ray);
                    let t = -b - (b * b - start.norm_squared() + radius_m * radius_m).sqrt();
                    (from_m + ray * t, (start + ray * t) / radius_m)
                }
                Surface::Cylinder { centre_m, radius_m, .. } => {
                    let (start, flat) = ((from_m - centre_m).xy(), ray.xy());
                    let (a, b) = (flat.norm_squared(), start.dot(&flat));
                    let t = (-b - (b * b - a * (start.norm_squared() - radius_m * radius_m)).sqrt()) / a;
                    let normal = (start + flat * t) / radius_m;
                    (from_m + ray * t, Vector3::new(normal.x, normal.y, 0.0))
                }
            };
            let back = ray - normal * (2.0 * ray.dot(&normal));
            place_m + back * (towards.dot(&(camera_m - place_m)) / towards.dot(&back))
        };
        let step = 1e-5;
        let (du, dv) = (pass(step, 0.0) - pass(-step, 0.0), pass(0.0, step) - pass(0.0, -step));
        assert!((pass(0.0, 0.0) - camera_m).norm() < 1e-6, "the mirrored ray meets the camera");
        4.0 * step * step / du.cross(&dv).norm()
    }

    #[test]
    fn images_are_where_rays_go_and_as_bright_as_bundles_of_them() {
        let centre_m = Vector3::new(0.05, -0.1, 0.1);
        let surfaces = [
            Surface::Sphere { centre_m, radius_m: 0.12 },
            Surface::Cylinder { centre_m, radius_m: 0.1, half_height_m: 0.4 },
            Surface::Plate {
                centre_m,
                normal: Unit::new_normalize(Vector3::new(1.0, 0.3, 0.5)),
                radius_m: 0.6,
            },
        ];
        let mut images = [0; 3];
        for n in 0..3000_u64 {
            let number = |salt: u64| 2.0 * uniform(10 * n + salt) - 1.0;
            let from_m = Vector3::new(number(0), number(1), 0.3 * number(2)) * 0.6;
            let camera_m = Vector3::new(number(3), number(4), 0.6 * number(5)) * 5.0;
            for (surface, images) in surfaces.iter().zip(&mut images) {
                let mirror = Mirror { surface: *surface, reflectance: 1.0 };
                let Some(image) = mirror.image(&from_m, &camera_m) else { continue };
                // a grazing bundle bends too much for finite differences
                if image.normal.dot(&(camera_m - image.place_m).normalize()) < 0.1 {
                    continue;
                }
                let expected = traced(&mirror, &image, &from_m, &camera_m);
                assert!(
                    (image.per_m2 / expected - 1.0).abs() < 1e-3,
                    "{surface:?} {n}: {} {expected}",
                    image.per_m2
                );
                *images += 1;
            }
        }
        assert!(images.iter().all(|count| *count > 100), "{images:?}");
    }

    #[test]
    fn a_ball_shows_the_sun_as_a_far_lamp() {
        let mirror = Mirror {
            surface: Surface::Sphere { centre_m: Vector3::zeros(), radius_m: 0.1 },
            reflectance: 0.3,
        };
        let (sun, camera_m) = (Vector3::new(0.6, 0.0, 0.8), Vector3::new(4.0, 2.0, -1.0));
        let (glint, far) =
            (mirror.glint(&sun, &camera_m).unwrap(), mirror.image(&(sun * 1e5), &camera_m).unwrap());
        assert!((glint.place_m - far.place_m).norm() < 1e-5, "{glint:?} {far:?}");
        assert!((glint.per_m2 / (far.per_m2 * 1e10) - 1.0).abs() < 1e-3);
        // a ball spreads the sun evenly: R r^2 / 4 d^2
        let expected = 0.3 * 0.01 / 4.0 / camera_m.norm_squared();
        assert!((glint.per_m2 / expected - 1.0).abs() < 0.15, "{} {expected}", glint.per_m2);
        assert_eq!(mirror.glint(&sun, &(-sun * 5.0)), None);
    }

    #[test]
    fn reflectance_of_glossy_paint_is_near_fresnels() {
        let mirror = Mirror {
            surface: Surface::Sphere { centre_m: Vector3::zeros(), radius_m: 1.0 },
            reflectance: 0.04,
        };
        for deg in [0.0_f64, 30.0, 60.0, 75.0, 85.0] {
            let cos = libm::cos(deg.to_radians());
            let inside = (1.0 - (1.0 - cos * cos) / 2.25).sqrt();
            let across = (cos - 1.5 * inside) / (cos + 1.5 * inside);
            let along = (1.5 * cos - inside) / (1.5 * cos + inside);
            let fresnel = 0.5 * (across * across + along * along);
            assert!((mirror.reflectance_at(cos) - fresnel).abs() < 0.04, "{deg} deg");
        }
    }
}
