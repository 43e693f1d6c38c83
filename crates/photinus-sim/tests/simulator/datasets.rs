//! What a simulation writes is read back, and what it says agrees with itself.

use std::path::{Path, PathBuf};

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use photinus::camera::Pixel;
use photinus_io::dataset::{Dataset, DatasetCamera, TruthFrame, TruthNeighbour};
use photinus_io::image::read_image;
use photinus_io::read_camera;
use photinus_sim::dataset::SceneDataset;
use photinus_sim::{Scene, Simulator};

const OBSERVER: &str = "[observer]\nmotion = { circle = { centre_m = [0.0, 0.0, 4.0], radius_m = 1.0, speed_m_s = 1.0 } }\n\
     spin = [{ start_s = 0.0, duration_s = 1.0, turns = 0.2 }]\n";
const FRONT: &str = "[[camera]]\nname = \"front\"\nfile = \"cameras/bluefox-dsl215.toml\"\nposition_m = [0.1, 0.02, -0.03]\n\
     pitch_deg = 10.0\n";
const LEFT: &str = "[[camera]]\nname = \"left\"\nfile = \"cameras/bluefox-dsl215.toml\"\nposition_m = [-0.05, 0.1, 0.04]\n\
     yaw_deg = 70.0\nroll_deg = 20.0\n";
const TARGET: &str = "[[target]]\nid = 5\nairframe = \"airframes/hexarotor-0.4.toml\"\n\
     motion = { hover = { position_m = [5.0, 3.0, 4.5] } }\n";

fn scene(parts: &str) -> Scene {
    let text = format!(
        "name = \"test\"\nseed = 3\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 20.0\nduration_s = 1.0\n\
         exposure_us = 1000.0\n{parts}"
    );
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/test.toml"));
    Scene::parse(&text, path).unwrap_or_else(|error| panic!("{error}"))
}

/// A folder for one test, gone with it.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("photinus-sim-{}-{test}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // A folder left behind in the system's temporary folder harms nobody.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Writes `frames` frames of all cameras and reads the dataset back.
fn written(folder: &Folder, scene: &Scene, frames: u64) -> Dataset {
    let cameras: Vec<usize> = (0..scene.cameras.len()).collect();
    let mut dataset = SceneDataset::create(&folder.0, scene, &cameras, frames).expect("a new folder");
    for camera in cameras {
        let mut simulator = Simulator::new(scene, camera).expect("it has this camera");
        (0..frames)
            .for_each(|number| dataset.add(camera, &simulator.frame(number)).expect("it can be written"));
    }
    Dataset::read(&folder.0).expect("what was written is read")
}

fn truth_of(dataset: &Dataset, camera: &str) -> Vec<TruthFrame> {
    let truth = dataset.truth().expect("truth is read").expect("truth is there");
    truth.into_iter().filter(|frame| frame.camera.as_deref() == Some(camera)).collect()
}

fn camera_from_body(neighbour: &TruthNeighbour) -> Isometry3<f64> {
    let [x, y, z, w] = neighbour.orientation_xyzw;
    let rotation = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
    Isometry3::from_parts(Translation3::from(Vector3::from(neighbour.position_m)), rotation)
}

fn mounting(camera: &DatasetCamera) -> Isometry3<f64> {
    let mounting = camera.mounting.expect("a rig has mountings");
    Isometry3::from_parts(
        Translation3::from(mounting.position_m.expect("where it sits is known")),
        mounting.body_from_camera,
    )
}

