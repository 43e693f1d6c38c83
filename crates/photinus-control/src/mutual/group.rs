//! Sights with identities -> places and headings of the whole group by least squares, with covariance.

use nalgebra::{Matrix3, Matrix3x4, Rotation3, Vector3};

use super::chain::chain;
use super::cholesky::Cholesky;
use super::{Group, Placed, Report};
use crate::{Heading, Normal};

/// Place and heading.
const STATES: usize = 4;
const ITERATIONS: usize = 12;
/// A heading that is known no better is not known.
const LARGEST_HEADING_SIGMA_RAD: f64 = 0.5;

/// Where a vehicle is and how turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pose {
    pub(super) place: Vector3<f64>,
    pub(super) heading_rad: f64,
}

impl Pose {
    /// A vector of the vehicle's level frame, in the axes of the group.
    pub(super) fn turn(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        Rotation3::from_axis_angle(&Vector3::z_axis(), self.heading_rad) * vector
    }
}

/// Counter-clockwise from x, seen from above.
pub(super) fn azimuth_rad(vector: &Vector3<f64>) -> f64 {
    libm::atan2(vector.y, vector.x)
}

/// One vehicle's view of another: both by their place in the list of vehicles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Edge {
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) offset_m: Vector3<f64>,
    pub(super) information: Matrix3<f64>,
}

impl Edge {
    /// A view with its covariance; `None` where that is not positive definite.
    pub(super) fn new(from: usize, to: usize, position_m: &Normal) -> Option<Self> {
        let information = position_m.covariance.cholesky()?.inverse();
        Some(Self { from, to, offset_m: position_m.mean, information })
    }

    /// What was seen less what should have been, and how that changes with the pose of the one who sees.
    fn residual(&self, poses: &[Pose]) -> (Vector3<f64>, Matrix3<f64>, Vector3<f64>) {
        let level_from_group =
            Rotation3::from_axis_angle(&Vector3::z_axis(), -poses[self.from].heading_rad).into_inner();
        let expected = level_from_group * (poses[self.to].place - poses[self.from].place);
        (self.offset_m - expected, level_from_group, Vector3::z().cross(&expected))
    }
}

/// Who reports, and who sees whom.
pub(super) struct Network {
    pub(super) ids: Vec<u32>,
    pub(super) edges: Vec<Edge>,
}

/// The network of reports whose sights all have identities; sights of others than those who report are left out.
pub(super) fn named(reports: &[&Report]) -> Network {
    let ids: Vec<u32> = reports.iter().map(|report| report.from).collect();
    let index = |identity: Option<u32>| ids.iter().position(|id| Some(*id) == identity);
    let edges = reports.iter().enumerate().flat_map(|(from, report)| {
        let edge = move |sight: &super::Sight| Edge::new(from, index(sight.identity)?, &sight.position_m);
        report.sights.iter().filter_map(edge).filter(move |edge| edge.to != from)
    });
    let edges = edges.collect();
    Network { ids, edges }
}

/// The group that fits best; `None` where nobody is connected with the first vehicle.
pub(super) fn fit(network: &Network) -> Option<Group> {
    let first = chain(network.ids.len(), &network.edges);
    // Only those who are reached, in the order of their reports.
    let reached: Vec<usize> = (0..first.len()).filter(|k| first[*k].is_some()).collect();
    if reached.len() < 2 {
        return None;
    }
    let new = |old: usize| reached.iter().position(|k| *k == old);
    let edges: Vec<Edge> = network
        .edges
        .iter()
        .filter_map(|edge| Some(Edge { from: new(edge.from)?, to: new(edge.to)?, ..*edge }))
        .collect();
    let mut poses: Vec<Pose> = first.into_iter().flatten().collect();
    for _ in 0..ITERATIONS {
        let (information, mut step) = normal_equations(&edges, &poses);
        Cholesky::new(step.len(), &information)?.solve(&mut step);
        for (pose, step) in poses[1..].iter_mut().zip(step.chunks_exact(STATES)) {
            pose.place += Vector3::new(step[0], step[1], step[2]);
            pose.heading_rad += step[3];
        }
    }
    let (information, step) = normal_equations(&edges, &poses);
    let factored = Cholesky::new(step.len(), &information)?;
    let mut undetermined: Vec<u32> =
        (0..network.ids.len()).filter(|k| !reached.contains(k)).map(|k| network.ids[k]).collect();
    let mut placed = Vec::new();
    for (k, vehicle) in reached.iter().enumerate().skip(1) {
        let told = told(network.ids[*vehicle], &poses[k], &factored, (k - 1) * STATES);
        if told.heading.sigma_rad > LARGEST_HEADING_SIGMA_RAD {
            undetermined.push(told.identity);
        } else {
            placed.push(told);
        }
    }
    let misfit = edges.iter().map(|edge| edge.residual(&poses).0).zip(&edges);
    let misfit = misfit.map(|(r, edge)| r.dot(&(edge.information * r))).sum();
    Some(Group { placed, undetermined, misfit, freedom: (3 * edges.len()).saturating_sub(step.len()) })
}

/// The information of all sights about all but the first vehicle, line by line, and the right side of Gauss and Newton.
fn normal_equations(edges: &[Edge], poses: &[Pose]) -> (Vec<f64>, Vec<f64>) {
    let size = STATES * (poses.len() - 1);
    let (mut information, mut right) = (vec![0.0; size * size], vec![0.0; size]);
    for edge in edges {
        let (residual, turn, by_heading) = edge.residual(poses);
        // How the residual changes with place and heading of both.
        let mut by_from = Matrix3x4::zeros();
        by_from.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn);
        by_from.fixed_view_mut::<3, 1>(0, 3).copy_from(&by_heading);
        let mut by_to = Matrix3x4::zeros();
        by_to.fixed_view_mut::<3, 3>(0, 0).copy_from(&-turn);
        let sides = [(edge.from, by_from), (edge.to, by_to)];
        for (a, by_a) in sides.iter().filter(|(a, _)| *a > 0) {
            let weighed = by_a.transpose() * edge.information;
            let line = (a - 1) * STATES;
            let gradient = weighed * residual;
            (0..STATES).for_each(|k| right[line + k] -= gradient[k]);
            for (b, by_b) in sides.iter().filter(|(b, _)| *b > 0) {
                let block = weighed * by_b;
                let column = (b - 1) * STATES;
                for r in 0..STATES {
                    for c in 0..STATES {
                        information[(line + r) * size + column + c] += block[(r, c)];
                    }
                }
            }
        }
    }
    (information, right)
}

fn told(identity: u32, pose: &Pose, factored: &Cholesky, at: usize) -> Placed {
    let columns: Vec<Vec<f64>> = (0..STATES).map(|k| factored.inverse_column(at + k)).collect();
    let covariance = Matrix3::from_fn(|r, c| 0.5 * (columns[c][at + r] + columns[r][at + c]));
    let (sine, cosine) = libm::sincos(pose.heading_rad);
    Placed {
        identity,
        position_m: Normal { mean: pose.place, covariance },
        heading: Heading { angle_rad: libm::atan2(sine, cosine), sigma_rad: libm::sqrt(columns[3][at + 3]) },
    }
}
