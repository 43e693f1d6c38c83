//! The point spread all over the image: a grid of zones.

use alloc::vec;
use alloc::vec::Vec;

use super::{OpticsError, PointSpread, SourceSize, check};
use crate::camera::Pixel;

/// Point spreads of a grid of zones that share the image evenly.
#[derive(Clone, Debug, PartialEq)]
pub struct SpreadField {
    columns: usize,
    rows: usize,
    zones: Vec<PointSpread>,
    per_zone: [f64; 2],
    shape_error: f64,
    wings_error: f64,
    unknown_below: f64,
    place_error_px: f64,
    source_size: SourceSize,
}

impl SpreadField {
    /// The same spread all over the image, wrong by `shape_error` of the light in a pixel (its standard deviation).
    ///
    /// # Errors
    /// [`OpticsError`] for an error that is not 0 to 1.
    pub fn even(spread: PointSpread, shape_error: f64) -> Result<Self, OpticsError> {
        Self::new(vec![spread], 1, 1.0, 1.0, shape_error)
    }

    /// A grid of zones, row by row, over an image of `width_px` by `height_px`.
    ///
    /// # Errors
    /// [`OpticsError`] when zones do not fill their rows, or for an error that is not 0 to 1.
    pub fn new(
        zones: Vec<PointSpread>,
        columns: usize,
        width_px: f64,
        height_px: f64,
        shape_error: f64,
    ) -> Result<Self, OpticsError> {
        let columns = columns.max(1);
        let rows = zones.len().div_ceil(columns).max(1);
        if zones.len() != rows * columns {
            return Err(OpticsError::Samples { samples: zones.len(), needed: rows * columns });
        }
        let is_legal = (0.0..=1.0).contains(&shape_error);
        check("the error of the point spread", shape_error, is_legal, "a share, 0 to 1")?;
        let per_zone = [columns as f64 / width_px, rows as f64 / height_px];
        Ok(Self {
            columns,
            rows,
            zones,
            per_zone,
            shape_error,
            wings_error: shape_error,
            unknown_below: 0.0,
            place_error_px: 0.0,
            source_size: SourceSize::UNKNOWN,
        })
    }

    /// The same, wrong by `wings_error` of the light in a pixel beside the summit: fewer spots tell what is there.
    ///
    /// # Errors
    /// [`OpticsError`] for an error that is not 0 to 1.
    pub fn with_wings_error(self, wings_error: f64) -> Result<Self, OpticsError> {
        let is_legal = (0.0..=1.0).contains(&wings_error);
        check("the error of the point spread's wings", wings_error, is_legal, "a share, 0 to 1")?;
        Ok(Self { wings_error, ..self })
    }

    /// The same, of which pixels with less than this share of a spot's light say nothing: beside the summit the error of a pixel's light over that light has the
    /// square `wings_error`^2 + `unknown_below` / share.
    ///
    /// # Errors
    /// [`OpticsError`] for a share that is not 0 to 1.
    pub fn with_unknown_below(self, unknown_below: f64) -> Result<Self, OpticsError> {
        let is_legal = (0.0..=1.0).contains(&unknown_below);
        check("the share of light below which nothing is known", unknown_below, is_legal, "a share, 0 to 1")?;
        Ok(Self { unknown_below, ..self })
    }

    /// The same, which places spots wrong by this (standard deviation along an axis), depending on where in a pixel they are: a bent point spread with uneven places
    /// explains spots as well as a straight one.
    ///
    /// # Errors
    /// [`OpticsError`] for an error that is not 0 px to 1 px.
    pub fn with_place_error_px(self, place_error_px: f64) -> Result<Self, OpticsError> {
        let is_legal = (0.0..=1.0).contains(&place_error_px);
        check("the error of places", place_error_px, is_legal, "0 px to 1 px")?;
        Ok(Self { place_error_px, ..self })
    }

    /// The same, learnt from sources of this size.
    ///
    /// # Errors
    /// [`OpticsError`] for numbers that no source has.
    pub fn with_source_size(self, source_size: SourceSize) -> Result<Self, OpticsError> {
        source_size.check()?;
        Ok(Self { source_size, ..self })
    }

    /// The spread at a place.
    pub fn at(&self, place: Pixel) -> &PointSpread {
        let index =
            |px: f64, per_px: f64, count: usize| (((px + 0.5) * per_px).max(0.0) as usize).min(count - 1);
        let column = index(place.u, self.per_zone[0], self.columns);
        let row = index(place.v, self.per_zone[1], self.rows);
        &self.zones[row * self.columns + column]
    }

    /// The zones, row by row.
    pub fn zones(&self) -> &[PointSpread] {
        &self.zones
    }

    /// Zones per row.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// How wrong the spread is: standard deviation of a pixel's light over that light.
    pub fn shape_error(&self) -> f64 {
        self.shape_error
    }

    /// How wrong it is beside its summit, where all of a saturated spot that can be seen lies.
    pub fn wings_error(&self) -> f64 {
        self.wings_error
    }

    /// Pixels with less than this share of a spot's light say nothing of a saturated one.
    pub fn unknown_below(&self) -> f64 {
        self.unknown_below
    }

    /// How far off it places spots, depending on where in a pixel they are, px (standard deviation along an axis).
    pub fn place_error_px(&self) -> f64 {
        self.place_error_px
    }

    /// How wide sources are, beyond those that it was learnt from.
    pub fn source_size(&self) -> &SourceSize {
        &self.source_size
    }
}
