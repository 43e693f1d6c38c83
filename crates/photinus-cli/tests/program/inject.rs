//! `inject`: what becomes of a dataset, that a seed gives the same bytes, what it refuses.

use photinus_io::dataset::Dataset;
use photinus_io::image::read_image;
use photinus_io::read_camera;

use crate::stage::Stage;

const SCENE: &str = "name = \"small\"\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 30.0\nduration_s = 1.0\n\
exposure_us = 1000.0\n[observer]\nmotion = { hover = { position_m = [0.0, 0.0, 3.0] } }\n\
[[camera]]\nname = \"front\"\nfile = \"camera.toml\"\n[[target]]\nid = 4\nairframe = \"hexa.toml\"\n\
motion = { hover = { position_m = [3.0, 0.0, 3.0] } }\n";

/// A dataset of eight frames, `flight`.
fn stage(test: &str) -> Stage {
    let stage = Stage::new(test);
    stage.file("scene.toml", SCENE);
    assert_eq!(stage.run("simulate scene.toml -q --out flight --frames 8").code, 0);
    stage
}

#[test]
fn a_dataset_with_faults_is_a_dataset_with_its_truth() {
    let stage = stage("inject");
    let words = "--fault gain=0.5 --fault dropped=0.4 --fault gravity=20 --fault focal=1.5 --fault airframe=2 --seed 3";
    let done = stage.run(&format!("inject flight {words} --out bad"));
    assert_eq!(done.code, 0);
    let [flight, bad] = ["flight", "bad"].map(|name| Dataset::read(stage.path(name)).unwrap());
    assert!((1..8).contains(&bad.frames().len()));
    assert!(done.err.contains(&format!("{} of 8 frames written to bad", bad.frames().len())), "{}", done.err);
    let truth = bad.truth().unwrap().unwrap();
    for (row, truth) in bad.frames().iter().zip(&truth) {
        let before = flight.frames().iter().find(|before| before.frame == row.frame).unwrap();
        assert_eq!((truth.frame, row.time_s.to_bits()), (row.frame, before.time_s.to_bits()));
        let angle = before.gravity.unwrap().angle(&row.gravity.unwrap());
        assert!((angle.to_degrees() - 20.0).abs() < 1e-6, "{angle}");
        let [dark, light] = [(&bad, row), (&flight, before)]
            .map(|(dataset, row)| read_image(dataset.path(&row.image)).unwrap().image);
        let halves = light.pixels().iter().map(|&grey| grey.div_ceil(2));
        assert!(halves.eq(dark.pixels().iter().copied()), "half of each level, 0.5 up");
    }
    assert!(stage.read("bad/told-camera.toml").contains("90.0"), "60 px of focal length told as 90");
    assert!(stage.read("bad/told-airframe.toml").contains("0.8"), "arms of 0.4 m told as 0.8");
    assert_eq!(stage.run("locate bad -q --out r.jsonl").code, 0);
    assert_eq!(stage.run("evaluate bad r.jsonl").code, 0);
}

#[test]
fn a_seed_gives_the_same_bytes_and_other_files_are_copied() {
    let stage = stage("inject-seed");
    for words in ["a --seed 1", "b --seed 1", "c --seed 2"] {
        assert_eq!(
            stage.run(&format!("inject flight -q --fault noise=5 --fault hot=4 --out {words}")).code,
            0
        );
    }
    let bytes = |name: &str| std::fs::read(stage.path(name).join("images/000003.png")).unwrap();
    assert!(bytes("a") == bytes("b") && bytes("a") != bytes("c"));
    assert_eq!(stage.read("a/camera.toml"), stage.read("flight/camera.toml"));
    assert_eq!(read_camera(stage.path("a/camera.toml")).unwrap().camera.width(), 96);
}

