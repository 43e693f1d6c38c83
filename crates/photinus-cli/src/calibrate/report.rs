//! All that is known about a calibration, as `report.json` has it and as the page of plots draws it.
//!
//! Lengths are in px and mm, angles in deg (where in the field) and mrad (how sure). The same photos give the same report,
//! byte for byte.

use photinus::camera::{Model, Pixel};
use photinus_calibrate::camera::{
    Calibration, Coverage, Lack, MisfitReason, Part, Residual, Ring, Split, Summary,
};
use photinus_calibrate::lens::Lens;
use photinus_calibrate::solve::Board;
use serde::Serialize;

use super::photos::Searched;

/// The report of a camera calibration.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct CameraReport {
    /// Photos given, those that show the grid, those that the camera rests on.
    pub(crate) photos_given: usize,
    pub(crate) photos_used: usize,
    pub(crate) width_px: usize,
    pub(crate) height_px: usize,
    pub(crate) grid_columns: usize,
    pub(crate) grid_rows: usize,
    pub(crate) pitch_m: f64,
    pub(crate) model: String,
    /// "flat" or "solved".
    pub(crate) board: &'static str,
    /// Distances between LEDs as seen and as expected, over all LEDs used.
    pub(crate) mean_px: f64,
    pub(crate) rms_px: f64,
    pub(crate) max_px: f64,
    /// Standard deviation along one axis, from the median.
    pub(crate) sigma_px: f64,
    pub(crate) held_out: Option<HeldOut>,
    /// Where the outermost LED was, and where the camera file stops answering, deg off the axis.
    pub(crate) reach_deg: f64,
    pub(crate) field_limit_deg: f64,
    pub(crate) parameters: Vec<Parameter>,
    /// By how much sigmas were raised above those of independent residuals: what was measured, what was done.
    pub(crate) inflation_measured: f64,
    pub(crate) inflation: f64,
    /// How well photos agree on where the LEDs are, and how well noise would.
    pub(crate) board_agreement: f64,
    pub(crate) board_agreement_by_chance: f64,
    /// Distance of columns over distance of rows of the board as found.
    pub(crate) pitch_ratio: f64,
    pub(crate) bearings: Vec<RingReport>,
    pub(crate) photos: Vec<PhotoReport>,
    pub(crate) leds: Vec<LedReport>,
    pub(crate) residuals: Vec<ResidualReport>,
    pub(crate) outliers: Vec<ResidualReport>,
    pub(crate) models: Vec<ModelReport>,
    pub(crate) coverage: Vec<CoverageReport>,
    /// Sigma of bearings over the image, a lattice of pixels; places without an answer are left out.
    pub(crate) sigma_map: Vec<SigmaReport>,
    /// The difference between the calibrations from two halves of the photos, without the turn that they have in common.
    pub(crate) half_difference: Vec<MoveReport>,
    /// Largest angle between the camera and its OCamCalib text, mrad; absent where there is no text of it.
    pub(crate) ocam_off_mrad: Option<f64>,
    pub(crate) warnings: Vec<String>,
}

/// Each half of the photos, calibrated and tried on the other half: mean distances over the random splits.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct HeldOut {
    pub(crate) splits: usize,
    pub(crate) failed: usize,
    pub(crate) median_px: f64,
    pub(crate) worst_px: f64,
}

/// A parameter of the camera file, with its standard deviation.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Parameter {
    pub(crate) name: String,
    pub(crate) value: f64,
    pub(crate) sigma: f64,
}

/// How sure bearings are in a ring of the field (both axes together).
#[derive(Clone, Debug, Serialize)]
pub(crate) struct RingReport {
    pub(crate) from_deg: f64,
    pub(crate) to_deg: f64,
    /// What the camera file says.
    pub(crate) sigma_mrad: f64,
    /// The scatter of calibrations from photos drawn with replacement.
    pub(crate) bootstrap_mrad: Option<f64>,
    /// The difference of two halves, median over the splits: about twice the sigma when that is honest.
    pub(crate) half_difference_mrad: Option<f64>,
}

/// A photo.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct PhotoReport {
    pub(crate) name: String,
    pub(crate) used: bool,
    /// Why not, where it was not used.
    pub(crate) reason: Option<String>,
    pub(crate) spots: usize,
    pub(crate) leds: usize,
    pub(crate) mean_px: Option<f64>,
    pub(crate) max_px: Option<f64>,
    /// Distance and direction of the middle of the board, and the angle between the board's axis and the line of sight.
    pub(crate) distance_m: Option<f64>,
    pub(crate) off_axis_deg: Option<f64>,
    pub(crate) tilt_deg: Option<f64>,
}