#[test]
fn one_camera_gives_the_layout_with_one_camera() {
    let (folder, scene) = (Folder::new("one"), scene(&format!("{OBSERVER}{FRONT}{TARGET}")));
    let dataset = written(&folder, &scene, 2);
    let text = std::fs::read_to_string(dataset.path("dataset.toml")).unwrap();
    let expected =
        "camera = \"camera.toml\"\nairframe = \"airframe.toml\"\nexposure_us = 1000.0\nrate_hz = 20.0\n";
    assert_eq!(text, expected);
    let mut simulator = Simulator::new(&scene, 0).unwrap();
    let rendered = [simulator.frame(0), simulator.frame(1)];
    assert_eq!(dataset.truth().unwrap().unwrap(), rendered.each_ref().map(|rendered| rendered.truth.clone()));
    let row = &dataset.frames()[1];
    assert_eq!(read_image(dataset.path(&row.image)).unwrap().image, rendered[1].image);
    assert!((row.gravity.unwrap().into_inner() - rendered[1].gravity.into_inner()).norm() < 1e-12);
    let camera = read_camera(dataset.path(&dataset.info().camera)).unwrap().camera;
    assert_eq!(camera, scene.cameras[0].camera);
    assert!(!dataset.path("vehicles.toml").exists() && !dataset.path("imu.csv").exists());
    assert!(SceneDataset::create(&folder.0, &scene, &[0], 2).is_err(), "a dataset is not written over");
    assert!(SceneDataset::create(Folder::new("none").0.as_path(), &scene, &[1], 2).is_err());
}

#[test]
fn a_point_seen_by_two_cameras_is_in_one_place() {
    let (folder, scene) = (Folder::new("two"), scene(&format!("{OBSERVER}{FRONT}{LEFT}{TARGET}")));
    let dataset = written(&folder, &scene, 4);
    let [front, left] = dataset.cameras() else { panic!("two cameras") };
    let leds = scene.targets[0].airframe.leds();
    let mut seen_by_both = 0;
    for (a, b) in truth_of(&dataset, "front").iter().zip(truth_of(&dataset, "left")) {
        let in_body = [(front, &a.neighbours[0]), (left, &b.neighbours[0])]
            .map(|(camera, neighbour)| mounting(camera) * camera_from_body(neighbour));
        let gap_m = (in_body[0].translation.vector - in_body[1].translation.vector).norm();
        assert!(gap_m < 1e-9 && in_body[0].rotation.angle_to(&in_body[1].rotation) < 1e-7, "{gap_m}");
        for (camera, neighbour) in [(front, &a.neighbours[0]), (left, &b.neighbours[0])] {
            let model = read_camera(dataset.path(&camera.camera)).unwrap().camera;
            for led in &neighbour.leds {
                // the ray of the pixel, carried to the body by the mounting, meets the LED where both cameras have it
                let ray = model.bearing(Pixel::new(led.u_px, led.v_px)).unwrap();
                let along = mounting(camera).rotation * ray.vector();
                let led_m = nalgebra::Point3::from(leds[led.led.unwrap() as usize].position_m);
                let from_camera_m = (in_body[0] * led_m).coords - mounting(camera).translation.vector;
                assert!(along.cross(&from_camera_m).norm() < 1e-6, "{}", along.cross(&from_camera_m).norm());
            }
        }
        let numbers = |n: &TruthNeighbour| n.leds.iter().map(|led| led.led).collect::<Vec<_>>();
        seen_by_both +=
            numbers(&a.neighbours[0]).iter().filter(|led| numbers(&b.neighbours[0]).contains(led)).count();
    }
    assert!(seen_by_both > 4, "{seen_by_both}");
    assert_eq!(left.frames[2].image, Path::new("left/images/000002.png"));
    assert_eq!(
        read_image(dataset.path(&left.frames[2].image)).unwrap().image,
        Simulator::new(&scene, 1).unwrap().frame(2).image
    );
}

