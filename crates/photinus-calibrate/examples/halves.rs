//! Photos of a 7x5 grid: how calibrations from random halves and small random subsets of them come out.
//!
//! ```text
//! cargo run --release -p photinus-calibrate --example halves -- photos/*.png
//! ```

#![allow(clippy::print_stdout, reason = "a program that reports")]

use photinus::spots::Detector;
use photinus_calibrate::adjust::View;
use photinus_calibrate::camera::{BoardChoice, Choices, Summary, calibrate};
use photinus_calibrate::grid::Grid;
use photinus_calibrate::lens::LensModel;
use photinus_calibrate::photo::{Photo, board_settings};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng as _, SeedableRng as _};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let grid = Grid::new(7, 5, 0.05)?;
    let mut detector = Detector::new(board_settings())?;
    let (mut views, mut size_px) = (Vec::new(), [0, 0]);
    for (index, path) in std::env::args().skip(1).enumerate() {
        let image = photinus_io::image::read_image(&path)?.image;
        let photo = Photo::of_frame(path, &image.view(), &mut detector)?;
        size_px = photo.size_px;
        views.push(photo.view(index, &grid)?);
    }
    let model = LensModel::kannala_brandt(2).ok_or("two terms")?;
    let solve = Choices { models: vec![model], board: BoardChoice::Solve };
    let calibration = calibrate(&views, &grid, size_px, &solve, |_| ())?;
    let mut held_out = Vec::new();
    for repeat in 0..20 {
        for half in calibration.split(repeat).halves {
            held_out.push(half.map_or(f64::NAN, |half| half.held_out.mean_px));
        }
    }
    held_out.sort_by(f64::total_cmp);
    println!("held out, 40 halves, px: {held_out:.4?}");
    let lenses: Vec<_> = (0..100).filter_map(|repeat| calibration.resampled(repeat)).collect();
    let rings = |rings: Vec<photinus_calibrate::camera::Ring>| -> Vec<f64> {
        rings.iter().map(|ring| 1e3 * ring.rms_rad).collect()
    };
    let field = calibration.field();
    println!("bootstrap, mrad: {:.3?}", rings(field.scatter(calibration.lens(), &lenses)));
    println!(
        "claimed, mrad:   {:.3?} inflation {:?}",
        rings(field.claimed(calibration.camera())),
        calibration.inflation()
    );

    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut worst = 0.0_f64;
    for _ in 0..100 {
        let count = 8 + (rng.next_u64() % 5) as usize;
        let mut subset: Vec<View> = views.clone();
        while subset.len() > count {
            subset.remove((rng.next_u64() % subset.len() as u64) as usize);
        }
        let flat = Choices { models: vec![model], board: BoardChoice::Flat };
        match calibrate(&subset, &grid, size_px, &flat, |_| ()) {
            Ok(calibration) => {
                let lengths = calibration.residuals().into_iter().map(|residual| residual.off_px.norm());
                let photos = calibration.views().len();
                let mean_px = Summary::of(lengths).mean_px;
                worst = worst.max(mean_px);
                if mean_px > 0.3 || photos < count {
                    println!("{count} photos: {mean_px:.3} px with {photos}");
                }
            }
            Err(error) => println!("{count} photos: {error}"),
        }
    }
    println!("from no guess, 100 subsets: worst mean {worst:.3} px");
    Ok(())
}
