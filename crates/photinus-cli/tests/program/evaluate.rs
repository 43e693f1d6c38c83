//! `photinus evaluate`: what it prints, writes and refuses.

use nalgebra::{Isometry3, Rotation3, UnitQuaternion, Vector3};
use photinus::airframe::Airframe;
use photinus::camera::{Bearing, Camera};
use photinus_io::airframe::read_airframe;
use photinus_io::dataset::{TruthFrame, TruthLed, TruthNeighbour};
use photinus_io::read_camera;
use photinus_io::results::{Distance, FrameRecord, NeighbourRecord, ResultsWriter};

use crate::stage::Stage;

const FRAMES: u64 = 20;

/// A neighbour that comes nearer, frame by frame at 20 Hz, straight ahead.
fn distance_m(frame: u64) -> f64 {
    8.0 - 0.25 * frame as f64
}

fn truth(frame: u64) -> TruthFrame {
    let leds = [40.0, 50.0].map(|u_px| TruthLed { u_px, v_px: 30.0, led: None });
    let neighbour = TruthNeighbour {
        id: 1,
        position_m: [0.0, 0.0, distance_m(frame)],
        orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
        distance_m: distance_m(frame),
        velocity_m_s: None,
        leds: leds.to_vec(),
    };
    TruthFrame { frame, time_s: frame as f64 / 20.0, neighbours: vec![neighbour], ..TruthFrame::default() }
}

/// Half a metre too far, and out of the bounds in frame 7.
fn result(frame: u64) -> FrameRecord {
    let estimate = distance_m(frame) + 0.5;
    let near_m = if frame == 7 { 0.25 } else { -1.0 };
    let neighbour = NeighbourRecord {
        track: None,
        id: None,
        id_probability: None,
        velocity_m_s: None,
        velocity_covariance_m2_s2: None,
        airframe: "hexa".to_owned(),
        spots: vec![],
        bearing: [0.0, 0.0, 1.0],
        distance_m: Distance {
            estimate: Some(estimate),
            sigma: Some(0.5),
            min: distance_m(frame) + near_m,
            max: Some(distance_m(frame) + 1.0),
            perpendicular: Some(distance_m(frame) + 1.0),
            inline: Some(distance_m(frame) - 1.0),
        },
        position_m: Some([0.0, 0.0, estimate]),
        position_covariance_m2: Some([[0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 0.25]]),
        position_body_m: None,
        position_body_covariance_m2: None,
        orientation_xyzw: None,
        orientation_covariance_rad2: None,
        position_orientation_covariance_m_rad: None,
        probability: None,
        misfit: None,
        airframe_probability: None,
        runner_up: None,
        modes: vec![],
    };
    FrameRecord {
        frame: Some(frame),
        camera: None,
        time_s: Some(frame as f64 / 20.0),
        latency_s: Some(0.004),
        source: String::new(),
        incomplete: false,
        spots: vec![],
        rejected: vec![],
        neighbours: vec![neighbour],
        tracks: vec![],
    }
}

fn lines(frames: impl Iterator<Item = FrameRecord>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut writer = ResultsWriter::new(&mut bytes, "results");
    frames.for_each(|frame| writer.write(&frame).unwrap());
    drop(writer);
    bytes
}

/// A dataset with truth in flight/, and results.jsonl of all its frames but the last.
fn stage(test: &str) -> Stage {
    let stage = Stage::new(test);
    std::fs::create_dir_all(stage.path("flight")).unwrap();
    stage.file(
        "flight/dataset.toml",
        "camera = \"camera.toml\"\nairframe = \"hexa.toml\"\nexposure_us = 1000.0\nrate_hz = 20.0\n",
    );
    let row = |frame: u64| format!("{frame},{},images/{frame:06}.png,,,\n", frame as f64 / 20.0);
    let rows: String = (0..FRAMES).map(row).collect();
    stage.file("flight/frames.csv", format!("frame,time_s,image,gx,gy,gz\n{rows}"));
    let truth: Vec<String> = (0..FRAMES).map(|frame| serde_json::to_string(&truth(frame)).unwrap()).collect();
    stage.file("flight/truth.jsonl", truth.join("\n"));
    stage.file("results.jsonl", lines((0..FRAMES - 1).map(result)));
    stage
}