#[test]
fn each_camera_has_its_own_clock() {
    let late = LEFT.replace(
        "yaw_deg",
        "clock = { offset_s = 0.5, ppm = 200.0, phase_s = 0.013 }\nexposure_us = 400.0\nyaw_deg",
    );
    let (folder, scene) = (Folder::new("clocks"), scene(&format!("{OBSERVER}{FRONT}{late}{TARGET}")));
    let dataset = written(&folder, &scene, 5);
    assert_eq!(
        dataset.cameras().iter().map(|camera| camera.exposure_us as u32).collect::<Vec<_>>(),
        [1000, 400]
    );
    for (number, (row, truth)) in
        dataset.cameras()[1].frames.iter().zip(truth_of(&dataset, "left")).enumerate()
    {
        // its own clock reads 0.013 s + n / 20 Hz when an exposure begins, 0.5 s and 200 ppm ahead of the world's
        let begins_s = (0.013 + number as f64 / 20.0 - 0.5) / 1.0002;
        assert!((truth.true_time_s.unwrap() - (begins_s + 0.0002)).abs() < 1e-12);
        assert!((row.time_s - ((begins_s + 0.0002) * 1.0002 + 0.5)).abs() < 1e-12);
        assert_eq!(truth.time_s.to_bits(), row.time_s.to_bits());
        // truth is that of the world's time
        let observer = scene.observer.pose(truth.true_time_s.unwrap()) * scene.cameras[1].body_from_camera;
        let expected = observer.inverse() * scene.targets[0].motion.pose(0.0);
        let is_m = Vector3::from(truth.neighbours[0].position_m);
        assert!((is_m - expected.translation.vector).norm() < 1e-9);
    }
    assert!(truth_of(&dataset, "front").iter().all(|frame| frame.true_time_s.is_none()));
}

#[test]
fn a_gyro_beside_one_camera_turns_as_its_frames_do() {
    let gyro = "[gyro]\nrate_hz = 1000.0\n[odometry]\nrate_hz = 50.0\n";
    let (folder, scene) = (Folder::new("gyro"), scene(&format!("{OBSERVER}{FRONT}{TARGET}{gyro}")));
    let dataset = written(&folder, &scene, 20);
    let (imu, truth) = (dataset.imu().unwrap().unwrap(), dataset.truth().unwrap().unwrap());
    let (mut first_from_now, mut turned) = (UnitQuaternion::identity(), 0.0);
    let start = truth[0].clone();
    let mut frames = truth.iter().skip(1).peekable();
    for row in imu.iter().filter(|row| row.time_s > start.time_s) {
        first_from_now *= UnitQuaternion::from_scaled_axis(row.turn_rad_s / 1000.0);
        let Some(frame) = frames.next_if(|frame| frame.time_s < row.time_s + 0.001) else { continue };
        // the target stands still: its attitude in the camera says how the camera turned
        let by_truth = camera_from_body(&start.neighbours[0]).rotation
            * camera_from_body(&frame.neighbours[0]).rotation.inverse();
        // a sample of 1 ms at up to 2 rad/s may begin before the first frame and end after this one
        assert!(first_from_now.angle_to(&by_truth) < 0.005, "{}", frame.frame);
        turned = by_truth.angle();
    }
    assert!(turned > 1.0, "it turned {turned} rad");
    let odometry = dataset.odometry().unwrap().unwrap();
    let moved_m =
        (scene.observer.pose(1.0).translation.vector - scene.observer.pose(0.0).translation.vector).norm();
    let last = odometry.iter().find(|row| row.time_s >= 1.0).unwrap();
    assert!((last.pose.translation.vector.norm() - moved_m).abs() < 1e-9 && (odometry.len() - 51) < 2);
}

