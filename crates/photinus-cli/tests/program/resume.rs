//! A stopped run is gone on with, and the result is that of an unbroken one.

use crate::stage::{Stage, video};

const FILES: [&str; 2] = ["r.jsonl", "t.csv"];

/// A dataset of six frames, and what an unbroken run writes.
fn stage(test: &str) -> (Stage, [String; 2]) {
    let stage = Stage::new(test);
    stage.dataset("rec", 6);
    assert_eq!(stage.run("locate rec -q --out r.jsonl --csv t.csv --overlay seen").code, 0);
    let whole = FILES.map(|name| stage.read(name));
    (stage, whole)
}

#[test]
fn wherever_it_was_stopped_the_result_is_the_unbroken_one() {
    let (stage, whole) = stage("resume");
    let line = whole[0].lines().next().unwrap().len();
    for bytes in [0, 1, line, line + 1, 2 * line + 20, whole[0].len() - 1, whole[0].len()] {
        stage.file("r.jsonl", &whole[0][..bytes]);
        stage.file("t.csv", &whole[1][..whole[1].len() / 2]);
        let _ = std::fs::remove_file(stage.path("seen/overlay-000005.png"));
        let done = stage.run("locate rec --out r.jsonl --csv t.csv --overlay seen --resume");
        assert_eq!(done.code, 0, "{bytes}: {}", done.err);
        assert_eq!(FILES.map(|name| stage.read(name)), whole, "cut at {bytes}");
        assert!(stage.path("seen/overlay-000005.png").is_file());
    }
    std::fs::remove_file(stage.path("r.jsonl")).unwrap();
    assert_eq!(stage.run("locate rec -q --out r.jsonl --resume").code, 0, "nothing is done yet");
    assert_eq!(stage.read("r.jsonl"), whole[0]);
}

#[test]
fn streams_images_and_spots_are_gone_on_with_too() {
    let (stage, _) = stage("resume-streams");
    stage.file("v.y4m", video(5));
    stage.run("detect v.y4m -q --out spots.jsonl");
    let parts = "--camera camera.toml --airframe hexa.toml -q";
    for words in [
        format!("locate v.y4m {parts}"),
        format!("locate frame.png frame.png frame.png frame.png frame.png {parts}"),
        format!("locate --spots spots.jsonl {parts}"),
        format!("locate v.y4m --frames 4 {parts}"),
        "locate rec --frames 4 -q".to_owned(),
    ] {
        stage.run(&format!("{words} --out whole.jsonl --force"));
        let whole = stage.read("whole.jsonl");
        let cut = whole.match_indices('\n').nth(1).unwrap().0 + 30;
        stage.file("cut.jsonl", &whole[..cut]);
        assert_eq!(stage.run(&format!("{words} --out cut.jsonl --resume")).code, 0, "{words}");
        assert_eq!(stage.read("cut.jsonl"), whole, "{words}");
    }
}

#[test]
fn results_of_another_run_are_left_alone() {
    let (stage, whole) = stage("resume-other");
    let cut = &whole[0][..whole[0].len() - 10];
    for (words, part) in [
        (
            "locate rec --marker-sigma 0.05",
            "this run finds something else in it; go on with the files, options and version",
        ),
        (
            "locate frame.png --camera camera.toml --airframe hexa.toml",
            "the input has no such frame; go on with the input",
        ),
    ] {
        stage.file("r.jsonl", cut);
        stage.file("t.csv", &whole[1]);
        let done = stage.run(&format!("{words} --out r.jsonl --csv t.csv --resume"));
        assert!(done.code == 2 && done.err.contains(part), "{}", done.err);
        assert_eq!((stage.read("r.jsonl").as_str(), stage.read("t.csv")), (cut, whole[1].clone()));
    }
    stage.file("r.jsonl", "no results\n");
    stage.refuses("locate rec --out r.jsonl --resume", &["r.jsonl: its last whole line is no result"]);
    assert_eq!(stage.read("r.jsonl"), "no results\n");
    stage.refuses("locate rec --resume", &["--out"]);
    stage.refuses("locate rec --out - --resume", &["only a file of results can be gone on with"]);
}

#[test]
fn a_cut_line_is_said_and_the_whole_ones_are_used() {
    let (stage, whole) = stage("cut-line");
    stage.file("r.jsonl", &whole[0][..whole[0].len() - 10]);
    let done = stage.run("evaluate rec r.jsonl");
    assert_eq!(done.code, 0, "{}", done.err);
    let told = "warning: r.jsonl, line 6: the last line is cut: the run that wrote it was stopped";
    assert!(
        done.err.contains(told) && done.err.contains("the 5 whole lines before it are used"),
        "{}",
        done.err
    );
}
