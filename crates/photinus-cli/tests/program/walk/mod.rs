//! A newcomer's walk: every example of the README and of the help, as it stands there, with files of the names that it names.

mod files;

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::stage::Stage;
use files::Store;

/// Commands whose examples are walked; the empty one is the program itself.
const COMMANDS: [&str; 26] = [
    "",
    "locate",
    "detect",
    "info",
    "doctor",
    "convert",
    "inject",
    "evaluate",
    "completions",
    "run",
    "recover",
    "plan",
    "simulate",
    "swarm",
    "reproduce",
    "codes check",
    "codes design",
    "codes preset",
    "calibrate camera",
    "calibrate coverage",
    "calibrate optics",
    "calibrate mask",
    "calibrate spot-size",
    "calibrate mounting",
    "calibrate airframe",
    "calibrate airframe-light",
];

/// Examples that take minutes, each with what is run in its place elsewhere.
const LEFT_OUT: [(&str, &str); 7] = [
    ("photinus demo", "demo.rs runs it"),
    ("photinus reproduce", "reproduce.rs runs every figure with --quick"),
    ("photinus reproduce 10 11 --out spots", "as above"),
    ("photinus reproduce range heading --out more", "as above"),
    ("photinus reproduce --quick --out glance", "reproduce.rs runs it, to the word"),
    ("photinus swarm three --perception rendered --out three", "swarm.rs renders a shorter flight"),
    (
        "photinus codes design --length 18 --distance 5 --longest-run 4 --duty 0.4..0.6 --effort 10 --out book.txt",
        "codes.rs searches for less",
    ),
];

/// Programs of others that examples call, as functions of the shell that stand in for them: what is tried is Photinus.
const OTHERS: &str = "ffmpeg() { cat video.y4m; }; jq() { grep overall >/dev/null; }";

/// Options and commands whose next word is written to.
const WRITES: [&str; 9] =
    ["--out", "--out-dir", "--csv", "--overlay", "--json", "--plots", "--report", "--ocam", ">"];

/// The examples of a help, each in one line.
fn examples(help: &str) -> Vec<String> {
    let (_, rest) = help.split_once("Examples:\n").unwrap();
    let block = rest.split("\n\n").next().unwrap();
    let joined = block.replace(" \\\n", " ").replace(" |\n", " | ");
    let lines = joined.lines().map(str::trim).filter(|line| !line.starts_with('#'));
    lines.map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect()
}

/// The commands of the README's blocks.
fn of_readme() -> Vec<String> {
    let blocks = include_str!("../../../../../README.md").split("```sh\n").skip(1);
    let lines = blocks.flat_map(|rest| rest.split("```").next().unwrap_or_default().lines());
    let commands = lines.map(|line| line.replace("cargo run --release -- ", "photinus "));
    commands.filter(|line| line.starts_with("photinus ")).collect()
}

/// What an example writes.
fn written(example: &str) -> BTreeSet<String> {
    let words: Vec<&str> = example.split(' ').collect();
    let mut written: BTreeSet<String> = words
        .windows(2)
        .filter(|pair| WRITES.contains(&pair[0]) && pair[1] != ">" && !example.contains("--resume"))
        .map(|pair| pair[1].replace("~/", ""))
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
    let of_help =
        COMMANDS.iter().flat_map(|command| examples(&help.run(format!("{command} --help").trim()).out));
    let all: BTreeSet<String> = of_readme().into_iter().chain(of_help).collect();
    for (left_out, reason) in LEFT_OUT {
        assert!(all.contains(left_out), "`{left_out}` is no example any more ({reason})");
    }
    let is_walked = |example: &&String| LEFT_OUT.iter().all(|(left_out, _)| left_out != example);
    let walked: Vec<&String> = all.iter().filter(is_walked).collect();
    assert!(walked.len() >= 66, "{}", walked.len());
    let (store, next) = (Store::new(), AtomicUsize::new(0));
    std::thread::scope(|scope| {
        // Most examples keep one processor busy.
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                loop {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    let Some(example) = walked.get(number) else { break };
                    walk(&store, number, example);
                }
            });
        }
    });
}

/// Runs an example, which must come through and leave what it says.
fn walk(store: &Store, number: usize, example: &str) {
    let stage = Stage::new(&format!("walk-{number}"));
    store.provide(&stage, example, &written(example));
    let done =
        stage.shell(&format!("HOME=$PWD; photinus() {{ \"$photinus\" \"$@\"; }}; {OTHERS}; {example}"));
    assert_eq!(done.code, 0, "{example}\n{}{}", done.out, done.err);
    for name in written(example).iter().filter(|name| *name != "-") {
        assert!(stage.path(name).exists(), "{example} leaves no {name}");
    }
}
