//! Ten numbers, eleven with a clock of the target's own, by robust least squares on positions, with standard errors that allow for errors which last.

use nalgebra::{Cholesky, Isometry3, Matrix3, SMatrix, SVector, Translation3, UnitQuaternion, Vector3};

use super::{AlignError, Alignment, AlignmentSigma, FEWEST_FRAMES, Logs, Seen, TargetClock, span_s};

const COUNT: usize = 11;
type Numbers = SVector<f64, COUNT>;
type Square = SMatrix<f64, COUNT, COUNT>;

/// What is believed of lever arms before: they are on the vehicle, m.
const LEVER_SIGMA_M: f64 = 0.5;
/// No position of a result is believed better than this, m and rad.
const FLOOR: (f64, f64) = (0.02, 0.002);
/// Residuals beyond this many sigmas pull no harder (Huber 1964).
const HUBER: f64 = 2.0;
/// Errors of results within a block of time are taken as one: as long as leaves this many blocks, but not shorter than this, s.
const BLOCKS: f64 = 30.0;
const SHORTEST_BLOCK_S: f64 = 1.0;
const MOST_STEPS: usize = 30;
/// Which of the numbers is the offset of the target's clock.
const TARGET_CLOCK: usize = 10;

/// What is estimated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parameters {
    pub(super) clock_offset_s: f64,
    pub(super) target_clock_offset_s: f64,
    pub(super) body_from_camera: UnitQuaternion<f64>,
    pub(super) camera_m: Vector3<f64>,
    pub(super) airframe_m: Vector3<f64>,
}

impl Parameters {
    /// Changed by a step: the clock, a turn about the camera's axes, the camera's centre, the airframe's origin, the target's clock.
    fn stepped(&self, step: &Numbers) -> Self {
        let part = |from: usize| step.fixed_rows::<3>(from).into_owned();
        Self {
            clock_offset_s: self.clock_offset_s + step[0],
            body_from_camera: self.body_from_camera * UnitQuaternion::from_scaled_axis(part(1)),
            camera_m: self.camera_m + part(4),
            airframe_m: self.airframe_m + part(7),
            target_clock_offset_s: self.target_clock_offset_s + step[TARGET_CLOCK],
        }
    }

    /// Where the airframe is in the camera frame at a time of the frames, m.
    fn seen_m(&self, logs: &Logs<'_>, time_s: f64) -> Option<Vector3<f64>> {
        let [observer, target] = logs.at(time_s + self.clock_offset_s, self.target_clock_offset_s)?;
        let camera = Isometry3::from_parts(Translation3::from(self.camera_m), self.body_from_camera);
        let airframe = target * nalgebra::Point3::from(self.airframe_m);
        Some((observer * camera).inverse_transform_point(&airframe).coords)
    }

    fn lever_arms(&self) -> Numbers {
        let mut arms = Numbers::zeros();
        arms.fixed_rows_mut::<3>(4).copy_from(&self.camera_m);
        arms.fixed_rows_mut::<3>(7).copy_from(&self.airframe_m);
        arms
    }
}

/// The sums of one block of time.
#[derive(Clone, Copy)]
struct Sums {
    normal: Square,
    gradient: Numbers,
    cost: f64,
    frames: usize,
}

/// The numbers that fit best, from a start that is near, with their standard errors.
pub(super) fn refined(logs: &Logs<'_>, seen: &[Seen], start: Parameters) -> Result<Alignment, AlignError> {
    let (prior, free) = (prior(), free(logs.target_clock));
    let cost = |parameters: &Parameters, blocks: &[Sums]| {
        let arms = parameters.lever_arms();
        blocks.iter().map(|block| block.cost).sum::<f64>() + arms.dot(&(prior * arms))
    };
    let mut now = start;
    let mut blocks = sums(logs, seen, &now, &free);
    let mut damping = 1e-3;
    for _ in 0..MOST_STEPS {
        let normal = blocks.iter().fold(solvable(prior, &free), |sum, block| sum + block.normal);
        let gradient = blocks.iter().fold(prior * now.lever_arms(), |sum, block| sum + block.gradient);
        let damped = normal + Square::from_diagonal(&(normal.diagonal() * damping));
        let Some(solver) = Cholesky::new(damped) else { return Err(AlignError::NoTurn) };
        let step = -solver.solve(&gradient);
        let next = now.stepped(&step);
        let next_blocks = sums(logs, seen, &next, &free);
        if frames(&next_blocks) >= frames(&blocks) / 2 && cost(&next, &next_blocks) < cost(&now, &blocks) {
            let is_settled = cost(&now, &blocks) - cost(&next, &next_blocks) < 1e-9 * cost(&now, &blocks);
            (now, blocks, damping) = (next, next_blocks, damping / 10.0);
            if is_settled {
                break;
            }
        } else if damping > 1e6 {
            break;
        } else {
            damping *= 10.0;
        }
    }
    let frames = frames(&blocks);
    if frames < FEWEST_FRAMES {
        return Err(AlignError::Few(frames));
    }
    let Parameters { clock_offset_s, target_clock_offset_s, body_from_camera, camera_m, airframe_m } = now;
    let sigma = sigma(&blocks, &prior, &free).ok_or(AlignError::NoTurn)?;
    Ok(Alignment {
        clock_offset_s,
        target_clock_offset_s,
        body_from_camera,
        camera_m,
        airframe_m,
        sigma,
        frames,
    })
}

