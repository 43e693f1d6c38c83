//! What a recording from the ground says about light, focus, exposure and time.

use std::path::Path;

use photinus::spots::{Detector, Settings};
use photinus_io::dataset::Dataset;
use photinus_io::frames::{Frame, FrameSource};
use photinus_io::kind::{self, Kind};
use photinus_io::video::Y4mFrames;
use photinus_io::whole::open_regular;
use photinus_io::{Error, Result};
use photinus_link::bag::{self, Bag, BagFrames};
use photinus_link::recording::{Frames, Recording, image_topics};

use super::Findings;

/// This many frames tell enough, spread over the recording where it can be done.
const MOST: usize = 200;
/// A background whose level changes by more than this, as a share, was exposed automatically.
const STEADY: f64 = 0.25;
/// Spots this small have a centre that is known to the pixel alone.
const SHARP_PX: u32 = 1;
/// A step between frames this many times the usual one is a gap.
const GAP: f64 = 1.8;

/// What was seen in the frames.
#[derive(Default)]
struct Seen {
    frames: usize,
    sizes: Vec<(usize, usize)>,
    /// The middle level of each frame.
    levels: Vec<f64>,
    areas_px: Vec<u32>,
    saturated: usize,
    rejected: usize,
    times_s: Vec<f64>,
    with_gravity: usize,
    converted: Option<String>,
}

pub(super) fn examined(path: &Path, kind: Kind, size: Option<(usize, usize)>) -> Result<Findings> {
    let seen = seen(frames(path, kind)?, path)?;
    let mut findings = Findings::default();
    light(&seen, &mut findings);
    spots(&seen, &mut findings);
    time(&seen, kind, &mut findings);
    if let ([found, ..], Some(size)) = (seen.sizes.as_slice(), size) {
        findings.check(
            *found == size,
            "of the camera's size",
            format!(
                "frames are {}x{}, the camera {}x{}: record at the size of the calibration",
                found.0, found.1, size.0, size.1
            ),
        );
    }
    findings.doubts.extend(
        seen.converted.map(|conversion| format!("{conversion}: record 8-bit grey, as the sensor gives it")),
    );
    Ok(findings)
}

fn frames(path: &Path, kind: Kind) -> Result<Box<dyn Iterator<Item = Result<Frame>>>> {
    Ok(match kind {
        Kind::Dataset => Box::new(FrameSource::dataset(Dataset::read(path)?)),
        Kind::ImageFolder => Box::new(FrameSource::images(spread(kind::images_in(path)?))),
        // Of several cameras the first, as of a dataset.
        Kind::Recording => {
            let first = image_topics(&Recording::open(path)?).into_iter().next();
            Box::new(Frames::open(path, first.as_ref().map(|topic| topic.name.as_str()))?)
        }
        Kind::Bag => {
            let first = bag::image_topics(&Bag::open(path)?).into_iter().next();
            Box::new(BagFrames::open(path, first.as_ref().map(|topic| topic.name.as_str()))?)
        }
        Kind::Video => {
            let file = open_regular(path)?;
            // A header that is wrong is told with its file.
            drop(Y4mFrames::new(&file, path)?);
            Box::new(FrameSource::y4m(open_regular(path)?, path)?)
        }
        _ => Box::new(FrameSource::images(vec![path.to_owned()])),
    })
}

/// No more than are looked at, evenly from the first to the last.
fn spread<T>(all: Vec<T>) -> Vec<T> {
    let step = all.len().div_ceil(MOST).max(1);
    all.into_iter().step_by(step).collect()
}

