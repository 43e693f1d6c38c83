//! Neighbours of several kinds in one recording: each is found, followed and named as what it is.

use std::collections::BTreeMap;

use photinus_io::dataset::Dataset;
use photinus_io::results::{FrameRecord, read_results};

use crate::stage::Stage;

const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");

/// A hexarotor and a quadrotor side by side, each turning slowly and blinking a word.
fn scene() -> String {
    let target = |id: u32, airframe: &str, y_m: f64, word: usize| {
        format!(
            "[[target]]\nid = {id}\nairframe = \"{SCENES}/airframes/{airframe}.toml\"\n\
             motion = {{ circle = {{ centre_m = [5.0, {y_m:?}, 5.0], radius_m = 0.5, speed_m_s = 0.5 }} }}\n\
             blink = {{ codes = \"{SCENES}/codes/l14-d3-r3.txt\", words = [{word}], rate_hz = 30.0, shift_s = 0.001 }}\n"
        )
    };
    format!(
        "name = \"two kinds\"\nseed = 3\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 30.0\nduration_s = 3.0\n\
         exposure_us = 1000.0\n[observer]\nmotion = {{ hover = {{ position_m = [0.0, 0.0, 5.0] }} }}\n\
         [[camera]]\nname = \"front\"\nfile = \"{SCENES}/cameras/bluefox-dsl215.toml\"\n{}{}",
        target(4, "hexarotor-0.4", 1.5, 0),
        target(7, "quadrotor-0.245", -1.5, 3),
    )
}

fn records(stage: &Stage, file: &str) -> Vec<FrameRecord> {
    read_results(stage.path(file)).unwrap().collect::<Result<_, _>>().unwrap()
}

#[test]
fn a_mixed_fleet_is_named_by_kind_and_id() {
    let stage = Stage::new("kinds");
    stage.file("scene.toml", scene());
    assert_eq!(stage.run("simulate scene.toml --out flight -q").code, 0);
    let told = stage.run("locate flight -q --out r.jsonl");
    assert_eq!((told.code, told.err.as_str()), (0, ""));
    let frames = records(&stage, "r.jsonl");
    assert_eq!(frames.len(), 90);
    // After a code length and a half both are known, and each by one track.
    let mut tracks = BTreeMap::new();
    for frame in &frames[30..] {
        assert_eq!(frame.tracks.len(), 2, "{:?}: {:?}", frame.frame, frame.tracks);
        for track in &frame.tracks {
            let expected = if track.airframe.starts_with("hexarotor") { 4 } else { 7 };
            assert!(track.id.is_none_or(|id| id == expected), "{:?}: {track:?}", frame.frame);
            if track.id.is_some() {
                tracks.entry(track.track).or_insert_with(|| (track.airframe.clone(), 0)).1 += 1;
            }
        }
    }
    let named: Vec<usize> = tracks.values().map(|(_, frames)| *frames).collect();
    assert!(named.len() == 2 && named.iter().all(|&frames| frames > 55), "{tracks:?}");
    let sure =
        frames.iter().flat_map(|frame| &frame.neighbours).filter(|neighbour| neighbour.spots.len() > 2);
    assert!(sure.clone().count() > 20);
    for neighbour in sure {
        let [side, ..] = neighbour.bearing;
        let is_left = side < 0.0;
        let probability = neighbour.airframe_probability.unwrap();
        assert!(
            neighbour.airframe.starts_with("hexarotor") == is_left || probability < 0.999,
            "{neighbour:?}"
        );
    }
}

#[test]
fn kinds_are_named_on_the_command_line_or_by_the_dataset() {
    let stage = Stage::new("kinds-named");
    stage.file("scene.toml", scene());
    assert_eq!(stage.run("simulate scene.toml --out flight --frames 3 -q").code, 0);
    let both = "--airframe flight/airframe.toml --airframe flight/airframe-2.toml";
    assert_eq!(stage.run(&format!("locate flight {both} --no-time -q --out named.jsonl")).code, 0);
    assert_eq!(stage.run("locate flight --no-time -q --out told.jsonl").code, 0);
    assert_eq!(
        stage.read("named.jsonl"),
        stage.read("told.jsonl"),
        "those of the dataset's vehicles are the default"
    );

    // A list in dataset.toml says the same, and survives a conversion.
    let info = stage
        .read("flight/dataset.toml")
        .replace("\"airframe.toml\"", "[\"airframe.toml\", \"airframe-2.toml\"]");
    stage.file(
        "flight/dataset.toml",
        info.replace("vehicles = \"vehicles.toml\"\n", "").replace("codes = \"codes.txt\"\n", ""),
    );
    assert_eq!(stage.run("locate flight --no-time -q --out listed.jsonl").code, 0);
    assert_eq!(stage.read("listed.jsonl"), stage.read("told.jsonl"));
    assert_eq!(stage.run("convert flight copy").code, 0);
    let copy = Dataset::read(stage.path("copy")).unwrap();
    assert_eq!(copy.info().airframe.iter().count(), 2);
    assert!(copy.airframes().iter().all(|file| file.is_file()), "{:?}", copy.airframes());

    // One of them alone takes the other for clutter or for its own kind, as it did.
    assert_eq!(
        stage.run("locate flight --airframe flight/airframe.toml --no-time -q --out one.jsonl").code,
        0
    );
    let one = records(&stage, "one.jsonl");
    assert!(one.iter().flat_map(|frame| &frame.neighbours).all(|n| n.airframe_probability.is_none()));

    let named = stage.read("flight/airframe.toml");
    let name = named.lines().find(|line| line.starts_with("name")).unwrap();
    let other = stage.read("flight/airframe-2.toml");
    let own = other.lines().find(|line| line.starts_with("name")).unwrap();
    stage.file("same.toml", other.replace(own, name));
    let refused =
        stage.run("locate flight --airframe flight/airframe.toml --airframe same.toml --out no.jsonl");
    assert_eq!(refused.code, 2);
    assert!(
        refused.err.contains("same.toml") && refused.err.contains("give each a name of its own"),
        "{}",
        refused.err
    );
}
