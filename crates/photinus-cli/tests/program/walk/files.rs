//! The files that examples name: small ones, made once by the program itself, then copied to each example.

use std::collections::BTreeSet;
use std::path::Path;

use photinus_io::image::{GreyImage, read_image, write_png};
use photinus_io::video::Y4mWriter;

use crate::stage::Stage;
use crate::{
    calibrate, calibrate_airframe, calibrate_airframe_light, calibrate_mounting, calibrate_spot_size,
    evaluate, evaluate_recordings,
};

/// The example flight of the repository, 4 frames with truth.
fn flight() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/three-hexarotors"))
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let (path, name) = entry.map(|entry| (entry.path(), entry.file_name())).unwrap();
        match path.is_dir() {
            true => copy(&path, &to.join(name)),
            false => drop(std::fs::copy(&path, to.join(name)).unwrap()),
        }
    }
}

/// Runs the program, which must come through.
fn make(stage: &Stage, words: &str) {
    let done = stage.run(words);
    assert_eq!(done.code, 0, "{words}: {}", done.err);
}

/// What examples are given copies of.
pub(super) struct Store {
    /// What most examples need.
    base: Stage,
    /// A robot alone before the camera, in alone/; an LED that recedes, in led/.
    recorded: Stage,
}

impl Store {
    /// Makes all of it.
    pub(super) fn new() -> Self {
        let recorded = Stage::new("walk-recorded");
        recorded.file("alone.toml", calibrate_airframe_light::scene(20.0));
        make(&recorded, "simulate alone.toml --out alone -q");
        scenes(&recorded);
        make(&recorded, "simulate scenes/receding-led.toml --out led -q");
        Self { base: base(), recorded }
    }

    /// Gives `stage` every file that `example` reads, but none of those `written` by it.
    pub(super) fn provide(&self, stage: &Stage, example: &str, written: &BTreeSet<String>) {
        std::fs::remove_file(stage.path("frame.png")).unwrap();
        copy(&self.base.path(""), &stage.path(""));
        self.recordings(stage, example);
        measurements(stage, example);
        for name in written.iter().map(|name| stage.path(name)) {
            drop(if name.is_dir() { std::fs::remove_dir_all(name) } else { std::fs::remove_file(name) });
        }
    }

    /// Recordings whose content depends on the example.
    fn recordings(&self, stage: &Stage, example: &str) {
        let put = |from: &str, to: &str| {
            drop(std::fs::remove_dir_all(stage.path(to)));
            copy(&self.recorded.path(from), &stage.path(to));
        };
        if example.contains("calibrate spot-size recording") {
            put("led", "recording");
        }
        if example.contains("calibrate airframe-light") {
            ["flight", "morning", "evening"].iter().for_each(|name| put("alone", name));
            std::fs::copy(stage.path("flight/airframe.toml"), stage.path("quad.toml")).unwrap();
        }
        if example.contains("calibrate mask") {
            put("alone", "recording");
        }
        if example.contains("calibrate optics") {
            put("alone", "flight");
            put("alone/images", "photos");
            make(stage, "convert flight/camera.toml calib.txt --force");
            make(stage, "convert flight/camera.toml camera.toml --force");
            make(stage, "convert flight video.y4m --force");
        }
    }
}

/// The scenes of the repository, the long ones shorter.
fn scenes(stage: &Stage) {
    copy(&flight().join("../../scenes"), &stage.path("scenes"));
    for (scene, from, to) in [
        ("outdoor-flight", "\nduration_s = 120.0", "\nduration_s = 0.2"),
        ("receding-led", "rate_hz = 20.0", "rate_hz = 1.0"),
        ("crossing", "\nduration_s = 10.0", "\nduration_s = 0.2"),
    ] {
        let name = format!("scenes/{scene}.toml");
        let text = stage.read(&name);
        assert!(text.contains(from), "{scene}");
        stage.file(&name, text.replace(from, to));
    }
}

