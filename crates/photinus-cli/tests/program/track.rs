//! `locate` of frames with times: who is followed, where it is going, and who it is.

use nalgebra::Vector3;
use photinus_io::dataset::Dataset;
use photinus_io::results::{FrameRecord, NeighbourRecord, TrackRecord, read_results};

use crate::stage::Stage;

/// A quadrotor that crosses the view to the right in three seconds, faster in the middle.
fn scene() -> String {
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
    format!(
        "name = \"passing\"\nseed = 5\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 20.0\nduration_s = 3.0\n\
         exposure_us = 1000.0\n[observer]\nmotion = {{ hover = {{ position_m = [0.0, 0.0, 5.0] }} }}\n\
         [[camera]]\nname = \"front\"\nfile = \"{scenes}/cameras/bluefox-dsl215.toml\"\n\
         [[target]]\nid = 1\nairframe = \"{scenes}/airframes/quadrotor-0.245.toml\"\n\
         motion = {{ line = {{ from_m = [4.0, 1.5, 5.0], to_m = [4.0, -1.5, 5.0], duration_s = 3.0 }} }}\n"
    )
}

fn records(stage: &Stage, file: &str) -> Vec<FrameRecord> {
    read_results(stage.path(file)).unwrap().collect::<Result<_, _>>().unwrap()
}

#[test]
fn a_neighbour_that_passes_by_is_one_track_that_knows_its_velocity() {
    let stage = Stage::new("track");
    stage.file("scene.toml", scene());
    assert_eq!(stage.run("simulate scene.toml --out flight -q").code, 0);
    assert_eq!(stage.run("locate flight -q --out r.jsonl --csv t.csv").code, 0);
    let frames = records(&stage, "r.jsonl");
    assert_eq!(frames.len(), 60);
    let truth = Dataset::read(stage.path("flight")).unwrap().truth().unwrap().unwrap();
    let place = |frame: usize| Vector3::from(truth[frame].neighbours[0].position_m);
    let id = frames[20].tracks[0].track;
    let mut squares = 0.0;
    for (number, frame) in frames.iter().enumerate().take(59).skip(20) {
        let [track] = frame.tracks.as_slice() else { panic!("{:?}: {:?}", frame.frame, frame.tracks) };
        assert_eq!((track.track, track.predicted), (id, false), "{:?}", frame.frame);
        assert!(track.probability > 0.9 && !track.spots.is_empty());
        assert!(frame.neighbours.iter().all(|neighbour| neighbour.track == Some(id)));
        let there_m_s = (place(number + 1) - place(number - 1)) * 10.0;
        let off = Vector3::from(track.velocity_m_s) - there_m_s;
        squares += off.norm_squared();
        for (axis, off) in off.iter().enumerate() {
            let sigma = track.velocity_covariance_m2_s2[axis][axis].sqrt();
            assert!(off.abs() < 4.0 * sigma, "{:?}, axis {axis}: {off} with {sigma}", frame.frame);
        }
    }
    assert!((squares / 39.0).sqrt() < 0.4, "rms {} m/s", (squares / 39.0).sqrt());
    assert!(stage.read("t.csv").lines().nth(30).unwrap().contains(&format!(",{id},")));

    // With --no-time a frame tells of itself alone, and says the same of it.
    assert_eq!(stage.run("locate flight --no-time -q --out alone.jsonl").code, 0);
    for (alone, followed) in records(&stage, "alone.jsonl").iter().zip(&frames) {
        assert!(alone.tracks.is_empty() && alone.neighbours.iter().all(|n| n.track.is_none()));
        assert_eq!(alone.neighbours.len(), followed.neighbours.len());
    }

    // A run that goes on where another ended follows the same.
    let all = stage.read("r.jsonl");
    let half: String = all.lines().take(30).map(|line| format!("{line}\n")).collect();
    stage.file("half.jsonl", half);
    assert_eq!(stage.run("locate flight --track -q --out half.jsonl --resume").code, 0);
    assert_eq!(stage.read("half.jsonl"), all);
}

