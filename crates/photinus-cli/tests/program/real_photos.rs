//! Photos of LED grids, where this machine has them.

use photinus_io::results::read_results;
use photinus_testing::real_data;

use crate::stage::Stage;

#[test]
fn every_marker_of_a_grid_is_found() {
    let Some(photo) = real_data("grid-752x480/image_01.jpg") else { return };
    let stage = Stage::new("grid");
    let done = stage.run(&format!("detect {} --overlay seen --out s.jsonl", photo.display()));
    assert_eq!(done.code, 0);
    let record = read_results(stage.path("s.jsonl")).unwrap().next().unwrap().unwrap();
    assert_eq!(record.spots.len(), 48, "8 x 6 LEDs");
    assert!(stage.path("seen/overlay-image_01.png").is_file());
}

#[test]
fn real_files_are_told() {
    let Some(data) = real_data("") else { return };
    let stage = Stage::new("real");
    for (folder, what) in [("ocamcalib", "a camera"), ("airframes", "an airframe"), ("masks", "a mask")] {
        let files: Vec<String> = std::fs::read_dir(data.join(folder))
            .unwrap()
            .map(|entry| entry.unwrap().path().display().to_string())
            .collect();
        let done = stage.run(&format!("info {}", files.join(" ")));
        assert_eq!(
            (done.code, done.out.matches(&format!(": {what}\n")).count()),
            (0, files.len()),
            "{folder}"
        );
    }
}
