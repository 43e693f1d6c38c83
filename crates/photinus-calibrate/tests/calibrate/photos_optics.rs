//! Real photos of LED grids: the optics of one half of the photos against the pixels of the other half. Skips without the data.

#![allow(clippy::print_stderr, reason = "what is reached is to be seen with --nocapture")]

use std::path::PathBuf;

use photinus_calibrate::optics::{Collection, LearnError, Prediction, learn, predict};
use photinus_io::image::read_image;
use photinus_testing::real_data;

/// The photos of a folder.
fn photos(folder: &str, ending: &str) -> Option<Vec<PathBuf>> {
    let entries = std::fs::read_dir(real_data(folder)?).expect("a folder");
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|end| end == ending));
    paths.sort();
    Some(paths)
}

fn collected<'a>(paths: impl Iterator<Item = &'a PathBuf>) -> Collection {
    let mut collection = Collection::default();
    for path in paths {
        assert!(collection.add(&read_image(path).expect("a photo").image.view(), None));
    }
    collection
}

/// Every other photo of a folder, beginning with the first or the second.
fn half(folder: &str, ending: &str, first: usize) -> Option<Collection> {
    Some(collected(photos(folder, ending)?.iter().skip(first).step_by(2)))
}

/// The second half as the first expects it.
fn predicted(folder: &str, ending: &str) -> Option<Result<Prediction, LearnError>> {
    let (learned_from, tried_on) = (half(folder, ending, 0)?, half(folder, ending, 1)?);
    let learned = learn(&learned_from).map(|learned| {
        let error = learned.optics.spread.shape_error();
        eprintln!("{folder}: {} spots, error of shape {error:.3}, {:?}", learned.spots, learned.unseen);
        predict(&learned.optics, &tried_on).expect("spots")
    });
    eprintln!("{folder}: {learned:?}");
    Some(learned)
}

#[test]
fn half_of_the_photos_of_a_wide_lens_predicts_the_other() {
    let Some(prediction) = predicted("grid-960x600", "png") else { return };
    let prediction = prediction.expect("700 LEDs");
    assert!((0.8..1.1).contains(&prediction.chi_square), "{prediction:?}");
}

/// Six photos of LEDs that stand near each other, black clipped, as JPEG: the fewest spots that make optics, wrong by a third of
/// the light and known to be: what is claimed is too wide, not too narrow.
#[test]
fn half_of_the_photos_of_a_sharp_lens_predicts_the_other() {
    let Some(prediction) = predicted("grid-752x480", "jpg") else { return };
    let prediction = prediction.expect("100 LEDs");
    assert!((0.4..1.1).contains(&prediction.chi_square), "{prediction:?}");
}

/// All of them, in whatever order: how wrong the shape is must not hang on a few spots.
#[test]
fn all_photos_of_a_sharp_lens_tell_how_wrong_its_shape_is() {
    let Some(paths) = photos("grid-752x480", "jpg") else { return };
    let in_turn = paths.iter().step_by(2).chain(paths.iter().skip(1).step_by(2));
    for all in [collected(paths.iter()), collected(in_turn)] {
        let learned = learn(&all).expect("200 LEDs");
        let prediction = predict(&learned.optics, &all).expect("spots");
        let (error, sigma) = (learned.optics.spread.shape_error(), learned.shape_error_sigma);
        eprintln!("all: error of shape {error:.3} +- {sigma:.3}, {prediction:?}");
        assert!(error < 0.6 && sigma < 0.5 * error, "{error} +- {sigma}");
        assert!((0.5..1.2).contains(&prediction.chi_square), "{prediction:?}");
    }
}
