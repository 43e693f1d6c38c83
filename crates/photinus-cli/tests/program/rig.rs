//! A dataset of several cameras on one vehicle: each line says which camera, and where neighbours are in the body frame.

use serde_json::Value;

use crate::stage::Stage;

/// The camera looks along the body's x axis.
pub(crate) const FORWARD: &str = "body_from_camera_xyzw = [-0.5, 0.5, -0.5, 0.5]\nposition_m = [0.1, 0.0, 0.05]\n\
                       rotation_covariance_rad2 = [[1e-4, 0, 0], [0, 1e-4, 0], [0, 0, 1e-4]]\n\
                       position_covariance_m2 = [[1e-6, 0, 0], [0, 1e-6, 0], [0, 0, 1e-6]]\n";
/// It looks along the negative x axis.
const BACKWARD: &str = "body_from_camera_xyzw = [-0.5, -0.5, 0.5, 0.5]\nposition_m = [-0.1, 0.0, 0.05]\n\
                        rotation_covariance_rad2 = [[0, 0, 0], [0, 0, 0], [0, 0, 0]]\n\
                        position_covariance_m2 = [[0, 0, 0], [0, 0, 0], [0, 0, 0]]\n";

/// A rig of two cameras that see the same, a third of a frame apart.
fn stage(test: &str) -> Stage {
    let stage = Stage::new(test);
    stage.dataset("rig", 3);
    stage.file("rig/front.toml", FORWARD);
    stage.file("rig/back.toml", BACKWARD);
    let frames = stage.read("rig/frames.csv");
    stage.file(
        "rig/back.csv",
        frames.replace(",0,images", ",0.01,images").replace(",0.05,", ",0.06,").replace(",0.1,", ",0.11,"),
    );
    let camera = |name: &str, frames: &str| {
        format!(
            "[[camera]]\nname = \"{name}\"\ncamera = \"camera.toml\"\nmounting = \"{name}.toml\"\nframes = \"{frames}\"\n"
        )
    };
    let table = "airframe = \"hexa.toml\"\nexposure_us = 1000\nrate_hz = 20\n";
    stage.file(
        "rig/dataset.toml",
        format!("{table}{}{}", camera("front", "frames.csv"), camera("back", "back.csv")),
    );
    let truth = |camera: &str, frame: usize, time_s: f64| {
        format!("{{\"frame\":{frame},\"camera\":\"{camera}\",\"time_s\":{time_s},\"neighbours\":[]}}\n")
    };
    let truth =
        (0..3).map(|n| truth("front", n, n as f64 / 20.0) + &truth("back", n, n as f64 / 20.0 + 0.01));
    stage.file("rig/truth.jsonl", truth.collect::<String>());
    stage
}

