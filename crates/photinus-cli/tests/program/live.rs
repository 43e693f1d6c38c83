//! `photinus run`: the same loop as `locate`, fed by cameras.

use std::io::{BufRead, BufReader, Read};
use std::process::Stdio;
use std::time::{Duration, Instant};

use crate::stage::{Stage, video};

fn config(stage: &Stage, pace: &str, source: &str, rest: &str) {
    let camera = "camera = \"camera.toml\"\nmounting = \"front.toml\"\n";
    let camera = if source.contains("dataset") { "" } else { camera };
    let airframe = if source.contains("dataset") { "" } else { "[airframe]\nfile = \"hexa.toml\"\n" };
    let text = format!(
        "pace = \"{pace}\"\n[[camera]]\nname = \"front\"\nsource = {{ {source} }}\n{camera}{airframe}{rest}"
    );
    stage.file("run.toml", text);
    stage.file(
        "front.toml",
        "body_from_camera_xyzw = [-0.5, 0.5, -0.5, 0.5]\nposition_m = [0.1, 0.0, 0.05]\n\
         rotation_covariance_rad2 = [[0, 0, 0], [0, 0, 0], [0, 0, 0]]\nposition_covariance_m2 = [[0, 0, 0], [0, 0, 0], [0, 0, 0]]\n",
    );
}

#[test]
fn a_dataset_run_fast_gives_what_locate_gives_byte_for_byte() {
    let stage = Stage::new("run-fast");
    stage.dataset("rec", 40);
    config(&stage, "fast", "dataset = \"rec\"", "[json]\nfile = \"live.jsonl\"\n");
    let told = stage.run("run run.toml");
    assert_eq!(told.code, 0, "{}", told.err);
    assert!(told.err.contains("front") && told.err.contains("json live.jsonl"), "{}", told.err);
    assert_eq!(stage.run("locate rec --out located.jsonl -q").code, 0);
    let live = stage.read("live.jsonl");
    assert_eq!(live.lines().count(), 40);
    assert_eq!(live.replace("\"camera\":\"front\",", ""), stage.read("located.jsonl"));
    // A file that is there already is added to.
    assert_eq!(stage.run("run run.toml -q").code, 0);
    assert_eq!(stage.read("live.jsonl"), live.repeat(2));
}

#[test]
fn a_sky_is_that_of_locate_byte_for_byte_and_its_sun_costs_a_neighbour_probability() {
    let stage = Stage::new("run-sky");
    stage.dataset("rec", 3);
    // At the equinox the sun rises in the east on the equator: there the camera looks, and there the neighbour is.
    let sky =
        "[sky]\nlatitude_deg = 0.0\nlongitude_deg = 0.0\ntime = 2024-03-20T06:08:00Z\nheading_deg = 90.0\n";
    let live = |sky: &str| {
        config(&stage, "fast", "dataset = \"rec\"", &format!("[json]\nfile = \"live.jsonl\"\n{sky}"));
        assert_eq!(stage.run("run run.toml -q").code, 0);
        let told = stage.read("live.jsonl").replace("\"camera\":\"front\",", "");
        std::fs::remove_file(stage.path("live.jsonl")).unwrap();
        told
    };
    let located = |sky: &str| {
        assert_eq!(stage.run(&format!("locate rec --out located.jsonl -q --force {sky}")).code, 0);
        stage.read("located.jsonl")
    };
    let (without, with) = (live(""), live(sky));
    assert_eq!(with, located("--sky 0,0,2024-03-20T06:08:00Z,90"));
    assert_eq!(without, located(""));
    let probability = |told: &str| {
        let line: serde_json::Value = serde_json::from_str(told.lines().next().unwrap()).unwrap();
        line["neighbours"][0]["probability"].as_f64().unwrap_or(0.0)
    };
    assert!(probability(&with) < probability(&without), "{with}\n{without}");
    // A dataset's own sky counts where the configuration has none.
    let table = stage.read("rec/dataset.toml");
    stage.file("rec/dataset.toml", format!("{table}{sky}"));
    assert_eq!(live(""), with);
}

#[test]
fn live_every_frame_is_located_or_counted_with_its_latency() {
    let stage = Stage::new("run-live");
    stage.dataset("rec", 20);
    config(&stage, "live", "dataset = \"rec\"", "[json]\nstdout = true\n[health]\nfile = \"health.jsonl\"\n");
    let told = stage.run("run run.toml");
    assert_eq!(told.code, 0, "{}", told.err);
    let lines: Vec<serde_json::Value> =
        told.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert!(lines.iter().all(|line| line["latency_s"].as_f64().unwrap() > 0.0), "{}", told.out);
    let health = stage.read("health.jsonl");
    let last = health.lines().rfind(|line| line.starts_with("{\"health\"")).unwrap();
    let last: serde_json::Value = serde_json::from_str(last).unwrap();
    let camera = &last["health"]["cameras"][0];
    assert_eq!(camera["frames"].as_u64().unwrap() + camera["dropped"].as_u64().unwrap(), 20);
    assert_eq!(camera["frames"], lines.len());
    assert!(camera["latency_ms"]["p99"].as_f64().unwrap() > 0.0);
    assert!(health.contains("its frames are at their end"));
}

