//! What the commands do when all is well.

use photinus_io::dataset::Dataset;
use photinus_io::image::{GreyImage, read_image, write_png};
use photinus_io::results::{FrameRecord, read_results};

use crate::stage::{OCAM, SIZE, Stage, frame, video};

const LOCATE: &str = "locate frame.png --camera camera.toml --airframe hexa.toml";

fn records(stage: &Stage, name: &str) -> Vec<FrameRecord> {
    read_results(stage.path(name)).unwrap().map(Result::unwrap).collect()
}

#[test]
fn every_command_explains_itself_with_examples() {
    let stage = Stage::new("help");
    for words in [
        "--help",
        "locate --help",
        "detect --help",
        "info --help",
        "convert --help",
        "simulate --help",
        "codes design --help",
    ] {
        let done = stage.run(words);
        assert_eq!(done.code, 0);
        let (_, examples) = done.out.split_once("Examples:\n").unwrap();
        assert!(examples.contains("  photinus "), "{words}");
    }
    assert!(stage.run("--version").out.starts_with("photinus 0."));
    assert_eq!(stage.run("").code, 2);
    assert_eq!(stage.run("frobnicate").code, 2);
}

#[test]
fn detect_finds_both_markers_and_draws_them() {
    let stage = Stage::new("detect");
    let done = stage.run("detect frame.png --overlay seen");
    assert_eq!((done.code, done.out.lines().count()), (0, 2), "a line per spot: {}", done.out);
    assert!(done.err.contains("spots     2\n") && done.err.contains("rejected  none\n"));
    assert!(read_image(stage.path("seen/overlay-frame.png")).unwrap().image.width() > 1000);
    let quiet = stage.run("detect frame.png -q --out s.jsonl");
    assert_eq!((quiet.out.as_str(), quiet.err.as_str()), ("", ""), "silence means success");
    let record = &records(&stage, "s.jsonl")[0];
    assert!((record.spots[0].u_px - 40.3).abs() < 0.2 && record.spots[0].peak == 220);
}

#[test]
fn every_kind_of_input_gives_the_same_neighbour() {
    let stage = Stage::new("inputs");
    let raw: Vec<u8> = [frame().pixels(), frame().pixels()].concat();
    stage.file("two.raw", raw);
    stage.file("two.y4m", video(2));
    stage.run("detect frame.png -q --out spots.jsonl");
    let known = "--camera camera.toml --airframe hexa.toml --no-time -q --out r.jsonl --force";
    let mut seen = Vec::new();
    for words in [
        format!("locate frame.png {known}"),
        format!("locate two.y4m {known}"),
        format!("locate two.raw --raw 96x64@20 {known}"),
        format!("locate two.raw --raw 96x64 --frames 1 {known}"),
    ] {
        assert_eq!(stage.run(&words).code, 0, "{words}");
        seen.push(records(&stage, "r.jsonl"));
    }
    assert_eq!(stage.run_with(&format!("locate - {known}"), &video(2)).code, 0);
    seen.push(records(&stage, "r.jsonl"));
    assert_eq!(seen.iter().map(Vec::len).collect::<Vec<_>>(), [1, 2, 2, 1, 2]);
    let same = |one: &FrameRecord, other: &FrameRecord| one.neighbours == other.neighbours;
    assert!(seen.iter().all(|records| same(&records[0], &seen[0][0])));
    // the second frame knows of the first
    assert!(seen.iter().filter_map(|records| records.get(1)).all(|record| same(record, &seen[1][1])));
    assert_eq!((seen[0][0].time_s, seen[1][1].time_s, seen[2][1].time_s), (None, Some(0.05), Some(0.05)));

    let neighbour = &seen[0][0].neighbours[0];
    assert_eq!((seen[0][0].neighbours.len(), neighbour.spots.as_slice()), (1, &[0, 1][..]));
    let distance = neighbour.distance_m;
    let estimate_m = distance.estimate.unwrap();
    assert!(distance.min < estimate_m && estimate_m < distance.max.unwrap(), "{distance:?}");

    stage.run(&format!("locate --spots spots.jsonl {known}"));
    assert_eq!(
        records(&stage, "r.jsonl")[0].neighbours,
        seen[0][0].neighbours,
        "spots lose nothing on the way"
    );
}

