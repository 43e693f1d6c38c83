//! Images, masks, videos and datasets.

use std::path::Path;

use photinus_io::airframe::read_airframe;
use photinus_io::dataset::Dataset;
use photinus_io::image::{ImageFile, read_image};
use photinus_io::mask::read_mask;
use photinus_io::spot_curve::read_spot_curve;
use photinus_io::video::Y4mFrames;
use photinus_io::whole::open_regular;
use photinus_io::{Result, read_camera};

use super::{Report, airframe, counted};

pub(super) fn image(path: &Path) -> Result<Report> {
    let ImageFile { image, conversions } = read_image(path)?;
    let (width, height, pixels) = (image.width(), image.height(), image.pixels());
    let black = pixels.iter().filter(|&&pixel| pixel == 0).count();
    let white = pixels.iter().filter(|&&pixel| pixel == u8::MAX).count();
    let share = |count: usize| 100.0 * count as f64 / pixels.len() as f64;
    // A frame of nothing but black and white with more than spots of white is no frame of a camera.
    let is_mask = black + white == pixels.len() && black > 0 && share(white) > 20.0;
    let mut report = Report::new(if is_mask { "a mask" } else { "an image" });
    report.fact("size", format!("{width} x {height} px"));
    if is_mask {
        report.fact("ignored", format!("{black} px, {:.1} % of the image", share(black)));
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

pub(super) fn dataset(folder: &Path) -> Result<Report> {
    let dataset = Dataset::read(folder)?;
    let (info, rows) = (dataset.info(), dataset.frames());
    let mut report = Report::new("a dataset");
    let span_s = rows.last().zip(rows.first()).map_or(0.0, |(last, first)| last.time_s - first.time_s);
    report.fact("frames", format!("{} over {span_s:.2} s", rows.len()));
    report.fact(
        "camera ran at",
        format!("{} frames per second, {} us exposure", info.rate_hz, info.exposure_us),
    );
    let with_gravity = rows.iter().filter(|row| row.gravity.is_some()).count();
    report.fact("gravity", format!("known for {with_gravity} of {} frames", rows.len()));

    let camera = read_camera(&dataset.path(&info.camera));
    let size = camera.as_ref().ok().map(|file| (file.camera.width(), file.camera.height()));
    let mut part = |name: &str, told: Result<String>| match told {
        Ok(text) => report.facts.row([name.to_owned(), text]),
        Err(error) => {
            report.facts.row([name.to_owned(), "not usable".to_owned()]);
            report.broken(error.to_string());
        }
    };
    let in_px = |(width, height): (usize, usize)| format!("{width} x {height} px");
    part(
        "camera",
        camera.map(|file| {
            let size = in_px((file.camera.width(), file.camera.height()));
            format!("{}, {}, {size}", info.camera.display(), super::camera::format_name(file.format))
        }),
    );
    part(
        "airframe",
        read_airframe(dataset.path(&info.airframe))
            .map(|file| format!("{}: {}", info.airframe.display(), airframe::in_a_line(&file.airframe))),
    );
    if let Some(mask) = &info.mask {
        let told = read_mask(dataset.path(mask)).and_then(|file| {
            if let Some((width, height)) = size {
                file.check_size(width, height)?;
            }
            Ok(format!("{}: {} ignored", mask.display(), counted_px(file.mask.ignored_px())))
        });
        part("mask", told);
    }
    if let Some(curve) = &info.spot_curve {
        part("spot curve", read_spot_curve(dataset.path(curve)).map(|_| curve.display().to_string()));
    }
    let truth = dataset.truth().map(|truth| match truth {
        Some(frames) => format!("for {}", counted(frames.len(), "frame")),
        None => "none".to_owned(),
    });
    part("truth", truth);
    if let Err(error) = dataset.check_inside() {
        report.notes.push(error.advise("--allow-outside lets the other commands read it").to_string());
    }
    let images = images(&dataset, size, &mut report);
    report.fact("images", images);
    Ok(report)
}

/// How many images are there, and whether the first one fits the camera.
fn images(dataset: &Dataset, size: Option<(usize, usize)>, report: &mut Report) -> String {
    let missing: Vec<_> = dataset.frames().iter().filter(|row| !dataset.path(&row.image).is_file()).collect();
    if let Some(first) = missing.first() {
        report.broken(format!(
            "{} missing, the first is {}: restore it, or remove line {} of frames.csv",
            counted(missing.len(), "image"),
            first.image.display(),
            first.line
        ));
    }
    let first = dataset.frames().iter().find(|row| dataset.path(&row.image).is_file());
    match first.map(|row| read_image(dataset.path(&row.image))) {
        Some(Ok(file)) => {
            let (width, height) = (file.image.width(), file.image.height());
            if size.is_some_and(|size| size != (width, height)) {
                report.broken(format!(
                    "the first image is {width}x{height}, which is not the size of the camera"
                ));
            }
            format!("{}, {width} x {height} px", dataset.frames().len() - missing.len())
        }
        Some(Err(error)) => {
            report.broken(error.to_string());
            "the first one cannot be read".to_owned()
        }
        None => "none".to_owned(),
    }
}

fn counted_px(count: usize) -> String {
    format!("{count} px")
}
