//! No mistake in the arguments costs a user a file.

use crate::stage::Stage;

/// A dataset `rec`, and beside it files that somebody may name by mistake.
fn stage(test: &str) -> Stage {
    let stage = Stage::new(test);
    stage.dataset("rec", 3);
    stage.file("mine.txt", "mine");
    std::fs::create_dir(stage.path("folder")).unwrap();
    stage.file("folder/mine.txt", "mine");
    stage.file("table.csv", "image,led,u_px,v_px\n");
    stage
}

/// The words are refused with this advice, and every file of the stage is as it was.
fn loses_nothing(stage: &Stage, words: &str, part: &str) {
    let before = everything(stage, "");
    let done = stage.run(words);
    assert_eq!(done.code, 2, "{words}: {}", done.err);
    assert!(done.err.contains(part), "{words}\n{}\nlacks `{part}`", done.err);
    assert_eq!(everything(stage, ""), before, "{words} left the files as they were");
}

/// Every file under a folder with its content, but for what the tests' own standard input is kept in.
fn everything(stage: &Stage, folder: &str) -> Vec<(String, Vec<u8>)> {
    let mut all = Vec::new();
    for name in stage.names(folder) {
        let path = format!("{folder}{name}");
        if stage.path(&path).is_dir() {
            all.extend(everything(stage, &format!("{path}/")));
        } else if name != ".stdin" {
            all.push((path.clone(), std::fs::read(stage.path(&path)).unwrap()));
        }
    }
    all
}

const IS_INPUT: &str = "this file is an input, it would be replaced; write elsewhere";
const IS_THERE: &str = "it is there already; write elsewhere, or over it with --force";

#[test]
fn what_a_run_reads_is_never_written_over() {
    let stage = stage("survive-inputs");
    std::fs::copy(stage.path("rec/images/000000.png"), stage.path("mask.png")).unwrap();
    stage
        .file("curve.toml", "exposure_us = 2000\nupper = { offset_px = 1, scale_px_m2 = 30, shift_m = 0 }\n");
    let locate =
        "locate rec --camera camera.toml --airframe hexa.toml --mask mask.png --spot-curve curve.toml -q";
    for victim in [
        "rec/dataset.toml",
        "rec/frames.csv",
        "rec/truth.jsonl",
        "rec/camera.toml",
        "rec/hexa.toml",
        "rec/images/000001.png",
        "camera.toml",
        "hexa.toml",
        "mask.png",
        "curve.toml",
        "./rec/../hexa.toml",
    ] {
        for option in ["--out", "--csv"] {
            for force in ["", " --force"] {
                loses_nothing(&stage, &format!("{locate} {option} {victim}{force}"), IS_INPUT);
            }
        }
    }
    loses_nothing(&stage, "locate rec --resume --out rec/truth.jsonl -q", "rec/truth.jsonl");
    loses_nothing(&stage, "detect frame.png --out frame.png --force", IS_INPUT);
    loses_nothing(&stage, "detect rec --mask mask.png --out mask.png --force", IS_INPUT);
    loses_nothing(&stage, "convert camera.toml camera.toml --force", IS_INPUT);
    loses_nothing(&stage, "convert rec rec --force", "a file in it is an input");
    loses_nothing(&stage, "convert rec copy --camera camera.toml --force --to toml", "cannot become");
    loses_nothing(
        &stage,
        "locate rec --overlay rec/images --force",
        "a file in it is an input; name another folder",
    );
    loses_nothing(&stage, "evaluate rec mine.txt --json mine.txt --force", "mine.txt");
    loses_nothing(&stage, "calibrate camera frame.png --grid 7x5 --out frame.png --force", IS_INPUT);
    loses_nothing(
        &stage,
        "calibrate camera frame.png --grid 7x5 --out x.toml --ocam frame.png --force",
        IS_INPUT,
    );
    loses_nothing(
        &stage,
        "calibrate mounting table.csv --camera camera.toml --out camera.toml --force",
        IS_INPUT,
    );
    loses_nothing(
        &stage,
        "calibrate airframe table.csv --camera camera.toml --nominal hexa.toml --out table.csv --force",
        IS_INPUT,
    );
    loses_nothing(&stage, "calibrate spot-size rec --out rec --force", "rec");
}

