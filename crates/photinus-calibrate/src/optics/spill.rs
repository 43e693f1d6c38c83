//! What the excess of full pixels does: the share that spills into the four neighbours, and from which charge on.
//!
//! Every spot with full pixels is explained by its light, spread by the point spread, overflowing: place, light and level are
//! fitted for a spill and a well that all spots share, and these are where all together are explained best. How much a fit is
//! worse without a tenth of the spots tells how sure they are; a spill that only few spots gain by is none. Where nothing is seen to
//! spill, nothing is known of larger charges than those that would have been seen to.

use nalgebra::{Matrix4, Vector4};
use photinus::optics::Measured;

use super::SPILL_BELIEVED;
use super::field::Field;
use super::noise::{Noise, least};
use super::saturation::Pile;
use super::spot::Spot;
use super::table::{FARTHEST_PX, Shares};

/// Spill, and the well where it is larger than what the converter tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spill {
    pub(super) share: Measured,
    pub(super) well_dn: Option<Measured>,
    /// Whether any charge was seen to spill: otherwise the share is what is believed, of what is above the largest charge that was seen not to.
    pub(super) is_seen: bool,
}

/// Spots used at most, and at least.
const MOST: usize = 60;
const LEAST_SPOTS: usize = 12;
/// Most full pixels of a spot that is used.
const MOST_FULL: usize = 30;
const REACH: usize = 7;
const SIDE: usize = 2 * REACH + 1;
/// Wells tried, in units of what a full pixel reads.
const WELLS: [f64; 5] = [1.0, 1.6, 2.5, 4.0, 6.3];
/// Spills tried first.
const SHARES: [f64; 4] = [0.0, 0.33, 0.67, 1.0];
/// Most steps of the fit of a spot, and the share of its cost that is too little to go on for: a spill was 0.92 for 0.98 where fits ended early.
const MOST_STEPS_OF_FIT: usize = 20;
const CONVERGED: f64 = 1e-4;
const PARTS: usize = 10;
/// What spots gain by a spill, summed, is more than this many sigmas of that.
const TOLD_SIGMAS: f64 = 3.0;
/// A spot that gains so much by a spill gains surely; one that gains more is no reason to doubt that the others do.
const MOST_GAIN: f64 = 25.0;
/// Where nothing is seen to spill: wells tried, each so many times the one before, and what spots cost by an overflow that would have been seen.
const WELL_STEP: f64 = 1.15;
const MOST_STEPS: i32 = 30;
const SEEN_COST: f64 = 4.0;
/// One spot counts at most this much against a spill: it may be two LEDs.
const MOST_COST: f64 = 60.0;

/// Overflow as it is tried.
#[derive(Clone, Copy)]
struct Tried {
    share: f64,
    /// Well over what a full pixel reads.
    well: f64,
}

const NO_SPILL: Tried = Tried { share: 0.0, well: 1.0 };

/// A spot with full pixels on its way.
#[derive(Clone)]
struct Full<'a, 'b> {
    spot: &'b Spot<'a>,
    at: Vector4<f64>,
}

