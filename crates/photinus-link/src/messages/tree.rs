//! tf: transforms between frames come in as they are told, how one frame is turned against another comes out, whatever stands between them.
//!
//! ```text
//! map -> odom -> base_link -> front_optical_frame     a transform each, by its child; those of /tf_static never change
//! ```
//! Only turns are kept. A turn over several transforms is that of the newest time that all of them know, each turned smoothly between the times that
//! were told of it.

use std::collections::{BTreeMap, VecDeque};

use nalgebra::UnitQuaternion;

use super::motion::{Turning, attitude};
use crate::ros::TFMessage;

/// So many frames are known at most, and so many transforms lead to one.
const MOST_FRAMES: usize = 1000;
/// What is kept of a transform, s, and how many times.
const KEPT_S: f64 = 5.0;
const MOST_TIMES: usize = 1000;

/// Transforms as they are told, and the turn of one frame against another, whose z is up.
#[derive(Clone, Debug)]
pub struct Tree {
    world: String,
    body: String,
    /// By the frame that is turned.
    edges: BTreeMap<String, Edge>,
    told_s: f64,
}

#[derive(Clone, Debug)]
struct Edge {
    parent: String,
    is_fixed: bool,
    /// parent_from_child by time, s; of a fixed one only the last.
    turns: VecDeque<(f64, UnitQuaternion<f64>)>,
}

impl Tree {
    /// How `body` is turned against `world` is asked for.
    #[must_use]
    pub fn new(world: &str, body: &str) -> Self {
        let (world, body) = (plain(world).to_owned(), plain(body).to_owned());
        Self { world, body, edges: BTreeMap::new(), told_s: f64::NEG_INFINITY }
    }

    /// Takes what `/tf`, or with `is_fixed` what `/tf_static` says. Leaves how the body is turned, where that is known of a later time than before.
    pub fn hear(&mut self, told: &TFMessage, is_fixed: bool) -> Option<Turning> {
        for told in &told.transforms {
            let (parent, child) = (plain(&told.header.frame_id), plain(&told.child_frame_id));
            let is_known = self.edges.contains_key(child);
            if let Some(turn) = attitude(&told.transform.rotation)
                && parent != child
                && (is_known || self.edges.len() < MOST_FRAMES)
            {
                let edge = self.edges.entry(child.to_owned()).or_insert_with(|| Edge::new(parent));
                edge.put(parent, is_fixed, told.header.stamp.seconds(), turn);
            }
        }
        self.turning()
    }

    fn turning(&mut self) -> Option<Turning> {
        let (of_body, of_world) = (self.way(&self.body)?, self.way(&self.world)?);
        // The transforms above the frame where both ways meet say nothing of one against the other.
        let above = |way: &[&Edge]| way.last().map(|edge| edge.parent.clone());
        let same =
            of_body.iter().rev().zip(of_world.iter().rev()).take_while(|(a, b)| std::ptr::eq(**a, **b));
        let same = same.count();
        let top_of_body = above(&of_body).unwrap_or_else(|| self.body.clone());
        let top_of_world = above(&of_world).unwrap_or_else(|| self.world.clone());
        if top_of_body != top_of_world {
            return None;
        }
        let of_body = &of_body[..of_body.len() - same];
        let of_world = &of_world[..of_world.len() - same];
        let moving = of_body.iter().chain(of_world).filter(|edge| !edge.is_fixed);
        let time_s = moving.filter_map(|edge| edge.turns.back()).map(|last| last.0).reduce(f64::min)?;
        if time_s <= self.told_s {
            return None;
        }
        let turned = |way: &[&Edge]| {
            way.iter().try_fold(UnitQuaternion::identity(), |below, edge| Some(edge.at(time_s)? * below))
        };
        let attitude = turned(of_world)?.inverse() * turned(of_body)?;
        self.told_s = time_s;
        Some(Turning { time_s, attitude: Some(attitude), rate_rad_s: None, velocity: None })
    }

    /// The transforms from a frame up to one without any; `None` where they go round in a circle.
    fn way(&self, from: &str) -> Option<Vec<&Edge>> {
        let mut way = Vec::new();
        let mut at = from;
        while let Some(edge) = self.edges.get(at) {
            if way.len() == self.edges.len() {
                return None;
            }
            way.push(edge);
            at = &edge.parent;
        }
        Some(way)
    }
}

impl Edge {
    fn new(parent: &str) -> Self {
        Self { parent: parent.to_owned(), is_fixed: false, turns: VecDeque::new() }
    }

    fn put(&mut self, parent: &str, is_fixed: bool, time_s: f64, turn: UnitQuaternion<f64>) {
        let last_s = self.turns.back().map_or(f64::NEG_INFINITY, |last| last.0);
        // Another tree.
        if self.parent != parent || is_fixed || self.is_fixed {
            *self = Self { is_fixed, ..Self::new(parent) };
        } else if time_s <= last_s {
            return;
        }
        self.turns.push_back((time_s, turn));
        while self.turns.len() > MOST_TIMES
            || self.turns.front().is_some_and(|first| first.0 < time_s - KEPT_S)
        {
            self.turns.pop_front();
        }
    }

    /// parent_from_child at a time; `None` of times that were not told.
    fn at(&self, time_s: f64) -> Option<UnitQuaternion<f64>> {
        if self.is_fixed {
            return self.turns.back().map(|last| last.1);
        }
        let later = self.turns.partition_point(|turn| turn.0 < time_s);
        let &(later_s, after) = self.turns.get(later)?;
        if later_s <= time_s {
            return Some(after);
        }
        let &(earlier_s, before) = self.turns.get(later.checked_sub(1)?)?;
        before.try_slerp(&after, (time_s - earlier_s) / (later_s - earlier_s), 1e-9)
    }
}

