//! `reproduce`: the rows of its table, the files it leaves, what it refuses.

use photinus_io::image::read_image;

use crate::stage::Stage;

/// Figures, and how many rows of the summary each has.
const ROWS: [(&str, usize); 13] = [
    ("4", 9),
    ("7", 3),
    ("8", 5),
    ("10", 10),
    ("11", 8),
    ("12", 8),
    ("13", 10),
    ("14", 11),
    ("15", 8),
    ("16", 3),
    ("17", 2),
    ("range", 12),
    ("heading", 4),
];

#[test]
fn a_quick_run_has_every_row_and_every_figure() {
    let stage = Stage::new("reproduce");
    let done = stage.run("reproduce --quick --out glance");
    assert_eq!(done.code, 0);
    let summary = stage.read("glance/summary.csv");
    let mut lines = summary.lines();
    assert_eq!(lines.next().unwrap(), "quantity,paper,reproduced,ratio,tolerance,within,note");
    let lines: Vec<&str> = lines.collect();
    for (figure, count) in ROWS {
        let is_of = |line: &&&str| line.trim_start_matches('"').starts_with(&format!("{figure}: "));
        assert_eq!(lines.iter().filter(is_of).count(), count, "rows of {figure}");
        assert!(read_image(stage.path(&format!("glance/figure-{figure}.png"))).is_ok(), "{figure}");
        assert!(stage.read(&format!("glance/figure-{figure}.svg")).contains("<svg"), "{figure}");
        assert!(stage.read(&format!("glance/figure-{figure}.csv")).lines().count() > 20, "{figure}");
    }
    assert_eq!(lines.len(), ROWS.iter().map(|row| row.1).sum::<usize>());
    assert!(!lines.iter().any(|line| line.contains(",none,")), "every number comes out:\n{summary}");
    // what does not hang on the number of frames must hold in a quick run, too
    for held in [
        "12: \"bearing errors under (3), threshold 200, share\"",
        "16: \"truth within Photinus' strict bounds, share\"",
        "8: intensity ahead of two LEDs at 120 deg (%)",
        "17: \"frames in which the neighbour is located, share\"",
        "range: \"frames with a marker at 15 m, Photinus, share\"",
    ] {
        let wanted = held.replace('"', "");
        let line = lines.iter().find(|line| line.trim_start_matches('"').starts_with(&wanted)).unwrap();
        assert!(line.contains(",yes,"), "{line}");
    }
    assert!(done.out.contains("| 10 | last spot of 2 px at 1000 us (m) | 6.62 | "));
    let page = stage.read("glance/index.html");
    assert!(page.contains("figure-17/overlay-000000.png"));
    assert!(read_image(stage.path("glance/figure-17/overlay-000000.png")).is_ok());
}

#[test]
fn figures_are_chosen_and_come_out_the_same() {
    let stage = Stage::new("reproduce-some");
    for folder in ["one", "two"] {
        let done = stage.run(&format!("reproduce 8 7 13 --quick -q --out {folder}"));
        assert_eq!((done.code, done.out.as_str()), (0, ""));
    }
    for file in ["summary.csv", "figure-7.csv", "figure-13.csv", "figure-13.svg"] {
        assert_eq!(stage.read(&format!("one/{file}")), stage.read(&format!("two/{file}")), "{file}");
    }
    assert!(!stage.path("one/figure-12.svg").exists(), "it shares its frames with 13, and was not asked for");
    let page = stage.read("one/index.html");
    for figure in ["7", "8", "13"] {
        assert!(page.contains(&format!("src=\"figure-{figure}.svg\"")), "{figure}");
    }
    assert!(!page.contains("figure-12.svg") && page.contains("<td>"), "what was asked for, with its numbers");
    let again = stage.run("reproduce 8 --out one");
    assert_eq!(again.code, 2);
    assert!(again.err.starts_with("error: one: it is there already; "), "{}", again.err);
}

#[test]
fn bad_usage() {
    let stage = Stage::new("reproduce-bad");
    let unknown = stage.run("reproduce 9 --out x");
    assert_eq!(unknown.code, 2);
    assert!(
        unknown.err.contains("choose among 4, 7, 8, 10, 11, 12, 13, 14, 15, 16, 17, range, heading"),
        "{}",
        unknown.err
    );
    assert!(!stage.path("x").exists());
    stage.file("file", "no folder");
    let file = stage.run("reproduce 8 --out file/x");
    assert_eq!(file.code, 2);
    assert!(file.err.contains("file/x") && file.err.contains("name a folder"), "{}", file.err);
    let help = stage.run("reproduce --help");
    assert!(help.out.contains("Examples:") && help.out.contains("photinus reproduce 10 11"));
}
