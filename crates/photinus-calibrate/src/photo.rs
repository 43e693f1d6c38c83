//! A photo of the board -> its spots, and which LED each of them is.

use nalgebra::Vector2;
use photinus::frame::{FrameError, FrameView};
use photinus::spots::{Detector, Settings};

use crate::adjust::{Observation, View};
use crate::grid::{Grid, OrderError, least_leds, order};

/// A photo, as far as calibration needs it.
#[derive(Clone, Debug, PartialEq)]
pub struct Photo {
    /// What to call it in messages.
    pub name: String,
    /// Columns and rows.
    pub size_px: [usize; 2],
    /// Its spots, LEDs or not.
    pub spots: Vec<PhotoSpot>,
}

/// A spot of a photo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhotoSpot {
    /// Its centre, (u, v) in px.
    pub centre: Vector2<f64>,
    /// Its light over its height: the area of a flat spot as bright, px; `None` for a corner from elsewhere.
    pub width_px2: Option<f64>,
    /// Column and row of the LED where that is known beforehand.
    pub led: Option<[usize; 2]>,
}

/// Settings of the detector for photos of a board: LEDs may be near and wide.
pub fn board_settings() -> Settings {
    let mut settings = Settings::default();
    settings.shape.widest_px = 60.0;
    settings
}

impl Photo {
    /// The photo in `frame`, its spots found by `detector` (see [`board_settings`]).
    ///
    /// # Errors
    /// [`FrameError`] when the detector refuses the frame.
    pub fn of_frame(
        name: String,
        frame: &FrameView<'_>,
        detector: &mut Detector,
    ) -> Result<Self, FrameError> {
        let found = detector.detect(frame, None)?;
        let spot = |spot: &photinus::spots::Spot| PhotoSpot {
            centre: Vector2::new(spot.centre.u, spot.centre.v),
            width_px2: Some(spot.flux / (f64::from(spot.peak) - spot.background).max(1.0)),
            led: None,
        };
        let spots = found.spots.iter().map(spot).collect();
        Ok(Self { name, size_px: [frame.width(), frame.height()], spots })
    }

    /// Finds the grid, or takes the labels that the spots came with.
    ///
    /// # Errors
    /// [`OrderError`] when the spots cannot be taken for the grid.
    pub fn view(&self, index: usize, grid: &Grid) -> Result<View, OrderError> {
        let labelled: Option<Vec<_>> =
            self.spots.iter().map(|spot| spot.led.map(|led| (led, spot.centre))).collect();
        let observations = match labelled {
            Some(labelled) if !labelled.is_empty() => with_labels(&labelled, grid)?,
            _ => {
                let centres: Vec<_> = self.spots.iter().map(|spot| spot.centre).collect();
                order(&centres, grid)?.observations
            }
        };
        Ok(View { photo: index, observations })
    }

    /// Median width of the spots near places of the board, as a length, px; `None` where it is not known.
    pub(crate) fn spot_width_px(&self, view: &View) -> Option<f64> {
        let is_led = |spot: &&PhotoSpot| view.observations.iter().any(|seen| seen.pixel == spot.centre);
        let mut widths: Vec<f64> =
            self.spots.iter().filter(is_led).filter_map(|spot| spot.width_px2).map(f64::sqrt).collect();
        widths.sort_by(f64::total_cmp);
        widths.get(widths.len() / 2).copied()
    }
}

/// Observations from labels that came with the corners.
fn with_labels(labelled: &[([usize; 2], Vector2<f64>)], grid: &Grid) -> Result<Vec<Observation>, OrderError> {
    let mut observations: Vec<Observation> = Vec::new();
    for &([column, row], pixel) in labelled {
        let led = row * grid.columns() + column;
        let is_twice = observations.iter().any(|seen| seen.led == led);
        if column >= grid.columns() || row >= grid.rows() || is_twice {
            return Err(OrderError::Label { column, row });
        }
        observations.push(Observation { led, pixel });
    }
    let needed = least_leds(grid);
    if observations.len() < needed {
        return Err(OrderError::TooFew { found: observations.len(), needed, leds: grid.leds() });
    }
    if turning(&observations, grid) < 0.0 {
        return Err(OrderError::Mirrored);
    }
    Ok(observations)
}

/// Positive where columns, then rows turn like u, then v.
fn turning(observations: &[Observation], grid: &Grid) -> f64 {
    let at = |led: usize| observations.iter().find(|seen| seen.led == led).map(|seen| seen.pixel);
    let corner = |seen: &Observation| {
        let is_last = seen.led % grid.columns() + 1 == grid.columns();
        let (right, down) = (at(seen.led + 1).filter(|_| !is_last)?, at(seen.led + grid.columns())?);
        Some((right - seen.pixel).perp(&(down - seen.pixel)))
    };
    observations.iter().filter_map(corner).sum()
}