/// Who is behind another's body shows no spots, and takes none of its. One flight says nothing of that: where what hides an LED was learnt anew in every frame,
/// half of them lost the true pose, and the scene's own seed did not.
#[test]
fn a_vehicle_behind_another_is_followed_and_takes_none_of_its_spots() {
    let stage = Stage::new("track-behind");
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
    let scene = std::fs::read_to_string(format!("{scenes}/blinking/behind-another.toml")).unwrap();
    for seed in [1, 21, 36, 46] {
        let scene = scene.replace("\"../", &format!("\"{scenes}/"));
        stage.file("scene.toml", scene.replace("\nseed = 1\n", &format!("\nseed = {seed}\n")));
        assert_eq!(stage.run("simulate scene.toml --frames 460 --out flight -q --force").code, 0);
        assert_eq!(stage.run("locate flight -q --out r.jsonl --force").code, 0);
        assert_eq!(stage.run("evaluate flight r.jsonl --json scores.json -q --force").code, 0);
        let scores: serde_json::Value = serde_json::from_str(&stage.read("scores.json")).unwrap();
        let followed = &scores["followed"];
        assert_eq!(followed["false"].as_u64(), Some(0), "seed {seed}: {followed:#}");
        assert_eq!(followed["hidden_recall"].as_f64(), Some(1.0), "seed {seed}: {followed:#}");
        assert_eq!(followed["recall"].as_f64(), Some(1.0), "seed {seed}: {followed:#}");
        let off_m = followed["seen_error_m"]["rms"].as_f64();
        assert!(off_m.is_some_and(|off_m| off_m < 0.3), "seed {seed}: {followed:#}");
    }
}

#[test]
fn frames_without_times_are_located_one_by_one() {
    let stage = Stage::new("track-untimed");
    assert_eq!(
        stage.run("locate frame.png --camera camera.toml --airframe hexa.toml -q --out r.jsonl").code,
        0
    );
    assert_eq!(
        stage
            .run("locate frame.png --camera camera.toml --airframe hexa.toml --no-time -q --out alone.jsonl")
            .code,
        0
    );
    assert_eq!(stage.read("r.jsonl"), stage.read("alone.jsonl"));
    assert!(records(&stage, "r.jsonl").iter().all(|frame| frame.tracks.is_empty()));
}

/// Two hexarotors beside each other for two seconds, each with a word, and a camera that pans.
fn blinking(words: [usize; 2], observer: &str) -> String {
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
    let target = |id: usize, y_m: f64, word: usize| {
        format!(
            "[[target]]\nid = {id}\nairframe = \"{scenes}/airframes/hexarotor-0.4.toml\"\n\
             motion = {{ line = {{ from_m = [5.0, {y_m}, 5.0], to_m = [5.5, {y_m}, 5.2], duration_s = 2.0 }} }}\n\
             blink = {{ codes = \"{scenes}/codes/l12-d3-r3.txt\", first_word = {word}, rate_hz = 60.0, shift_s = 0.00{id} }}\n"
        )
    };
    format!(
        "name = \"blinking\"\nseed = 3\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 60.0\nduration_s = 2.0\n\
         exposure_us = 1000.0\n{observer}[[camera]]\nname = \"front\"\nfile = \"{scenes}/cameras/bluefox-dsl215.toml\"\n{}{}",
        target(4, 1.2, words[0]),
        target(9, -1.2, words[1])
    )
}

const STILL: &str = "[observer]\nmotion = { hover = { position_m = [0.0, 0.0, 5.0] } }\n";

/// For each frame after the first half second: of each track the true id, by its side, and the id that is told.
fn told(stage: &Stage, file: &str) -> Vec<(u32, Option<u32>)> {
    let later = records(stage, file).into_iter().filter(|frame| frame.time_s > Some(0.5));
    // The camera's x is to the right: -y of the world.
    let own = |track: &TrackRecord| (if track.position_m[0] < 0.0 { 4 } else { 9 }, track.id);
    later.flat_map(|frame| frame.tracks.iter().map(own).collect::<Vec<_>>()).collect()
}

#[test]
fn vehicles_that_blink_words_are_named() {
    let stage = Stage::new("named");
    stage.file("scene.toml", blinking([2, 7], STILL));
    assert_eq!(stage.run("simulate scene.toml --out flight -q").code, 0);
    let done = stage.run("locate flight --out r.jsonl");
    assert_eq!((done.code, done.err.contains("two tracks")), (0, false), "{}", done.err);
    let told = told(&stage, "r.jsonl");
    assert!(told.len() > 170, "{}", told.len());
    assert!(told.iter().all(|(true_id, id)| id.is_none_or(|id| id == *true_id)), "{told:?}");
    let named = told.iter().filter(|(_, id)| id.is_some()).count();
    assert!(named as f64 > 0.97 * told.len() as f64, "{named} of {}", told.len());
    let frames = records(&stage, "r.jsonl");
    let neighbours: Vec<_> = frames[60..].iter().flat_map(|frame| &frame.neighbours).collect();
    let whole =
        |n: &&&NeighbourRecord| n.id.is_some() && n.id_probability > Some(0.99) && n.velocity_m_s.is_some();
    assert!(neighbours.iter().filter(whole).count() as f64 > 0.9 * neighbours.len() as f64);
    let scores = stage.run("evaluate flight r.jsonl");
    assert_eq!(scores.code, 0, "{}", scores.err);
}