#[test]
fn tables_and_json_say_how_well_it_went() {
    let stage = stage("evaluate");
    let done = stage.run("evaluate flight results.jsonl --json scores.json --bins 5");
    assert_eq!(done.code, 0);
    assert!(done.err.contains("warning: results.jsonl: 1 of 20 frames are not in it and count as missed"));
    assert!(done.out.contains("      all       20     19       1      0      95.0        100.0\n"));
    assert!(
        done.out
            .contains("violated: frame 7, neighbour 1, at 6.250 m, bounds 6.500 to 7.250 m, out by 0.250 m")
    );
    let scores: serde_json::Value = serde_json::from_str(&stage.read("scores.json")).unwrap();
    assert_eq!(scores["neighbours"]["overall"]["recall"], 0.95);
    assert_eq!(scores["distance"]["overall"]["error_m"]["bias"], 0.5);
    assert_eq!(scores["position"]["overall"]["nees"], 1.0);
    assert_eq!(scores["bounds"]["violations"][0]["frame"], 7);
    assert_eq!(scores["bounds"]["overall"]["inside"], 18);
    assert_eq!(scores["latency_s"]["median"], 0.004);
    assert!(done.out.contains("latency  median 4.0 ms, 95 % 4.0 ms, longest 4.0 ms"));
    assert_eq!(scores["paper"]["overall"]["between"], 1.0);
    assert_eq!(scores["spots"]["overall"]["recall"], 0.0);
    assert_eq!(scores["bearing_error_rad"]["bins"][0]["to_m"], 5.0);

    let alone = stage.run("evaluate flight results.jsonl --json - -q --bins 5");
    assert_eq!((alone.out, alone.err), (stage.read("scores.json"), String::new()));
}

/// A hexarotor that spins as it recedes, seen from its side: its LEDs that shine at the camera, as spots to the pixel.
fn spinning(frame: u64, camera: &Camera, airframe: &Airframe) -> (TruthFrame, String) {
    let position_m = Vector3::new(0.4, -0.1, 1.5 + 0.1 * frame as f64);
    let body_up = Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
    let camera_from_body = body_up * Rotation3::from_axis_angle(&Vector3::z_axis(), 0.3 * frame as f64);
    let mut leds = Vec::new();
    for (led, number) in airframe.leds().iter().zip(0..) {
        let at_m = position_m + camera_from_body * led.position_m;
        let faces = (camera_from_body * led.axis.into_inner()).dot(&at_m.normalize()) < -0.3;
        let pixel = camera.pixel(&Bearing::new(at_m).unwrap());
        if let (true, Some(pixel)) = (faces, pixel) {
            leds.push(TruthLed { u_px: pixel.u, v_px: pixel.v, led: Some(number) });
        }
    }
    let spot = |led: &TruthLed| format!("{{\"u_px\":{},\"v_px\":{}}}", led.u_px.round(), led.v_px.round());
    let spots: Vec<String> = leds.iter().map(spot).collect();
    let q = UnitQuaternion::from_rotation_matrix(&camera_from_body);
    let neighbour = TruthNeighbour {
        id: 1,
        position_m: position_m.into(),
        orientation_xyzw: [q.i, q.j, q.k, q.w],
        distance_m: position_m.norm(),
        velocity_m_s: None,
        leds,
    };
    let time_s = frame as f64 / 20.0;
    let truth = TruthFrame { frame, time_s, neighbours: vec![neighbour], ..TruthFrame::default() };
    (truth, format!("{{\"frame\":{frame},\"time_s\":{time_s},\"spots\":[{}]}}", spots.join(",")))
}

