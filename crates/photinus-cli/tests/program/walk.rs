//! A newcomer's walk: every example of the README and of the help, as it stands there, with files of the names that it names.

use std::collections::BTreeSet;
use std::path::Path;

use photinus_io::image::{GreyImage, read_image, write_png};
use photinus_io::video::Y4mWriter;

use crate::stage::Stage;
use crate::{calibrate_airframe, calibrate_mounting, calibrate_spot_size, evaluate, evaluate_recordings};

/// Commands whose examples are walked; the others calibrate from photos that cannot be part of the repository, or simulate for minutes,
/// and have tests of their own.
const WALKED: [&str; 15] = [
    "locate",
    "detect",
    "info",
    "doctor",
    "convert",
    "inject",
    "evaluate",
    "completions",
    "codes check",
    "codes design",
    "codes preset",
    "calibrate spot-size",
    "calibrate mounting",
    "calibrate airframe",
    "simulate",
];

/// What an example has that a test cannot: other programs, minutes of simulation or of search, recordings of a robot or an LED alone, a
/// home folder.
const LEFT_OUT: [&str; 9] = [
    "ffmpeg",
    "jq",
    "outdoor-flight.toml",
    "swarm-12.toml",
    "receding-led.toml",
    "spot-size recording",
    "morning",
    "~/",
    "--effort",
];

/// Options and commands whose next word is written to.
const WRITES: [&str; 8] = ["--out", "--csv", "--overlay", "--json", "--plots", "--report", "--ocam", ">"];

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

/// A folder with every file that `example` reads, but none of `written`.
fn provide(stage: &Stage, example: &str, written: &BTreeSet<String>) {
    for folder in ["recording", "flight", "bad-day", "other-flight", "examples/three-hexarotors"] {
        copy(flight(), &stage.path(folder));
    }
    copy(&flight().join("images"), &stage.path("frames"));
    copy(&flight().join("images"), &stage.path("photos"));
    copy(&flight().join("../../scenes"), &stage.path("scenes"));
    let frames: Vec<GreyImage> =
        (0..2).map(|n| read_image(flight().join(format!("images/{n:06}.png"))).unwrap().image).collect();
    let size = (frames[0].width(), frames[0].height());
    for (name, frame) in ["photo.png", "a.png"].iter().zip(&frames) {
        write_png(stage.path(name), &frame.view()).unwrap();
    }
    let white = GreyImage::new(vec![255; size.0 * size.1], size.0, size.1).unwrap();
    let mut mask = white.pixels().to_vec();
    mask[..1000].fill(0);
    std::fs::remove_file(stage.path("frame.png")).unwrap();
    std::fs::create_dir_all(stage.path("photinus-demo")).unwrap();
    write_png(stage.path("mask.png"), &GreyImage::new(mask, size.0, size.1).unwrap().view()).unwrap();
    let mut video = Y4mWriter::new(Vec::new(), "video.y4m", size, (5, 1)).unwrap();
    frames.iter().for_each(|frame| video.write(&frame.view()).unwrap());
    stage.file("video.y4m", video.finish().unwrap());
    stage.file("frames.raw", frames.iter().flat_map(|frame| frame.pixels().to_vec()).collect::<Vec<u8>>());
    stage.file("gravity.csv", "time_s,gx,gy,gz\n0,0,1,0\n10,0,1,0\n");
    for made in [
        "convert flight/camera.toml camera.txt --force",
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
        let done = stage.run(made);
        assert_eq!(done.code, 0, "{made}: {}", done.err);
    }
    for (from, to) in [
        ("flight/truth.jsonl", "photinus-demo/truth.jsonl"),
        ("results.jsonl", "photinus-demo/results.jsonl"),
        ("camera.toml", "measured.toml"),
        ("airframe.toml", "learned.toml"),
    ] {
        std::fs::copy(stage.path(from), stage.path(to)).unwrap();
    }
    provide_measurements(stage, example);
    for name in written.iter().map(|name| stage.path(name)) {
        drop(if name.is_dir() { std::fs::remove_dir_all(name) } else { std::fs::remove_file(name) });
    }
}

/// What somebody measured, in files whose content depends on the example.
fn provide_measurements(stage: &Stage, example: &str) {
    if example.contains("flight.mcap") && !example.contains("flight.mcap:") {
        assert_eq!(stage.run("convert flight flight.mcap").code, 0);
    }
    if example.contains("calibrate mounting") {
        stage.file("seen.csv", calibrate_mounting::directions(stage));
    }
    if example.contains("calibrate airframe") {
        stage.file("seen.csv", calibrate_airframe::sightings(stage, "quad.toml"));
    }
    if example.contains("areas.csv") || example.contains("spots.toml") {
        stage.file("areas.csv", calibrate_spot_size::areas(&[1000.0]));
        assert_eq!(stage.run("calibrate spot-size areas.csv --out spots.toml").code, 0);
    }
    if example.contains("observer.csv") {
        evaluate::two_logs(stage);
    }
    if example.contains("flight.mcap:") {
        evaluate_recordings::recorded(stage);
    }
}

/// The examples of a help, each in one line.
fn examples(help: &str) -> Vec<String> {
    let (_, rest) = help.split_once("Examples:\n").unwrap();
    let block = rest.split("\n\n").next().unwrap();
    let joined = block.replace(" \\\n", " ").replace(" |\n", " | ");
    let lines = joined.lines().map(str::trim).filter(|line| !line.starts_with('#'));
    lines.map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect()
}

/// The commands of the README's blocks; the demo has a test of its own.
fn of_readme() -> Vec<String> {
    let blocks = include_str!("../../../../README.md").split("```sh\n").skip(1);
    let lines = blocks.flat_map(|rest| rest.split("```").next().unwrap_or_default().lines());
    let commands = lines.map(|line| line.replace("cargo run --release -- ", "photinus "));
    commands.filter(|line| line.starts_with("photinus ") && line != "photinus demo").collect()
}

/// What an example writes.
fn written(example: &str) -> BTreeSet<String> {
    let words: Vec<&str> = example.split(' ').collect();
    let mut written: BTreeSet<String> = words
        .windows(2)
        .filter(|pair| WRITES.contains(&pair[0]) && !example.contains("--resume"))
        .map(|pair| pair[1].to_owned())
        .collect();
    if let Some(options) = example.strip_prefix("photinus convert ") {
        let places = options.split(' ').take_while(|word| !word.starts_with("--"));
        written.extend(places.last().map(str::to_owned));
    }
    written
}

#[test]
fn every_example_does_what_it_says() {
    let help = Stage::new("walk-help");
    let of_help = WALKED.iter().flat_map(|command| examples(&help.run(&format!("{command} --help")).out));
    let is_walked = |example: &String| !LEFT_OUT.iter().any(|part| example.contains(part));
    let walked: Vec<String> = of_readme().into_iter().chain(of_help).filter(is_walked).collect();
    assert!(walked.len() >= 44, "{}", walked.len());
    for (number, example) in walked.iter().enumerate() {
        let stage = Stage::new(&format!("walk-{number}"));
        provide(&stage, example, &written(example));
        let done = stage.shell(&format!("photinus() {{ \"$photinus\" \"$@\"; }}; {example}"));
        assert_eq!(done.code, 0, "{example}\n{}{}", done.out, done.err);
        for name in written(example).iter().filter(|name| *name != "-") {
            assert!(stage.path(name).exists(), "{example} leaves no {name}");
        }
    }
}