fn base() -> Stage {
    let stage = Stage::new("walk-base");
    std::fs::remove_file(stage.path("frame.png")).unwrap();
    for folder in ["recording", "flight", "bad-day", "other-flight", "examples/three-hexarotors"] {
        copy(flight(), &stage.path(folder));
    }
    for folder in ["frames", "photos"] {
        copy(&flight().join("images"), &stage.path(folder));
    }
    scenes(&stage);
    ["airframes", "cameras", "codes"]
        .iter()
        .for_each(|part| copy(&stage.path("scenes").join(part), &stage.path(part)));
    for folder in ["photinus-demo", ".config/fish/completions"] {
        std::fs::create_dir_all(stage.path(folder)).unwrap();
    }
    pictures(&stage);
    stage.file("scene.toml", stage.read("scenes/crossing.toml"));
    stage.file("gravity.csv", "time_s,gx,gy,gz\n0,0,1,0\n10,0,1,0\n");
    stage.file(
        "photinus.toml",
        "pace = \"fast\"\n[[camera]]\nname = \"front\"\nsource = { dataset = \"recording\" }\n[json]\nfile = \"run.jsonl\"\n",
    );
    for made in [
        "convert flight/camera.toml camera.txt",
        "convert flight/camera.toml calib_results.txt",
        "convert flight/camera.toml calib.txt",
        "convert flight/camera.toml recalibrated.txt",
        "convert flight/camera.toml kalibr.yaml --to kalibr",
        "convert flight/camera.toml camera.toml --force",
        "convert flight/airframe.toml airframe.toml",
        "convert flight/airframe.toml quad.toml",
        "convert flight/airframe.toml quad.txt",
        "detect flight -q --out spots.jsonl",
        "locate flight -q --out results.jsonl",
        "codes preset l18-d3-r2 --out book.txt",
    ] {
        make(&stage, made);
    }
    stage.file("set-up.toml", stage.run("plan --example").out);
    for (from, to) in [
        ("flight/truth.jsonl", "photinus-demo/truth.jsonl"),
        ("results.jsonl", "photinus-demo/results.jsonl"),
        ("camera.toml", "measured.toml"),
        ("airframe.toml", "learned.toml"),
    ] {
        std::fs::copy(stage.path(from), stage.path(to)).unwrap();
    }
    stage
}

/// Frames of the flight as photos, a video and raw frames, and a mask of their size.
fn pictures(stage: &Stage) {
    let frames: Vec<GreyImage> =
        (0..2).map(|n| read_image(flight().join(format!("images/{n:06}.png"))).unwrap().image).collect();
    let size = (frames[0].width(), frames[0].height());
    for (name, frame) in ["photo.png", "a.png"].iter().zip(&frames) {
        write_png(stage.path(name), &frame.view()).unwrap();
    }
    let mut mask = vec![255; size.0 * size.1];
    mask[..1000].fill(0);
    write_png(stage.path("mask.png"), &GreyImage::new(mask, size.0, size.1).unwrap().view()).unwrap();
    let mut video = Y4mWriter::new(Vec::new(), "video.y4m", size, (5, 1)).unwrap();
    frames.iter().for_each(|frame| video.write(&frame.view()).unwrap());
    stage.file("video.y4m", video.finish().unwrap());
    stage.file("frames.raw", frames.iter().flat_map(|frame| frame.pixels().to_vec()).collect::<Vec<u8>>());
}

/// What somebody measured, in files whose content depends on the example.
fn measurements(stage: &Stage, example: &str) {
    if example.contains("flight.mcap") && !example.contains("flight.mcap:") {
        make(stage, "convert flight flight.mcap");
    }
    if example.contains("photinus recover") {
        let bytes = std::fs::read(stage.path("flight.mcap")).unwrap();
        stage.file("flight.mcap", &bytes[..bytes.len() * 4 / 5]);
    }
    if example.contains("my-swarm.toml") {
        let scenario = stage.run("swarm three --print").out;
        stage.file("my-swarm.toml", scenario.replace("duration_s = 40.0", "duration_s = 1.0"));
    }
    if example.contains("--grid 7x5") {
        std::fs::remove_dir_all(stage.path("photos")).unwrap();
        std::fs::create_dir(stage.path("photos")).unwrap();
        calibrate::photos(stage, "photos", 15);
    }
    if example.contains("corners.csv") {
        stage.file("corners.csv", calibrate::corners(15, (8, 6)));
    }
    if example.contains("calibrate mounting") {
        stage.file("seen.csv", calibrate_mounting::directions(stage));
    }
    if example.contains("calibrate airframe ") {
        stage.file("seen.csv", calibrate_airframe::sightings(stage, "quad.toml"));
    }
    if example.contains("areas.csv") || example.contains("spots.toml") {
        stage.file("areas.csv", calibrate_spot_size::areas(&[1000.0]));
        make(stage, "calibrate spot-size areas.csv --out spots.toml");
    }
    if example.contains("observer.csv") {
        evaluate::two_logs(stage);
    }
    if example.contains("flight.mcap:") {
        evaluate_recordings::recorded(stage);
    }
}
