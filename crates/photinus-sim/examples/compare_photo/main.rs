//! A photo and a simulated frame: what is alike in numbers, and side by side.
//!
//! `cargo run --release -p photinus-sim --example compare_photo -- PHOTO SCENE [DIR]` prints histograms of spot areas and of
//! background levels of both. Into DIR, which is made, it writes side-by-side.png (photo left), simulated.png, and
//! photo-and-simulated.svg: sections through spots, their widths, the background.

#![allow(clippy::print_stdout, reason = "a program that reports")]

mod measure;
mod plots;

use std::path::Path;
use std::process::ExitCode;

use measure::Measured;
use photinus_io::image::{GreyImage, read_image, write_png};
use photinus_io::{Error, Result};
use photinus_sim::{Scene, Simulator};

/// Upper ends of the classes of spot areas, px.
const AREAS_PX: [u32; 8] = [1, 2, 4, 16, 24, 32, 48, 64];
/// Shares of pixels below which a background level is given.
const SHARES: [f64; 5] = [0.01, 0.1, 0.5, 0.9, 0.99];

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [photo, scene, folder @ ..] = words.as_slice() else {
        println!("give a photo, a scene, and a folder for pictures");
        return ExitCode::from(2);
    };
    match compare(photo.as_ref(), scene.as_ref(), folder.first().map(Path::new)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            println!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn compare(photo: &Path, scene: &Path, folder: Option<&Path>) -> Result<()> {
    let photo_image = read_image(photo)?.image;
    let scene_read = Scene::read(scene)?;
    let Some(mut simulator) = Simulator::new(&scene_read, 0) else {
        return Err(Error::format(scene, "it has no camera"));
    };
    let frame = simulator.frame(0).image;
    let both = [Measured::of(&photo_image), Measured::of(&frame)];
    print_table(&both);
    let Some(folder) = folder else { return Ok(()) };
    std::fs::create_dir_all(folder).map_err(|error| Error::io(folder, error))?;
    write_png(folder.join("side-by-side.png"), &side_by_side(&photo_image, &frame, folder)?.view())?;
    write_png(folder.join("simulated.png"), &frame.view())?;
    plots::save(folder, &both[0], &both[1])
}

fn print_table(both: &[Measured; 2]) {
    let row = |label: &str, cell: &dyn Fn(&Measured) -> String| {
        println!("| {label} | {} |", both.each_ref().map(cell).join(" | "));
    };
    println!("| | photo | simulated |\n|---|---|---|");
    row("spots", &|measured| measured.areas_px.len().to_string());
    for (index, most) in AREAS_PX.iter().enumerate() {
        row(&format!("of up to {most} px"), &|measured| class(&measured.areas_px, index).to_string());
    }
    row("mean width at half height", &|measured| format!("{:.2} px", measured.width_px()));
    row("width of the mean spot, along rows and along columns", &|measured| {
        let (across, down) = measured.mean_widths_px();
        format!("{across:.2} px, {down:.2} px")
    });
    for share in SHARES {
        row(&format!("level below which are {:.0} % of the pixels", 100.0 * share), &|measured| {
            measured.level(share).to_string()
        });
    }
}

/// Both in one picture; `folder` is for the messages.
fn side_by_side(photo: &GreyImage, frame: &GreyImage, folder: &Path) -> Result<GreyImage> {
    let (width, height) = (photo.width() + frame.width(), photo.height().max(frame.height()));
    let mut pixels = vec![0; width * height];
    for (image, left) in [(photo, 0), (frame, photo.width())] {
        for (v, row) in image.pixels().chunks_exact(image.width()).enumerate() {
            pixels[v * width + left..][..image.width()].copy_from_slice(row);
        }
    }
    GreyImage::new(pixels, width, height).map_err(|error| Error::new(folder, error))
}

fn class(areas: &[u32], index: usize) -> usize {
    let above = index.checked_sub(1).map_or(0, |before| AREAS_PX[before]);
    areas.iter().filter(|area| **area > above && **area <= AREAS_PX[index]).count()
}