#[test]
fn every_camera_of_a_rig_has_the_fault_and_what_lies_beside_is_kept() {
    let stage = stage("inject-rig");
    let camera = |name: &str| {
        format!(
            "[[camera]]\nname = \"{name}\"\ncamera = \"camera.toml\"\nmounting = \"{name}.toml\"\nframes = \"{name}/frames.csv\"\n"
        )
    };
    let head =
        "airframe = \"airframe.toml\"\nvehicles = \"vehicles.toml\"\nexposure_us = 1000.0\nrate_hz = 30.0\n";
    stage.file("flight/dataset.toml", [head, &camera("left"), &camera("right")].concat());
    stage.file("flight/vehicles.toml", "[[vehicle]]\nid = 4\nairframe = \"airframe.toml\"\n");
    let mounting = "body_from_camera_xyzw = [0.0, 0.0, 0.0, 1.0]\n\
        rotation_covariance_rad2 = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]\n";
    let truth: String = ["left", "right"]
        .map(|name| {
            stage.file(&format!("flight/{name}.toml"), mounting);
            std::fs::create_dir_all(stage.path("flight").join(name)).unwrap();
            let rows = stage.read("flight/frames.csv");
            stage.file(&format!("flight/{name}/frames.csv"), rows);
            stage
                .read("flight/truth.jsonl")
                .replace("{\"frame\"", &format!("{{\"camera\":\"{name}\",\"frame\""))
        })
        .concat();
    stage.file("flight/truth.jsonl", truth);
    stage.file("flight/imu.csv", "time_s,wx_rad_s,wy_rad_s,wz_rad_s\n0.0,0.1,0.2,0.3\n");
    assert_eq!(stage.run("inject flight -q --fault noise=5 --fault airframe=1.5 --out bad").code, 0);
    let bad = Dataset::read(stage.path("bad")).unwrap();
    assert_eq!(bad.cameras().len(), 2);
    assert_eq!(bad.truth().unwrap().unwrap().len(), 16);
    assert_eq!(bad.imu().unwrap().unwrap().len(), 1);
    assert!((bad.vehicles()[0].airframe.max_radius_m() - 0.6).abs() < 1e-9);
    let image = |name: &str| std::fs::read(stage.path("bad").join(name).join("images/000003.png")).unwrap();
    assert!(image("left") != image("right"), "each camera has noise of its own");
}

#[test]
fn what_cannot_be_injected_is_refused() {
    let stage = stage("inject-bad");
    let refuses = |words: &str, parts: &[&str]| stage.refuses(&format!("inject {words}"), parts);
    refuses("flight --fault noise=5 --out flight --force", &["flight: a file in it is an input"]);
    std::fs::create_dir(stage.path("mine")).unwrap();
    stage.file("mine/mine.txt", "mine");
    refuses("flight --fault noise=5 --out mine", &["mine: it is there already"]);
    refuses("flight --fault fog --out x", &["`fog`: no such fault; there is gain=0.5 noise=8"]);
    refuses("flight --fault noise=-1 --out x", &["give noise= a number from 0 to 255"]);
    refuses("flight --out x", &["--fault <WORD>"]);
    refuses("none --fault mirrored --out x", &["none: ", "check the path"]);
    refuses("mine --fault mirrored --out x", &["the folder holds no dataset.toml"]);
    stage.file("flight/outside.toml", stage.read("flight/dataset.toml"));
    let outside = stage.read("flight/dataset.toml").replace("airframe.toml", "../hexa.toml");
    stage.file("flight/dataset.toml", outside);
    refuses(
        "flight --fault mirrored --out x",
        &["hexa.toml: this file lies outside of the dataset's folder"],
    );
    std::fs::rename(stage.path("flight/outside.toml"), stage.path("flight/dataset.toml")).unwrap();
    std::fs::remove_file(stage.path("flight/truth.jsonl")).unwrap();
    refuses("flight --fault dead-led=1 --out x", &["it holds no truth, and dead-led=1 needs to know"]);
    assert!(!stage.path("x").exists(), "what is refused leaves nothing behind");
}