/// An LED of the board.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct LedReport {
    pub(crate) column: usize,
    pub(crate) row: usize,
    pub(crate) seen: usize,
    pub(crate) mean_px: f64,
    /// Where it is off its nominal place, mm; zeros on a flat board.
    pub(crate) offset_mm: [f64; 3],
}

/// An LED in a photo: where it is seen, and seen minus expected.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct ResidualReport {
    pub(crate) photo: usize,
    pub(crate) column: usize,
    pub(crate) row: usize,
    pub(crate) u_px: f64,
    pub(crate) v_px: f64,
    pub(crate) du_px: f64,
    pub(crate) dv_px: f64,
    /// Why it was left out, where it was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) reason: Option<String>,
}

/// A model that was compared.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct ModelReport {
    pub(crate) model: String,
    pub(crate) parameters: usize,
    pub(crate) mean_px: f64,
    pub(crate) held_out_px: Option<f64>,
    pub(crate) chosen: bool,
}

/// A ninth of the image, counted from the top left.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct CoverageReport {
    pub(crate) column: usize,
    pub(crate) row: usize,
    pub(crate) photos: usize,
    pub(crate) more_wanted: usize,
}

/// Sigma of the bearing at a pixel (both axes together).
#[derive(Clone, Debug, Serialize)]
pub(crate) struct SigmaReport {
    pub(crate) u_px: f64,
    pub(crate) v_px: f64,
    pub(crate) sigma_mrad: f64,
}

/// How far a bearing moves, in the camera's axes.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct MoveReport {
    pub(crate) u_px: f64,
    pub(crate) v_px: f64,
    pub(crate) move_mrad: [f64; 3],
}

/// Repeats of a calibration.
pub(crate) struct Repeats {
    pub(crate) splits: Vec<Split>,
    pub(crate) resampled: Vec<Lens>,
}

impl CameraReport {
    /// The report of `calibration`.
    pub(crate) fn of(searched: &Searched, calibration: &Calibration, repeats: &Repeats) -> Self {
        let residuals = calibration.residuals();
        let summary = Summary::of(residuals.iter().map(|residual| residual.off_px.norm()));
        let [width_px, height_px] = searched.size_px;
        let grid = &searched.grid;
        let agreement = calibration.agreement();
        let inflation = calibration.inflation();
        let residual = |residual: &Residual| residual_report(residual, grid.columns());
        let outliers = calibration.outliers().iter().map(|outlier| ResidualReport {
            reason: Some(format!(
                "{:.2} px off, {:.0} times the scatter of the others",
                outlier.residual.off_px.norm(),
                outlier.residual.off_px.norm() / outlier.sigma_px
            )),
            ..residual(&outlier.residual)
        });
        Self {
            photos_given: searched.photos.len(),
            photos_used: calibration.views().len(),
            width_px,
            height_px,
            grid_columns: grid.columns(),
            grid_rows: grid.rows(),
            pitch_m: grid.pitch_m(),
            model: calibration.lens().model().to_string(),
            board: if calibration.board() == Board::Solved { "solved" } else { "flat" },
            mean_px: summary.mean_px,
            rms_px: summary.rms_px,
            max_px: summary.max_px,
            sigma_px: calibration.sigma_px(),
            held_out: held_out(&repeats.splits),
            reach_deg: calibration.reach_rad().to_degrees(),
            field_limit_deg: calibration.camera().field_limit_rad().to_degrees(),
            parameters: parameters(calibration),
            inflation_measured: inflation.measured,
            inflation: inflation.applied,
            board_agreement: agreement.correlation,
            board_agreement_by_chance: agreement.chance,
            pitch_ratio: calibration.pitch_ratio(),
            bearings: bearings(calibration, repeats),
            photos: photos(searched, calibration, &residuals),
            leds: leds(calibration, &residuals),
            residuals: residuals.iter().map(residual).collect(),
            outliers: outliers.collect(),
            models: calibration.candidates().iter().map(model_report).collect(),
            coverage: coverage(calibration),
            sigma_map: sigma_map(calibration),
            half_difference: half_difference(calibration, &repeats.splits),
            ocam_off_mrad: calibration.ocam().ok().map(|ocam| 1e3 * ocam.max_off_rad),
            warnings: calibration.warnings(&searched.photos).iter().map(ToString::to_string).collect(),
        }
    }
}