#[cfg(unix)]
#[test]
fn sigterm_ends_it_cleanly_and_a_command_that_died_was_started_anew() {
    let stage = Stage::new("run-term");
    stage.file("video.y4m", video(3));
    // A pipeline that gives three frames and dies.
    let source = "command = [\"sh\", \"-c\", \"cat video.y4m; sleep 0.2; exit 3\"]";
    config(&stage, "live", source, "[json]\nfile = \"live.jsonl\"\n");
    let mut child = stage.command("run run.toml").stderr(Stdio::piped()).spawn().unwrap();
    let mut told = BufReader::new(child.stderr.take().unwrap());
    let (mut line, until) = (String::new(), Instant::now() + Duration::from_secs(60));
    while !line.contains("it is back") {
        line.clear();
        assert!(told.read_line(&mut line).unwrap() > 0 && Instant::now() < until, "{line}");
    }
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-TERM", &id]).status().unwrap().success());
    let mut rest = String::new();
    told.read_to_string(&mut rest).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(0), "{rest}");
    assert!(rest.contains("frames  failed  dropped  lost"), "{rest}");
    let written = stage.read("live.jsonl");
    assert!(written.ends_with('\n') && written.contains("position_body_m"), "{written}");
}

#[test]
fn check_tries_every_part_and_leaves_nothing_behind() {
    let stage = Stage::new("run-check");
    stage.dataset("rec", 2);
    let sinks = "[json]\nfile = \"live.jsonl\"\n[page]\nlisten = \"127.0.0.1:0\"\n";
    config(&stage, "live", "dataset = \"rec\"", sinks);
    let told = stage.run("run --check run.toml");
    assert_eq!(told.code, 0, "{}", told.err);
    assert!(told.out.contains("camera front: 90 x 60 px") || told.out.contains(" px, "), "{}", told.out);
    assert!(!stage.path("live.jsonl").exists());
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    config(&stage, "live", "dataset = \"rec\"", &format!("[json]\ntcp = \"127.0.0.1:{port}\"\n"));
    stage.refuses("run --check run.toml", &["end the program that listens there, or choose another"]);
    stage.file("video.y4m", b"YUV4MPEG2 W4 H3 F20:1 Cmono\nFRAME\n123456789abc");
    config(&stage, "live", "command = [\"cat\", \"video.y4m\"]", "[json]\nstdout = true\n");
    stage.refuses("run --check run.toml", &["give the calibration of this camera at this resolution"]);
}

#[test]
fn what_is_not_understood_is_refused_with_its_line() {
    let stage = Stage::new("run-refused");
    stage.dataset("rec", 1);
    config(&stage, "live", "dataset = \"rec\"", "[jason]\nfile = \"x\"\n");
    stage.refuses("run run.toml", &["run.toml, line 5: unknown key `jason`"]);
    config(&stage, "live", "dataset = \"rec\"", "");
    stage.refuses("run run.toml", &["nobody is told what is found; add [json], [page] or another sink"]);
    let example = stage.run("run --example");
    assert!(example.code == 0 && example.out.contains("[[camera]]"));
}

#[test]
fn spots_of_another_detector_are_located_as_locate_does_and_a_bad_line_costs_itself() {
    let stage = Stage::new("run-spots");
    stage.dataset("rec", 5);
    assert_eq!(stage.run("detect rec --out spots.jsonl -q").code, 0);
    let spots = stage.read("spots.jsonl");
    let located = stage.run("locate --spots spots.jsonl --camera camera.toml --airframe hexa.toml --no-time --out located.jsonl -q");
    assert_eq!(located.code, 0, "{}", located.err);
    let mut lines: Vec<&str> = spots.lines().collect();
    lines.insert(2, "{\"spots\": 7}");
    stage.file("line.jsonl", lines.join("\n") + "\n");
    let rest = "[locate]\ntime = false\n[json]\nfile = \"live.jsonl\"\n";
    config(&stage, "fast", "command = [\"cat\", \"line.jsonl\"], spots = true", rest);
    let told = stage.run("run run.toml");
    assert!(told.code == 0 && told.err.contains("line 3"), "{}", told.err);
    // What the stream does not say is not made up: neither camera nor mounting change what was located.
    let neighbours = |text: &str| -> Vec<serde_json::Value> {
        let line = |line: &str| serde_json::from_str::<serde_json::Value>(line).unwrap();
        let all = text.lines().map(line).map(|line| {
            (line["frame"].clone(), line["time_s"].clone(), line["neighbours"][0]["position_m"].clone())
        });
        all.map(|parts| serde_json::json!(parts)).collect()
    };
    let live = neighbours(&stage.read("live.jsonl"));
    assert_eq!((live.len(), &live), (5, &neighbours(&stage.read("located.jsonl"))));
    assert!(live[0][2].is_array(), "{live:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_costs_the_sink_that_writes_there_and_no_other() {
    let stage = Stage::new("run-full");
    stage.dataset("rec", 60);
    config(
        &stage,
        "fast",
        "dataset = \"rec\"",
        "[json]\nfile = \"live.jsonl\"\nstdout = true\n[record]\nfile = \"live.mcap\"\n",
    );
    // The largest file that may be written stands for the disk's last byte: 8 blocks of 1024.
    let program = env!("CARGO_BIN_EXE_photinus");
    let done = std::process::Command::new("bash")
        .args(["-c", &format!("ulimit -f 8; exec {program} run run.toml")])
        .current_dir(stage.path(""))
        .output()
        .unwrap();
    let (out, err) = (String::from_utf8_lossy(&done.stdout), String::from_utf8_lossy(&done.stderr));
    assert_eq!(out.lines().count(), 60, "{err}");
    assert!(
        err.contains("json live.jsonl") && err.contains("nothing more goes there, the other outputs go on"),
        "{err}"
    );
    assert!(stage.read("live.jsonl").len() <= 8192);
}
