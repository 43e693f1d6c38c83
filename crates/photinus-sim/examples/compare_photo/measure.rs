//! What is measured of an image with spots: areas, sections, widths, background.

use photinus::spots::{Detector, Settings, Spot};
use photinus_io::image::GreyImage;

/// How far a section reaches to either side of a spot's centre, px, and its step.
const REACH_PX: f64 = 10.0;
const STEP_PX: f64 = 0.25;

/// What is alike in a photo and a simulated frame, or not.
pub(crate) struct Measured {
    /// Pixels of each spot.
    pub(crate) areas_px: Vec<u32>,
    /// Mean grey level of all spots along rows, by the distance from the centre, (px, level).
    pub(crate) along_rows: Vec<(f64, f64)>,
    /// The same along columns.
    pub(crate) along_columns: Vec<(f64, f64)>,
    /// Full width at half height of each spot, mean of rows and columns, px.
    pub(crate) widths_px: Vec<f64>,
    /// Share of pixels at each grey level.
    pub(crate) levels: Vec<f64>,
}

impl Measured {
    /// Finds the spots by the method's own detector, and measures.
    pub(crate) fn of(image: &GreyImage) -> Self {
        let mut detector = Detector::new(Settings::default()).expect("defaults are legal");
        let found = detector.detect(&image.view(), None).map(|found| found.spots.clone());
        let spots = found.unwrap_or_default();
        let sections = |along: (f64, f64)| -> Vec<Vec<(f64, f64)>> {
            spots.iter().map(|spot| section(image, spot, along)).collect()
        };
        let (rows, columns) = (sections((1.0, 0.0)), sections((0.0, 1.0)));
        let widths = rows.iter().zip(&columns).map(|(row, column)| 0.5 * (width_px(row) + width_px(column)));
        let mut levels = vec![0.0; 256];
        for &level in image.pixels() {
            levels[usize::from(level)] += 1.0 / image.pixels().len() as f64;
        }
        Self {
            areas_px: spots.iter().map(|spot| spot.area_px).collect(),
            widths_px: widths.collect(),
            along_rows: mean(&rows),
            along_columns: mean(&columns),
            levels,
        }
    }

    /// Mean width, px.
    pub(crate) fn width_px(&self) -> f64 {
        self.widths_px.iter().sum::<f64>() / self.widths_px.len() as f64
    }

    /// Widths of the mean spot along rows and along columns, px.
    pub(crate) fn mean_widths_px(&self) -> (f64, f64) {
        (width_px(&self.along_rows), width_px(&self.along_columns))
    }

    /// The grey level below which a share of the pixels is.
    pub(crate) fn level(&self, share: f64) -> usize {
        let mut below = 0.0;
        let is_reached = |part: &f64| {
            below += part;
            below >= share
        };
        self.levels.iter().position(is_reached).unwrap_or(255)
    }
}

/// Grey levels through a spot's centre, (px from the centre, level).
fn section(image: &GreyImage, spot: &Spot, (along_u, along_v): (f64, f64)) -> Vec<(f64, f64)> {
    let steps = (REACH_PX / STEP_PX) as i32;
    let at = |step: i32| {
        let off_px = f64::from(step) * STEP_PX;
        (off_px, level_at(image, spot.centre.u + off_px * along_u, spot.centre.v + off_px * along_v))
    };
    (-steps..=steps).map(at).collect()
}

/// The grey level between pixels, bilinear; that of the border outside.
fn level_at(image: &GreyImage, u: f64, v: f64) -> f64 {
    let (u, v) = (u.clamp(0.0, image.width() as f64 - 1.001), v.clamp(0.0, image.height() as f64 - 1.001));
    let pixel = |du: usize, dv: usize| {
        let index = (v as usize + dv).min(image.height() - 1) * image.width()
            + (u as usize + du).min(image.width() - 1);
        f64::from(image.pixels()[index])
    };
    let (right, down) = (u.fract(), v.fract());
    let row = |dv: usize| pixel(0, dv) * (1.0 - right) + pixel(1, dv) * right;
    row(0) * (1.0 - down) + row(1) * down
}

/// Full width at half height above the lower end of a section, px.
fn width_px(section: &[(f64, f64)]) -> f64 {
    let (least, most) = section.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), p| (a.min(p.1), b.max(p.1)));
    let middle = section.len() / 2;
    // from the centre outwards, so that a neighbouring spot does not count
    let half = |side: &mut dyn Iterator<Item = &(f64, f64)>| {
        side.take_while(|p| p.1 >= 0.5 * (least + most)).count()
    };
    STEP_PX * (half(&mut section[middle..].iter()) + half(&mut section[..middle].iter().rev())) as f64
}

fn mean(sections: &[Vec<(f64, f64)>]) -> Vec<(f64, f64)> {
    let count = sections.len() as f64;
    let Some(first) = sections.first() else { return Vec::new() };
    let level = |index: usize| sections.iter().map(|section| section[index].1).sum::<f64>() / count;
    first.iter().enumerate().map(|(index, (off_px, _))| (*off_px, level(index))).collect()
}