#[test]
fn locate_prints_writes_and_draws() {
    let stage = Stage::new("locate");
    let printed = stage.run(LOCATE);
    assert!(printed.out.starts_with("frame     0  hexa") && printed.out.contains("left"), "{}", printed.out);
    for stage_name in ["reading", "spots", "bearings", "grouping", "posing", "writing"] {
        assert!(printed.err.contains(&format!("\n  {stage_name} ")), "{stage_name}: {}", printed.err);
    }
    let done = stage.run(&format!("{LOCATE} --csv r.csv --out - --overlay seen --gravity 0,1,0"));
    assert_eq!((done.code, done.out.lines().count()), (0, 1));
    assert!(done.out.starts_with("{\"frame\":0,"), "standard output holds nothing but JSON lines");
    assert_eq!(stage.read("r.csv").lines().count(), 2);
    assert!(stage.path("seen/overlay-frame.png").is_file());
    let warned = stage.run(&format!("{LOCATE} --spot-curve paper"));
    assert!(warned.err.contains("warning: paper: the spot curve was measured with a threshold of 200"));
    assert!(!stage.run(&format!("{LOCATE} --spot-curve paper --threshold 200")).err.contains("warning"));
    let table = stage.run(&format!("{LOCATE} -q --csv - --gravity 0,1,0"));
    assert_eq!((table.code, table.out), (0, stage.read("r.csv")));
}

#[test]
fn a_frame_that_holds_more_than_the_budget_says_so() {
    let stage = Stage::new("budget");
    for (budget, incomplete) in [(3, true), (10_000, false)] {
        let done = stage.run(&format!("{LOCATE} --out r.jsonl --force --budget {budget}"));
        assert_eq!(done.code, 0);
        assert_eq!(records(&stage, "r.jsonl")[0].incomplete, incomplete, "budget {budget}");
        assert_eq!(stage.read("r.jsonl").contains("\"incomplete\":true"), incomplete);
        assert_eq!(done.err.contains("held more than the budget: 1;"), incomplete, "{}", done.err);
    }
}

#[test]
fn what_is_believed_of_a_neighbour_shows_in_its_sigma() {
    let stage = Stage::new("priors");
    let neighbour = |options: &str| {
        assert_eq!(
            stage.run(&format!("{LOCATE} -q --out r.jsonl --force --gravity 0,1,0 {options}")).code,
            0
        );
        records(&stage, "r.jsonl")[0].neighbours.remove(0)
    };
    let sigma_m = |options: &str| neighbour(options).distance_m.sigma.unwrap();
    let tilt_sigma_rad = |options: &str| neighbour(options).orientation_covariance_rad2.unwrap()[0][0].sqrt();
    let usual_m = sigma_m("");
    assert!(
        (sigma_m("--tilt-sigma 5 --marker-sigma 0.003 --scale-sigma 0.01") - usual_m).abs() < 1e-12,
        "these are the defaults"
    );
    assert!(sigma_m("--marker-sigma 0.05") > 1.2 * usual_m);
    assert!(sigma_m("--no-brightness") > usual_m);
    assert!(tilt_sigma_rad("--tilt-sigma 0.5") < 0.1 * tilt_sigma_rad("--tilt-sigma 20"));
}

#[test]
fn signals_of_spots_tell_the_yaw() {
    let stage = Stage::new("signals");
    let led = |arm: i32| {
        let (yaw_rad, radius_m) = (f64::from(arm) * std::f64::consts::FRAC_PI_3, 0.4);
        let (sin, cos) = libm::sincos(yaw_rad);
        format!("{} {} 0 0 0 {yaw_rad} {arm}\n", radius_m * cos, radius_m * sin)
    };
    stage.file("six.txt", (0..6).map(led).collect::<String>());
    // Arms that face the camera: the body's left is the image's right.
    for (left, right) in [(0, 1), (2, 3)] {
        let spot = |u_px: f64, signal: u32| {
            format!(r#"{{"u_px":{u_px},"v_px":31,"sigma_px":0.1,"signal":{signal}}}"#)
        };
        stage.file("s.jsonl", format!("{{\"spots\":[{},{}]}}", spot(42.0, left), spot(52.0, right)));
        let known = "--camera camera.toml --airframe six.txt --gravity 0,1,0 -q --out r.jsonl --force";
        assert_eq!(stage.run(&format!("locate --spots s.jsonl {known}")).code, 0);
        let record = &records(&stage, "r.jsonl")[0];
        assert_eq!(record.spots[1].signal, Some(right));
        // The body's x axis in the camera frame, x and z; the arms are to the left of it.
        let [x, y, z, w] = record.neighbours[0].orientation_xyzw.unwrap();
        let forward = [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * z - y * w)];
        let camera_deg = libm::atan2(-forward[0], -forward[1]).to_degrees();
        let middle_deg = 30.0 * f64::from(left + right);
        let off_deg = (camera_deg - middle_deg).rem_euclid(360.0);
        assert!(off_deg.min(360.0 - off_deg) < 30.0, "the camera is at {camera_deg}, not {middle_deg}");
    }
}