#[test]
fn what_locate_says_of_exact_geometry_keeps_its_bounds() {
    let stage = stage("evaluate-locate");
    // As fine as the cameras of the paper, so that markers stay apart.
    let camera = "model = \"equidistant\"\nwidth_px = 752\nheight_px = 480\ncentre_px = [375.5, 239.5]\n\
                  focal_px = [265.0, 265.0]\n";
    stage.file("camera.toml", camera);
    let camera = read_camera(stage.path("camera.toml")).unwrap().camera;
    let airframe = read_airframe(stage.path("hexa.toml")).unwrap().airframe;
    let seen = (0..FRAMES).map(|frame| spinning(frame, &camera, &airframe));
    let (truth, spots): (Vec<String>, Vec<String>) =
        seen.map(|(truth, spots)| (serde_json::to_string(&truth).unwrap(), spots)).unzip();
    stage.file("flight/truth.jsonl", truth.join("\n"));
    stage.file("spots.jsonl", spots.join("\n"));

    let located = stage
        .run("locate --spots spots.jsonl --camera camera.toml --airframe hexa.toml -q --out located.jsonl");
    assert_eq!(located.code, 0);
    let done = stage.run("evaluate flight located.jsonl --json scores.json");
    assert_eq!(done.code, 0);
    let scores: serde_json::Value = serde_json::from_str(&stage.read("scores.json")).unwrap();
    assert_eq!(scores["spots"]["overall"]["recall"], 1.0);
    assert_eq!(scores["neighbours"]["overall"]["recall"], 1.0);
    assert_eq!(scores["neighbours"]["overall"]["precision"], 1.0);
    assert_eq!(scores["bounds"]["overall"]["coverage"], 1.0, "{}", scores["bounds"]["violations"]);
    // The middle of what shows is no farther aside than the airframe's radius, at the nearest distance.
    assert!(scores["bearing_error_rad"]["overall"]["max"].as_f64().unwrap() < 0.4 / 1.5);
    assert!(scores["distance"]["overall"]["relative_error"]["rms"].as_f64().unwrap() < 0.3);
}

#[test]
fn plots_are_png_and_svg() {
    let stage = stage("evaluate-plots");
    assert_eq!(stage.run("evaluate flight results.jsonl --plots figures -q").code, 0);
    for name in ["recall-precision", "distance-error", "bounds", "position-nees", "distance-over-time-1"] {
        let png = std::fs::read(stage.path(&format!("figures/{name}.png"))).unwrap();
        assert!(png.starts_with(b"\x89PNG"), "{name}");
        assert!(stage.read(&format!("figures/{name}.svg")).contains("</svg>"), "{name}");
    }
    let over_time = stage.read("figures/distance-over-time-1.svg");
    for words in ["time (s)", "distance (m)", "bounds", "estimate", "truth", "l_A", "l_B"] {
        assert!(over_time.contains(words), "{words}");
    }
    let before = over_time;
    stage.run("evaluate flight results.jsonl --plots figures -q");
    assert_eq!(before, stage.read("figures/distance-over-time-1.svg"), "the same picture every time");
}

