//! A photo and a simulated frame: what is alike in numbers, and side by side.
//!
//! `cargo run --release -p photinus-sim --example compare_photo -- PHOTO SCENE [PICTURE.png]` prints histograms of spot areas and of
//! background levels of both, and writes the picture, photo left.

#![allow(clippy::print_stdout, reason = "a program that reports")]

use std::path::Path;
use std::process::ExitCode;

use photinus::spots::{Detector, Settings};
use photinus_io::image::{GreyImage, read_image, write_png};
use photinus_io::{Error, Result};
use photinus_sim::{Scene, Simulator};

/// Upper ends of the classes of spot areas, px.
const AREAS_PX: [u32; 8] = [1, 2, 4, 16, 24, 32, 48, 64];
/// Shares of pixels below which a background level is given.
const SHARES: [f64; 5] = [0.01, 0.1, 0.5, 0.9, 0.99];

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [photo, scene, picture @ ..] = words.as_slice() else {
        println!("give a photo, a scene, and where to write the picture");
        return ExitCode::from(2);
    };
    match compare(photo.as_ref(), scene.as_ref(), picture.first().map(Path::new)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            println!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn compare(photo: &Path, scene: &Path, picture: Option<&Path>) -> Result<()> {
    let photo_image = read_image(photo)?.image;
    let scene_read = Scene::read(scene)?;
    let Some(mut simulator) = Simulator::new(&scene_read, 0) else {
        return Err(Error::format(scene, "it has no camera"));
    };
    let frame = simulator.frame(0).image;
    let columns = [("photo", areas(&photo_image)), ("simulated", areas(&frame))];
    println!("| spots | {} |\n|---|---|---|", columns.each_ref().map(|column| column.0).join(" | "));
    for (index, most) in AREAS_PX.iter().enumerate() {
        let counts = columns.each_ref().map(|(_, areas)| class(areas, index).to_string());
        println!("| up to {most} px | {} |", counts.join(" | "));
    }
    println!("\n| pixels below | {} |\n|---|---|---|", columns.each_ref().map(|column| column.0).join(" | "));
    for share in SHARES {
        let levels = [&photo_image, &frame].map(|image| level(image, share).to_string());
        println!("| {:.0} % | {} |", 100.0 * share, levels.join(" | "));
    }
    if let Some(picture) = picture {
        let (width, height) = (photo_image.width() + frame.width(), photo_image.height().max(frame.height()));
        let mut pixels = vec![0; width * height];
        for (image, left) in [(&photo_image, 0), (&frame, photo_image.width())] {
            for (v, row) in image.pixels().chunks_exact(image.width()).enumerate() {
                pixels[v * width + left..][..image.width()].copy_from_slice(row);
            }
        }
        let both = GreyImage::new(pixels, width, height).map_err(|error| Error::new(picture, error))?;
        write_png(picture, &both.view())?;
    }
    Ok(())
}

/// Areas of the spots that the method's own detector finds, px.
fn areas(image: &GreyImage) -> Vec<u32> {
    let mut detector = Detector::new(Settings::default()).expect("defaults are legal");
    let found = detector.detect(&image.view(), None);
    found.map_or_else(|_| Vec::new(), |found| found.spots.iter().map(|spot| spot.area_px).collect())
}

fn class(areas: &[u32], index: usize) -> usize {
    let above = index.checked_sub(1).map_or(0, |before| AREAS_PX[before]);
    areas.iter().filter(|area| **area > above && **area <= AREAS_PX[index]).count()
}

fn level(image: &GreyImage, share: f64) -> u8 {
    let mut pixels = image.pixels().to_vec();
    let at = ((pixels.len() - 1) as f64 * share) as usize;
    *pixels.select_nth_unstable(at).1
}