#[test]
fn frames_are_lost_late_and_swapped_as_the_scene_says() {
    let faults =
        "[recording]\nlost = 0.2\nlate = 0.3\nlate_by_s = 0.04\nswapped = 0.5\n[gravity]\nnoise_deg = 1.0\n";
    let (folder, scene) = (Folder::new("faults"), scene(&format!("{OBSERVER}{FRONT}{TARGET}{faults}")));
    let dataset = written(&folder, &scene, 20);
    let (rows, truth) = (dataset.frames(), dataset.truth().unwrap().unwrap());
    assert!((8..20).contains(&rows.len()) && rows.len() == truth.len(), "{}", rows.len());
    let mut simulator = Simulator::new(&scene, 0).unwrap();
    let (mut late, mut swapped, mut wrong_rad) = (0, 0, 0.0);
    for (row, truth) in rows.iter().zip(&truth) {
        let rendered = simulator.frame(row.frame);
        assert_eq!((row.frame, row.time_s.to_bits()), (truth.frame, truth.time_s.to_bits()));
        assert_eq!(truth.neighbours, rendered.truth.neighbours, "truth is that of the frame's number");
        let late_s = row.time_s - rendered.truth.time_s;
        assert!((0.0..0.04).contains(&late_s));
        late += usize::from(late_s > 0.0);
        let shown = read_image(dataset.path(&row.image)).unwrap().image;
        let is_own = shown == rendered.image;
        assert!(is_own || shown == simulator.frame(row.frame ^ 1).image);
        swapped += usize::from(!is_own);
        wrong_rad += libm::acos(row.gravity.unwrap().dot(&rendered.gravity).min(1.0)) / rows.len() as f64;
    }
    assert!(late > 0 && swapped > 0 && swapped % 2 == 0, "{late} {swapped}");
    assert!((0.005..0.06).contains(&wrong_rad), "a degree about two axes: {wrong_rad}");
}

#[test]
fn vehicles_and_their_words_are_written() {
    let blink =
        |words: &str| format!("blink = {{ codes = \"codes/two-words.txt\", {words}rate_hz = 60.0 }}\n");
    let quad = "[[target]]\nid = 8\nairframe = \"airframes/quadrotor-0.245.toml\"\nmotion = { hover = { position_m = [4.0, -3.0, 4.0] } }\n";
    let steady = quad.replace("id = 8", "id = 9");
    let text = format!(
        "{OBSERVER}{FRONT}{TARGET}{}{quad}{}{steady}",
        blink("words = [1], "),
        blink("first_word = 0, ")
    );
    let (folder, scene) = (Folder::new("vehicles"), scene(&text));
    let dataset = written(&folder, &scene, 1);
    assert_eq!(dataset.codes(), Some(&scene.targets[0].blink.as_ref().unwrap().codes));
    let vehicles = dataset.vehicles();
    let words = |index: usize| vehicles[index].blink.as_ref().map(|blink| blink.words.clone());
    assert_eq!(vehicles.iter().map(|vehicle| vehicle.id).collect::<Vec<_>>(), [5, 8, 9]);
    assert_eq!([words(0), words(1), words(2)], [Some(vec![1]), Some(vec![0]), None]);
    for (vehicle, target) in vehicles.iter().zip(&scene.targets) {
        assert_eq!(vehicle.airframe, target.airframe);
    }
    assert!(dataset.path("airframe-2.toml").exists() && !dataset.path("airframe-3.toml").exists());
}

#[test]
fn what_is_written_is_a_function_of_the_scene() {
    let rest = "[gyro]\nrate_hz = 100.0\nnoise_rad_s = 0.01\nbias_rad_s = 0.01\nbias_walk_rad_s = 0.001\n[gravity]\nbias_deg = 1.0\n\
                [odometry]\nrate_hz = 20.0\nplace_walk_m = 0.1\n[recording]\nlost = 0.1\nlate = 0.5\nlate_by_s = 0.01\n";
    let mut scene = scene(&format!("{OBSERVER}{FRONT}{LEFT}{TARGET}{rest}"));
    let texts = |test: &str, scene: &Scene| {
        let folder = Folder::new(test);
        written(&folder, scene, 3);
        ["front/frames.csv", "left/frames.csv", "truth.jsonl", "imu.csv", "odometry.csv"]
            .map(|name| std::fs::read_to_string(folder.0.join(name)).unwrap())
    };
    let first = texts("seed-a", &scene);
    assert_eq!(first, texts("seed-b", &scene));
    scene.set_seed(4);
    let other = texts("seed-c", &scene);
    assert!(first.iter().zip(&other).all(|(a, b)| a != b), "noise, bias and faults have the seed");
}
