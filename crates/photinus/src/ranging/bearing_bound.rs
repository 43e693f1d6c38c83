//! How far a marker's true direction can be from the bearing of its spot.

/// Largest bearing error of a spot, rad: paper (3), eps = k (S - 1/2).
///
/// `rad_per_px` is k, the camera's angle per pixel at the spot; `area_px` is S, the pixels of this very spot
/// or, for the bound at a distance, [`SpotCurve::max_area_px`](super::SpotCurve::max_area_px). An area of 0
/// counts as 1.
///
/// Known limitation: the paper counts pixels along a row or column, from the middle of a spot's first pixel to
/// the far edge of its last. Towards a corner of a single pixel a marker can be off by k / sqrt(2), not k / 2,
/// and a diagonal chain is longer than its count, so a spot of one or two pixels can exceed this bound.
pub fn bearing_bound_rad(rad_per_px: f64, area_px: u32) -> f64 {
    rad_per_px * (f64::from(area_px.max(1)) - 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ranging::SpotCurve;

    #[test]
    fn single_pixel_is_known_to_half_a_pixel() {
        assert!((bearing_bound_rad(3.7673e-3, 1) - 1.883_65e-3).abs() < 1e-12);
        assert!((bearing_bound_rad(3.7673e-3, 0) - 1.883_65e-3).abs() < 1e-12);
    }

    #[test]
    fn corner_of_a_single_pixel_is_farther_than_the_paper_counts() {
        let corner_px = libm::hypot(0.5, 0.5);
        assert!(bearing_bound_rad(1.0, 1) < corner_px);
    }

    #[test]
    fn papers_camera_is_under_20_mrad_past_3_m() {
        let curve = SpotCurve::paper_1000_us();
        assert!(bearing_bound_rad(3.7673e-3, curve.max_area_px(3.05)) < 0.02);
        assert!(bearing_bound_rad(3.7673e-3, curve.max_area_px(1.0)) > 0.02);
    }
}
