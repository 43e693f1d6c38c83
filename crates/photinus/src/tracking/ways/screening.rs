//! Vehicles ahead of each other -> which markers may be hidden by a nearer one: nobody describes its body, but it may fill the sphere on which its
//! markers sit. How likely it hides them is learnt ([`super::super::silent`]).

use alloc::vec::Vec;

use nalgebra::Vector3;

use super::super::component::Component;
use crate::airframe::Airframe;
use crate::pose::Pose;

/// Where vehicles are that may hide others. Keeps its room.
#[derive(Debug, Default)]
pub(super) struct Screens(Vec<Screen>);

#[derive(Debug)]
struct Screen {
    vehicle: usize,
    ahead: Vector3<f64>,
    distance_m: f64,
}

impl Screens {
    /// Forgets all of them.
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// Adds a vehicle, where it most likely is.
    pub(super) fn add(&mut self, vehicle: usize, components: &[Component]) {
        let likeliest = components.iter().max_by(|a, b| a.weight.total_cmp(&b.weight));
        let Some(distance_m) = likeliest.map(|component| component.pose.position_m.norm()) else { return };
        if let Some(component) = likeliest.filter(|_| distance_m > 0.0) {
            self.0.push(Screen { vehicle, ahead: component.pose.position_m / distance_m, distance_m });
        }
    }

    /// Says which markers of a vehicle at a pose lie behind another one.
    pub(super) fn screen(&self, vehicle: usize, airframe: &Airframe, pose: &Pose, screened: &mut [bool]) {
        let radius_m = airframe.max_radius_m();
        let range_m = pose.position_m.norm();
        let may_hide = |screen: &&Screen| {
            let reach = radius_m / screen.distance_m + radius_m / range_m.max(radius_m);
            screen.vehicle != vehicle
                && screen.distance_m + 2.0 * radius_m < range_m
                && (screen.ahead * range_m - pose.position_m).norm() < reach * range_m
        };
        for screen in self.0.iter().filter(may_hide) {
            for (marker, screened) in airframe.markers().iter().zip(&mut *screened) {
                let place_m = pose.camera_from_body * marker.position_m + pose.position_m;
                let before_m = screen.ahead * (screen.ahead.dot(&place_m));
                *screened |= (place_m - before_m).norm() * screen.distance_m < radius_m * before_m.norm();
            }
        }
    }
}
