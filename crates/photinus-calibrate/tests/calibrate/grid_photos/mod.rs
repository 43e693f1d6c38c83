//! Real photos of LED grids with the grid found in each, for the tests that need them; without the data they skip.

#![allow(dead_code, reason = "each test looks at a part")]

use std::path::PathBuf;

use photinus::spots::Detector;
use photinus_calibrate::adjust::View;
use photinus_calibrate::grid::Grid;
use photinus_calibrate::photo::{Photo, board_settings};
use photinus_io::image::{GreyImage, read_image};
use photinus_testing::real_data;

/// Photos of one camera.
pub(crate) struct Set {
    pub(crate) grid: Grid,
    pub(crate) images: Vec<GreyImage>,
    pub(crate) photos: Vec<Photo>,
    pub(crate) views: Vec<View>,
}

/// The 20 photos of a board of 7 x 5 LEDs, of a camera of 960x600.
pub(crate) fn seven_by_five() -> Option<Set> {
    set("grid-960x600", "png", 7, 5)
}

/// The 6 photos of a board of 8 x 6 LEDs, of a camera of 752x480: spots of a pixel or two.
pub(crate) fn eight_by_six() -> Option<Set> {
    set("grid-752x480", "jpg", 8, 6)
}

/// The photos of a folder of the data, with the grid found in every one; `None` where there is no data.
fn set(folder: &str, ending: &str, columns: usize, rows: usize) -> Option<Set> {
    let entries = std::fs::read_dir(real_data(folder)?).expect("a folder");
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|end| end == ending));
    paths.sort();
    let grid = Grid::new(columns, rows, 0.05).expect("a grid");
    let mut detector = Detector::new(board_settings()).expect("settings");
    let images: Vec<GreyImage> = paths.iter().map(|path| read_image(path).expect("a photo").image).collect();
    let photo = |(path, image): (&PathBuf, &GreyImage)| {
        Photo::of_frame(path.display().to_string(), &image.view(), &mut detector).expect("a frame")
    };
    let photos: Vec<Photo> = paths.iter().zip(&images).map(photo).collect();
    let view = |(index, photo): (usize, &Photo)| photo.view(index, &grid).expect("the grid");
    let views = photos.iter().enumerate().map(view).collect();
    Some(Set { grid, images, photos, views })
}
