//! Shapes and graphs against what is plain to see, and against brute force.

use nalgebra::{UnitQuaternion, Vector3};

use super::shape::{extension_m, formation_error_m};
use super::sight::Graph;
use crate::chance::{Chance, Use};

#[test]
fn a_formation_is_the_same_wherever_it_stands_and_however_it_is_turned() {
    let mut chance = Chance::new(2, Use::Places, 0);
    let wanted: Vec<Vector3<f64>> = (0..6).map(|_| chance.normals() * 5.0).collect();
    let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * 2.1);
    let moved: Vec<Vector3<f64>> = wanted.iter().map(|p| turn * p + Vector3::new(7.0, -3.0, 2.0)).collect();
    assert!(formation_error_m(&moved, &wanted) < 1e-6);
    // against trying every turn by hand
    let bent: Vec<Vector3<f64>> = moved.iter().map(|place| place + chance.normals() * 0.8).collect();
    let by_hand = |angle_rad: f64| {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * angle_rad);
        let off: Vec<Vector3<f64>> = bent.iter().zip(&wanted).map(|(p, w)| p - turn * w).collect();
        extension_m(&off)
    };
    let best = (0..100_000).map(|step| by_hand(f64::from(step) * 6.283_185e-5)).fold(f64::INFINITY, f64::min);
    let told = formation_error_m(&bent, &wanted);
    assert!(told > 0.3 && (told / best - 1.0).abs() < 1e-6, "{told} {best}");
}

#[test]
fn parts_of_a_graph_are_those_that_walking_finds() {
    let mut chance = Chance::new(3, Use::Places, 0);
    for _ in 0..200 {
        let count = 1 + (chance.uniform() * 12.0) as usize;
        let mut graph = Graph::new(count);
        let mut links = vec![vec![false; count]; count];
        for _ in 0..(chance.uniform() * 12.0) as usize {
            let [a, b] = [0, 1].map(|_| (chance.uniform() * count as f64) as usize);
            graph.join(a, b);
            (links[a][b], links[b][a]) = (true, true);
        }
        let part = |from: usize| {
            let mut reached = vec![false; count];
            let mut left = vec![from];
            while let Some(at) = left.pop() {
                if !std::mem::replace(&mut reached[at], true) {
                    left.extend((0..count).filter(|&to| links[at][to]));
                }
            }
            reached.into_iter().filter(|reached| *reached).count()
        };
        assert_eq!(graph.largest(), (0..count).map(part).max().unwrap());
    }
}