#[test]
fn a_video_becomes_a_dataset_that_knows_its_camera_and_becomes_the_video_again() {
    let stage = Stage::new("dataset");
    stage.file("two.y4m", video(2));
    let words = "convert two.y4m rec --camera camera.toml --airframe hexa.toml --exposure-us 1000";
    let done = stage.run(words);
    assert_eq!((done.code, done.err.as_str()), (0, ""));
    let dataset = Dataset::read(stage.path("rec")).unwrap();
    assert!((dataset.info().rate_hz - 20.0).abs() < 1e-9);
    assert!(stage.run("info rec").out.contains("airframe       airframe.toml: hexa, 6 markers"));
    assert_eq!(stage.run("locate rec -q --out r.jsonl").code, 0);
    assert_eq!(records(&stage, "r.jsonl")[1].neighbours.len(), 1);
    assert_eq!(stage.run("convert rec back.y4m").code, 0);
    let frames = |name: &str| {
        let bytes = std::fs::read(stage.path(name)).unwrap();
        let header = bytes.iter().position(|&byte| byte == b'\n').unwrap();
        bytes[header..].to_vec()
    };
    assert!(frames("back.y4m") == frames("two.y4m"));
    assert!(stage.run("info back.y4m").out.contains("rate    20 frames per second"));
    assert_eq!(stage.run(words).code, 2, "a dataset is not replaced");
    std::fs::remove_file(stage.path("rec/images/000000.png")).unwrap();
    let done = stage.run("locate rec");
    assert!(done.code == 1 && done.err.contains("frame 0: ") && done.err.contains("line 2 of frames.csv"));
}

#[test]
fn a_copy_of_a_dataset_keeps_all_that_it_is_not_told_otherwise() {
    let stage = Stage::new("copy");
    std::fs::create_dir_all(stage.path("rec/images")).unwrap();
    let mut mask = vec![255; SIZE.0 * SIZE.1];
    mask[0] = 0;
    write_png(stage.path("rec/own.png"), &GreyImage::new(mask, SIZE.0, SIZE.1).unwrap().view()).unwrap();
    for name in ["a", "b", "c"] {
        write_png(stage.path(&format!("rec/images/{name}.png")), &frame().view()).unwrap();
    }
    stage.file(
        "rec/frames.csv",
        "frame,time_s,image,gx,gy,gz\n3,0.1,images/a.png,0,1,0\n\
        5,0.3,images/b.png,,,\n9,0.35,images/c.png,,,\n",
    );
    stage.file(
        "rec/spots.toml",
        "exposure_us = 2000\nupper = { offset_px = 1, scale_px_m2 = 30, shift_m = 0 }\n",
    );
    stage.file(
        "rec/dataset.toml",
        "camera = \"../camera.toml\"\nairframe = \"../hexa.toml\"\nexposure_us = 1000\n\
        rate_hz = 20\nspot_curve = \"spots.toml\"\nmask = \"own.png\"\ncodes = \"book.txt\"\nvehicles = \"who.toml\"\n",
    );
    stage.file("rec/book.txt", "0,1,1,0\n1,0,1,0\n");
    stage.file(
        "rec/who.toml",
        "[[vehicle]]\nid = 7\nairframe = \"../hexa.toml\"\nwords = [1]\nbit_rate_hz = 60.0\n",
    );
    stage.file("rec/imu.csv", "time_s,wx_rad_s,wy_rad_s,wz_rad_s\n0,0.1,0.2,0.3\n");
    stage.file("rec/truth.jsonl", "{\"frame\":5,\"time_s\":0.3,\"neighbours\":[]}\n");
    stage.file("rec/images/b.png", "broken");

    let done = stage.run("convert rec copy --exposure-us 2000");
    assert!(done.code == 1 && done.err.contains("frame 5: "), "{}", done.err);
    stage.file("rec/truth.jsonl", "{\"frame\":9,\"time_s\":0.35,\"neighbours\":[]}\n");
    assert_eq!(stage.run("convert rec again").code, 1);
    let [first, second] = ["copy", "again"].map(|name| Dataset::read(stage.path(name)).unwrap());
    assert_eq!(
        (first.info().exposure_us, second.info().exposure_us, second.info().rate_hz),
        (2000.0, 1000.0, 20.0)
    );
    assert_eq!((first.truth().unwrap(), second.truth().unwrap().unwrap()[0].frame), (None, 9));
    let rows: Vec<_> =
        second.frames().iter().map(|row| (row.frame, row.time_s, row.gravity.is_some())).collect();
    assert_eq!(rows, [(3, 0.1, true), (9, 0.35, false)]);
    let same = |one: &str, other: &str| {
        std::fs::read(stage.path(one)).unwrap() == std::fs::read(stage.path(other)).unwrap()
    };
    assert_eq!((second.codes().map(|codes| codes.words().len()), second.vehicles()[0].id), (Some(2), 7));
    assert!(same("rec/imu.csv", "again/imu.csv"));
    assert!(same("rec/own.png", "again/mask.png") && same("rec/spots.toml", "again/spot_curve.toml"));

    let warning = "the spot curve was measured with an exposure of 2000 us, the frames have 1000 us";
    assert!(stage.run("locate again").err.contains(warning));
    assert!(!stage.run("locate copy").err.contains("warning"));
}