#[cfg(unix)]
#[test]
fn another_name_of_a_file_is_the_same_file() {
    let stage = stage("survive-links");
    std::os::unix::fs::symlink(stage.path("rec/truth.jsonl"), stage.path("link.jsonl")).unwrap();
    std::fs::hard_link(stage.path("rec/truth.jsonl"), stage.path("hard.jsonl")).unwrap();
    loses_nothing(&stage, "locate rec -q --out link.jsonl --force", IS_INPUT);
    loses_nothing(&stage, "locate rec -q --out hard.jsonl --force", IS_INPUT);
    std::os::unix::fs::symlink(stage.path("mine.txt"), stage.path("link.txt")).unwrap();
    loses_nothing(&stage, "locate rec -q --out link.txt", IS_THERE);
    assert_eq!(stage.run("locate rec -q --out link.txt --force").code, 0);
    assert!(stage.path("link.txt").is_symlink() && stage.read("mine.txt").lines().count() == 3);
}

#[test]
fn what_is_there_stays_without_force() {
    let stage = stage("survive-there");
    for words in [
        "locate rec -q --out mine.txt",
        "locate rec -q --csv mine.txt",
        "detect rec -q --out mine.txt",
        "convert hexa.toml camera.toml",
        "convert camera.toml mine.txt",
        "convert frame.png mine.txt --to y4m",
        "simulate SCENE --out mine.txt --frames 1",
        "evaluate rec rec/truth.jsonl --json mine.txt",
        "calibrate camera frame.png --grid 7x5 --out mine.txt",
        "calibrate camera frame.png --grid 7x5 --out new.toml --ocam mine.txt",
        "calibrate mounting table.csv --camera camera.toml --out mine.txt",
        "calibrate airframe table.csv --camera camera.toml --nominal hexa.toml --out mine.txt",
        "calibrate airframe-light rec --out mine.txt",
        "calibrate spot-size rec --json mine.txt",
    ] {
        let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/crossing.toml");
        loses_nothing(&stage, &words.replace("SCENE", scene), "it is there already");
    }
    for words in [
        "locate rec -q --overlay folder",
        "detect rec -q --overlay folder",
        "convert rec folder",
        "simulate SCENE --out folder --frames 1",
        "evaluate rec rec/truth.jsonl --plots folder",
        "calibrate camera frame.png --grid 7x5 --out new.toml --report folder",
        "calibrate spot-size rec --plots folder",
        "demo --out folder",
        "reproduce 4 --quick --out folder",
    ] {
        let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/crossing.toml");
        let advice = "folder: it is there already; name another folder, or write into it with --force";
        loses_nothing(&stage, &words.replace("SCENE", scene), advice);
    }
    loses_nothing(&stage, "locate rec --out folder", "it is a folder; name a file");
    loses_nothing(&stage, "locate rec --overlay mine.txt", "it is there already, and no folder");
    loses_nothing(&stage, "locate rec --out none/r.jsonl", "make its folder first");
}

#[test]
fn two_outputs_do_not_share_a_place() {
    let stage = stage("survive-shared");
    let advice = "both write to standard output: name a file for one of them";
    loses_nothing(&stage, "locate rec --out - --csv -", advice);
    for (out, csv) in [("x", "x"), ("x", "./x"), ("rec/../x", "x")] {
        loses_nothing(
            &stage,
            &format!("locate rec --out {out} --csv {csv}"),
            "two outputs would be written here",
        );
    }
    let camera = "calibrate camera frame.png --grid 7x5 --out x.toml --ocam x.toml";
    loses_nothing(
        &stage,
        camera,
        "x.toml: two outputs would be written here; name another place for one of them",
    );
}

#[test]
fn what_may_go_goes_and_nothing_else() {
    let stage = stage("survive-force");
    assert_eq!(stage.run("locate rec -q --out mine.txt --csv table.csv --overlay folder --force").code, 0);
    assert_eq!(stage.read("mine.txt").lines().count(), 3);
    assert_eq!(stage.read("table.csv").lines().count(), 4);
    assert_eq!(stage.read("folder/mine.txt"), "mine", "other files of a folder stay");
    assert!(stage.path("folder/overlay-000002.png").is_file());
    assert_eq!(stage.run("convert rec folder --force").code, 0);
    assert!(stage.path("folder/images/000002.png").is_file() && stage.read("folder/mine.txt") == "mine");
    std::fs::create_dir(stage.path("empty")).unwrap();
    assert_eq!(stage.run("convert rec empty").code, 0, "an empty folder has nothing to lose");
    assert_eq!(stage.run("locate rec -q --out /dev/null --csv /dev/null").code, 0);
    let left: Vec<String> = stage.names("").into_iter().filter(|name| name.ends_with(".partial")).collect();
    assert_eq!(left, [""; 0], "nothing half-made is left");
}