#[test]
fn a_line_that_is_no_result_is_told_and_its_frame_missed() {
    let stage = stage("evaluate-lines");
    let mut bytes = lines((0..FRAMES - 1).map(result));
    bytes.extend(b"{\"frame\":19,\"spots\":[\n");
    stage.file("results.jsonl", bytes);
    let done = stage.run("evaluate flight results.jsonl");
    assert_eq!(done.code, 1);
    assert!(done.err.contains("error: results.jsonl, line 20: "), "{}", done.err);
    assert!(done.err.contains("the line is cut"));
    assert!(done.out.contains("1 missing"), "the rest is scored");
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let stage = stage("evaluate-refused");
    let refuses = |words: &str, parts: &[&str]| {
        let done = stage.run(words);
        assert_eq!((done.code, done.out.as_str()), (2, ""), "{words}");
        for part in parts {
            assert!(done.err.contains(part), "{words}\n{}\nlacks `{part}`", done.err);
        }
    };
    stage.file("empty.jsonl", "");
    std::fs::create_dir(stage.path("images")).unwrap();
    stage.file("longer.jsonl", lines([0, 25].into_iter().map(result)));
    stage.file("twice.jsonl", lines([3, 3].into_iter().map(result)));
    let late = FrameRecord { time_s: Some(9.0), ..result(3) };
    stage.file("late.jsonl", lines([late].into_iter()));

    refuses("evaluate no results.jsonl", &["no: ", "; check the path"]);
    refuses("evaluate images results.jsonl", &["images: the folder holds no dataset.toml"]);
    refuses("evaluate flight no.jsonl", &["no.jsonl: ", "; check the path"]);
    refuses(
        "evaluate flight empty.jsonl",
        &["empty.jsonl: it holds no result; give what `photinus locate --out`"],
    );
    refuses(
        "evaluate flight longer.jsonl",
        &["longer.jsonl, frame 25: ", "lists no such frame; give the results of this dataset"],
    );
    refuses(
        "evaluate flight twice.jsonl",
        &["twice.jsonl, frame 3: the frame stands twice in the results; give"],
    );
    refuses(
        "evaluate flight late.jsonl",
        &["late.jsonl, frame 3: ", "at 9 s, truth at 0.15 s; give the results of"],
    );
    refuses("evaluate flight results.jsonl --bins 5,2", &["give distances in m that grow"]);
    refuses("evaluate flight results.jsonl --json results.jsonl", &["it would be replaced"]);
    refuses("evaluate flight results.jsonl --json flight/truth.jsonl", &["it would be replaced"]);
    refuses("evaluate flight results.jsonl --json no/s.json", &["no/s.json: ", "make its folder first"]);
    refuses(
        "evaluate flight results.jsonl --plots results.jsonl",
        &["results.jsonl: it is there already, and no folder; name another folder"],
    );

    let wrong = stage.read("flight/truth.jsonl").replace("\"distance_m\":7.0", "\"distance_m\":70.0");
    stage.file("flight/truth.jsonl", wrong);
    refuses("evaluate flight results.jsonl", &["truth.jsonl, frame 4: neighbour 1 is at 70 m"]);
    std::fs::remove_file(stage.path("flight/truth.jsonl")).unwrap();
    refuses("evaluate flight results.jsonl", &["flight: the folder holds no truth.jsonl; only results of"]);
}

#[test]
fn a_truth_file_alone_gives_the_same_scores() {
    let stage = stage("evaluate-files");
    std::fs::copy(stage.path("flight/truth.jsonl"), stage.path("alone.jsonl")).unwrap();
    let of_dataset = stage.run("evaluate flight results.jsonl");
    let of_files = stage.run("evaluate alone.jsonl results.jsonl");
    assert_eq!((of_files.code, &of_files.out), (0, &of_dataset.out));
    let refused = stage.run("evaluate alone.jsonl results.jsonl --json alone.jsonl --force");
    assert!(refused.code == 2 && refused.err.contains("it would be replaced"), "{}", refused.err);
    let swapped = stage.run("evaluate results.jsonl alone.jsonl");
    assert_eq!(swapped.code, 2, "{}", swapped.err);
}

/// Where an observer and its target were, by the clock of their logs.
fn flown(time_s: f64) -> [Isometry3<f64>; 2] {
    let pose = |t: f64, far_m: f64| {
        let place = Vector3::new(
            far_m + libm::sin(0.7 * t),
            1.5 * libm::cos(0.4 * t),
            5.0 + 0.8 * libm::sin(0.31 * t),
        );
        let turn = UnitQuaternion::from_euler_angles(
            0.2 * libm::sin(1.3 * t),
            0.2 * libm::cos(0.9 * t),
            0.8 * libm::sin(0.5 * t),
        );
        Isometry3::from_parts(place.into(), turn)
    };
    [pose(time_s, 0.0), pose(time_s + 11.0, 7.0)]
}

/// What the clock of the logs is ahead of that of the frames.
const LATE_S: f64 = 0.4;
/// Where the camera sits on the observer.
const CAMERA_M: Vector3<f64> = Vector3::new(0.1, 0.0, 0.05);

