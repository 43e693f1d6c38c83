//! A spot as it stands in a file: all of it in our own results, its place at least in those of others.

use serde::{Deserialize, Serialize};

use photinus::frame::FrameView;

/// Standard deviation of a spot that does not say its own, px per axis: a place known to the pixel, 1/sqrt(12).
pub const DEFAULT_SIGMA_PX: f64 = 0.288_675_134_594_812_9;

/// Something bright that may be a marker.
///
/// Only `u_px` and `v_px` must stand in a file. Defaults: `area_px` 1, `peak` 255, `saturated_px` 0, `flux` 0 (not known),
/// `sigma_px` [`DEFAULT_SIGMA_PX`] (a number, or one per axis), `covariance_px2` diagonal from `sigma_px`,
/// `middle_px` the nearest pixel, `background` 0, `probability` 0.5, the others `null`. `covariance_px2` goes before `sigma_px`,
/// `marker_log_odds` before `probability`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Given")]
pub struct SpotRecord {
    /// Column of the centre, px.
    pub u_px: f64,
    /// Row of the centre, px.
    pub v_px: f64,
    /// Pixels that it covers.
    pub area_px: u32,
    /// Its brightest pixel.
    pub peak: u8,
    /// Pixels of 255.
    pub saturated_px: u32,
    /// Sum of its pixels above the background, grey levels; 0 where it is not known.
    pub flux: f64,
    /// All of its light and the sigma of that, grey levels: with what full pixels hide, as far as it is told.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light: Option<[f64; 2]>,
    /// Root of the mean variance of the centre over the two axes, px.
    pub sigma_px: f64,
    /// Covariance of the centre, u then v, px^2.
    pub covariance_px2: [[f64; 2]; 2],
    /// The paper's middle pixel: column and row.
    pub middle_px: [u32; 2],
    /// The box of pixels that it spans: first column, first row, last column, last row.
    pub extent_px: Option<[u32; 4]>,
    /// Grey value around it.
    pub background: f64,
    /// The probability that it is the light of markers and not clutter, from how it looks in its frame alone.
    pub probability: f64,
    /// Natural logarithm of the odds of that.
    pub marker_log_odds: f64,
    /// Unit vector towards it in the camera frame, where the camera is known.
    pub bearing: Option<[f64; 3]>,
    /// Truth is never farther from the bearing, rad.
    pub bound_rad: Option<f64>,
    /// Truth is never outside, m; the far end is `null` where nothing bounds it.
    pub range_m: Option<(f64, Option<f64>)>,
    /// Which of the airframe's signals it was seen to blink, where that is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub signal: Option<u32>,
}

impl SpotRecord {
    /// Root of the mean of the two variances, px: what `sigma_px` says of `covariance_px2`.
    pub fn sigma_of(covariance_px2: [[f64; 2]; 2]) -> f64 {
        ((covariance_px2[0][0] + covariance_px2[1][1]) / 2.0).sqrt()
    }
}

/// What may stand in a file.
#[derive(Deserialize)]
struct Given {
    u_px: f64,
    v_px: f64,
    area_px: Option<u32>,
    peak: Option<u8>,
    saturated_px: Option<u32>,
    flux: Option<f64>,
    light: Option<[f64; 2]>,
    sigma_px: Option<Sigma>,
    covariance_px2: Option<[[f64; 2]; 2]>,
    middle_px: Option<[u32; 2]>,
    extent_px: Option<[u32; 4]>,
    background: Option<f64>,
    probability: Option<f64>,
    marker_log_odds: Option<f64>,
    bearing: Option<[f64; 3]>,
    bound_rad: Option<f64>,
    range_m: Option<(f64, Option<f64>)>,
    signal: Option<u32>,
}

/// How well a centre may be known, px: neither better than any light tells, nor worse than not at all.
const SIGMAS_PX: std::ops::RangeInclusive<f64> = 1e-6..=1e4;

/// No look of a spot makes it more certain than this, as the logarithm of the odds.
const SUREST_LOG_ODDS: f64 = 20.0;

/// One standard deviation, or one per axis.
#[derive(Clone, Copy, Deserialize)]
#[serde(untagged, expecting = "sigma_px must be a number or [u, v]")]
enum Sigma {
    Both(f64),
    PerAxis([f64; 2]),
}

