//! `simulate`: what it writes, that a seed gives the same bytes, what it refuses.

use photinus_io::dataset::{Dataset, read_truth};
use photinus_io::results::read_results;

use crate::stage::Stage;

const SCENE: &str = "name = \"small\"\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 30.0\nduration_s = 1.0\n\
exposure_us = 1000.0\n[observer]\nmotion = { hover = { position_m = [0.0, 0.0, 3.0] } }\nwind_m_s = 1.0\n\
[[camera]]\nname = \"front\"\nfile = \"camera.toml\"\n[[target]]\nid = 4\nairframe = \"hexa.toml\"\nwind_m_s = 2.0\n\
motion = { hover = { position_m = [3.0, 0.0, 3.0] } }\n";

fn stage(test: &str) -> Stage {
    let stage = Stage::new(test);
    stage.file("scene.toml", SCENE);
    stage
}

#[test]
fn a_simulated_dataset_is_located_as_a_recording() {
    let stage = stage("simulate");
    let done = stage.run("simulate scene.toml --out flight --frames 4 --threads 2");
    assert_eq!(done.code, 0);
    assert!(done.err.starts_with("scene.toml: 4 frames of small in "), "{}", done.err);
    let truth = Dataset::read(stage.path("flight")).unwrap().truth().unwrap().unwrap();
    assert_eq!((truth.len(), truth[3].neighbours[0].id), (4, 4));
    assert_eq!(stage.run("locate flight -q --out r.jsonl").code, 0);
    for (record, truth) in read_results(stage.path("r.jsonl")).unwrap().zip(&truth) {
        let found = record.unwrap().neighbours;
        let (min, max) = (found[0].distance_m.min, found[0].distance_m.max);
        let true_m = truth.neighbours[0].distance_m;
        assert!(min <= true_m && max.is_none_or(|max| true_m <= max), "{true_m}");
    }
    assert_eq!(stage.run("simulate scene.toml --out flight").code, 2, "a dataset is not written over");
}

#[test]
fn a_seed_gives_the_same_bytes_whatever_the_threads() {
    let stage = stage("simulate-seed");
    for words in ["a.y4m --threads 1", "b.y4m --threads 3", "c.y4m --seed 9"] {
        assert_eq!(stage.run(&format!("simulate scene.toml -q --frames 5 --out {words}")).code, 0);
    }
    let bytes = |name: &str| std::fs::read(stage.path(name)).unwrap();
    assert!(bytes("a.y4m") == bytes("b.y4m") && bytes("a.y4m") != bytes("c.y4m"));
    assert_eq!(stage.run("simulate scene.toml --out t.jsonl").code, 0);
    assert_eq!(read_truth(stage.path("t.jsonl")).unwrap().len(), 30, "the scene's duration");
}

/// Every file of a folder and the folders in it, with its bytes.
fn files(folder: &std::path::Path) -> Vec<(std::path::PathBuf, Vec<u8>)> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => all.extend(files(&path)),
            false => all.push((path.clone(), std::fs::read(&path).unwrap())),
        }
    }
    all.sort();
    all
}

#[test]
fn several_cameras_give_one_dataset_whatever_the_threads() {
    let stage = stage("simulate-rig");
    let back = "[[camera]]\nname = \"back\"\nfile = \"camera.toml\"\nyaw_deg = 180.0\nclock = { phase_s = 0.01 }\n[gyro]\n\
        rate_hz = 100.0\nnoise_rad_s = 0.01\n[recording]\nlost = 0.2\nswapped = 0.5\n[[target]]";
    stage.file("rig.toml", SCENE.replace("[[target]]", back));
    let bytes = |threads: u32| {
        let done = stage.run(&format!("simulate rig.toml --out rig --frames 6 --threads {threads}"));
        assert_eq!(done.code, 0, "{}", done.err);
        assert!(done.err.contains("12 frames of small"), "{}", done.err);
        let bytes = files(&stage.path("rig"));
        let dataset = Dataset::read(stage.path("rig")).unwrap();
        let names: Vec<_> = dataset.cameras().iter().map(|camera| camera.name.as_deref()).collect();
        assert_eq!(names, [Some("front"), Some("back")]);
        assert!(
            dataset.cameras().iter().all(|camera| !camera.frames.is_empty() && camera.mounting.is_some())
        );
        assert_eq!(dataset.imu().unwrap().unwrap().len(), 22, "to 0.21 s at 100 Hz");
        std::fs::remove_dir_all(stage.path("rig")).unwrap();
        bytes
    };
    assert!(bytes(1) == bytes(3));
    assert_eq!(stage.run("simulate rig.toml --out one -q --frames 2 --camera back").code, 0);
    assert_eq!(Dataset::read(stage.path("one")).unwrap().cameras()[0].name, None);
    let done = stage.run("simulate rig.toml --out rig.y4m");
    assert!(
        done.err.contains("it can hold one camera; choose with --camera among front, back"),
        "{}",
        done.err
    );
}

#[test]
fn bad_scenes_are_refused_with_file_key_and_reason() {
    let stage = stage("simulate-bad");
    stage.file("far.toml", SCENE.replace("[3.0, 0.0, 3.0]", "[0.2, 0.0, 3.0]"));
    stage.file("key.toml", SCENE.replace("rate_hz", "rate"));
    for (words, message) in [
        (
            "far.toml --out x",
            "error: far.toml, `target[0].motion`: at 0.00 s camera front is inside the target",
        ),
        ("key.toml --out x", "error: key.toml, line 3: unknown key `rate`"),
        ("none.toml --out x", "error: none.toml: "),
        ("scene.toml --out x --camera back", "error: scene.toml: there is no camera `back`; it has front"),
        ("scene.toml --out no/x.y4m", "error: no/x.y4m: "),
    ] {
        let done = stage.run(&format!("simulate {words}"));
        assert_eq!(done.code, 2, "{words}");
        assert!(done.err.starts_with(message), "{}", done.err);
    }
}