fn residual_report(residual: &Residual, columns: usize) -> ResidualReport {
    ResidualReport {
        photo: residual.photo,
        column: residual.led % columns,
        row: residual.led / columns,
        u_px: residual.seen.x,
        v_px: residual.seen.y,
        du_px: residual.off_px.x,
        dv_px: residual.off_px.y,
        reason: None,
    }
}

fn model_report(candidate: &photinus_calibrate::camera::Candidate) -> ModelReport {
    ModelReport {
        model: candidate.model.to_string(),
        parameters: candidate.model.parameters(),
        mean_px: candidate.mean_px,
        held_out_px: candidate.held_out_px,
        chosen: candidate.chosen,
    }
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let (low, high) = (values.get(values.len().checked_sub(1)? / 2)?, values.get(values.len() / 2)?);
    Some(0.5 * (low + high))
}

fn held_out(splits: &[Split]) -> Option<HeldOut> {
    let halves: Vec<_> = splits.iter().flat_map(|split| &split.halves).collect();
    let means: Vec<f64> = halves.iter().copied().flatten().map(|half| half.held_out.mean_px).collect();
    Some(HeldOut {
        splits: splits.len(),
        failed: halves.len() - means.len(),
        worst_px: means.iter().copied().fold(0.0, f64::max),
        median_px: median(means)?,
    })
}

fn bearings(calibration: &Calibration, repeats: &Repeats) -> Vec<RingReport> {
    let field = calibration.field();
    let claimed = field.claimed(calibration.camera());
    let bootstrap = match repeats.resampled.is_empty() {
        true => Vec::new(),
        false => field.scatter(calibration.lens(), &repeats.resampled),
    };
    let halves: Vec<Vec<Ring>> = repeats
        .splits
        .iter()
        .filter_map(|split| match &split.halves {
            [Some(a), Some(b)] => Some(field.rings_of(&field.difference(&a.lens, &b.lens))),
            _ => None,
        })
        .collect();
    let ring = |(index, ring): (usize, &Ring)| RingReport {
        from_deg: ring.from_rad.to_degrees(),
        to_deg: ring.to_rad.to_degrees(),
        sigma_mrad: 1e3 * ring.rms_rad,
        bootstrap_mrad: bootstrap.get(index).map(|ring| 1e3 * ring.rms_rad),
        half_difference_mrad: median(halves.iter().map(|rings| 1e3 * rings[index].rms_rad).collect()),
    };
    claimed.iter().enumerate().map(ring).collect()
}

fn photos(searched: &Searched, calibration: &Calibration, residuals: &[Residual]) -> Vec<PhotoReport> {
    let report = |(index, photo): (usize, &photinus_calibrate::photo::Photo)| {
        let used = calibration.views().iter().zip(calibration.poses()).find(|(view, _)| view.photo == index);
        let refused = searched
            .refused
            .iter()
            .find(|(refused, _)| *refused == index)
            .map(|(_, error)| error.to_string());
        let misfit = calibration.misfits().iter().find(|misfit| misfit.photo == index);
        let misfit = misfit.map(|misfit| match misfit.reason {
            MisfitReason::Mirrored => format!("it is mirrored ({:.1} px off)", misfit.mean_px),
            MisfitReason::Foreign => format!("it does not fit the others ({:.1} px off)", misfit.mean_px),
        });
        let own = residuals.iter().filter(|residual| residual.photo == index);
        let summary = used.map(|_| Summary::of(own.map(|residual| residual.off_px.norm())));
        let place = used.map(|(_, pose)| pose.translation.vector);
        PhotoReport {
            name: photo.name.clone(),
            used: used.is_some(),
            reason: refused.or(misfit),
            spots: photo.spots.len(),
            leds: used.map_or(0, |(view, _)| view.observations.len()),
            mean_px: summary.map(|summary| summary.mean_px),
            max_px: summary.map(|summary| summary.max_px),
            distance_m: place.map(|place| place.norm()),
            off_axis_deg: place.map(|place| libm::atan2(place.xy().norm(), place.z).to_degrees()),
            tilt_deg: used.map(|(_, pose)| {
                let axis = pose.rotation * nalgebra::Vector3::z();
                axis.angle(&pose.translation.vector).to_degrees()
            }),
        }
    };
    searched.photos.iter().enumerate().map(report).collect()
}

