//! A camera as a calibration finds it: by where the light of LEDs falls, not by where the chief ray would meet the image.
//!
//! Coma moves the centroid of the light away from the axis in proportion to the angle; axis coma, and a table of the point spread that has its
//! centroid beside its middle, move it everywhere alike. A calibration takes the first for focal length and the others for the principal
//! point, so none is an error of the method's.

use photinus::camera::{Camera, Ideal, Model, Pixel};
use photinus_io::dataset::TruthFrame;
use photinus_sim::optics::{Lens, PointLight};

/// The camera that is told: for a lens of the equidistant law exactly that which maps centroids, for others near the axis.
pub(crate) fn calibrated(camera: &Camera, lens: &Lens) -> Camera {
    let bent = lens.spread.aberrations();
    let Model::Ideal(ideal) = camera.model() else { return camera.clone() };
    let [u_px, v_px] = moved_px(lens, [ideal.centre().u, ideal.centre().v]);
    let focal_px = ideal.focal_px().map(|focal_px| focal_px + bent.coma_px_per_rad);
    let centre = Pixel::new(ideal.centre().u + u_px, ideal.centre().v + v_px);
    let moved = Ideal::new(ideal.law(), focal_px, centre).expect("a lens about as long as before");
    Camera::new(Model::Ideal(moved), camera.width(), camera.height(), camera.stated_limit_rad())
        .expect("a camera about as before")
}

/// Moves the LEDs of truth from chief rays to centroids.
pub(crate) fn to_centroids(truth: &mut TruthFrame, camera: &Camera, lens: &Lens) {
    let (bent, axis) = (lens.spread.aberrations(), camera.model().centre());
    for led in truth.neighbours.iter_mut().flat_map(|neighbour| &mut neighbour.leds) {
        let Some(bearing) = camera.bearing(Pixel::new(led.u_px, led.v_px)) else { continue };
        let coma_px = bent.coma_px_per_rad * bearing.off_axis_rad();
        let [out_u, out_v] = PointLight::outward([led.u_px, led.v_px], [axis.u, axis.v]);
        let [u_px, v_px] = moved_px(lens, [led.u_px, led.v_px]);
        led.u_px += coma_px * out_u + u_px;
        led.v_px += coma_px * out_v + v_px;
    }
}

/// How far a point's light is moved whatever its angle.
fn moved_px(lens: &Lens, [u_px, v_px]: [f64; 2]) -> [f64; 2] {
    let (table, axis_coma) = (lens.spread.centroid_px(u_px, v_px), lens.spread.aberrations().axis_coma_px);
    [table[0] + axis_coma[0], table[1] + axis_coma[1]]
}
