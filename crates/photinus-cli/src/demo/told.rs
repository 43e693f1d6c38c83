//! What was done and what came out, in lines to read.

use photinus_evaluate::Scores;
use photinus_sim::Scene;

/// The lines, without a line break at the end.
pub(super) fn lines(scene: &Scene, scores: &Scores) -> String {
    let view = &scene.cameras[0].camera;
    let robots = scene.targets.len();
    let bounds = &scores.bounds.by_range.overall;
    format!(
        "{} robots flew outdoors for {:.0} s in a breeze: one looks with a UV camera, {robots} blink, each a word of its own by six UV LEDs.\n  \
         simulated  {} frames of {}x{} at {:.0} Hz, {:.0} us each, with noise, sky and sun\n  \
         located    frame by frame, knowing camera, airframe, gravity, gyro and words: no radio\n  \
         {}\n  \
         bounds     held {} %: truth was inside in {} of {}; median width {} m",
        robots + 1,
        scene.frames as f64 / scene.rate_hz,
        scene.frames,
        view.width(),
        view.height(),
        scene.rate_hz,
        scene.exposure_us,
        told_of_tracks(scores).join("\n  "),
        number(percent(bounds.coverage), 2),
        bounds.inside,
        bounds.count,
        number(bounds.median_width_m, 2),
    )
}

/// What is known of who was followed and named.
fn told_of_tracks(scores: &Scores) -> Vec<String> {
    let named = scores.identity.as_ref().map(|identity| {
        format!(
            "named      {} s after the first light at most; {} of {} names are right, {} changed",
            number(identity.time_to_identity_s.max, 2),
            identity.correct,
            identity.identified,
            identity.switches,
        )
    });
    let followed = scores.followed.as_ref().map(|followed| {
        let all = followed.visible + followed.hidden;
        format!(
            "followed   {} of {all} times, {} of {} of them dark or hidden; {} found where nobody is\n  \
             position   {} m off in the median where LEDs show, {} m where none does",
            followed.followed + followed.hidden_followed,
            followed.hidden_followed,
            followed.hidden,
            followed.false_tracks,
            number(followed.seen_error_m.median, 3),
            number(followed.predicted_error_m.median, 3),
        )
    });
    named.into_iter().chain(followed).collect()
}

fn percent(share: Option<f64>) -> Option<f64> {
    share.map(|share| 100.0 * share)
}

/// A number with this many decimals, `-` where there is none.
fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.decimals$}"))
}
