//! Images, masks and videos.

use std::path::{Path, PathBuf};

use photinus_io::Result;
use photinus_io::image::{ImageFile, read_image};
use photinus_io::kind;
use photinus_io::mask::read_mask;
use photinus_io::video::Y4mFrames;
use photinus_io::whole::open_regular;

use super::Report;

/// A frame of nothing but black and white with a larger share of white than spots have is a mask, %.
const LEAST_WHITE: f64 = 5.0;

pub(super) fn image(path: &Path) -> Result<Report> {
    let ImageFile { image, conversions } = read_image(path)?;
    let (width, height, pixels) = (image.width(), image.height(), image.pixels());
    let black = pixels.iter().filter(|&&pixel| pixel == 0).count();
    let white = pixels.iter().filter(|&&pixel| pixel == u8::MAX).count();
    let share = |count: usize| 100.0 * count as f64 / pixels.len() as f64;
    let is_mask = black + white == pixels.len() && black > 0 && share(white) > LEAST_WHITE;
    let mut report = Report::new(if is_mask { "a mask" } else { "an image" });
    report.fact("size", format!("{width} x {height} px"));
    if is_mask {
        report.fact("ignored", format!("{black} px, {:.1} % of the image", share(black)));
        report.notes.extend(mask_notes(path));
    } else {
        let mut sorted = pixels.to_vec();
        sorted.sort_unstable();
        let at = |share: f64| sorted[((sorted.len() - 1) as f64 * share) as usize];
        report.fact(
            "grey levels",
            format!("{} to {}, half of them up to {}, 99 % up to {}", at(0.0), at(1.0), at(0.5), at(0.99)),
        );
        report.fact("saturated", counted_px(white));
    }
    report.notes.extend(conversions.iter().map(ToString::to_string));
    Ok(report)
}

/// What is odd about a mask.
fn mask_notes(path: &Path) -> Vec<String> {
    read_mask(path).map(|file| file.notes).unwrap_or_default()
}

/// Images that lie together: how many, and whether they are of one size.
pub(super) fn folder(path: &Path) -> Result<Report> {
    let images = kind::images_in(path)?;
    let mut report = Report::new("a folder of images");
    report.fact("images", images.len().to_string());
    let mut sizes: Vec<((usize, usize), &PathBuf)> = Vec::new();
    for image in &images {
        match read_image(image) {
            Ok(file) => {
                let size = (file.image.width(), file.image.height());
                if !sizes.iter().any(|(known, _)| *known == size) {
                    sizes.push((size, image));
                }
            }
            Err(error) => report.broken(error.to_string()),
        }
    }
    let told: Vec<String> =
        sizes.iter().map(|((width, height), _)| format!("{width} x {height} px")).collect();
    report.fact("size", told.join(", "));
    if let [_, (_, other), ..] = sizes.as_slice() {
        report.broken(format!(
            "{} has another size than those before it: sort the images by camera",
            other.display()
        ));
    }
    Ok(report)
}

pub(super) fn video(path: &Path) -> Result<Report> {
    let file = open_regular(path)?;
    let mut frames = Y4mFrames::new(file, path)?;
    let mut report = Report::new("a Y4M video");
    report.fact("size", format!("{} x {} px", frames.width(), frames.height()));
    report.fact(
        "rate",
        frames.rate_hz().map_or("unknown".to_owned(), |rate| format!("{rate} frames per second")),
    );
    report.notes.extend(frames.conversions().iter().map(ToString::to_string));
    let rate_hz = frames.rate_hz();
    let (mut whole, mut last) = (0_u32, None);
    for frame in &mut frames {
        match frame {
            Ok(_) => whole += 1,
            Err(error) => last = Some(error),
        }
    }
    let duration = rate_hz.map_or(String::new(), |rate_hz| format!(", {:.2} s", f64::from(whole) / rate_hz));
    report.fact("frames", format!("{whole}{duration}"));
    if let Some(error) = last {
        report.broken(error.to_string());
    }
    if whole == 0 && !report.is_broken {
        report.broken("it holds no frame");
    }
    Ok(report)
}

pub(super) fn counted_px(count: usize) -> String {
    format!("{count} px")
}
