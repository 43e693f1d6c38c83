//! Many normal distributions of one vehicle -> few: those of no weight go, those that say the same become one, unless that is wider than is split again.

use alloc::vec::Vec;

use super::component::{Component, YAW, merged};
use super::state::MOST_COMPONENTS;

/// A share of the weight that counts for nothing.
const NEGLIGIBLE: f64 = 1e-4;
/// Distributions whose means are nearer than this, squared and in variances of the heavier one, become one.
const SAME: f64 = 1.0;

/// Reduces normal distributions in place; their weights add up to 1 afterwards, the heaviest first.
pub(super) fn reduce(components: &mut Vec<Component>, straight_rad: f64) {
    let total: f64 = components.iter().map(|component| component.weight).sum();
    components.retain(|component| component.weight > NEGLIGIBLE * total);
    let mut kept = 0;
    while kept < components.len() && kept < MOST_COMPONENTS {
        heaviest_first(&mut components[kept..]);
        let heaviest = components[kept];
        let Some(factor) = heaviest.covariance.cholesky() else {
            components.remove(kept);
            continue;
        };
        let is_same = |other: &Component| {
            let off = heaviest.step_to(other);
            let widest_rad2 = heaviest.covariance[(YAW, YAW)].max(other.covariance[(YAW, YAW)]);
            let yaw_rad2 = widest_rad2 + 0.25 * off[YAW] * off[YAW];
            yaw_rad2 < straight_rad * straight_rad && off.dot(&factor.solve(&off)) < SAME
        };
        // Those that say the same, brought next to it.
        let mut end = kept + 1;
        for index in kept + 1..components.len() {
            if is_same(&components[index]) {
                components.swap(end, index);
                end += 1;
            }
        }
        if let Some(one) = merged(components[kept..end].iter()) {
            components[kept] = one;
            components.drain(kept + 1..end);
        }
        kept += 1;
    }
    components.truncate(kept);
    heaviest_first(components);
    let total: f64 = components.iter().map(|component| component.weight).sum();
    components.iter_mut().for_each(|component| component.weight /= total);
}

fn heaviest_first(components: &mut [Component]) {
    components.sort_unstable_by(|a, b| {
        let by_place = || a.pose.position_m.norm().total_cmp(&b.pose.position_m.norm());
        b.weight.total_cmp(&a.weight).then_with(by_place)
    });
}