/// Learns the spill from spots of which some have full pixels; `None` where too few have.
pub(super) fn learn(spots: &[Spot<'_>], field: &Field, noise: &Noise, pile: &Pile) -> Option<Spill> {
    let full = |spot: &&Spot<'_>| {
        let count = spot.window.within(REACH).filter(|(.., value)| *value >= pile.least_dn()).count();
        !spot.is_linear() && spot.window.reach >= REACH && count <= MOST_FULL
    };
    let all: Vec<&Spot<'_>> = spots.iter().filter(full).collect();
    if all.len() < LEAST_SPOTS {
        return None;
    }
    let step = all.len().div_ceil(MOST);
    let model = Model { field, noise, pile };
    let mut fulls: Vec<Full<'_, '_>> = all.into_iter().step_by(step).map(|spot| model.start(spot)).collect();
    let mut best = (f64::INFINITY, NO_SPILL);
    for well in WELLS {
        for share in SHARES {
            let tried = Tried { share, well };
            let cost = sum(&model.costs(&mut fulls, tried));
            if cost < best.0 {
                best = (cost, tried);
            }
        }
    }
    let mut found = best.1;
    for _ in 0..2 {
        model.costs(&mut fulls, found);
        // A larger spill from a larger well is much like a smaller one from a smaller: each share is tried with the well that goes with it.
        let share = least(
            |share| sum(&model.with_best_well(&fulls, Tried { share, ..found }).0),
            (found.share - 0.35).max(0.0),
            (found.share + 0.35).min(1.0),
            7,
        );
        found = model.with_best_well(&fulls, Tried { share, ..found }).1;
    }
    model.costs(&mut fulls, found);
    if is_told(&model.gains(&fulls, found)) {
        let [share, well] = model.jackknife(&fulls, found);
        if share.value > 2.0 * share.sigma {
            let well = (well.value > 1.05).then_some(well);
            let well_dn = well.map(|well| Measured {
                value: pile.level_dn * well.value,
                sigma: pile.level_dn * well.sigma,
            });
            return Some(Spill { share, well_dn, is_seen: true });
        }
    }
    let well = model.largest_seen_well(&mut fulls)?;
    let well = Measured { value: pile.level_dn * well, sigma: pile.level_dn * well * (WELL_STEP - 1.0) };
    Some(Spill { share: SPILL_BELIEVED, well_dn: Some(well), is_seen: false })
}

struct Model<'a> {
    field: &'a Field,
    noise: &'a Noise,
    pile: &'a Pile,
}

