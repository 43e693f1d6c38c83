//! `demo`: the files it leaves, what it says.

use photinus_io::dataset::read_truth;
use photinus_io::image::read_image;
use photinus_io::results::read_results;

use crate::stage::Stage;

#[test]
fn a_demo_leaves_a_folder_to_look_at() {
    let stage = Stage::new("demo");
    let done = stage.run("demo --out seen --seconds 2");
    assert_eq!((done.code, done.out.lines().count()), (0, 9));
    assert!(done.out.contains(" 0 changed") && done.out.contains(" 0 found where nobody is"), "{}", done.out);
    assert!(done.out.contains("held 100.00 %"));

    let truth = read_truth(stage.path("seen/truth.jsonl")).unwrap();
    let found: Vec<_> = read_results(stage.path("seen/results.jsonl")).unwrap().map(Result::unwrap).collect();
    assert_eq!((truth.len(), found.len()), (120, 120));
    let ids: Vec<Option<u32>> = found[119].tracks.iter().map(|track| track.id).collect();
    assert!(
        truth[119].neighbours.iter().all(|there| ids.contains(&Some(there.id))) && ids.len() == 4,
        "{ids:?}"
    );
    // The words leave frames in which somebody is dark: a track goes on.
    assert!(found[60..].iter().any(|record| record.tracks.iter().any(|track| track.predicted)));
    for figure in ["distance-over-time-1", "distance-over-time-4"] {
        assert!(stage.read(&format!("seen/figures/{figure}.svg")).contains("bounds"));
        assert!(read_image(stage.path(&format!("seen/figures/{figure}.png"))).is_ok());
    }

    let page = stage.read("seen/index.html");
    let pictures = std::fs::read_dir(stage.path("seen/pictures")).unwrap();
    let names: Vec<String> =
        pictures.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    assert_eq!(names.len(), 4, "two a second");
    for name in names {
        assert!(page.contains(&format!("\"pictures/{name}\"")), "{name}");
        assert!(read_image(stage.path(&format!("seen/pictures/{name}"))).is_ok());
    }
    assert!(page.contains("held 100.00 %") && page.contains("figures/distance-over-time-1.svg"));

    let again = stage.run("demo --out seen");
    assert_eq!(again.code, 2);
    assert!(again.err.starts_with("error: seen: it is there already; "), "{}", again.err);
}
