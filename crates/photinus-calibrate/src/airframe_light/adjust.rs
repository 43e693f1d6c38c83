//! Poses of all frames and all that they share, by least squares at once (Levenberg-Marquardt). Poses are eliminated (Schur
//! complement): what is solved is as large as the airframe, however many frames there are.

use nalgebra::{DMatrix, DVector, SMatrix, Vector2, Vector3};
use photinus::airframe::Airframe;

use super::flight::Frame;
use super::model::{Model, Own, Parameters, Row, Spread, moved};
use super::shape::Shape;

const PASSES: usize = 40;
const POSE_PASSES: usize = 8;
/// A step that gains less ends the search, nats.
const ENOUGH_NATS: f64 = 1e-3;
/// Beyond this many sigma the pull of a residual no longer grows.
const HUBER: f64 = 3.5;
/// A frame with a residual beyond this is no frame of this airframe, or not so turned.
const STRANGE_SIGMAS: f64 = 8.0;
/// Where markers sit against the airframe's file before the frames tell, m.
const OFFSET_SIGMA_M: f64 = 0.002;

/// How much the light of an LED differs from frame to frame before the frames tell, as a logarithm.
const LIGHT_SIGMA: f64 = 0.1;

type Information = SMatrix<f64, 7, 7>;

/// Frames, and what they share.
#[derive(Clone, Debug)]
pub(super) struct Adjustment<'a> {
    nominal: &'a Airframe,
    frames: Vec<Frame>,
    pub(super) parameters: Parameters,
    pub(super) spread: Spread,
}

/// The normal equations: of what is shared, and of each frame with what joins them. Without the priors.
pub(super) struct Equations {
    cost: f64,
    shared: DMatrix<f64>,
    gradient: DVector<f64>,
    frames: Vec<FrameEquations>,
}

/// Of one frame.
pub(super) struct FrameEquations {
    pub(super) information: Information,
    gradient: Own,
    pub(super) with_shared: DMatrix<f64>,
}

impl<'a> Adjustment<'a> {
    pub(super) fn new(nominal: &'a Airframe, frames: Vec<Frame>, shapes: Vec<Shape>) -> Self {
        let log_powers: Vec<f64> = nominal.leds().iter().map(|led| libm::log(led.power)).collect();
        let told_log_powers = log_powers.clone();
        let offsets_m = vec![Vector3::zeros(); nominal.markers().len()];
        let askew_rad = vec![Vector2::zeros(); nominal.leds().len()];
        let log_light = frames.iter().map(|frame| frame.log_light).sum::<f64>() / frames.len() as f64;
        let parameters = Parameters { log_powers, told_log_powers, shapes, askew_rad, log_light, offsets_m };
        let spread = Spread { scatter: [1.0; 2], light_sigma: LIGHT_SIGMA, offset_sigma_m: OFFSET_SIGMA_M };
        Self { nominal, frames, parameters, spread }
    }

    pub(super) fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// The same of other frames.
    pub(super) fn with_frames(self, frames: Vec<Frame>) -> Self {
        Self { frames, ..self }
    }

