//! Cubic B-splines: smooth to the second derivative, and through every sample.

/// Turns samples into the coefficients of the spline through them (M. Unser, IEEE SPM 16, 1999): `c[k-1] + 4 c[k] + c[k+1] = 6 s[k]`,
/// nothing outside. `room` is as long as the samples.
pub(super) fn coefficients(samples: &mut [f64], room: &mut [f64]) {
    let mut factor = 0.0;
    let mut before = 0.0;
    for (sample, room) in samples.iter_mut().zip(room.iter_mut()) {
        factor = 1.0 / (4.0 - factor);
        before = (6.0 * *sample - before) * factor;
        (*sample, *room) = (before, factor);
    }
    let mut after = 0.0;
    for (sample, factor) in samples.iter_mut().zip(room.iter()).rev() {
        *sample -= factor * after;
        after = *sample;
    }
}

/// The coefficients of the same spline at steps half as long, of which every second stands where one of these does: two less one for each of these.
pub(super) fn refine(coefficients: &[f64], refined: &mut [f64]) {
    let at = |k: Option<usize>| k.and_then(|k| coefficients.get(k)).copied().unwrap_or(0.0);
    for (k, refined) in refined.iter_mut().enumerate() {
        let (here, after) = (at(Some(k / 2)), at(Some(k / 2 + 1)));
        *refined = if k % 2 == 0 {
            0.125 * (at((k / 2).checked_sub(1)) + 6.0 * here + after)
        } else {
            0.5 * (here + after)
        };
    }
}

/// What four coefficients count for at a place between the second and the third: for the value, for its slope, for its curvature.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weights {
    pub(super) values: [f32; 4],
    pub(super) slopes: [f32; 4],
    pub(super) curvatures: [f32; 4],
}

/// Weights at a share `t` of the way from the second coefficient to the third; derivatives are by t.
pub(super) fn weights(t: f32) -> Weights {
    let s = 1.0 - t;
    let sixth = 1.0 / 6.0;
    let values = [
        s * s * s * sixth,
        (4.0 - 6.0 * t * t + 3.0 * t * t * t) * sixth,
        (4.0 - 6.0 * s * s + 3.0 * s * s * s) * sixth,
        t * t * t * sixth,
    ];
    let slopes = [-0.5 * s * s, 1.5 * t * t - 2.0 * t, 2.0 * s - 1.5 * s * s, 0.5 * t * t];
    Weights { values, slopes, curvatures: [s, 3.0 * t - 2.0, 3.0 * s - 2.0, t] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_spline_passes_through_its_samples(samples in prop::collection::vec(-1.0..1.0f64, 1..40)) {
            let (mut spline, mut room) = (samples.clone(), samples.clone());
            coefficients(&mut spline, &mut room);
            let at = |k: isize| usize::try_from(k).ok().and_then(|k| spline.get(k)).copied().unwrap_or(0.0);
            for (k, sample) in (0isize..).zip(&samples) {
                let value = (at(k - 1) + 4.0 * at(k) + at(k + 1)) / 6.0;
                prop_assert!((value - sample).abs() < 1e-12);
            }
        }

        #[test]
        fn a_refined_spline_is_the_same(coefficients in prop::collection::vec(-1.0..1.0f64, 8..20), t in 0.0..1.0f32) {
            let mut refined = vec![0.0; 2 * coefficients.len() - 1];
            refine(&coefficients, &mut refined);
            let value = |coefficients: &[f64], place: f32| {
                let whole = place as usize;
                let four = &coefficients[whole - 1..];
                let values = weights(place - whole as f32).values;
                values.iter().zip(four).map(|(weight, value)| f64::from(*weight) * value).sum::<f64>()
            };
            // Beside the first and the last, around which the refined one has less than all.
            let place = 2.0 + t * (coefficients.len() - 6) as f32;
            let (coarse, fine) = (value(&coefficients, place), value(&refined, 2.0 * place));
            prop_assert!((coarse - fine).abs() < 1e-5, "{coarse} {fine}");
        }

        #[test]
        fn weights_are_a_share_and_slopes_their_derivatives(t in 0.01..0.99f32) {
            let here = weights(t);
            prop_assert!((here.values.iter().sum::<f32>() - 1.0).abs() < 1e-6);
            let (after, before) = (weights(t + 4e-3), weights(t - 4e-3));
            for i in 0..4 {
                prop_assert!((here.slopes[i] - (after.values[i] - before.values[i]) / 8e-3).abs() < 1e-3);
                prop_assert!((here.curvatures[i] - (after.slopes[i] - before.slopes[i]) / 8e-3).abs() < 1e-3);
            }
        }
    }
}
