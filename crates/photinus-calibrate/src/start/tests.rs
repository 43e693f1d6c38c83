use nalgebra::{Isometry3, Vector3};

use super::*;
use crate::adjust::Observation;
use crate::grid::Grid;

fn views(lens: &Lens, grid: &Grid) -> (Vec<View>, Vec<Isometry3<f64>>) {
    let nominal = grid.nominal_m();
    let poses: Vec<_> = (0..6)
        .map(|i| {
            let angle = f64::from(i);
            let place = Vector3::new(0.5 * libm::sin(angle), 0.3 * libm::cos(angle), 0.5 + 0.1 * angle);
            Isometry3::new(place, Vector3::new(0.4 * libm::cos(angle), 0.4 * libm::sin(2.0 * angle), angle))
        })
        .collect();
    let view = |(photo, pose): (usize, &Isometry3<f64>)| View {
        photo,
        observations: (0..grid.leds())
            .map(|led| {
                let point = pose * nalgebra::Point3::from(nominal[led]);
                Observation { led, pixel: lens.pixel(&point.coords).unwrap() }
            })
            .collect(),
    };
    (poses.iter().enumerate().map(view).collect(), poses)
}

#[test]
fn a_flat_board_has_its_pose_in_closed_form_also_past_a_right_angle() {
    let grid = Grid::new(7, 5, 0.05).unwrap();
    let lens = Lens::equidistant(300.0, 250.0, [376.0, 240.0]);
    let (mut views, mut poses) = views(&lens, &grid);
    let side = Isometry3::new(Vector3::new(0.6, 0.0, -0.05), Vector3::new(0.0, 1.6, 0.0));
    let nominal = grid.nominal_m();
    let pixel = |led: usize| lens.pixel(&(side * nalgebra::Point3::from(nominal[led])).coords).unwrap();
    let observations = (0..grid.leds()).map(|led| Observation { led, pixel: pixel(led) }).collect();
    views.push(View { photo: 6, observations });
    poses.push(side);
    for (view, pose) in views.iter().zip(&poses) {
        let found = planar_pose(&lens, &nominal, view).unwrap();
        assert!((found.inverse() * pose).translation.vector.norm() < 1e-9);
        assert!(found.rotation.angle_to(&pose.rotation) < 1e-9);
        let twice = other_fold(&other_fold(pose).unwrap()).unwrap();
        assert!(twice.rotation.angle_to(&pose.rotation) < 1e-12);
    }
}

#[test]
fn an_equidistant_camera_is_found_from_nothing() {
    let grid = Grid::new(7, 5, 0.05).unwrap();
    let lens = Lens::equidistant(250.0, 260.0, [375.5, 239.5]);
    let (views, _) = views(&lens, &grid);
    let scene = start(&views, &grid.nominal_m(), [752, 480]).unwrap();
    let focal_px = scene.lens.radius_px(1.0).unwrap();
    assert!((focal_px - 260.0).abs() < 1e-3, "{focal_px}");
}
