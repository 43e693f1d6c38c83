//! Two hexarotors cross in the image, one behind the other: whether each keeps its track and its name.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use photinus_io::dataset::TruthFrame;
use rand_pcg::Pcg64;

use crate::flight::fly_well;
use crate::scene::{HEXAROTOR, RATE_HZ, between, blink, head, parse, target, word};
use crate::score::{SURE, pair};

const DURATION_S: f64 = 3.0;
/// A round of a word, s.
const ROUND_S: f64 = 18.0 / RATE_HZ;
/// Tracks have begun, s.
const BEGUN_S: f64 = 3.0 * ROUND_S;
/// Markers so near to each other are one spot, rad: 2.5 px.
const CELL_RAD: f64 = 2.5 * 3.77e-3;
const RADIUS_M: f64 = 0.4;

/// What became of crossings.
#[derive(Default)]
struct Outcome {
    crossings: usize,
    /// Those after which one had another track, or another's name, a round after they were apart; and those with one that had no track.
    switched: usize,
    misnamed: usize,
    lost: usize,
    /// The longest that a wrong track lasted after they were apart, s.
    longest_s: f64,
}

pub(crate) fn table(seeds: RangeInclusive<u64>) {
    println!(
        "| LEDs | crossings | another track, longer than a round | another's name, longer than a round | without a track | the longest with another track, s |\n|---|---|---|---|---|---|"
    );
    for (name, is_blinking) in [("blinking", true), ("steady", false)] {
        let mut outcome = Outcome::default();
        seeds.clone().for_each(|seed| outcome.add(seed, is_blinking));
        let Outcome { crossings, switched, misnamed, lost, longest_s } = outcome;
        println!("| {name} | {crossings} | {switched} | {misnamed} | {lost} | {longest_s:.2} |");
    }
}

impl Outcome {
    /// Flies the crossing of a seed.
    fn add(&mut self, seed: u64, is_blinking: bool) {
        let mut before: BTreeMap<u32, u64> = BTreeMap::new();
        let (mut have_met, mut apart_s) = (false, None);
        let (mut is_switched, mut is_misnamed, mut is_lost) = (false, false, false);
        fly_well(&scene(seed, is_blinking), |lookout, truth| {
            let pairs = pair(&lookout.tracked().tracks, &truth.neighbours);
            if is_apart(truth) && !have_met && truth.time_s < BEGUN_S {
                before.extend(pairs.iter().map(|(track, there)| (there.id, track.id)));
            }
            have_met |= !is_apart(truth);
            if !have_met || !is_apart(truth) {
                return;
            }
            let since_s = truth.time_s - *apart_s.get_or_insert(truth.time_s);
            is_lost |= pairs.len() < truth.neighbours.len();
            for (track, there) in pairs {
                if before.get(&there.id) != Some(&track.id) {
                    self.longest_s = self.longest_s.max(since_s);
                    is_switched |= since_s > ROUND_S;
                }
                let name = lookout.name(track.id).filter(|name| name.probability >= SURE);
                is_misnamed |= since_s > ROUND_S && name.is_some_and(|name| name.id != there.id);
            }
        });
        self.crossings += usize::from(apart_s.is_some());
        self.switched += usize::from(is_switched);
        self.misnamed += usize::from(is_misnamed);
        self.lost += usize::from(is_lost);
    }
}

/// Whether the spots of the two are apart.
fn is_apart(truth: &TruthFrame) -> bool {
    let [a, b] = [0, 1].map(|of| nalgebra::Vector3::from(truth.neighbours[of].position_m));
    let reach_rad = RADIUS_M / a.norm() + RADIUS_M / b.norm() + CELL_RAD;
    a.angle(&b) > reach_rad
}

fn scene(seed: u64, is_blinking: bool) -> photinus_sim::Scene {
    let mut random = Pcg64::new(u128::from(seed), 0xc5055);
    let mut between = |low: f64, high: f64| between(&mut random, low, high);
    let near_m = between(4.0, 6.0);
    let far_m = near_m + between(1.5, 3.0);
    let mut text = head(seed, DURATION_S);
    for (number, ahead_m) in [near_m, far_m].into_iter().enumerate() {
        let side = if number == 0 { 1.0 } else { -1.0 };
        let (half_m, up_m) = (side * ahead_m * between(0.25, 0.45), 5.0 + ahead_m * between(-0.01, 0.01));
        let motion = format!(
            "line = {{ from_m = [{ahead_m:?}, {half_m:?}, {up_m:?}], to_m = [{ahead_m:?}, {:?}, {up_m:?}], duration_s = {DURATION_S:?} }}",
            -half_m
        );
        let mut rest = format!("heading_deg = {:?}\n", between(0.0, 360.0));
        let (shift_s, ppm) = (between(0.001, 0.3), between(-30.0, 30.0));
        if is_blinking {
            rest += &blink(&[word(number)], RATE_HZ, shift_s, ppm);
        }
        text += &target(number + 1, HEXAROTOR, &motion, "", &rest);
    }
    parse(&text)
}
