//! How far a marker's true direction can be from the bearing of its spot.

/// Largest bearing error of a spot, rad: paper (3), eps = k (S - 1/2).
///
/// `rad_per_px` is k, the camera's angle per pixel at the spot; `area_px` is S, the pixels of this very spot or,
/// for the bound at a distance, [`SpotCurve::max_area_px`](super::SpotCurve::max_area_px). The formula holds
/// because any pixel of the spot, wherever the marker is in it, is at most that many pixels away in a spot one
/// pixel wide. An area of 0 counts as 1.
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
    fn papers_camera_is_under_20_mrad_past_3_m() {
        let curve = SpotCurve::paper_1000_us();
        assert!(bearing_bound_rad(3.7673e-3, curve.max_area_px(3.05)) < 0.02);
        assert!(bearing_bound_rad(3.7673e-3, curve.max_area_px(1.0)) > 0.02);
    }
}
