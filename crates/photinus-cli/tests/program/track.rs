//! `locate --track`: who is followed, and that it says where it is going.

use nalgebra::Vector3;
use photinus_io::dataset::Dataset;
use photinus_io::results::{FrameRecord, read_results};

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
    assert_eq!(stage.run("locate flight --track -q --out r.jsonl --csv t.csv").code, 0);
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

    // Without --track a frame tells of itself alone, and says the same of it.
    assert_eq!(stage.run("locate flight -q --out alone.jsonl").code, 0);
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

#[test]
fn frames_without_times_cannot_be_followed() {
    let stage = Stage::new("track-untimed");
    let done = stage.run("locate frame.png --camera camera.toml --airframe hexa.toml --track --out r.jsonl");
    assert_eq!(done.code, 2, "{}", done.err);
    assert!(done.err.contains("no time") && done.err.contains("--track"), "{}", done.err);
}