impl Model<'_> {
    /// The best of a few lights, without spill.
    fn start<'a, 'b>(&self, spot: &'b Spot<'a>) -> Full<'a, 'b> {
        let start = |times: f64| {
            let mut full = Full {
                spot,
                at: Vector4::from([spot.u, spot.v, libm::log(spot.light.max(50.0) * times), spot.level]),
            };
            let cost = self.fit(&mut full, NO_SPILL, 5);
            (cost, full)
        };
        let starts = [0.7, 1.5, 3.0, 8.0].map(start);
        let best = starts.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or_else(|| Full { spot, at: Vector4::zeros() }, |(_, full)| full)
    }

    /// How badly each spot is explained.
    fn costs(&self, fulls: &mut [Full<'_, '_>], tried: Tried) -> Vec<f64> {
        fulls.iter_mut().map(|full| self.fit(full, tried, MOST_STEPS_OF_FIT)).collect()
    }

    /// How badly each spot is explained with a share and the well that goes with it best, tried near the one it has.
    fn with_best_well(&self, fulls: &[Full<'_, '_>], tried: Tried) -> (Vec<f64>, Tried) {
        let costs = |tried: Tried| self.costs(&mut fulls.to_vec(), tried);
        if tried.well <= 1.0 {
            return (costs(tried), tried);
        }
        let log = libm::log(tried.well);
        let at = |log: f64| Tried { well: libm::exp(log), ..tried };
        let log = least(|log| sum(&costs(at(log))), (log - 0.2).max(0.0), log + 0.2, 7);
        (costs(at(log)), at(log))
    }

    /// Levenberg's steps for place, logarithm of light, and level; the cost where they end.
    fn fit(&self, full: &mut Full<'_, '_>, tried: Tried, steps: usize) -> f64 {
        let mut damping = 1e-2;
        let mut left = self.left(full, tried);
        let mut cost = square(&left);
        for _ in 0..steps {
            const STEPS: [f64; 4] = [0.02, 0.02, 0.02, 0.1];
            let aside: [Vec<f64>; 4] = std::array::from_fn(|k| {
                let mut moved = full.clone();
                moved.at[k] += STEPS[k];
                self.left(&moved, tried)
            });
            let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
            for (index, left) in left.iter().enumerate() {
                let row = Vector4::from_fn(|k, _| (left - aside[k][index]) / STEPS[k]);
                normal += row * row.transpose();
                right += row * *left;
            }
            (0..4).for_each(|k| normal[(k, k)] *= 1.0 + damping);
            let Some(step) = normal.cholesky().map(|factor| factor.solve(&right)) else { break };
            let mut moved = full.clone();
            let limits = [0.3, 0.3, 0.7, 5.0];
            (0..4).for_each(|k| moved.at[k] += step[k].clamp(-limits[k], limits[k]));
            (0..2).for_each(|k| moved.at[k] = moved.at[k].clamp(-FARTHEST_PX, FARTHEST_PX));
            let next = self.left(&moved, tried);
            let next_cost = square(&next);
            let is_there = (next_cost - cost).abs() < CONVERGED * cost;
            if next_cost < cost {
                (*full, left, cost, damping) = (moved, next, next_cost, 0.3 * damping);
            } else {
                damping *= 8.0;
            }
            if is_there {
                break;
            }
        }
        cost.min(MOST_COST * (SIDE * SIDE) as f64)
    }

    /// What is left of each pixel over its sigma.
    fn left(&self, full: &Full<'_, '_>, tried: Tried) -> Vec<f64> {
        let [u, v, log_light, level] = full.at.into();
        let light = libm::exp(log_light);
        let mut shares = Shares::default();
        let place = [full.spot.window.column as f64 + u, full.spot.window.row as f64 + v];
        self.field.at(place).window(u, v, REACH, &mut shares);
        let reads = (self.pile.level_dn - level).max(1.0);
        let mut charge: Vec<f64> = shares.of_pixels.iter().map(|share| light * share.value).collect();
        overflow(&mut charge, reads * tried.well, tried.share);
        let window = full.spot.window.within(REACH);
        charge
            .iter()
            .zip(window)
            .map(|(&charge, (column, row, value))| {
                let value = f64::from(value);
                let level = level + full.spot.ground.above_middle(column, row);
                let is_full = value >= f64::from(self.pile.least_dn());
                if is_full && charge >= reads {
                    return 0.0;
                }
                let spread = self.pile.spread_dn;
                let wrong = 0.01 * charge;
                let variance = self.noise.variance(charge.min(reads)) + spread * spread + wrong * wrong;
                (value - level - charge.min(reads)) / variance.sqrt()
            })
            .collect()
    }

    /// What each spot gains by a spill.
    fn gains(&self, fulls: &[Full<'_, '_>], found: Tried) -> Vec<f64> {
        let [without, with] = [NO_SPILL, found].map(|tried| self.costs(&mut fulls.to_vec(), tried));
        without.iter().zip(&with).map(|(without, with)| without - with).collect()
    }

    /// The largest well whose overflow would have been seen; `None` where it is no larger than what a full pixel reads.
    fn largest_seen_well(&self, fulls: &mut [Full<'_, '_>]) -> Option<f64> {
        let without = sum(&self.costs(fulls, NO_SPILL));
        let scale = (without / (fulls.len() * (SIDE * SIDE - 4)) as f64).max(1.0);
        let wells = (0..MOST_STEPS).map(|step| WELL_STEP.powi(step));
        let is_seen = |well: &f64| {
            let tried = Tried { share: SPILL_BELIEVED.sigma, well: *well };
            sum(&self.costs(&mut fulls.to_vec(), tried)) - without > SEEN_COST * scale
        };
        wells.take_while(is_seen).last().filter(|well| *well > 1.0)
    }

    /// The place of the least cost by a parabola, and its scatter when tenths of the spots are left out.
    fn jackknife(&self, fulls: &[Full<'_, '_>], found: Tried) -> [Measured; 2] {
        let of = |tried: Tried| self.costs(&mut fulls.to_vec(), tried);
        let middle = of(found);
        let parabola = |low: &[f64], high: &[f64], step: f64, part: usize| {
            let rest = |costs: &[f64]| -> f64 {
                costs.iter().enumerate().filter(|(k, _)| k % PARTS != part).map(|(_, cost)| cost).sum()
            };
            let [low, middle, high] = [rest(low), rest(&middle), rest(high)];
            let bend = low + high - 2.0 * middle;
            if bend > 0.0 { (0.5 * step * (low - high) / bend).clamp(-2.0 * step, 2.0 * step) } else { 0.0 }
        };
        let measured = |value: f64, low: Vec<f64>, high: Vec<f64>, step: f64| {
            let all = parabola(&low, &high, step, PARTS);
            let parts = (0..PARTS).map(|part| parabola(&low, &high, step, part) - all);
            let square: f64 = parts.map(|off| off * off).sum();
            Measured {
                value: value + all,
                sigma: (square * (PARTS - 1) as f64 / PARTS as f64).sqrt().max(1e-3),
            }
        };
        const STEP: f64 = 0.06;
        let share = found.share.clamp(STEP, 1.0 - STEP);
        let at = |off: f64| {
            let share = (found.share + off).clamp(0.0, 1.0);
            self.with_best_well(fulls, Tried { share, ..found }).0
        };
        let spill = if (share - found.share).abs() > 0.5 * STEP {
            // at an end of what can be: as sure as the slope there allows
            let inward = if found.share < 0.5 { at(STEP) } else { at(-STEP) };
            let rise: f64 = sum(&inward) - sum(&middle);
            let scale = sum(&middle) / (middle.len() * (SIDE * SIDE - 4)) as f64;
            let sigma = STEP * (scale.max(1.0) / rise.max(1e-3)).sqrt();
            Measured { value: found.share, sigma: sigma.min(0.5) }
        } else {
            measured(found.share, at(-STEP), at(STEP), STEP)
        };
        let times = |factor: f64| {
            let well = (found.well * factor).max(1.0);
            let cost = |share: f64| sum(&of(Tried { share, well }));
            let share = least(cost, (found.share - 0.2).max(0.0), (found.share + 0.2).min(1.0), 7);
            of(Tried { share, well })
        };
        let well = if found.well > 1.05 {
            let of_spots = measured(found.well, times(0.95), times(1.05), 0.05 * found.well);
            // Without a tenth of the spots the share is not searched anew: what it leaves open of the well comes on top.
            let aside = found.share + if found.share > 0.5 { -spill.sigma } else { spill.sigma };
            let share = aside.clamp(0.0, 1.0);
            let of_share = self.with_best_well(fulls, Tried { share, ..found }).1.well - found.well;
            Measured { sigma: libm::hypot(of_spots.sigma, of_share), ..of_spots }
        } else {
            Measured { value: found.well, sigma: 0.05 }
        };
        [Measured { value: spill.value.clamp(0.0, 1.0), ..spill }, well]
    }
}

