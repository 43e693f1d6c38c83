//! What to do about photos in which the grid was not found.

use photinus_calibrate::camera::LEAST_PHOTOS;
use photinus_calibrate::grid::OrderError;

use super::photos::Searched;

/// What to do about one photo.
pub(super) fn on(error: &OrderError) -> &'static str {
    match error {
        OrderError::TooFew { .. } => {
            "is the grid in the picture, lit, sharp, and not overexposed? photinus detect shows what was found"
        }
        OrderError::NoLattice { .. } | OrderError::NotSmooth { .. } => {
            "does it show the grid, without other lights? photinus detect shows what was found"
        }
        OrderError::OtherSize { .. } | OrderError::Outside { .. } => {
            "correct --grid, or bring the whole grid into the picture"
        }
        OrderError::Ambiguous { .. } => "bring the whole grid into the picture",
        OrderError::Label { .. } => "correct --grid or the labels",
        OrderError::Mirrored => {
            "count columns and rows as they are seen from the side that shines, or leave the labels out"
        }
    }
}

/// What is wrong with photos of which too few show the grid; `None` when there are enough.
pub(super) fn on_all(searched: &Searched) -> Option<String> {
    let (all, usable) = (searched.photos.len(), searched.views.len());
    if usable >= LEAST_PHOTOS {
        return None;
    }
    let sizes = searched.refused.iter().filter_map(|(_, error)| match error {
        OrderError::OtherSize { columns, rows } => Some((*columns, *rows)),
        _ => None,
    });
    let sizes: Vec<(usize, usize)> = sizes.collect();
    let count = |size: &(usize, usize)| sizes.iter().filter(|other| *other == size).count();
    if let Some(size) = sizes.iter().max_by_key(|size| count(size)).filter(|size| 2 * count(size) > all) {
        return Some(format!(
            "{} of {all} photos show a grid of {}x{}, not {}x{}: give --grid {}x{}",
            count(size),
            size.0,
            size.1,
            searched.grid.columns(),
            searched.grid.rows(),
            size.0,
            size.1
        ));
    }
    Some(format!(
        "{usable} of {all} photos show the grid: at least {LEAST_PHOTOS} are needed, and 15 or more with the grid near, far, \
         tilted and at every edge make a good calibration"
    ))
}