    /// The airframe as it is known so far; `None` where the numbers make none.
    pub(super) fn model(&self) -> Option<Model<'_>> {
        Model::new(self.nominal, &self.parameters)
    }

    /// A frame with the pose that suits it best while what is shared stays as it is, and what it then costs, nats.
    pub(super) fn posed(&self, model: &Model<'_>, frame: &Frame) -> Option<(f64, Frame)> {
        let equations = |frame: &Frame| {
            let (mut cost, mut information, mut gradient) = (0.0, Information::zeros(), Own::zeros());
            for Row { residual, by_own, .. } in model.rows(frame, &self.spread) {
                let (weight, nats) = huber(residual);
                cost += nats;
                information += by_own * by_own.transpose() * weight;
                gradient += by_own * (weight * residual);
            }
            (cost, information, gradient)
        };
        let (mut posed, mut at) = (frame.clone(), equations(frame));
        let mut damping = 1e-3;
        for _ in 0..POSE_PASSES {
            let damped = at.1 + Information::from_diagonal(&(at.1.diagonal() * damping));
            let next = moved(&posed, &damped.cholesky()?.solve(&-at.2));
            let after = equations(&next);
            if after.0 < at.0 {
                (posed, at, damping) = (next, after, damping * 0.1);
            } else {
                damping *= 10.0;
            }
        }
        at.0.is_finite().then_some((at.0, posed))
    }

    /// Goes to the least cost near by; `None` where there is none.
    pub(super) fn refine(&mut self) -> Option<()> {
        self.approach(PASSES)
    }

    /// The same in this many passes at most.
    pub(super) fn approach(&mut self, passes: usize) -> Option<()> {
        let mut equations = self.equations()?;
        let mut damping = 1e-3;
        for _ in 0..passes {
            let next = self.step(&equations, damping);
            let after = next.as_ref().and_then(Self::equations);
            let before = equations.cost + self.prior_cost();
            match (next, after) {
                (Some(next), Some(after)) if after.cost + next.prior_cost() < before => {
                    let gain = before - after.cost - next.prior_cost();
                    (*self, equations) = (next, after);
                    damping = f64::max(damping * 0.1, 1e-9);
                    if gain < ENOUGH_NATS {
                        break;
                    }
                }
                _ if damping > 1e6 => break,
                _ => damping *= 10.0,
            }
        }
        Some(())
    }

    /// Leaves out frames that cannot be what they are taken for.
    pub(super) fn leave_out_strangers(&mut self) {
        let Some(model) = Model::new(self.nominal, &self.parameters) else { return };
        let is_strange = |row: &Row| row.residual.is_nan() || row.residual.abs() > STRANGE_SIGMAS;
        self.frames.retain(|frame| !model.rows(frame, &self.spread).iter().any(is_strange));
    }

    pub(super) fn equations(&self) -> Option<Equations> {
        let (model, count) = (self.model()?, self.parameters.count());
        let mut equations = Equations {
            cost: 0.0,
            shared: DMatrix::zeros(count, count),
            gradient: DVector::zeros(count),
            frames: Vec::with_capacity(self.frames.len()),
        };
        for frame in &self.frames {
            let mut of_frame = FrameEquations::new(count);
            for row in model.rows(frame, &self.spread) {
                equations.add(&mut of_frame, &row);
            }
            // A frame without light of its own keeps the one it has.
            of_frame.information[(6, 6)] += 1e-9;
            equations.frames.push(of_frame);
        }
        equations.cost.is_finite().then_some(equations)
    }

    /// What it all costs, nats.
    pub(super) fn cost(&self) -> Option<f64> {
        Some(self.equations()?.cost + self.prior_cost())
    }

    fn prior_cost(&self) -> f64 {
        let off = self.parameters.off_prior(self.spread.offset_sigma_m);
        off.iter().map(|(off, sigma)| 0.5 * (off / sigma) * (off / sigma)).sum()
    }

    /// Information of what is shared, the poses following it, with the priors; and the gradient.
    fn shared(&self, equations: &Equations, damping: f64) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let (mut information, mut gradient) = equations.without_poses(damping)?;
        for (number, (off, sigma)) in
            self.parameters.off_prior(self.spread.offset_sigma_m).into_iter().enumerate()
        {
            information[(number, number)] += 1.0 / (sigma * sigma);
            gradient[number] += off / (sigma * sigma);
        }
        Some((information, gradient))
    }

    /// Covariance of what is shared.
    pub(super) fn covariance(&self, equations: &Equations) -> Option<DMatrix<f64>> {
        let inverse = self.shared(equations, 0.0)?.0.cholesky()?.inverse();
        inverse.iter().all(|entry| entry.is_finite()).then_some(inverse)
    }

    fn step(&self, equations: &Equations, damping: f64) -> Option<Self> {
        let (mut information, gradient) = self.shared(equations, damping)?;
        for index in 0..information.nrows() {
            information[(index, index)] += damping * equations.shared[(index, index)];
        }
        let shared = information.cholesky()?.solve(&-gradient);
        let frame = |(frame, of_frame): (&Frame, &FrameEquations)| {
            let gradient = of_frame.gradient + &of_frame.with_shared * &shared;
            Some(moved(frame, &of_frame.damped(damping).cholesky()?.solve(&-gradient)))
        };
        let frames = self.frames.iter().zip(&equations.frames).map(frame).collect::<Option<Vec<_>>>()?;
        let parameters = self.parameters.moved(shared.as_slice());
        Some(Self { frames, parameters, ..*self })
    }
}

impl Equations {
    pub(super) fn frames(&self) -> &[FrameEquations] {
        &self.frames
    }

    fn add(&mut self, frame: &mut FrameEquations, row: &Row) {
        let (weight, nats) = huber(row.residual);
        self.cost += nats;
        frame.information += row.by_own * row.by_own.transpose() * weight;
        frame.gradient += row.by_own * (weight * row.residual);
        for &(number, slope) in &row.by_shared {
            self.gradient[number] += weight * slope * row.residual;
            frame.with_shared.column_mut(number).axpy(weight * slope, &row.by_own, 1.0);
            for &(other, with) in &row.by_shared {
                self.shared[(number, other)] += weight * slope * with;
            }
        }
    }

    /// Information and gradient of what is shared alone, the poses following it.
    pub(super) fn without_poses(&self, damping: f64) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let (mut information, mut gradient) = (self.shared.clone(), self.gradient.clone());
        for frame in &self.frames {
            let followed = frame.damped(damping).cholesky()?.solve(&frame.with_shared);
            information.gemm_tr(-1.0, &frame.with_shared, &followed, 1.0);
            gradient.gemv_tr(-1.0, &followed, &frame.gradient, 1.0);
        }
        Some((information, gradient))
    }
}

/// Weight of a residual's square, and what it costs, nats.
pub(super) fn huber(residual: f64) -> (f64, f64) {
    let size = residual.abs();
    match size > HUBER {
        true => (HUBER / size, HUBER * (size - 0.5 * HUBER)),
        false => (1.0, 0.5 * size * size),
    }
}

impl FrameEquations {
    fn new(shared: usize) -> Self {
        Self {
            information: Information::zeros(),
            gradient: Own::zeros(),
            with_shared: DMatrix::zeros(7, shared),
        }
    }

    fn damped(&self, damping: f64) -> Information {
        self.information + Information::from_diagonal(&(self.information.diagonal() * damping))
    }
}
