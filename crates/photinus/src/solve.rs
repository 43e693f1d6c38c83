//! Least squares: a problem and a place to start from enter, the nearest place of least cost leaves.
//!
//! Levenberg and Marquardt's way down (J. J. Moré, "The Levenberg-Marquardt algorithm: implementation and theory", 1978): steps of Gauss and Newton, held
//! back by a share of the diagonal that grows until a step is better. What runs on every frame goes its own way (`pose/refine.rs`, `spots/fit.rs`).

use nalgebra::{SMatrix, SVector};

/// Held back so much at first, a share of the diagonal, and no less, and no more.
const FIRST: f64 = 1e-3;
const LEAST: f64 = 1e-12;
const MOST: f64 = 1e9;
/// After a step that is better, and after one that is not.
const LESS: f64 = 0.1;
const MORE: f64 = 8.0;
/// Added to the diagonal, so that what nothing tells of stays where it is.
const FLOOR: f64 = 1e-12;
/// A step that lowers the cost by no more than this share is the last.
const SMALL_GAIN: f64 = 1e-9;

/// What is to cost least.
pub trait Descent {
    /// What is looked for.
    type Place;
    /// The cost around a place, to second order.
    type Normal;

    /// What a place costs; `None` where nothing can be there.
    fn cost(&self, place: &Self::Place) -> Option<f64>;

    /// The cost around a place; `None` where it cannot be told.
    fn normal(&self, place: &Self::Place) -> Option<Self::Normal>;

    /// The place to which that leads, with so large a share of the diagonal added; `None` where it leads nowhere.
    fn stepped(&self, place: &Self::Place, normal: &Self::Normal, damping: f64) -> Option<Self::Place>;
}

/// The place that costs least near `start`, after no more than so many steps, and what it costs; `None` where the cost at a place that was reached, the start
/// among them, cannot be told.
pub fn descend<D: Descent>(descent: &D, start: D::Place, most_steps: u32) -> Option<(D::Place, f64)> {
    let (mut place, mut damping) = (start, FIRST);
    let mut cost = descent.cost(&place)?;
    for _ in 0..most_steps {
        let normal = descent.normal(&place)?;
        let Some((next, next_cost)) = better(descent, &place, &normal, cost, &mut damping) else { break };
        let gain = cost - next_cost;
        (place, cost) = (next, next_cost);
        if gain <= SMALL_GAIN * cost {
            break;
        }
    }
    Some((place, cost))
}

/// A place that costs less, held back as much as that needs; `None` when there is none.
fn better<D: Descent>(
    descent: &D,
    place: &D::Place,
    normal: &D::Normal,
    cost: f64,
    damping: &mut f64,
) -> Option<(D::Place, f64)> {
    while *damping < MOST {
        if let Some(next) = descent.stepped(place, normal, *damping)
            && let Some(next_cost) = descent.cost(&next).filter(|next| *next < cost)
        {
            *damping = (*damping * LESS).max(LEAST);
            return Some((next, next_cost));
        }
        *damping *= MORE;
    }
    None
}

/// The step that normal equations J'J x = -J'e lead to with a share of the diagonal added, where `downhill` is -J'e; `None` where J'J is not positive.
pub fn step<const N: usize>(
    normal: &SMatrix<f64, N, N>,
    downhill: &SVector<f64, N>,
    damping: f64,
) -> Option<SVector<f64, N>> {
    let mut damped = *normal;
    for k in 0..N {
        damped[(k, k)] += damping * damped[(k, k)] + FLOOR;
    }
    damped.cholesky().map(|factors| factors.solve(downhill))
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix2, Vector2};

    use super::*;

    /// Rosenbrock's valley: 1 - x and 10 (y - x^2), which bends; nothing is right of `wall`.
    struct Valley {
        wall: f64,
    }

    impl Valley {
        fn residuals(at: &Vector2<f64>) -> Vector2<f64> {
            Vector2::new(1.0 - at.x, 10.0 * (at.y - at.x * at.x))
        }
    }

    impl Descent for Valley {
        type Place = Vector2<f64>;
        type Normal = (Matrix2<f64>, Vector2<f64>);

        fn cost(&self, at: &Vector2<f64>) -> Option<f64> {
            (at.x < self.wall).then(|| Self::residuals(at).norm_squared())
        }

        fn normal(&self, at: &Vector2<f64>) -> Option<Self::Normal> {
            let jacobian = Matrix2::new(-1.0, 0.0, -20.0 * at.x, 10.0);
            Some((jacobian.transpose() * jacobian, -jacobian.transpose() * Self::residuals(at)))
        }

        fn stepped(
            &self,
            at: &Vector2<f64>,
            (normal, downhill): &Self::Normal,
            damping: f64,
        ) -> Option<Vector2<f64>> {
            step(normal, downhill, damping).map(|step| at + step)
        }
    }

    #[test]
    fn the_end_of_a_bent_valley_is_found() {
        let (end, cost) = descend(&Valley { wall: 9.0 }, Vector2::new(-1.2, 1.0), 100).unwrap();
        assert!((end - Vector2::new(1.0, 1.0)).norm() < 1e-6 && cost < 1e-12, "{end} {cost}");
    }

    #[test]
    fn where_nothing_can_be_is_never_gone_to() {
        let (end, cost) = descend(&Valley { wall: 0.5 }, Vector2::new(-1.2, 1.0), 100).unwrap();
        assert!(end.x < 0.5 && cost < 0.6 * 0.6, "{end} {cost}");
        assert!(descend(&Valley { wall: -2.0 }, Vector2::new(-1.2, 1.0), 100).is_none());
    }

    #[test]
    fn a_step_of_gauss_and_newton_is_what_is_left_without_damping() {
        let (normal, downhill) = (Matrix2::new(4.0, 1.0, 1.0, 3.0), Vector2::new(1.0, 2.0));
        let free = step(&normal, &downhill, 0.0).unwrap();
        assert!((normal * free - downhill).norm() < 1e-9);
        let held = step(&normal, &downhill, 1e6).unwrap();
        assert!(held.norm() < 1e-5 * free.norm() && held.dot(&downhill) > 0.0);
        assert!(step(&-normal, &downhill, 0.0).is_none());
    }
}