fn lines(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

#[test]
fn every_line_says_its_camera_and_places_in_the_body_frame() {
    let stage = stage("rig");
    let told = stage.run("info rig");
    for part in [
        "a dataset of 2 cameras",
        "camera called  back",
        "back.toml: at -0.100, 0.000, 0.050 m in the body frame",
    ] {
        assert!(told.code == 0 && told.out.contains(part), "{}\nlacks {part}", told.out);
    }
    let done = stage.run("locate rig -q --out r.jsonl --csv t.csv --overlay seen");
    assert_eq!(done.code, 0, "{}", done.err);
    let records = lines(&stage.read("r.jsonl"));
    let order: Vec<(&str, u64)> =
        records.iter().map(|r| (r["camera"].as_str().unwrap(), r["frame"].as_u64().unwrap())).collect();
    assert_eq!(order, [("front", 0), ("back", 0), ("front", 1), ("back", 1), ("front", 2), ("back", 2)]);
    let place = |record: &Value, field: &str| numbers(&record["neighbours"][0][field]);
    let (seen_m, front_m, back_m) = (
        place(&records[0], "position_m"),
        place(&records[0], "position_body_m"),
        place(&records[1], "position_body_m"),
    );
    // Right of a camera that looks forward is the body's right, its negative y; of one that looks back, its left.
    let expected_front = [seen_m[2] + 0.1, -seen_m[0], 0.05 - seen_m[1]];
    let expected_back = [-seen_m[2] - 0.1, seen_m[0], 0.05 - seen_m[1]];
    for axis in 0..3 {
        assert!((front_m[axis] - expected_front[axis]).abs() < 1e-9, "{front_m:?} not {expected_front:?}");
        assert!((back_m[axis] - expected_back[axis]).abs() < 1e-9, "{back_m:?} not {expected_back:?}");
    }
    // 10 mrad about the vertical at 2.7 m move it 27 mm sideways.
    let variance =
        |record: &Value| record["neighbours"][0]["position_body_covariance_m2"][1][1].as_f64().unwrap();
    let added_m2 = variance(&records[0]) - variance(&records[1]);
    assert!((added_m2 / (1e-4 * seen_m[2] * seen_m[2] + 1e-6) - 1.0).abs() < 0.02, "{added_m2}");
    assert_eq!(
        stage.names("seen"),
        ["back", "front"]
            .iter()
            .flat_map(|name| (0..3).map(move |n| format!("overlay-{name}-{n:06}.png")))
            .collect::<Vec<_>>()
    );
    assert!(
        stage
            .read("t.csv")
            .lines()
            .next()
            .unwrap()
            .ends_with(",camera,x_body_m,y_body_m,z_body_m,probability,misfit_p")
    );
    assert!(stage.read("t.csv").lines().nth(2).unwrap().contains(",back,-2."));
}

/// Each camera sees its own vehicle, ahead of it, and none behind.
#[test]
fn cameras_share_their_tracks() {
    let stage = stage("rig-tracks");
    assert_eq!(stage.run("locate rig -q --out r.jsonl").code, 0);
    let records = lines(&stage.read("r.jsonl"));
    let tracks = |record: &Value| -> Vec<(u64, bool, Vec<f64>)> {
        let track = |track: &Value| {
            let seen = !track["spots"].as_array().unwrap().is_empty();
            (track["track"].as_u64().unwrap(), seen, numbers(&track["position_body_m"]))
        };
        record["tracks"].as_array().unwrap().iter().map(track).collect()
    };
    let (front, back) = (tracks(&records[4]), tracks(&records[5]));
    let numbers = |tracks: &[(u64, bool, Vec<f64>)]| tracks.iter().map(|track| track.0).collect::<Vec<_>>();
    assert_eq!((numbers(&front), numbers(&back)), (vec![0, 1], vec![0, 1]));
    for (place, (ahead, behind)) in front.iter().zip(&back).enumerate() {
        assert_eq!((ahead.1, behind.1), (place == 0, place == 1), "one camera sees it, the other does not");
        let apart_m = (ahead.2[0] - behind.2[0]).abs() + (ahead.2[1] - behind.2[1]).abs();
        assert!(apart_m < 0.05 && (ahead.2[0] > 0.0) == (place == 0), "{ahead:?} {behind:?}");
    }
    assert_eq!(records[4]["tracks"][0]["predicted"], false);
    assert_eq!(records[5]["tracks"][0]["predicted"], false, "who is behind this camera does not coast");
}

/// A run takes frames of its cameras in as they come; its recording says in which order that was.
#[test]
fn a_recording_of_several_cameras_replays_to_what_the_run_found() {
    let stage = stage("rig-replay");
    let camera = |name: &str, source: &str| {
        format!("[[camera]]\nname = \"{name}\"\nsource = {{ {source}, camera = \"{name}\" }}\n")
    };
    let of_dataset: String = ["front", "back"].map(|name| camera(name, "dataset = \"rig\"")).concat();
    let sinks = |name: &str| format!("[json]\nfile = \"{name}.jsonl\"\n");
    stage.file("run.toml", format!("{of_dataset}{}[record]\nfile = \"run.mcap\"\n", sinks("run")));
    let told = stage.run("run run.toml");
    assert_eq!(told.code, 0, "{}", told.err);
    let replayed = |name: &str| {
        let source = camera(name, "recording = \"run.mcap\"");
        format!("{source}camera = \"rig/camera.toml\"\nmounting = \"rig/{name}.toml\"\n")
    };
    let replay =
        format!("{}[airframe]\nfile = \"rig/hexa.toml\"\n", ["back", "front"].map(replayed).concat());
    // What a clock says of the run is no result.
    let results = |name: &str| {
        let without_latency = |line: &str| {
            let mut record: Value = serde_json::from_str(line).unwrap();
            record.as_object_mut().unwrap().remove("latency_s");
            record.to_string()
        };
        let mut lines: Vec<String> = stage.read(name).lines().map(without_latency).collect();
        lines.sort_unstable();
        lines
    };
    let found = results("run.jsonl");
    assert!(found.len() >= 4 && found.iter().any(|line| line.contains("\"tracks\"")), "{found:?}");
    for name in ["first", "second"] {
        stage.file("replay.toml", format!("pace = \"fast\"\n{replay}{}", sinks(name)));
        let told = stage.run("run replay.toml");
        assert_eq!(told.code, 0, "{}", told.err);
        assert_eq!(results(&format!("{name}.jsonl")), found);
    }
    for (wrong, words) in [
        (format!("{replay}{}", sinks("x")), "add pace = \"fast\""),
        (
            format!(
                "pace = \"fast\"\n{}{}",
                replay.replace("camera = \"back\"", "camera = \"left\""),
                sinks("x")
            ),
            "back",
        ),
        (format!("pace = \"fast\"\n{}{}", replay.replace("run.mcap", "no.mcap"), sinks("x")), "no.mcap"),
    ] {
        stage.file("wrong.toml", wrong);
        let told = stage.run("run wrong.toml");
        assert!(told.code == 2 && told.err.contains(words), "{}", told.err);
    }
}

#[test]
fn one_camera_of_several_can_be_chosen() {
    let stage = stage("rig-only");
    // What is followed is followed by all cameras together.
    assert_eq!(stage.run("locate rig -q --no-time --out all.jsonl").code, 0);
    assert_eq!(stage.run("locate rig -q --no-time --only back --out back.jsonl").code, 0);
    let of_back: String = stage
        .read("all.jsonl")
        .lines()
        .filter(|line| line.contains("\"camera\":\"back\""))
        .map(|line| format!("{line}\n"))
        .collect();
    assert_eq!(stage.read("back.jsonl"), of_back);
    let names = "it has the cameras front, back; choose one with --only NAME";
    for words in [
        "locate rig --camera camera.toml",
        "detect rig --mask rig/images/000000.png",
        "convert rig one",
        "evaluate rig all.jsonl",
    ] {
        stage.refuses(words, &[names]);
    }
    stage.refuses("locate rig --only left", &["--only left: the dataset has the cameras front, back"]);
    assert_eq!(stage.run("convert rig one --only back").code, 0);
    assert_eq!(stage.run("locate one -q --out one.jsonl").code, 0, "of one camera it is a plain dataset");
    let done = stage.run("evaluate rig all.jsonl --only back");
    assert!(done.code == 0 && !done.err.contains("missed"), "{}", done.err);
    for victim in ["rig/back.toml", "rig/back.csv", "rig/imu.csv"] {
        stage.file("rig/imu.csv", "time_s,wx_rad_s,wy_rad_s,wz_rad_s\n0,0,0,0\n");
        stage.refuses(&format!("locate rig --out {victim} --force"), &["this file is an input"]);
    }
}

#[test]
fn a_mounting_of_its_own_and_a_run_that_goes_on() {
    let stage = stage("rig-resume");
    stage.file("front.toml", FORWARD);
    let plain = stage
        .run("locate frame.png --camera camera.toml --airframe hexa.toml -q --out - --mounting front.toml");
    let ahead_m = plain.out.split("\"position_body_m\":[").nth(1).and_then(|rest| rest.split(',').next());
    let ahead_m: f64 = ahead_m.expect("a place in the body").parse().expect("a number");
    assert!((ahead_m - 2.8).abs() < 0.03, "{}", plain.out);
    assert_eq!(stage.run("locate rig -q --out whole.jsonl").code, 0);
    let whole = stage.read("whole.jsonl");
    for cut in [1, 2, 3, 4] {
        let at = whole.match_indices('\n').nth(cut).unwrap().0 + 7;
        stage.file("r.jsonl", &whole[..at]);
        assert_eq!(stage.run("locate rig -q --out r.jsonl --resume").code, 0);
        assert_eq!(stage.read("r.jsonl"), whole, "after {cut} lines");
    }
}
