//! How many words a book can have at most: groups of candidates that all conflict with each other, each of which has one word of a
//! book at most, laid over the candidates until each is covered several times.
//!
//! With so many groups that every candidate lies in `m` of them, `m` words of a book count `m` times among `groups`: a book has at
//! most `groups / m` words. Which groups to lay is a linear program, solved nearly by weights that fall as a candidate is covered
//! (N. Young, "Randomized rounding without solving the linear program", SODA 1995). The bound holds however well it is solved.

use alloc::collections::{BTreeMap, BinaryHeap};
use alloc::vec;
use alloc::vec::Vec;
use core::cmp::Ordering;

use super::super::Word;
use super::candidates::Requirements;
use super::conflicts::{Conflicts, first};

/// How often every candidate is covered.
const LAYERS: u32 = 60;

/// By what a candidate's weight falls when a group covers it.
const FALL: f64 = 0.85;

/// No set of candidates without conflicts is larger.
pub(super) fn at_most(conflicts: &Conflicts, requirements: &Requirements, words: &[Word]) -> usize {
    let mut groups = balls(requirements, words);
    for group in &mut groups {
        widen(group, conflicts);
    }
    groups.sort_unstable();
    groups.dedup();
    laid(&groups, words.len())
}

/// Candidates that lie near one point: any two of them are closer than the distance asked for. Around a circle of bits lie those
/// that differ from it in up to half of what is too close; when that is odd, one more bit of all is free.
fn balls(requirements: &Requirements, words: &[Word]) -> Vec<Vec<u32>> {
    let length = requirements.length();
    let index: BTreeMap<Word, u32> = words.iter().copied().zip(0..).collect();
    let too_close = requirements.distance().saturating_sub(1);
    let free_bits = if too_close % 2 == 1 { length } else { 1 };
    let circles = (0..1_u64 << length).map(|number| Word::of(number, length as u32));
    let mut balls: Vec<Vec<u32>> = Vec::new();
    for centre in circles.filter(|word| word.least_turned() == *word) {
        for free in 0..free_bits {
            let mut ball = Vec::new();
            let also = if too_close % 2 == 1 { 1 << free } else { 0 };
            around(centre.number(), length as u32, too_close / 2, 0, &mut |number| {
                for number in [number, number ^ also] {
                    ball.extend(index.get(&Word::of(number, length as u32).least_turned()));
                }
            });
            ball.sort_unstable();
            ball.dedup();
            if !ball.is_empty() {
                balls.push(ball);
            }
        }
    }
    balls.sort_unstable();
    balls.dedup();
    balls
}

/// Every number that differs from `number` in up to `radius` of its bits from `from` on.
fn around(number: u64, length: u32, radius: u32, from: u32, each: &mut impl FnMut(u64)) {
    each(number);
    if radius > 0 {
        (from..length).for_each(|bit| around(number ^ 1 << bit, length, radius - 1, bit + 1, each));
    }
}

/// Adds what conflicts with every member, from the least number on.
fn widen(group: &mut Vec<u32>, conflicts: &Conflicts) {
    let Some((&one, others)) = group.split_first() else { return };
    let mut may_join = conflicts.row(one as usize).to_vec();
    let narrow = |may_join: &mut [u64], v: usize| {
        may_join.iter_mut().zip(conflicts.row(v)).for_each(|(bits, row)| *bits &= row);
    };
    others.iter().for_each(|&v| narrow(&mut may_join, v as usize));
    while let Some(v) = first(&may_join) {
        group.push(v as u32);
        narrow(&mut may_join, v);
    }
    group.sort_unstable();
}

/// A group and what it weighed when that was last added up; weights only fall.
struct Weighed {
    weight: f64,
    group: u32,
}

/// Lays the heaviest group again and again: the least `groups / layers` that was met.
fn laid(groups: &[Vec<u32>], candidates: usize) -> usize {
    let mut weights = vec![1.0_f64; candidates];
    let mut layers = vec![0_u32; candidates];
    // every candidate lies in the ball around itself
    let (mut open, mut depth, mut count) = (candidates, 0_u32, 0_usize);
    let mut at_most = candidates;
    let weigh = |group: &[u32], weights: &[f64]| group.iter().map(|&v| weights[v as usize]).sum::<f64>();
    let mut heaviest: BinaryHeap<Weighed> = (0..)
        .zip(groups)
        .map(|(group, members)| Weighed { weight: weigh(members, &weights), group })
        .collect();
    while depth < LAYERS {
        let Some(top) = heaviest.pop() else { break };
        let members = &groups[top.group as usize];
        let weight = weigh(members, &weights);
        if heaviest.peek().is_some_and(|next| next.weight > weight) {
            heaviest.push(Weighed { weight, ..top });
            continue;
        }
        count += 1;
        for &v in members {
            weights[v as usize] *= FALL;
            layers[v as usize] += 1;
            open -= usize::from(layers[v as usize] == depth + 1);
        }
        heaviest.push(Weighed { weight: weigh(members, &weights), ..top });
        while open == 0 {
            depth += 1;
            open = layers.iter().filter(|&&layers| layers == depth).count();
            at_most = at_most.min(count / depth as usize);
        }
    }
    at_most
}

impl PartialEq for Weighed {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Weighed {}

impl PartialOrd for Weighed {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Weighed {
    fn cmp(&self, other: &Self) -> Ordering {
        self.weight.total_cmp(&other.weight).then_with(|| other.group.cmp(&self.group))
    }
}
