//! P3P and PnP against OpenCV's, an implementation that shares nothing with ours, on views in front of the
//! camera (OpenCV knows no others): ordinary ones, nearly flat, nearly on one line, far away.
//!
//! Needs a Python with cv2: that of the environment variable PHOTINUS_PYTHON, else `python3`. OpenCV 4 and 5 agree with it.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::io::Write;
use std::process::Stdio;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use photinus::pose::{p3p, pnp};
use photinus_testing::python_with;
use rand_distr::{Distribution, StandardNormal, Uniform};
use rand_pcg::Pcg64;

struct View {
    name: &'static str,
    truth: Isometry3<f64>,
    points_m: Vec<Vector3<f64>>,
    bearings: Vec<Vector3<f64>>,
}

impl View {
    fn cost(&self, pose: &Isometry3<f64>) -> f64 {
        let chord = |(p, bearing): (&Vector3<f64>, &Vector3<f64>)| (seen(pose, p) - bearing).norm_squared();
        self.points_m.iter().zip(&self.bearings).map(chord).sum()
    }
}

fn seen(pose: &Isometry3<f64>, point_m: &Vector3<f64>) -> Vector3<f64> {
    (pose.rotation * point_m + pose.translation.vector).normalize()
}

fn vector(rng: &mut Pcg64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| StandardNormal.sample(rng))
}

/// What the body is like: its name, how much it is squeezed along each axis, and how far away it is, m.
const KINDS: [(&str, [f64; 3], [f64; 2]); 4] = [
    ("ordinary", [1.0, 1.0, 1.0], [4.0, 12.0]),
    ("nearly flat", [1.0, 1.0, 1e-3], [4.0, 12.0]),
    ("nearly on a line", [1.0, 3e-2, 3e-2], [4.0, 12.0]),
    ("far", [1.0, 1.0, 1.0], [50.0, 200.0]),
];

fn views(count: usize, per_kind: usize, sigma_rad: f64, rng: &mut Pcg64) -> Vec<View> {
    let mut views = Vec::new();
    for (name, squeeze, [near_m, far_m]) in KINDS {
        let distance = Uniform::new(near_m, far_m).unwrap();
        for _ in 0..per_kind {
            let points_m: Vec<_> =
                (0..count).map(|_| vector(rng).component_mul(&Vector3::from(squeeze))).collect();
            let aside = vector(rng) * 0.2;
            let towards = (Vector3::z() + aside.component_mul(&Vector3::new(1.0, 1.0, 0.0))).normalize();
            let attitude = UnitQuaternion::from_scaled_axis(vector(rng) * 2.0);
            let truth = Isometry3::from_parts(Translation3::from(towards * distance.sample(rng)), attitude);
            let bearings: Vec<_> =
                points_m.iter().map(|p| (seen(&truth, p) + vector(rng) * sigma_rad).normalize()).collect();
            if bearings.iter().all(|bearing| bearing.z > 0.2) {
                views.push(View { name, truth, points_m, bearings });
            }
        }
    }
    views
}

/// The poses that OpenCV finds for each view; `None` where it is not installed.
fn by_opencv(views: &[View]) -> Option<Vec<Vec<Isometry3<f64>>>> {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/opencv/pnp.py");
    let mut python = python_with(&["cv2", "numpy"])?;
    let mut child = python.arg(script).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut input = String::new();
    for view in views {
        input += &view.points_m.len().to_string();
        for (p, bearing) in view.points_m.iter().zip(&view.bearings) {
            let image = bearing.xy() / bearing.z;
            input += &format!(" {} {} {} {} {}", p.x, p.y, p.z, image.x, image.y);
        }
        input.push('\n');
    }
    // The script reads everything before it writes, so this cannot block.
    child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{script} failed");
    let lines = String::from_utf8(output.stdout).unwrap();
    let poses: Vec<_> = lines.lines().map(poses).collect();
    assert_eq!(poses.len(), views.len());
    Some(poses)
}