fn leds(calibration: &Calibration, residuals: &[Residual]) -> Vec<LedReport> {
    let grid = calibration.grid();
    let nominal_m = grid.nominal_m();
    let report = |led: usize| {
        let own = residuals.iter().filter(|residual| residual.led == led);
        let summary = Summary::of(own.map(|residual| residual.off_px.norm()));
        let offset = 1e3 * (calibration.scene().board_m[led] - nominal_m[led]);
        LedReport {
            column: led % grid.columns(),
            row: led / grid.columns(),
            seen: summary.count,
            mean_px: summary.mean_px,
            offset_mm: offset.into(),
        }
    };
    (0..grid.leds()).map(report).collect()
}

fn coverage(calibration: &Calibration) -> Vec<CoverageReport> {
    let coverage = Coverage::of(calibration.views(), calibration.size_px());
    let lacks = coverage.lacks();
    let report = |part: Part| {
        let [column, row] = part.place();
        let lack: Option<&Lack> = lacks.iter().find(|lack| lack.part == part);
        CoverageReport {
            column,
            row,
            photos: coverage.seen(part),
            more_wanted: lack.map_or(0, |lack| lack.more),
        }
    };
    Part::all().map(report).collect()
}

/// Columns of the lattice of the sigma map.
const MAP_COLUMNS: usize = 64;

fn sigma_map(calibration: &Calibration) -> Vec<SigmaReport> {
    let [width, height] = calibration.size_px().map(|side| side as f64);
    let step = width / MAP_COLUMNS as f64;
    let rows = (height / step).ceil() as usize;
    let mut map = Vec::new();
    for index in 0..rows * MAP_COLUMNS {
        let place = |i: usize| (i as f64 + 0.5) * step - 0.5;
        let (u, v) = (place(index % MAP_COLUMNS), place(index / MAP_COLUMNS));
        if let Some(covariance) = calibration.camera().calibration_covariance(Pixel::new(u, v)) {
            map.push(SigmaReport { u_px: u, v_px: v, sigma_mrad: 1e3 * covariance.trace().sqrt() });
        }
    }
    map
}

fn half_difference(calibration: &Calibration, splits: &[Split]) -> Vec<MoveReport> {
    let first = splits.iter().find_map(|split| match &split.halves {
        [Some(a), Some(b)] => Some(calibration.field().difference(&a.lens, &b.lens)),
        _ => None,
    });
    let report = |(pixel, off): &(nalgebra::Vector2<f64>, nalgebra::Vector3<f64>)| MoveReport {
        u_px: pixel.x,
        v_px: pixel.y,
        move_mrad: (1e3 * off).into(),
    };
    first.map_or(Vec::new(), |difference| difference.moves.iter().map(report).collect())
}

/// The parameters of the camera file in the order of its covariance.
fn parameters(calibration: &Calibration) -> Vec<Parameter> {
    let camera = calibration.camera();
    let centre = camera.model().centre();
    let named: Vec<(String, f64)> = match camera.model() {
        Model::OCam(lens) => {
            let s = lens.stretch();
            let direct =
                lens.direct().iter().enumerate().map(|(k, a)| (format!("direct_polynomial[{k}]"), *a));
            let rest = [
                ("centre_u_px", centre.u),
                ("centre_v_px", centre.v),
                ("c", s.m11),
                ("d", s.m12),
                ("e", s.m21),
                ("stretch[1][1]", s.m22),
            ];
            direct.chain(rest.map(|(name, value)| (name.to_owned(), value))).collect()
        }
        Model::KannalaBrandt(lens) => {
            let ([fu, fv], [k1, k2, k3, k4]) = (lens.focal_px(), lens.k());
            let names = [
                "focal_u_px",
                "focal_v_px",
                "k1",
                "k2",
                "k3",
                "k4",
                "centre_u_px",
                "centre_v_px",
                "shear_px",
            ];
            let values = [fu, fv, k1, k2, k3, k4, centre.u, centre.v, lens.shear_px()];
            names.map(str::to_owned).into_iter().zip(values).collect()
        }
        Model::Ideal(_) | Model::Pinhole(_) => Vec::new(),
    };
    let sigma = |k: usize| camera.parameter_covariance().map_or(0.0, |covariance| covariance[(k, k)].sqrt());
    named
        .into_iter()
        .enumerate()
        .map(|(k, (name, value))| Parameter { name, value, sigma: sigma(k) })
        .collect()
}