fn seen(frames: impl Iterator<Item = Result<Frame>>, path: &Path) -> Result<Seen> {
    let mut detector =
        Detector::new(Settings::default()).map_err(|error| Error::format(path, error.to_string()))?;
    let mut seen = Seen::default();
    for frame in frames.take(MOST) {
        let frame = frame?;
        let image = frame.image.view();
        let size = (image.width(), image.height());
        if !seen.sizes.contains(&size) {
            seen.sizes.push(size);
        }
        let mut sorted = frame.image.pixels().to_vec();
        let middle = sorted.len() / 2;
        seen.levels.push(f64::from(*sorted.select_nth_unstable(middle).1));
        let found = detector.detect(&image, None).map_err(|error| Error::new(path, error))?;
        seen.areas_px.extend(found.spots.iter().map(|spot| spot.area_px));
        seen.saturated += found.spots.iter().filter(|spot| spot.saturated_px > 0).count();
        seen.rejected += found.rejected.len();
        seen.times_s.extend(frame.time_s);
        seen.with_gravity += usize::from(frame.gravity.is_some());
        seen.converted = seen.converted.or_else(|| frame.conversions.first().map(ToString::to_string));
        seen.frames += 1;
    }
    if seen.frames == 0 {
        return Err(Error::format(path, "it holds no frame").advise("name a recording made on the ground"));
    }
    Ok(seen)
}

fn light(seen: &Seen, findings: &mut Findings) {
    let mean = seen.levels.iter().sum::<f64>() / seen.frames as f64;
    findings.check(
        mean < 60.0,
        format!("background of {mean:.0} grey levels"),
        format!("background of {mean:.0} grey levels: the filter lets daylight in, or the exposure is long; markers are lost in it"),
    );
    let (least, most) = seen
        .levels
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(least, most), &level| (least.min(level), most.max(level)));
    if seen.frames > 1 {
        findings.check(
            most - least <= STEADY * mean + 2.0,
            "the exposure looks fixed",
            format!(
                "the background goes from {least:.0} to {most:.0} grey levels: fix exposure and gain, or the size of spots says \
                 nothing about distance"
            ),
        );
    }
}

fn spots(seen: &Seen, findings: &mut Findings) {
    let count = seen.areas_px.len();
    if count == 0 {
        let doubt = "no spot in any frame: are the LEDs lit, and in sight? a longer exposure shows more";
        return findings.doubts.push(doubt.to_owned());
    }
    let share = |part: usize| 100 * part / count;
    let sharp = share(seen.areas_px.iter().filter(|&&area_px| area_px <= SHARP_PX).count());
    findings.check(
        sharp < 50,
        format!("{count} spots, {sharp} % of them a single pixel"),
        format!("{sharp} % of the {count} spots are a single pixel, whose centre is known to a third of a pixel: focus a little softer, or come nearer"),
    );
    let saturated = share(seen.saturated);
    findings.check(
        saturated < 80,
        format!("{saturated} % of the spots are saturated"),
        format!("{saturated} % of the spots are saturated, which hides their light: a shorter exposure or less gain"),
    );
    findings.check(
        seen.rejected <= count,
        "fewer regions are rejected than taken for markers",
        format!(
            "{} regions are rejected beside {count} spots: look at them with `photinus detect --overlay`, and mask what is the \
             robot's own",
            seen.rejected
        ),
    );
}

fn time(seen: &Seen, kind: Kind, findings: &mut Findings) {
    let mut steps_s: Vec<f64> = seen.times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps_s.is_empty() {
        return;
    }
    steps_s.sort_by(f64::total_cmp);
    let usual_s = steps_s[steps_s.len() / 2];
    let gaps = steps_s.iter().filter(|&&step_s| step_s > GAP * usual_s).count();
    findings.check(
        gaps == 0,
        format!("frames come every {:.1} ms, without gaps", 1e3 * usual_s),
        format!(
            "{gaps} gaps between frames, which come every {:.1} ms: the recorder loses frames",
            1e3 * usual_s
        ),
    );
    if matches!(kind, Kind::Dataset | Kind::Recording) {
        findings.check(
            seen.with_gravity == seen.frames,
            "gravity is known in every frame",
            format!(
                "gravity is known in {} of {} frames: bounds are wider without it, and reflections are harder to tell",
                seen.with_gravity, seen.frames
            ),
        );
    }
}
