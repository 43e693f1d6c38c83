//! The observer's own airframe, as its camera sees it: parts that hide what is behind them, and edges that shine.

use nalgebra::{Isometry3, Point3, Vector3};

use super::Solid;

/// What of the observer its own cameras see, in its body frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OwnAirframe {
    /// Parts that hide.
    pub solids: Vec<Solid>,
    /// How bright they are against what they hide: 0 black to 1.
    pub brightness: f64,
    /// Edges that shine.
    pub edges: Vec<Edge>,
}

/// An edge in sunlight or in the light of the observer's own LEDs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// One end, m.
    pub from_m: Vector3<f64>,
    /// The other end, m.
    pub to_m: Vector3<f64>,
    /// Intensity of a metre of it against that of a marker's LED on its axis.
    pub power_per_m: f64,
}

impl OwnAirframe {
    /// Whether there is nothing of it.
    pub fn is_none(&self) -> bool {
        self.solids.is_empty() && self.edges.is_empty()
    }

    /// Whether a part stands before a direction of the camera frame.
    pub fn hides(&self, body_from_camera: &Isometry3<f64>, direction: &Vector3<f64>) -> bool {
        let from_m = body_from_camera.translation.vector;
        let towards = body_from_camera.rotation * direction;
        self.solids.iter().any(|solid| {
            let far_m = 2.0 * (from_m.norm() + solid.reach_m());
            solid.cuts(&from_m, &(from_m + towards * far_m))
        })
    }

    /// Places of an edge in the camera frame, `count` of them, each with its share of the edge's intensity.
    pub(crate) fn places(
        edge: &Edge,
        body_from_camera: &Isometry3<f64>,
        count: usize,
    ) -> Vec<(Vector3<f64>, f64)> {
        let camera_from_body = body_from_camera.inverse();
        let way_m = edge.to_m - edge.from_m;
        let power = edge.power_per_m * way_m.norm() / count as f64;
        let place = |index: usize| {
            let along_m = way_m * ((index as f64 + 0.5) / count as f64);
            ((camera_from_body * Point3::from(edge.from_m + along_m)).coords, power)
        };
        (0..count).map(place).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_before_the_camera_hides_and_what_is_behind_does_not() {
        let solid = Solid::Sphere { centre_m: Vector3::new(0.5, 0.0, 0.0), radius_m: 0.1 };
        let own = OwnAirframe { solids: vec![solid], ..Default::default() };
        let body_from_camera = Isometry3::translation(0.1, 0.0, 0.0);
        // the camera's axes are the body's here: the ball is 0.4 m ahead, its edge at asin 0.25
        for (deg, hidden) in [(0.0_f64, true), (14.0, true), (15.0, false), (180.0, false)] {
            let (sin, cos) = libm::sincos(deg.to_radians());
            assert_eq!(own.hides(&body_from_camera, &Vector3::new(cos, sin, 0.0)), hidden, "{deg}");
        }
    }

    #[test]
    fn an_edge_shares_its_light_out_along_its_length() {
        let edge =
            Edge { from_m: Vector3::new(1.0, 0.0, 0.0), to_m: Vector3::new(1.0, 0.5, 0.0), power_per_m: 0.2 };
        let places = OwnAirframe::places(&edge, &Isometry3::identity(), 10);
        assert!((places.iter().map(|place| place.1).sum::<f64>() - 0.1).abs() < 1e-12);
        assert!((places[9].0 - Vector3::new(1.0, 0.475, 0.0)).norm() < 1e-12);
    }
}