/// Names of tf1 began with a slash.
fn plain(frame: &str) -> &str {
    frame.trim_start_matches('/')
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use rand_distr::{Distribution, UnitSphere};
    use rand_pcg::Pcg64;

    use super::*;
    use crate::ros;

    fn transform(parent: &str, child: &str, time_s: f64, turn: UnitQuaternion<f64>) -> TFMessage {
        let mut told = ros::TransformStamped::default();
        told.header.frame_id = parent.to_owned();
        told.header.stamp = ros::Time::from_seconds(time_s);
        told.child_frame_id = child.to_owned();
        let turn = turn.coords;
        told.transform.rotation = [turn.x, turn.y, turn.z, turn.w].into();
        TFMessage { transforms: vec![told] }
    }

    fn roll(angle_rad: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle_rad)
    }

    fn yaw(angle_rad: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle_rad)
    }

    #[test]
    fn a_body_whose_parent_is_the_world_is_turned_as_it_is_told() {
        let mut tree = Tree::new("odom", "base_link");
        assert_eq!(tree.hear(&transform("odom", "camera", 1.0, roll(0.1)), false), None);
        assert_eq!(tree.hear(&transform("map", "odom", 2.0, yaw(1.0)), false), None);
        let said = tree.hear(&transform("/odom", "/base_link", 4.0, roll(0.3)), false).unwrap();
        assert!((said.time_s - 4.0).abs() < 1e-9 && said.rate_rad_s.is_none());
        assert!(said.attitude.unwrap().angle_to(&roll(0.3)) < 1e-9);
        // Nothing is told twice, and four zeros are no turn.
        assert_eq!(tree.hear(&transform("map", "odom", 5.0, yaw(2.0)), false), None);
        let mut zeros = transform("odom", "base_link", 6.0, roll(0.0));
        zeros.transforms[0].transform.rotation = [0.0; 4].into();
        assert_eq!(tree.hear(&zeros, false), None);
    }

    #[test]
    fn turns_are_chained_at_the_newest_time_that_all_know() {
        let mut tree = Tree::new("map", "base_link");
        assert_eq!(tree.hear(&transform("frame", "base_link", 0.0, roll(0.5)), true), None);
        for step in 0..10 {
            let time_s = 10.0 + 0.1 * f64::from(step);
            let told = tree.hear(&transform("odom", "frame", time_s, yaw(time_s)), false);
            assert_eq!(told, None, "nobody said how odom stands in map");
        }
        // The slow one was 0.25 at 10.0 s; of 10.35 s the fast one is known between two of its times.
        assert!(tree.hear(&transform("map", "odom", 10.0, roll(0.25)), false).is_some());
        let said = tree.hear(&transform("map", "odom", 10.35, roll(0.3)), false).unwrap();
        assert!((said.time_s - 10.35).abs() < 1e-9);
        let expected = roll(0.3) * yaw(10.35) * roll(0.5);
        assert!(said.attitude.unwrap().angle_to(&expected) < 1e-9, "{said:?}");
    }

    #[test]
    fn the_world_may_stand_below_the_body_or_beside_it() {
        // As autopilots do that publish base_link -> odom, and a tracker that sees a marker of the ground and the vehicle.
        let mut below = Tree::new("odom", "base_link");
        let said = below.hear(&transform("base_link", "odom", 1.0, roll(0.3)), false).unwrap();
        assert!(said.attitude.unwrap().angle_to(&roll(-0.3)) < 1e-9);
        let mut beside = Tree::new("ground", "base_link");
        assert_eq!(beside.hear(&transform("room", "ground", 0.0, yaw(0.7)), true), None);
        let said = beside.hear(&transform("room", "base_link", 1.0, roll(0.3)), false).unwrap();
        assert!(said.attitude.unwrap().angle_to(&(yaw(-0.7) * roll(0.3))) < 1e-9);
    }

    #[test]
    fn circles_and_strangers_end_and_a_flood_is_bounded() {
        let mut tree = Tree::new("odom", "base_link");
        assert_eq!(tree.hear(&transform("a", "base_link", 1.0, roll(0.1)), false), None);
        assert_eq!(tree.hear(&transform("base_link", "a", 1.0, roll(0.1)), false), None);
        assert_eq!(tree.hear(&transform("b", "b", 1.0, roll(0.1)), false), None);
        let mut tree = Tree::new("odom", "base_link");
        assert!(tree.hear(&transform("odom", "base_link", 100.0, roll(0.1)), false).is_some());
        let mut random = Pcg64::new(1, 1);
        for number in 0..3000 {
            let [x, y, _] = UnitSphere.sample(&mut random);
            let frames = (format!("p{number}"), format!("c{number}"));
            tree.hear(&transform(&frames.0, &frames.1, x, yaw(y)), number % 2 == 0);
            tree.hear(&transform("odom", "base_link", 100.0 + 1e-3 * f64::from(number + 1), yaw(x)), false);
        }
        assert_eq!(tree.edges.len(), MOST_FRAMES);
        assert!(tree.edges.values().all(|edge| edge.turns.len() <= MOST_TIMES));
        assert_eq!(tree.hear(&transform("odom", "base_link", 99.0, yaw(0.0)), false), None, "it is old");
    }
}