fn frames(blocks: &[Sums]) -> usize {
    blocks.iter().map(|block| block.frames).sum()
}

fn prior() -> Square {
    let mut weights = Numbers::zeros();
    weights.fixed_rows_mut::<6>(4).fill(1.0 / (LEVER_SIGMA_M * LEVER_SIGMA_M));
    Square::from_diagonal(&weights)
}

/// One for each number that is estimated, zero for the target's clock where it is that of the observer.
fn free(target_clock: TargetClock) -> Numbers {
    let mut free = Numbers::repeat(1.0);
    if target_clock == TargetClock::Shared {
        free[TARGET_CLOCK] = 0.0;
    }
    free
}

/// Normal equations, in which what is not estimated has a one on the diagonal and no step.
fn solvable(normal: Square, free: &Numbers) -> Square {
    normal + Square::from_diagonal(&free.map(|free| 1.0 - free))
}

/// Normal equations by blocks of time; of a frame the neighbour that is nearest to where the target should be.
fn sums(logs: &Logs<'_>, seen: &[Seen], at: &Parameters, free: &Numbers) -> Vec<Sums> {
    let (first_s, last_s) = span_s(seen.iter().map(|frame| frame.time_s));
    let block_s = ((last_s - first_s) / BLOCKS).max(SHORTEST_BLOCK_S);
    let mut blocks: Vec<(i64, Sums)> = Vec::new();
    for frame in seen {
        let Some(predicted) = at.seen_m(logs, frame.time_s) else { continue };
        let whitened = frame.neighbours.iter().filter_map(|(place, covariance)| {
            let (near, turn) = (FLOOR.0, FLOOR.1 * place.norm());
            let floor = Matrix3::identity() * (near * near + turn * turn);
            let root = Cholesky::new(covariance + floor)?;
            let residual = root.l().solve_lower_triangular(&(predicted - place))?;
            Some((residual, root))
        });
        let nearest = whitened.min_by(|a, b| a.0.norm_squared().total_cmp(&b.0.norm_squared()));
        let Some((residual, root)) = nearest else { continue };
        let Some(jacobian) = jacobian(logs, frame.time_s, at, free) else { continue };
        let Some(jacobian) = root.l().solve_lower_triangular(&jacobian) else { continue };
        let length = residual.norm();
        let weight = if length > HUBER { HUBER / length } else { 1.0 };
        let block = ((frame.time_s - first_s) / block_s).floor() as i64;
        if blocks.last().is_none_or(|(last, _)| *last != block) {
            let nothing = Sums { normal: Square::zeros(), gradient: Numbers::zeros(), cost: 0.0, frames: 0 };
            blocks.push((block, nothing));
        }
        let Some((_, sums)) = blocks.last_mut() else { continue };
        sums.normal += weight * jacobian.transpose() * jacobian;
        sums.gradient += weight * jacobian.transpose() * residual;
        sums.cost += if length > HUBER { HUBER * (2.0 * length - HUBER) } else { length * length };
        sums.frames += 1;
    }
    blocks.into_iter().map(|(_, sums)| sums).collect()
}

/// How the predicted position changes with each number, by central differences.
fn jacobian(logs: &Logs<'_>, time_s: f64, at: &Parameters, free: &Numbers) -> Option<SMatrix<f64, 3, COUNT>> {
    // Steps far above what rounding leaves, and far below what bends: s, rad, m.
    let steps = [1e-3, 1e-5, 1e-5, 1e-5, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-3];
    let mut jacobian = SMatrix::<f64, 3, COUNT>::zeros();
    for (column, step) in steps.into_iter().enumerate() {
        let mut small = Numbers::zeros();
        small[column] = step;
        let [ahead, behind] = [small, -small].map(|small| at.stepped(&small).seen_m(logs, time_s));
        jacobian.set_column(column, &((ahead? - behind?) * (free[column] / (2.0 * step))));
    }
    Some(jacobian)
}

/// Standard errors by the scatter of the blocks' gradients (the sandwich of Huber 1967, White 1980, with blocks as clusters).
fn sigma(blocks: &[Sums], prior: &Square, free: &Numbers) -> Option<AlignmentSigma> {
    let normal = blocks.iter().fold(solvable(*prior, free), |sum, block| sum + block.normal);
    let bread = Cholesky::new(normal)?.inverse();
    let count = blocks.len() as f64;
    let scatter =
        blocks.iter().fold(Square::zeros(), |sum, block| sum + block.gradient * block.gradient.transpose());
    // What the numbers took from the scatter is given back.
    let filling = scatter * (count / (count - free.sum()).max(1.0)) + prior;
    let of = (bread * filling * bread).diagonal().map(f64::sqrt);
    let part = |from: usize| of.fixed_rows::<3>(from).into_owned();
    Some(AlignmentSigma {
        clock_offset_s: of[0],
        target_clock_offset_s: of[TARGET_CLOCK],
        rotation_rad: part(1),
        camera_m: part(4),
        airframe_m: part(7),
    })
}