/// A flight of a minute as observer.csv and target.csv, with results.jsonl, and the text of the target's log.
pub(crate) fn two_logs(stage: &Stage) -> String {
    let camera = Isometry3::from_parts(CAMERA_M.into(), UnitQuaternion::from_euler_angles(-1.6, 0.0, -1.5));
    let mut logs = ["time_s,x_m,y_m,z_m,qx,qy,qz,qw\n"; 2].map(str::to_owned);
    for step in 0..3500 {
        let time_s = f64::from(step) / 50.0;
        for (log, pose) in logs.iter_mut().zip(flown(time_s)) {
            let (p, q) = (pose.translation, pose.rotation);
            *log += &format!("{time_s},{},{},{},{},{},{},{}\n", p.x, p.y, p.z, q.i, q.j, q.k, q.w);
        }
    }
    let [observer, target] = &logs;
    stage.file("observer.csv", observer);
    stage.file("target.csv", target);
    let mut records = Vec::new();
    for frame in 0..1200 {
        let time_s = f64::from(frame) / 20.0;
        let [observer, target] = flown(time_s + LATE_S);
        let seen = (observer * camera).inv_mul(&target).translation.vector;
        let mut record = result(u64::from(frame as u32));
        record.time_s = Some(time_s);
        // Half a centimetre of what looks like noise.
        let wobble = 0.005 * libm::sin(37.0 * time_s);
        let neighbour = &mut record.neighbours[0];
        neighbour.position_m = Some((seen * (1.0 + wobble / seen.norm())).into());
        neighbour.bearing = seen.normalize().into();
        neighbour.distance_m.estimate = Some(seen.norm() + wobble);
        (neighbour.distance_m.min, neighbour.distance_m.max) = (seen.norm() - 1.0, Some(seen.norm() + 1.0));
        records.push(record);
    }
    stage.file("results.jsonl", lines(records.into_iter()));
    target.clone()
}

#[test]
fn two_logs_are_a_truth() {
    let stage = Stage::new("evaluate-logs");
    let target = two_logs(&stage);
    let done = stage.run("evaluate observer.csv results.jsonl --target target.csv --json s.json");
    assert!(done.code == 0 && done.out.contains("clock offset s"), "{}{}", done.out, done.err);
    let scores: serde_json::Value = serde_json::from_str(&stage.read("s.json")).unwrap();
    let number = |place: &str| scores.pointer(place).and_then(serde_json::Value::as_f64).unwrap();
    assert!((number("/alignment/clock_offset_s") - LATE_S).abs() < 0.005, "{}", done.out);
    assert!((number("/alignment/camera_m/0") - CAMERA_M.x).abs() < 0.02, "{}", done.out);
    assert!(number("/neighbours/overall/recall") > 0.999 && number("/distance/overall/error_m/rms") < 0.02);
    // The same logs, the target's by a clock that is 1.3 s ahead.
    let ahead = target.lines().skip(1).map(|row| {
        let (time_s, rest) = row.split_once(',').unwrap();
        format!("{},{rest}\n", time_s.parse::<f64>().unwrap() + 1.3)
    });
    stage.file("ahead.csv", format!("{}\n{}", target.lines().next().unwrap(), ahead.collect::<String>()));
    let done = stage.run(
        "evaluate observer.csv results.jsonl --target ahead.csv --target-clock-offset 0 --json own.json",
    );
    assert!(done.code == 0 && done.out.contains("target's clock offset s"), "{}{}", done.out, done.err);
    let scores: serde_json::Value = serde_json::from_str(&stage.read("own.json")).unwrap();
    let number = |place: &str| scores.pointer(place).and_then(serde_json::Value::as_f64).unwrap();
    assert!((number("/alignment/clock_offset_s") - LATE_S).abs() < 0.01, "{}", done.out);
    assert!((number("/alignment/target_clock_offset_s") - 1.3).abs() < 0.01, "{}", done.out);
    assert!(number("/neighbours/overall/recall") > 0.999 && number("/distance/overall/error_m/rms") < 0.02);
    stage.refuses(
        "evaluate observer.csv results.jsonl --target target.csv --clock-offset 500",
        &["the logs have 0.000 to 69.980 s in common, the frames 0.000 to 59.950 s; give the logs of this flight"],
    );
}
