//! `demo`: the files it leaves, what it says.

use photinus_io::dataset::read_truth;
use photinus_io::image::read_image;
use photinus_io::results::read_results;

use crate::stage::Stage;

#[test]
fn a_demo_leaves_a_folder_to_look_at() {
    let stage = Stage::new("demo");
    let done = stage.run("demo --out seen --seconds 2");
    assert_eq!((done.code, done.out.lines().count()), (0, 8));
    assert!(done.out.contains("in 140 of 140 frames") && done.out.contains("held 100.00 %"));

    let found = read_results(stage.path("seen/results.jsonl")).unwrap();
    let found: Vec<usize> = found.map(|record| record.unwrap().neighbours.len()).collect();
    assert_eq!(found, vec![1; read_truth(stage.path("seen/truth.jsonl")).unwrap().len()]);
    assert!(stage.read("seen/figures/distance-over-time-1.svg").contains("bounds"));
    assert!(read_image(stage.path("seen/figures/distance-over-time-1.png")).is_ok());

    let page = stage.read("seen/index.html");
    let pictures = std::fs::read_dir(stage.path("seen/pictures")).unwrap();
    let names: Vec<String> =
        pictures.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    assert!(!names.is_empty());
    for name in names {
        assert!(page.contains(&format!("\"pictures/{name}\"")), "{name}");
        assert!(read_image(stage.path(&format!("seen/pictures/{name}"))).is_ok());
    }
    assert!(page.contains("held 100.00 %") && page.contains("figures/distance-over-time-1.svg"));

    let again = stage.run("demo --out seen");
    assert_eq!(again.code, 2);
    assert!(again.err.starts_with("error: seen: it is there already; "), "{}", again.err);
}