/// Whether spots together are explained better by a spill than without: a few that are two LEDs, or of no point spread that is known, may
/// gain by one that is none.
fn is_told(gains: &[f64]) -> bool {
    let gains = gains.iter().map(|gain| gain.clamp(-MOST_GAIN, MOST_GAIN));
    let (sum, squares) = gains.fold((0.0, 0.0), |(sum, squares), gain| (sum + gain, squares + gain * gain));
    sum > TOLD_SIGMAS * f64::sqrt(squares)
}

/// Lets charge above the well go: a share of it in equal parts to the four neighbours, the rest is drained.
fn overflow(charge: &mut [f64], well: f64, share: f64) {
    const SWEEPS: usize = 400;
    let mut excess = vec![0.0; charge.len()];
    for _ in 0..SWEEPS {
        let mut most = 0.0_f64;
        for (charge, excess) in charge.iter_mut().zip(&mut excess) {
            *excess = (*charge - well).max(0.0);
            *charge -= *excess;
            most = most.max(*excess);
        }
        if most < 0.2 || share <= 0.0 {
            return;
        }
        let part = 0.25 * share;
        for (index, excess) in excess.iter().enumerate() {
            let given = part * excess;
            if given > 0.0 {
                let (column, row) = (index % SIDE, index / SIDE);
                let beside = [
                    (column > 0).then(|| index - 1),
                    (column + 1 < SIDE).then_some(index + 1),
                    (row > 0).then(|| index - SIDE),
                    (row + 1 < SIDE).then_some(index + SIDE),
                ];
                beside.into_iter().flatten().for_each(|other| charge[other] += given);
            }
        }
    }
}

fn sum(costs: &[f64]) -> f64 {
    costs.iter().sum()
}

fn square(left: &[f64]) -> f64 {
    left.iter().map(|left| (left * left).min(MOST_COST)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_spot_that_gains_most_is_no_doubt_of_the_others() {
        let even = vec![20.0; 12];
        assert!(is_told(&even));
        assert!(is_told(&[&even[..], &[900.0]].concat()));
        assert!(!is_told(&[&[0.5; 40][..], &[900.0, 900.0]].concat()), "two LEDs side by side, twice");
    }
}
