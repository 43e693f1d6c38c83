//! How far claims of centres and of light are off, and how far markers sit from where they should: what residuals and offsets
//! themselves say.

use nalgebra::{DMatrix, DVector};

use super::Known;
use super::adjust::{Adjustment, Equations, huber};
use super::model::Kind;

/// Steps of expectation and maximisation; each is cheap.
const STEPS: usize = 200;
/// Markers are known no better, m: less means nothing to any pose.
const LEAST_M: f64 = 1e-5;
/// Such a share of the coordinates of markers must be told for a sigma of them, ...
const TOLD_SHARE: f64 = 0.5;
/// ... but for a shift, a turn and a scale, which look like another pose or another light.
const UNTOLD: f64 = 7.0;
const LEAST_SCATTER: f64 = 0.2;
/// Where the unknowns leave fewer residuals than this, the residuals say nothing of their scatter.
const LEAST_REDUNDANCY: f64 = 20.0;
/// The light of an LED is no steadier from frame to frame, as a logarithm.
const LEAST_LIGHT_SIGMA: f64 = 0.005;

/// Sets the scatter, then the sigmas of light from frame to frame and of the markers' offsets.
pub(super) fn update(adjustment: &mut Adjustment<'_>, equations: &Equations) -> Option<()> {
    let ratios = ratios(adjustment, equations)?;
    adjustment.spread.light_sigma = light_sigma(adjustment, equations)?;
    for (scatter, ratio) in adjustment.spread.scatter.iter_mut().zip(ratios) {
        *scatter = (*scatter * ratio.unwrap_or(1.0)).max(LEAST_SCATTER);
    }
    let equations = adjustment.equations()?;
    adjustment.spread.offset_sigma_m = offset_sigma_m(adjustment, &equations)?;
    Some(())
}

/// Scatter of centres and of light against what is assumed: squares of residuals over their redundancy, which is their number
/// less what poses and all that frames share have taken up of it (W. Förstner, 1979); `None` where that is next to nothing.
fn ratios(adjustment: &Adjustment<'_>, equations: &Equations) -> Option<[Option<f64>; 2]> {
    let (model, covariance) = (adjustment.model()?, adjustment.covariance(equations)?);
    let (mut squares, mut redundancy) = ([0.0; 2], [0.0; 2]);
    for (frame, of_frame) in adjustment.frames().iter().zip(equations.frames()) {
        let own = of_frame.information.cholesky()?.inverse();
        let follows = own * &of_frame.with_shared;
        for row in model.rows(frame, &adjustment.spread) {
            let part = match row.kind {
                Kind::Bearing => 0,
                Kind::Light => 1,
                Kind::Prior => continue,
            };
            let (weight, _) = huber(row.residual);
            let mut shared: DVector<f64> = -follows.transpose() * row.by_own;
            row.by_shared.iter().for_each(|(number, slope)| shared[*number] += slope);
            let taken_up = row.by_own.dot(&(own * row.by_own)) + shared.dot(&(&covariance * &shared));
            squares[part] += weight * row.residual * row.residual;
            redundancy[part] += 1.0 - weight * taken_up;
        }
    }
    Some(
        [0, 1].map(|part| {
            (redundancy[part] > LEAST_REDUNDANCY).then(|| (squares[part] / redundancy[part]).sqrt())
        }),
    )
}

/// How much the light of an LED differs from frame to frame: what it is off by, and what is not known of that.
fn light_sigma(adjustment: &Adjustment<'_>, equations: &Equations) -> Option<f64> {
    let mean = adjustment.parameters.log_light;
    let mut second = 0.0;
    for (frame, of_frame) in adjustment.frames().iter().zip(equations.frames()) {
        let off = frame.log_light - mean;
        second += off * off + of_frame.information.cholesky()?.inverse()[(6, 6)];
    }
    Some((second / adjustment.frames().len() as f64).sqrt().max(LEAST_LIGHT_SIGMA))
}

/// The sigma of the offsets under which they are the likeliest.
fn offset_sigma_m(adjustment: &Adjustment<'_>, equations: &Equations) -> Option<f64> {
    let parameters = &adjustment.parameters;
    let (data, gradient) = equations.without_poses(0.0)?;
    let first = parameters.first_offset();
    let count = (parameters.count() - first) as f64;
    let mut sigma_m = adjustment.spread.offset_sigma_m;
    for _ in 0..STEPS {
        let (mut information, mut pull) = (data.clone(), gradient.clone());
        for (number, (off, sigma)) in parameters.off_prior(sigma_m).into_iter().enumerate() {
            information[(number, number)] += 1.0 / (sigma * sigma);
            pull[number] += off / (sigma * sigma);
        }
        let factors = information.cholesky()?;
        let step: DVector<f64> = factors.solve(&-pull);
        let covariance = factors.inverse();
        let offsets = parameters.offsets_m.iter().flat_map(|offset_m| offset_m.iter());
        let second: f64 = (first..)
            .zip(offsets)
            .map(|(number, offset_m)| {
                let offset_m = offset_m + step[number];
                offset_m * offset_m + covariance[(number, number)]
            })
            .sum();
        sigma_m = (second / count).sqrt().max(LEAST_M);
    }
    Some(sigma_m)
}

/// The sigma of the markers' positions, where enough of them are told. Its own sigma is that of as many normal numbers as the
/// frames tell.
pub(super) fn position_sigma_m(adjustment: &Adjustment<'_>, covariance: &DMatrix<f64>) -> Option<Known> {
    let (first, value) = (adjustment.parameters.first_offset(), adjustment.spread.offset_sigma_m);
    let told: f64 = (first..covariance.nrows())
        .map(|number| (1.0 - covariance[(number, number)] / (value * value)).max(0.0))
        .sum();
    let fewest = (TOLD_SHARE * ((covariance.nrows() - first) as f64 - UNTOLD)).max(1.0);
    (told > fewest).then(|| Known { value, sigma: value / (2.0 * told).sqrt() })
}
