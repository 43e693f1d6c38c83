//! Runs that are stopped, and outputs that fail: what is whole stays, what fails is told, the rest goes on.

use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use photinus_testing::Skipped;

use crate::stage::{Stage, video};

const LOCATE: &str = "locate - --camera camera.toml --airframe hexa.toml";

/// Every line of a file but the last is JSON, and so is the last if it ends.
fn whole_lines(text: &str) -> usize {
    let (whole, _) = text.rsplit_once('\n').unwrap_or_default();
    whole
        .lines()
        .map(|line| assert!(serde_json::from_str::<serde_json::Value>(line).is_ok(), "{line}"))
        .count()
}

/// Starts a run that is fed frames without end.
fn endless(stage: &Stage, words: &str) -> (Child, std::thread::JoinHandle<()>) {
    let mut child = stage.command(words).stdin(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    let feeder = std::thread::spawn(move || {
        let frames = video(2);
        let one = &frames[frames.len() - (frames.len() - 37) / 2..];
        let _ = input.write_all(&frames);
        // Frames whose beginning is not theirs would be refused, but they are: every one ends where the next begins.
        while input.write_all(one).is_ok() {
            std::thread::sleep(Duration::from_millis(1));
        }
    });
    (child, feeder)
}

/// Waits until a file has a few lines.
fn wait_for_lines(stage: &Stage, name: &str) {
    for _ in 0..600 {
        if std::fs::read_to_string(stage.path(name)).is_ok_and(|text| text.lines().count() > 3) {
            return;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    panic!("{name} never grew");
}

fn signal(child: &Child, name: &str) {
    assert!(Command::new("kill").args([name, &child.id().to_string()]).status().unwrap().success());
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_what_is_whole_and_says_where_it_ended() {
    let stage = Stage::new("ctrl-c");
    for (number, name) in ["-INT", "-TERM"].into_iter().enumerate() {
        let file = format!("r{number}.jsonl");
        let (mut child, feeder) = endless(&stage, &format!("{LOCATE} -q --out {file}"));
        wait_for_lines(&stage, &file);
        signal(&child, name);
        let told: Vec<String> =
            BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap).collect();
        assert_eq!(child.wait().unwrap().code(), Some(130), "{told:?}");
        feeder.join().unwrap();
        let text = stage.read(&file);
        assert!(text.ends_with('\n'), "the last line is whole");
        let part =
            format!("interrupted after {} frames; {file} holds them, --resume goes on", whole_lines(&text));
        assert!(told.iter().any(|line| line.contains(&part)), "{told:?} lacks {part}");
    }
}

#[cfg(unix)]
#[test]
fn a_folder_that_is_interrupted_holds_whole_frames() {
    let stage = Stage::new("interrupted-folder");
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/swarm-12.toml");
    let mut child = stage.command(&format!("simulate {scene} --out rec -q --frames 100000"));
    let child = child.stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(1500));
    signal(&child, "-INT");
    let done = child.wait_with_output().unwrap();
    let told = String::from_utf8(done.stderr).unwrap();
    assert_eq!(done.status.code(), Some(130), "{told}");
    if told.contains("frames are in it") {
        assert_eq!(stage.run("info rec").code, 0);
    } else {
        // It came before the first frame.
        assert!(told.contains("what was not finished is gone") && !stage.path("rec").exists(), "{told}");
    }
    assert!(!stage.names("").iter().any(|name| name.ends_with(".partial")), "{:?}", stage.names(""));
}

#[cfg(unix)]
#[test]
fn killed_runs_leave_whole_lines_and_no_half_files() {
    let stage = Stage::new("killed");
    stage.dataset("rec", 40);
    stage.run("locate rec -q --out good.jsonl");
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/crossing.toml");
    for round in 0..21_u64 {
        let words = match round % 7 {
            0 => "locate rec -q --out r.jsonl --csv t.csv --force",
            1 => "convert rec whole.y4m --force",
            2 => "convert rec copy",
            3 => "convert hexa.toml airframe.txt --force",
            4 => "simulate SCENE -q --out scene --frames 20",
            5 => "inject rec --fault noise=3 -q --out noisy",
            _ => "evaluate rec good.jsonl -q --json scores.json --force",
        };
        for folder in ["copy", "scene", "noisy"] {
            let _ = std::fs::remove_dir_all(stage.path(folder));
        }
        let mut child = stage.command(&words.replace("SCENE", scene)).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(4 + 6 * round));
        let _ = child.kill();
        child.wait().unwrap();
        if let Ok(text) = std::fs::read_to_string(stage.path("r.jsonl")) {
            whole_lines(&text);
        }
        let scores = std::fs::read_to_string(stage.path("scores.json"));
        assert!(scores.is_err() || serde_json::from_str::<serde_json::Value>(&scores.unwrap()).is_ok());
        for name in ["whole.y4m", "copy", "scene", "noisy", "airframe.txt"] {
            let is_whole = !stage.path(name).exists() || stage.run(&format!("info {name}")).code == 0;
            assert!(is_whole, "{name} is whole or not there");
        }
    }
    assert_eq!(stage.run("locate rec -q --out r.jsonl --csv t.csv --resume").code, 0);
    assert_eq!(whole_lines(&stage.read("r.jsonl")), 40);
}

#[cfg(unix)]
#[test]
fn an_output_that_nobody_reads_any_more_does_not_cost_the_others() {
    let stage = Stage::new("closed");
    stage.file("v.y4m", video(400));
    let done = stage.shell(
        "{ $photinus locate v.y4m --camera camera.toml --airframe hexa.toml --out f.jsonl --csv -; echo $? > code; } | head -1",
    );
    assert_eq!(stage.read("code").trim(), "1", "{}", done.err);
    assert_eq!(whole_lines(&stage.read("f.jsonl")), 400, "every line is in the file");
    assert!(
        done.err.contains("error: standard output: ") && done.err.contains("the other outputs go on"),
        "{}",
        done.err
    );
    // With no other output it is as ever: no failure.
    let done = stage.shell("{ $photinus detect v.y4m -q --out -; echo $? > code; } | head -1");
    assert_eq!((stage.read("code").trim(), done.err.as_str()), ("0", ""));
    let done = stage.shell("$photinus detect v.y4m -q > /dev/full");
    assert!(done.code == 1 && done.err.contains("error: standard output: No space left"), "{}", done.err);
    let done = stage.shell(
        "$photinus detect v.y4m -q --out f2.jsonl --overlay seen & sleep 0.3; chmod 0 seen 2>/dev/null; wait",
    );
    assert_eq!(done.code, 0);
}

/// A disk of its own; `None` where that may not be had.
struct Disk(PathBuf);

impl Disk {
    fn mount(stage: &Stage, options: &str) -> Option<Self> {
        let folder = stage.path("disk");
        std::fs::create_dir_all(&folder).unwrap();
        let mounted =
            Command::new("mount").args(["-t", "tmpfs", "-o", options, "tmpfs"]).arg(&folder).output();
        if mounted.is_ok_and(|mounted| mounted.status.success()) {
            return Some(Self(folder));
        }
        Skipped::current_test("a file system cannot be mounted here");
        None
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        // A file system left behind is seen by the next one to look.
        let _ = Command::new("umount").arg(&self.0).status();
    }
}

#[cfg(unix)]
#[test]
fn a_full_disk_is_told_and_leaves_no_half_file() {
    let stage = Stage::new("full");
    stage.dataset("rec", 60);
    let Some(_disk) = Disk::mount(&stage, "size=64k") else { return };
    stage.file("disk/mine.txt", "mine");
    for words in [
        "locate rec -q --out disk/r.jsonl",
        "locate rec -q --overlay disk/seen",
        "locate rec -q --out good.jsonl --csv disk/t.csv --overlay disk/seen --force",
        "convert rec disk/v.y4m",
        "convert rec disk/copy",
        "simulate SCENE --out disk/scene --frames 3 -q",
        "simulate SCENE --out disk/scene.y4m --frames 3 -q",
        "demo --out disk/demo --seconds 1",
    ] {
        let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/crossing.toml");
        let done = stage.run(&words.replace("SCENE", scene));
        assert_eq!(done.code, 1, "{words}: {}", done.err);
        assert!(done.err.contains("No space left") && done.err.contains("disk"), "{words}: {}", done.err);
        assert!(!done.err.contains(".partial"), "{words}: names that nobody gave are not told: {}", done.err);
        for name in stage.names("disk") {
            match name.as_str() {
                "mine.txt" => {}
                "r.jsonl" => drop(whole_lines(&stage.read("disk/r.jsonl"))),
                "t.csv" => {}
                // Pictures, and frames that were whole before the disk was full.
                "seen" | "copy" | "scene" => {}
                _ => panic!("{words} left {name}"),
            }
            if name != "mine.txt" {
                let path = stage.path("disk").join(name);
                let _ = std::fs::remove_dir_all(&path).or_else(|_| std::fs::remove_file(&path));
            }
        }
        assert_eq!(stage.read("disk/mine.txt"), "mine");
    }
    assert_eq!(whole_lines(&stage.read("good.jsonl")), 60, "the file on the other disk is whole");

    // With no room at all, commands that write one small file fail, too, and leave nothing.
    let room =
        (1..=64).rev().find(|kib| std::fs::write(stage.path("disk/filler"), vec![0; kib << 10]).is_ok());
    assert!(room.is_some());
    let row = |n: u32| f64::from(n) / 5.0;
    let rows = (5..45).map(|n| format!("{},{}\n", row(n), (1.3 + 31.5 / (row(n) * row(n))).floor()));
    stage.file("sizes.csv", format!("distance_m,area_px\n{}", rows.collect::<String>()));
    for words in [
        "detect rec -q --out disk/s.jsonl",
        "convert hexa.toml disk/a.txt",
        "convert good.jsonl disk/t.csv",
        "evaluate rec good.jsonl -q --json disk/s.json",
        "inject rec --fault noise=3 -q --out disk/noisy",
        "calibrate spot-size sizes.csv -q --out disk/curve.toml",
        "reproduce 4 --quick -q --out disk/figures",
    ] {
        let done = stage.run(words);
        assert!(matches!(done.code, 1 | 2), "{words}: {}", done.err);
        assert!(
            done.err.contains("No space left") && !done.err.contains(".partial"),
            "{words}: {}",
            done.err
        );
        let left: Vec<String> = stage.names("disk").into_iter().filter(|name| name != "s.jsonl").collect();
        assert_eq!(left, ["filler", "mine.txt"], "{words}");
    }
}

#[cfg(unix)]
#[test]
fn a_file_that_may_not_grow_is_an_error_and_no_signal() {
    let stage = Stage::new("limit");
    stage.dataset("rec", 60);
    let done = stage.shell("ulimit -f 64; $photinus locate rec -q --out r.jsonl");
    assert!(done.code == 1 && done.err.contains("File too large"), "{}", done.err);
    assert!(whole_lines(&stage.read("r.jsonl")) > 0);
    let done = stage.shell("ulimit -f 8; $photinus convert rec v.y4m");
    assert!(done.code == 1 && done.err.contains("File too large"), "{}", done.err);
    assert!(!stage.path("v.y4m").exists());
}

#[cfg(unix)]
#[test]
fn a_folder_that_may_not_be_written_to_is_noticed_before_the_work() {
    let stage = Stage::new("read-only");
    stage.dataset("rec", 2);
    stage.run("locate rec -q --out good.jsonl");
    let Some(_disk) = Disk::mount(&stage, "ro") else { return };
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/crossing.toml");
    for words in [
        "locate rec --out disk/r.jsonl",
        "locate rec --csv disk/t.csv",
        "detect rec --overlay disk/seen",
        "convert hexa.toml disk/a.txt",
        "convert rec disk/copy",
        "convert rec disk/v.y4m",
        "evaluate rec good.jsonl --json disk/s.json",
        "evaluate rec good.jsonl --plots disk/plots",
        "simulate SCENE --out disk/scene",
        "simulate SCENE --out disk/scene.y4m",
        "calibrate camera frame.png --grid 7x5 --out disk/c.toml",
        "calibrate spot-size rec --json disk/s.json",
        "demo --out disk/demo",
        "reproduce --out disk/figures",
    ] {
        let done = stage.run(&words.replace("SCENE", scene));
        assert_eq!(done.code, 2, "{words}: {}", done.err);
        assert!(done.err.contains("Read-only file system"), "{words}: {}", done.err);
        assert!(done.err.contains("disk") && !done.err.contains(".partial"), "{words}: {}", done.err);
    }
}
