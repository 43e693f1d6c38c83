//! Spots that stand alone: a brightest pixel, nothing else bright around it.

use super::Photo;

/// Which spots are taken.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// Half the side of the window around a spot, px.
    pub half_px: usize,
    /// Least height of the brightest pixel above what surrounds the spot.
    pub least: f64,
    /// Most height of it: above, a response may not be in proportion.
    pub most: f64,
}

/// A spot and the pixels around it.
#[derive(Clone, Debug)]
pub struct Spot {
    /// Column of its centre, px.
    pub u_px: f64,
    /// Row of its centre, px.
    pub v_px: f64,
    /// All its light.
    pub flux: f64,
    /// Level of what surrounds it.
    pub level: f64,
    pub(super) pixels: Vec<(f64, f64, f64)>,
}

/// The spots of a photo.
pub fn find(photo: &Photo, wanted: &Wanted) -> Vec<Spot> {
    let half = wanted.half_px;
    if photo.width() <= 2 * half || photo.height() <= 2 * half {
        return Vec::new();
    }
    let rows = half..photo.height() - half;
    let columns = || half..photo.width() - half;
    rows.flat_map(|v| columns().filter_map(move |u| spot(photo, wanted, (u, v)))).collect()
}

fn spot(photo: &Photo, wanted: &Wanted, (u, v): (usize, usize)) -> Option<Spot> {
    let (half, peak) = (wanted.half_px, photo.at(u, v));
    let near = (v - 1..=v + 1).flat_map(|b| (u - 1..=u + 1).map(move |a| (a, b)));
    if !peak.is_finite() || near.clone().any(|(a, b)| photo.at(a, b) > peak) {
        return None; // most pixels end here
    }
    let window = || (v - half..=v + half).flat_map(move |b| (u - half..=u + half).map(move |a| (a, b)));
    let brighter = |&(a, b): &(usize, usize)| {
        let other = photo.at(a, b);
        !other.is_finite() || other > peak || (other >= peak && (b, a) < (v, u))
    };
    if window().any(|place| brighter(&place)) {
        return None;
    }
    let mut border: Vec<f64> = window()
        .filter(|(a, b)| a.abs_diff(u).max(b.abs_diff(v)) + 1 >= half)
        .map(|(a, b)| photo.at(a, b))
        .collect();
    border.sort_by(f64::total_cmp);
    let level = border[border.len() / 2];
    let height = peak - level;
    let alone = window().all(|(a, b)| {
        let far = a.abs_diff(u).max(b.abs_diff(v)) > half / 2;
        !far || photo.at(a, b) - level < 0.2 * height
    });
    if !(wanted.least..=wanted.most).contains(&height) || !alone {
        return None;
    }
    let pixels: Vec<_> = window().map(|(a, b)| (a as f64, b as f64, photo.at(a, b))).collect();
    let (mut flux, mut mean_u, mut mean_v) = (0.0, 0.0, 0.0);
    for &(a, b, value) in &pixels {
        let light = value - level;
        flux += light;
        if (a - u as f64).abs().max((b - v as f64).abs()) < 2.5 {
            (mean_u, mean_v) = (mean_u + light.max(0.0) * a, mean_v + light.max(0.0) * b);
        }
    }
    let core: f64 = pixels
        .iter()
        .filter(|(a, b, _)| (a - u as f64).abs().max((b - v as f64).abs()) < 2.5)
        .map(|(.., value)| (value - level).max(0.0))
        .sum();
    (flux > 0.0).then_some(Spot { u_px: mean_u / core, v_px: mean_v / core, flux, level, pixels })
}
