//! What was done and what came out, in lines to read.

use photinus_evaluate::Scores;
use photinus_io::dataset::TruthFrame;
use photinus_sim::Scene;

/// The lines, without a line break at the end.
pub(super) fn lines(scene: &Scene, truth: &[TruthFrame], scores: &Scores) -> String {
    let view = &scene.cameras[0].camera;
    let (near_m, far_m) = truth
        .iter()
        .flat_map(|frame| &frame.neighbours)
        .map(|neighbour| neighbour.distance_m)
        .fold((f64::INFINITY, 0.0), |(near_m, far_m): (f64, f64), m| (near_m.min(m), far_m.max(m)));
    let (neighbours, distance) = (&scores.neighbours.by_range.overall, &scores.distance.overall);
    let bounds = &scores.bounds.by_range.overall;
    format!(
        "Two robots flew outdoors for {:.0} s in a breeze: one looks with a UV camera, one carries six UV LEDs.\n  \
         simulated  {} frames of {}x{} at {:.0} Hz, {:.0} us each, with noise, sky and sun\n  \
         located    each frame by itself, knowing camera, airframe and gravity: no radio, no track\n  \
         found      in {} of {} frames in which it can be seen ({} %), {} found where nobody is\n  \
         distance   {near_m:.1} to {far_m:.1} m; error {} m rms ({} %)\n  \
         bounds     held {} %: truth was inside in {} of {}; median width {} m",
        scene.frames as f64 / scene.rate_hz,
        scene.frames,
        view.width(),
        view.height(),
        scene.rate_hz,
        scene.exposure_us,
        neighbours.found,
        neighbours.visible,
        number(percent(neighbours.recall), 1),
        neighbours.false_neighbours,
        number(distance.error_m.rms, 2),
        number(percent(distance.relative_error.rms), 1),
        number(percent(bounds.coverage), 2),
        bounds.inside,
        bounds.count,
        number(bounds.median_width_m, 2),
    )
}

fn percent(share: Option<f64>) -> Option<f64> {
    share.map(|share| 100.0 * share)
}

/// A number with this many decimals, `-` where there is none.
fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.decimals$}"))
}