#[test]
fn an_id_that_two_carry_is_nobodys_and_the_user_is_told() {
    let stage = Stage::new("twice");
    stage.file("scene.toml", blinking([5, 5], STILL));
    assert_eq!(stage.run("simulate scene.toml --out flight -q").code, 0);
    // Both blink word 5, and only one of them is listed.
    let vehicles = stage.read("flight/vehicles.toml");
    let second = vehicles.rfind("[[vehicle]]").unwrap();
    stage.file("flight/vehicles.toml", &vehicles[..second]);
    let done = stage.run("locate flight --out r.jsonl");
    assert!(done.code == 0 && done.err.contains("two tracks blink the words of vehicle 4"), "{}", done.err);
    let told = told(&stage, "r.jsonl");
    assert!(told.len() > 170 && told.iter().all(|(_, id)| id.is_none()), "{told:?}");
    let last = records(&stage, "r.jsonl").pop().unwrap();
    assert!(last.tracks.iter().all(|track| track.ids.iter().all(|id| id.contested && id.probability < 0.9)));
}

#[test]
fn a_wrong_book_names_nobody() {
    let stage = Stage::new("wrong-book");
    stage.file("scene.toml", blinking([2, 7], STILL));
    assert_eq!(stage.run("simulate scene.toml --out flight -q").code, 0);
    assert_eq!(stage.run("codes preset l14-d3-r3 --out flight/codes.txt --force").code, 0);
    let done = stage.run("locate flight --out r.jsonl -q");
    assert_eq!(done.code, 0, "{}", done.err);
    let told = told(&stage, "r.jsonl");
    assert!(told.len() > 170 && told.iter().all(|(_, id)| id.is_none()), "{told:?}");
}

/// Three quadrotors of whose arms each blinks a word of its own: each is one track with its name after three code lengths, and nobody else is there.
#[test]
fn vehicles_whose_arms_blink_different_words_are_named() {
    let stage = Stage::new("several");
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
    let target = |id: usize, x_m: f64, y_m: f64, heading_deg: f64| {
        let words: Vec<usize> = (4 * id - 4..4 * id).collect();
        format!(
            "[[target]]\nid = {id}\nairframe = \"{scenes}/airframes/quadrotor-pairs-0.3.toml\"\nheading_deg = {heading_deg}\n\
             motion = {{ line = {{ from_m = [{x_m}, {y_m}, 5.0], to_m = [{x_m}, {}, 5.4], duration_s = 2.0 }} }}\n\
             blink = {{ codes = \"{scenes}/codes/l18-d3-r3.txt\", words = {words:?}, rate_hz = 60.0, shift_s = 0.00{id} }}\n",
            y_m - 0.6
        )
    };
    let scene = format!(
        "name = \"several\"\nseed = 7\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 60.0\nduration_s = 2.0\n\
         exposure_us = 1000.0\n{STILL}[[camera]]\nname = \"front\"\nfile = \"{scenes}/cameras/bluefox-dsl215.toml\"\n{}{}{}",
        target(1, 4.0, 2.2, 20.0),
        target(2, 5.0, 0.3, 110.0),
        target(3, 4.5, -1.8, 250.0)
    );
    stage.file("scene.toml", scene);
    assert_eq!(stage.run("simulate scene.toml --out flight -q").code, 0);
    let done = stage.run("locate flight --out r.jsonl");
    assert_eq!((done.code, done.err.contains("not followed")), (0, false), "{}", done.err);
    let truth = Dataset::read(stage.path("flight")).unwrap().truth().unwrap().unwrap();
    let (mut named, mut tracks) = (0, std::collections::BTreeSet::new());
    for (frame, truth) in records(&stage, "r.jsonl").iter().zip(&truth).skip(54) {
        tracks.extend(frame.tracks.iter().map(|track| track.track));
        for track in &frame.tracks {
            let Some(id) = track.id else { continue };
            let there = truth.neighbours.iter().find(|there| there.id == id).unwrap();
            let off = Vector3::from(track.position_m) - Vector3::from(there.position_m);
            assert!(off.norm() < 0.1 * there.distance_m, "{:?}: vehicle {id} is {off:?} m off", frame.frame);
            named += 1;
        }
    }
    let frames = truth.len() - 54;
    assert!(named as f64 > 0.99 * 3.0 * frames as f64, "{named} of {}", 3 * frames);
    assert_eq!(tracks.len(), 3, "{tracks:?}");
}