impl TryFrom<Given> for SpotRecord {
    type Error = String;

    fn try_from(given: Given) -> Result<Self, String> {
        // The outer edge of the first pixel is at -0.5.
        let side = -0.5..=FrameView::MAX_SIDE_PX as f64;
        let (u_px, v_px) = (given.u_px, given.v_px);
        if !side.contains(&u_px) || !side.contains(&v_px) {
            return Err(format!("a spot at ({u_px}, {v_px}) px is in no image"));
        }
        let [sigma_u, sigma_v] = match given.sigma_px {
            Some(Sigma::Both(sigma)) => [sigma, sigma],
            Some(Sigma::PerAxis(sigmas)) => sigmas,
            None => [DEFAULT_SIGMA_PX; 2],
        };
        for sigma_px in [sigma_u, sigma_v] {
            if sigma_px <= 0.0 {
                return Err("sigma_px is not above 0".to_owned());
            }
            if !SIGMAS_PX.contains(&sigma_px) {
                let (least, most) = (SIGMAS_PX.start(), SIGMAS_PX.end());
                return Err(format!("sigma_px is {sigma_px}; a centre is known to {least:e} to {most} px"));
            }
        }
        let covariance_px2 =
            given.covariance_px2.unwrap_or([[sigma_u * sigma_u, 0.0], [0.0, sigma_v * sigma_v]]);
        let sigma_px = match (given.covariance_px2, given.sigma_px) {
            (_, Some(Sigma::Both(sigma))) => sigma,
            _ => Self::sigma_of(covariance_px2),
        };
        let [[uu, uv], [vu, vv]] = covariance_px2;
        let is_variance = |px2: f64| SIGMAS_PX.contains(&px2.max(0.0).sqrt());
        if !(is_variance(uu) && is_variance(vv) && uu * vv > uv * vu && (uv - vu).abs() <= 1e-9 * uv.abs()) {
            return Err(format!("covariance_px2 {covariance_px2:?} is no covariance"));
        }
        let is_box = |[left, top, right, bottom]: [u32; 4]| {
            left <= right && top <= bottom && right.max(bottom) as usize <= FrameView::MAX_SIDE_PX
        };
        if given.light.is_some_and(|[light, sigma]| !(light > 0.0 && sigma > 0.0)) {
            return Err("light is two numbers above 0: the light and its sigma".to_owned());
        }
        if given.extent_px.is_some_and(|extent| !is_box(extent)) {
            return Err(
                "extent_px is no box of an image: first column, first row, last column, last row".to_owned()
            );
        }
        if given.probability.is_some_and(|probability| !(0.0..=1.0).contains(&probability)) {
            return Err("probability is not 0 to 1".to_owned());
        }
        if given.marker_log_odds.is_some_and(|log_odds| log_odds.abs() > SUREST_LOG_ODDS) {
            return Err(format!("marker_log_odds is not -{SUREST_LOG_ODDS} to {SUREST_LOG_ODDS}"));
        }
        let of_probability = |probability: f64| {
            libm::log(probability / (1.0 - probability)).clamp(-SUREST_LOG_ODDS, SUREST_LOG_ODDS)
        };
        let marker_log_odds = given.marker_log_odds.or(given.probability.map(of_probability)).unwrap_or(0.0);
        // The sides are those of an image, checked above.
        let nearest = |px: f64| px.round() as u32;
        Ok(Self {
            u_px,
            v_px,
            area_px: given.area_px.unwrap_or(1),
            peak: given.peak.unwrap_or(255),
            saturated_px: given.saturated_px.unwrap_or(0),
            flux: given.flux.unwrap_or(0.0),
            light: given.light,
            sigma_px,
            covariance_px2,
            middle_px: given.middle_px.unwrap_or([nearest(u_px), nearest(v_px)]),
            extent_px: given.extent_px,
            background: given.background.unwrap_or(0.0),
            probability: 1.0 / (1.0 + libm::exp(-marker_log_odds)),
            marker_log_odds,
            bearing: given.bearing,
            bound_rad: given.bound_rad,
            range_m: given.range_m,
            signal: given.signal,
        })
    }
}