#[test]
fn cameras_and_airframes_go_both_ways() {
    let stage = Stage::new("convert");
    stage.file("ocam.txt", OCAM);
    let done = stage.run("convert ocam.txt ocam.toml");
    assert!(done.code == 0 && done.err.contains("inverse polynomial is not kept"), "{}", done.err);
    let done = stage.run("convert ocam.toml back.txt");
    assert!(done.err.contains("back.txt: the inverse polynomial is a new one of degree"), "{}", done.err);
    let field = |name: &str| {
        let out = stage.run(&format!("info {name}")).out;
        out.lines()
            .find(|line| line.contains("field of view"))
            .unwrap()
            .split_once("horizontal")
            .unwrap()
            .1
            .to_owned()
    };
    assert_eq!(field("ocam.txt"), field("back.txt"));
    let done = stage.run("convert camera.toml x.txt");
    assert!(
        done.code == 0 && done.err.contains("x.txt: the model is another one: bearings differ by 0.0"),
        "{}",
        done.err
    );
    assert_eq!(field("camera.toml"), field("x.txt"));

    let done = stage.run("convert hexa.toml six.txt");
    assert!(
        done.err.contains("the name `hexa` is not kept") && done.err.contains("6 of 6 LEDs have no signal")
    );
    assert_eq!(stage.run("convert six.txt six.toml").code, 0);
    assert!(stage.run("info six.toml").out.contains("ring     6 markers, radius 0.4000 m"));
    assert!(
        stage
            .run("convert hexa.toml x.csv")
            .err
            .contains("cannot become CSV; choose --to toml or --to layout")
    );
}

#[test]
fn results_become_a_table() {
    let stage = Stage::new("table");
    stage.run(&format!("{LOCATE} --out r.jsonl --csv direct.csv"));
    let done = stage.run("convert r.jsonl r.csv");
    assert!(done.code == 0 && done.err.contains("2 spots"), "{}", done.err);
    assert_eq!(stage.read("r.csv"), stage.read("direct.csv"));
}

#[test]
fn info_tells_what_a_camera_and_an_airframe_can_do() {
    let stage = Stage::new("info");
    let out = stage.run("info camera.toml hexa.toml frame.png").out;
    for part in [
        "camera.toml: a camera\n",
        "  field of view   horizontal 91.7°, vertical 61.1°",
        "  resolution      16.667 mrad (0.955°) per px at the centre",
        "hexa.toml: an airframe\n",
        "  markers seen from  front  45°  left",
        "frame.png: an image\n",
        "  size         96 x 64 px\n",
    ] {
        assert!(out.contains(part), "lacks {part}");
    }
}
