//! Real photos of LED grids: the optics of one half of the photos against the pixels of the other half. Skips without the data.

use std::path::PathBuf;

use photinus_calibrate::optics::{Collection, LearnError, Prediction, learn, predict};
use photinus_io::image::read_image;
use photinus_testing::real_data;

/// Every other photo of a folder, beginning with the first or the second.
fn half(folder: &str, ending: &str, first: usize) -> Option<Collection> {
    let entries = std::fs::read_dir(real_data(folder)?).expect("a folder");
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|end| end == ending));
    paths.sort();
    let mut collection = Collection::default();
    for path in paths.iter().skip(first).step_by(2) {
        assert!(collection.add(&read_image(path).expect("a photo").image.view(), None));
    }
    Some(collection)
}

/// The second half as the first expects it.
fn predicted(folder: &str, ending: &str) -> Option<Result<Prediction, LearnError>> {
    let (learned_from, tried_on) = (half(folder, ending, 0)?, half(folder, ending, 1)?);
    let learned = learn(&learned_from).map(|learned| {
        println!("{folder}: {:?}, unseen {:?}", learned.optics.sensor, learned.unseen);
        println!("  {} spots, error of shape {:.3}", learned.spots, learned.optics.spread.shape_error());
        predict(&learned.optics, &tried_on).expect("spots")
    });
    println!("{folder}: {learned:?}");
    Some(learned)
}

#[test]
fn half_of_the_photos_of_a_wide_lens_predicts_the_other() {
    let Some(prediction) = predicted("grid-960x600", "png") else { return };
    let prediction = prediction.expect("700 LEDs");
    assert!((0.7..1.4).contains(&prediction.chi_square), "{prediction:?}");
}

#[test]
fn half_of_the_photos_of_a_sharp_lens_predicts_the_other() {
    let Some(prediction) = predicted("grid-752x480", "jpg") else { return };
    let Ok(prediction) = prediction else { return };
    assert!((0.7..1.4).contains(&prediction.chi_square), "{prediction:?}");
}
