//! Reports without identities -> the only way in which all of them agree, or how many there are.

use super::group::{Edge, Network, fit};
use super::hypotheses::{Hypothesis, hypotheses};
use super::{Group, Report, Unclear};

/// Ways whose misfit is larger than the best one's by no more than that are not told apart: a wrong one is better than the right one
/// by chance about once in three million.
const SURE: f64 = 30.0;
/// Screening takes shared errors for independent ones: what it may be off by.
const SCREENING: f64 = 60.0;
/// This many ways are fitted.
const MOST_WAYS: usize = 24;

/// The group in the level frame of the first report.
pub(super) fn identify(reports: &[&Report]) -> Result<Group, Unclear> {
    let (own, others) = (reports[0], &reports[1..]);
    let options: Vec<Vec<Hypothesis>> = others.iter().map(|other| hypotheses(own, other)).collect();
    let mut ways = Ways { options: &options, best: f64::INFINITY, found: Vec::new() };
    ways.search(&mut Vec::new(), 0.0);
    let (best, mut found) = (ways.best, ways.found);
    found.retain(|(_, cost)| *cost <= best + SCREENING);
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    found.truncate(MOST_WAYS);
    let mut fitted: Vec<Group> =
        found.iter().filter_map(|(way, _)| fit(&network(reports, &options, way))).collect();
    // More sights explained by the same vehicles weigh as what a lonely one costs; all ways are of the same sights.
    fitted.sort_by(|a, b| weight(a).total_cmp(&weight(b)));
    let Some(best) = fitted.first().map(weight) else { return Err(Unclear::NoAgreement) };
    let ways = fitted.iter().filter(|group| weight(group) <= best + SURE).count();
    if ways > 1 { Err(Unclear::Ambiguous { ways }) } else { Ok(fitted.swap_remove(0)) }
}

/// The misfit, and what it costs to leave a sight out (three of freedom): so much that no way wins by it that is not wrong.
fn weight(group: &Group) -> f64 {
    group.misfit - 20.0 * group.freedom as f64
}

/// The search for ways in which each who reports is another sight.
struct Ways<'a> {
    options: &'a [Vec<Hypothesis>],
    best: f64,
    /// Of each who reports which hypothesis, and the cost of all.
    found: Vec<(Vec<usize>, f64)>,
}

impl Ways<'_> {
    fn search(&mut self, chosen: &mut Vec<usize>, cost: f64) {
        if cost > self.best + SCREENING {
            return;
        }
        let options = self.options;
        let Some(next) = options.get(chosen.len()) else {
            self.best = self.best.min(cost);
            self.found.push((chosen.clone(), cost));
            // Only the best are kept, so that a symmetric crowd takes no more room than another.
            if self.found.len() > 8 * MOST_WAYS {
                self.found.sort_by(|a, b| a.1.total_cmp(&b.1));
                self.found.truncate(MOST_WAYS);
                self.best = self.best.min(self.found[MOST_WAYS - 1].1 - SCREENING);
            }
            return;
        };
        for (k, option) in next.iter().enumerate() {
            let taken = chosen.iter().zip(options).any(|(k, own)| own[*k].sight == option.sight);
            if !taken {
                chosen.push(k);
                self.search(chosen, cost + option.cost);
                chosen.pop();
            }
        }
    }
}

/// Who sees whom, if each reporter is what a way takes it for.
fn network(reports: &[&Report], options: &[Vec<Hypothesis>], way: &[usize]) -> Network {
    let ids = reports.iter().map(|report| report.from).collect();
    let chosen: Vec<&Hypothesis> = way.iter().zip(options).map(|(k, own)| &own[*k]).collect();
    // Which vehicle one of the first vehicle's sights is.
    let vehicle = |sight: usize| chosen.iter().position(|h| h.sight == sight).map(|k| k + 1);
    let own = reports[0].sights.iter().enumerate();
    let mut edges: Vec<Edge> =
        own.filter_map(|(s, sight)| Edge::new(0, vehicle(s)?, &sight.position_m)).collect();
    for (k, (hypothesis, report)) in chosen.iter().zip(&reports[1..]).enumerate() {
        for (t, sight) in report.sights.iter().enumerate() {
            let to = if t == hypothesis.back { Some(0) } else { hypothesis.matches[t].and_then(vehicle) };
            edges.extend(to.filter(|to| *to != k + 1).and_then(|to| Edge::new(k + 1, to, &sight.position_m)));
        }
    }
    Network { ids, edges }
}