fn poses(line: &str) -> Vec<Isometry3<f64>> {
    let numbers: Vec<f64> = line.split_whitespace().map(|number| number.parse().unwrap()).collect();
    let pose = |n: &[f64]| Isometry3::new(Vector3::new(n[3], n[4], n[5]), Vector3::new(n[0], n[1], n[2]));
    numbers.chunks_exact(6).map(pose).collect()
}

fn difference(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    let shift = (a.translation.vector - b.translation.vector).norm() / b.translation.vector.norm();
    shift.max(a.rotation.angle_to(&b.rotation))
}

fn nearest<'a>(poses: impl IntoIterator<Item = &'a Isometry3<f64>>, pose: &Isometry3<f64>) -> f64 {
    poses.into_iter().map(|other| difference(other, pose)).fold(f64::INFINITY, f64::min)
}

#[test]
fn p3p_finds_what_opencv_finds() {
    let views = views(3, 500, 0.0, &mut Pcg64::new(1, 1));
    let Some(theirs) = by_opencv(&views) else { return };
    let (mut shared, mut only_ours) = (0, 0);
    for (view, theirs) in views.iter().zip(&theirs) {
        let (bearings, points_m) = (&view.bearings[..], &view.points_m[..]);
        let ours = p3p(bearings.try_into().unwrap(), points_m.try_into().unwrap());
        assert!(nearest(ours.iter(), &view.truth) < 1e-6, "{}: the truth is missed", view.name);
        // Some of what OpenCV returns explains the bearings badly.
        for pose in theirs.iter().filter(|pose| view.cost(pose) < 1e-18) {
            let nearest = nearest(ours.iter(), pose);
            assert!(nearest < 1e-4, "{}: {nearest:e} from a pose of OpenCV's, {pose}", view.name);
            shared += 1;
        }
        only_ours += ours.iter().filter(|pose| nearest(theirs, pose) > 1e-4).count();
    }
    println!("{} views: {shared} poses of OpenCV's found, {only_ours} that it does not have", views.len());
    assert!(shared * 2 > views.len());
}

#[test]
fn pnp_of_exact_bearings_is_opencvs() {
    let mut views = views(4, 100, 0.0, &mut Pcg64::new(2, 1));
    views.extend(self::views(12, 100, 0.0, &mut Pcg64::new(3, 1)));
    let Some(theirs) = by_opencv(&views) else { return };
    let mut shared = 0;
    for (view, theirs) in views.iter().zip(&theirs) {
        let ours = pnp(&view.bearings, &view.points_m).unwrap();
        assert!(difference(&ours, &view.truth) < 1e-7, "{}: {}", view.name, difference(&ours, &view.truth));
        shared += usize::from(nearest(theirs, &ours) < 1e-4);
    }
    println!("{} views, {shared} as OpenCV has them", views.len());
    assert!(shared * 10 > views.len() * 8);
}

#[test]
fn pnp_of_noisy_bearings_explains_them_no_worse_than_opencvs() {
    let mut views = views(4, 100, 3e-4, &mut Pcg64::new(4, 1));
    views.extend(self::views(12, 100, 3e-4, &mut Pcg64::new(5, 1)));
    let Some(theirs) = by_opencv(&views) else { return };
    let (mut compared, mut alike) = (0, 0);
    for (view, theirs) in views.iter().zip(&theirs) {
        let ours = view.cost(&pnp(&view.bearings, &view.points_m).unwrap());
        for pose in theirs {
            let theirs = view.cost(pose);
            assert!(ours <= theirs * (1.0 + 1e-6), "{}: {ours:e}, OpenCV's {theirs:e}", view.name);
            compared += 1;
            alike += usize::from(theirs < ours * 1.1);
        }
    }
    println!("{compared} poses of OpenCV's: {alike} explain the bearings within 10 % as well, none better");
    assert!(compared > views.len() && alike * 2 > compared);
}
