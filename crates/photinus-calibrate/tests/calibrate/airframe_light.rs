//! Rendered flights: learned lobes and powers take away the bias of distance that a wrong airframe file makes.

use crate::flight::{Built, distances, distances_after, known, learn, powers_off};
use photinus::locator::Settings;

/// LEDs as narrow as cos^3, with powers that spread by 20 %, told as equal cosines.
fn built(seed: u64) -> Built {
    Built { airframe: "hexarotor-0.4", cosine_power: 3.0, spread: 0.2, misplaced_m: 0.0, seed }
}

#[test]
fn distances_in_other_frames_lose_their_bias() {
    let built = built(20_261);
    let scene = built.flight(400);
    let told = &scene.targets[0].airframe;
    let light = learn(&scene);
    let cosine = light.lobes[0].cosine_power.expect("a lobe that was seen");
    assert!((cosine.value - 3.0).abs() < 0.15 && cosine.sigma < 0.05, "{cosine:?}");
    assert!(powers_off(&light, &built).0 < 0.05, "{:?}", light.powers);

    let others = built.other_frames(150);
    // Until three markers show together, after some 110 frames, two explain as well wrong lobes as another distance.
    let before = distances_after(150, &built.other_frames(1500), told, Settings::default());
    let after = distances(&others, &light.airframe, known(&light));
    let truth = distances(&others, &built.as_built(told), known(&light));
    // Wrong lobes make distances several times as uncertain, which is told; right ones do not.
    assert!(before.frames > 1300 && before.rms > 2.0 * after.rms, "{before:?} {after:?}");
    assert!(before.nees < 1.5, "{before:?} {after:?}");
    assert!(after.frames == 150 && after.nees < 1.2, "{before:?} {after:?}");
    // What is left is what the true airframe leaves, in frames that are the same.
    assert!((after.bias - truth.bias).abs() < 0.002, "{after:?} {truth:?}");
}
