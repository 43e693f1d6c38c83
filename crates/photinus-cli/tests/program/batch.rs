//! Many recordings at once: the results of each are those of the recording alone, whatever was stopped, and none is done twice.

use std::os::unix::fs::MetadataExt;
use std::time::Duration;

use crate::stage::Stage;

const NAMES: [&str; 5] = ["day-1/a", "day-1/b", "day-2/a", "c", "d"];

/// Five datasets, and what `locate --out` writes of each.
fn stage(test: &str) -> (Stage, Vec<String>) {
    let stage = Stage::new(test);
    let alone = NAMES.iter().enumerate().map(|(number, name)| {
        stage.dataset(name, 2 + number);
        assert_eq!(stage.run(&format!("locate {name} -q --out alone.jsonl --force")).code, 0);
        stage.read("alone.jsonl")
    });
    let alone = alone.collect();
    (stage, alone)
}

fn all() -> String {
    format!("locate -q {} --out-dir out", NAMES.join(" "))
}

fn results(stage: &Stage) -> Vec<String> {
    NAMES.iter().map(|name| stage.read(&format!("out/{name}.jsonl"))).collect()
}

#[test]
fn each_has_the_results_that_it_has_alone_and_is_done_once() {
    let (stage, alone) = stage("batch");
    assert_eq!(stage.run(&format!("{} --jobs 2", all())).code, 0);
    assert_eq!(results(&stage), alone);
    let made = |name: &str| std::fs::metadata(stage.path(name)).unwrap().ino();
    let kept = made("out/c.jsonl");
    std::fs::remove_file(stage.path("out/day-2/a.jsonl")).unwrap();
    stage.dataset("e", 1);
    let again = stage.run(&format!("{} e", all().replace(" -q", "")));
    assert_eq!(again.code, 0);
    assert!(
        again.err.contains("2 recordings located, 5 frames; 4 recordings were done before"),
        "{}",
        again.err
    );
    assert_eq!((results(&stage), made("out/c.jsonl")), (alone, kept));
}

#[test]
fn one_that_fails_costs_itself_alone_and_is_tried_again() {
    let (stage, alone) = stage("batch-fails");
    let image = stage.path("c/images/000003.png");
    let whole = std::fs::read(&image).unwrap();
    stage.file("c/images/000003.png", &whole[..20]);
    std::fs::rename(stage.path("d/frames.csv"), stage.path("d/frames")).unwrap();
    let done = stage.run(&all());
    assert_eq!(done.code, 1);
    assert!(
        done.err.contains("000003.png") && done.err.contains("d: the folder holds no frames.csv"),
        "{}",
        done.err
    );
    assert_eq!(stage.read("out/day-1/a.jsonl"), alone[0]);
    assert_eq!(stage.read("out/c.jsonl").lines().count(), 4, "the other frames of it");
    assert!(!stage.path("out/d.jsonl").exists());
    std::fs::rename(stage.path("d/frames"), stage.path("d/frames.csv")).unwrap();
    assert_eq!(stage.run(&all()).code, 0);
    assert_eq!(stage.read("out/d.jsonl"), alone[4]);
}

#[test]
fn killed_at_any_time_it_goes_on_and_nothing_has_a_name_that_is_not_whole() {
    let (stage, alone) = stage("batch-killed");
    for wait_ms in [5, 40, 80, 120] {
        let mut running = stage.command(&format!("{} --jobs 2", all())).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(wait_ms));
        running.kill().unwrap();
        running.wait().unwrap();
        for (name, alone) in NAMES.iter().zip(&alone) {
            let there = std::fs::read_to_string(stage.path(&format!("out/{name}.jsonl")));
            assert!(there.is_err() || there.is_ok_and(|text| text == *alone), "{name} after {wait_ms} ms");
        }
    }
    assert_eq!(stage.run(&all()).code, 0);
    assert_eq!(results(&stage), alone);
}

#[test]
fn a_folder_has_results_of_the_same_options_alone() {
    let (stage, alone) = stage("batch-options");
    assert_eq!(stage.run(&all()).code, 0);
    let other = format!("{} --no-time", all());
    stage.refuses(&other, &["photinus.json: the results here were made by other options", "--force"]);
    assert_eq!(results(&stage), alone);
    assert_eq!(stage.run(&format!("{other} --force")).code, 0);
    assert_ne!(results(&stage), alone);
    stage.refuses("locate c --out-dir d", &["d: it is there already, with something else in it"]);
    stage.refuses("locate c day-1/../c ./c --out-dir new", &["its results would be those of"]);
    stage.refuses("locate --out-dir new", &["no recordings"]);
    stage.refuses("locate - --out-dir new", &["use --out in place of --out-dir"]);
    stage.refuses("locate c --out-dir new --out r.jsonl", &["--out"]);
    stage.refuses("locate c --jobs 2", &["--out-dir"]);
}

#[test]
fn tables_are_made_of_results_also_of_those_that_were_there() {
    let (stage, _) = stage("batch-parquet");
    assert_eq!(stage.run(&all()).code, 0);
    assert_eq!(stage.run(&format!("{} --parquet", all())).code, 0);
    let table = std::fs::read(stage.path("out/day-1/a.parquet")).unwrap();
    assert!(table.starts_with(b"PAR1") && table.ends_with(b"PAR1"));
    std::fs::remove_file(stage.path("out/day-1/a.parquet")).unwrap();
    assert_eq!(stage.run(&format!("{} --parquet", all())).code, 0);
    assert_eq!(std::fs::read(stage.path("out/day-1/a.parquet")).unwrap(), table);
}
