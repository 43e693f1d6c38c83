//! Claimed probabilities against what was right: reliability by decile, and what each least probability would keep.
//!
//! A reported neighbour is right where it is paired with one of truth, as everywhere here. Those of neighbours with no LED in
//! the image are neither right nor false and take no part. Pairs are those of all that was reported, whatever is kept.

use serde::Serialize;

use super::spread::{mean, share};
use crate::frames::{Compared, ComparedFrame};

/// A right neighbour whose position is off by more than this, in sigma, is told as far off.
const FAR_OFF_SIGMAS: f64 = 5.0;
/// Deciles of claimed probability.
const DECILES: usize = 10;
/// What a user may set `--min-probability` to: precision and recall are told at each.
const LEAST: [f64; 13] = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 0.999];

/// Whether the probability of neighbours keeps its word.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbabilityScore {
    /// Reported neighbours that claim a probability and are right or false.
    pub count: usize,
    /// The mean of what they claim.
    pub claimed: f64,
    /// How many of them are right: `claimed * count` are to be expected.
    pub right: usize,
    /// Mean of |share that is right - mean claim| over the deciles, each by its count (Naeini et al., AAAI 2015); 0 is best.
    pub expected_calibration_error: f64,
    /// Mean of (claim - 1 if right, else 0)^2 (Brier, 1950); 0 is best.
    pub brier: f64,
    /// Area under precision over recall, of what was reported in the order of its claims; `None` where nothing was visible.
    pub average_precision: Option<f64>,
    /// Reliability, those deciles that hold anything.
    pub deciles: Vec<Decile>,
    /// Precision and recall at each least probability.
    pub kept: Vec<Kept>,
}

/// The neighbours whose claims are within a decile.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Decile {
    /// The smallest probability in it.
    pub from: f64,
    /// Up to this, which belongs to the next one but for 1.
    pub to: f64,
    /// How many.
    pub count: usize,
    /// The mean of what they claim.
    pub claimed: f64,
    /// How many are right: `claimed * count` are to be expected.
    pub right: usize,
    /// Right ones whose position is off by more than 5 sigma.
    pub far_off: usize,
}

/// What is left where less likely neighbours are dropped.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Kept {
    /// Neighbours are at least so likely.
    pub min_probability: f64,
    /// How many of them are right.
    pub found: usize,
    /// How many of them are not.
    #[serde(rename = "false")]
    pub false_neighbours: usize,
    /// found / visible.
    pub recall: Option<f64>,
    /// found / (found + false).
    pub precision: Option<f64>,
}

/// A reported neighbour: its claim, and what it is.
#[derive(Clone, Copy)]
struct Claim {
    probability: f64,
    is_right: bool,
    is_far_off: bool,
}

impl ProbabilityScore {
    /// `None` where no neighbour claims a probability.
    pub(crate) fn new(compared: &Compared<'_>) -> Option<Self> {
        let has_leds = compared.has_leds;
        let mut claims: Vec<Claim> =
            compared.frames.iter().flat_map(|frame| claims(frame, has_leds)).collect();
        claims.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        let visible = compared.frames.iter().map(|frame| frame.visible(has_leds).count()).sum();
        let square = |claim: &Claim| {
            let off = claim.probability - f64::from(u8::from(claim.is_right));
            off * off
        };
        let deciles: Vec<Decile> = (0..DECILES).filter_map(|decile| Decile::of(decile, &claims)).collect();
        Some(Self {
            count: claims.len(),
            claimed: mean(claims.iter().map(|claim| claim.probability))?,
            right: right(&claims),
            expected_calibration_error: expected_calibration_error(&deciles)?,
            brier: mean(claims.iter().map(square))?,
            average_precision: average_precision(&claims, visible),
            deciles,
            kept: LEAST.map(|least| Kept::new(least, &claims, visible)).to_vec(),
        })
    }
}

/// Mean of |share that is right - mean claim| over deciles, each by its count; `None` of nothing.
pub fn expected_calibration_error(deciles: &[Decile]) -> Option<f64> {
    let count: usize = deciles.iter().map(|decile| decile.count).sum();
    let off = |decile: &Decile| (decile.right as f64 - decile.claimed * decile.count as f64).abs();
    (count > 0).then(|| deciles.iter().map(off).sum::<f64>() / count as f64)
}

fn right(claims: &[Claim]) -> usize {
    claims.iter().filter(|claim| claim.is_right).count()
}

fn claims<'a>(frame: &'a ComparedFrame<'_>, has_leds: bool) -> impl Iterator<Item = Claim> + 'a {
    frame.found().iter().enumerate().filter_map(move |(found, reported)| {
        let probability = reported.probability?;
        let pair = frame.pair_of(found);
        let is_seen = |truth: usize| frame.visible(has_leds).any(|visible| visible == truth);
        let is_far_off =
            pair.and_then(|(_, pair)| pair.nees()).is_some_and(|nees| nees > FAR_OFF_SIGMAS * FAR_OFF_SIGMAS);
        pair.is_none_or(|(truth, _)| is_seen(truth)).then_some(Claim {
            probability,
            is_right: pair.is_some(),
            is_far_off,
        })
    })
}

impl Decile {
    fn of(decile: usize, claims: &[Claim]) -> Option<Self> {
        let is_in =
            |claim: &&Claim| ((claim.probability * DECILES as f64) as usize).min(DECILES - 1) == decile;
        let those: Vec<Claim> = claims.iter().filter(is_in).copied().collect();
        Some(Self {
            from: decile as f64 / DECILES as f64,
            to: (decile + 1) as f64 / DECILES as f64,
            count: those.len(),
            claimed: mean(those.iter().map(|claim| claim.probability))?,
            right: right(&those),
            far_off: those.iter().filter(|claim| claim.is_far_off).count(),
        })
    }
}

impl Kept {
    /// Of claims from the likeliest down.
    fn new(min_probability: f64, claims: &[Claim], visible: usize) -> Self {
        let kept = &claims[..claims.partition_point(|claim| claim.probability >= min_probability)];
        let found = right(kept);
        Self {
            min_probability,
            found,
            false_neighbours: kept.len() - found,
            recall: share(found, visible),
            precision: share(found, kept.len()),
        }
    }
}

/// Over claims from the likeliest down: the mean precision where each right one is reached, those that claim the same reached
/// together, and 0 for those that never are.
fn average_precision(claims: &[Claim], visible: usize) -> Option<f64> {
    let (mut kept, mut found, mut area) = (0, 0, 0.0);
    for same in claims.chunk_by(|a, b| a.probability.total_cmp(&b.probability).is_eq()) {
        kept += same.len();
        found += right(same);
        area += right(same) as f64 * found as f64 / kept as f64;
    }
    (visible > 0).then(|| area / visible as f64)
}

#[cfg(test)]
mod tests {
    use photinus_io::results::NeighbourRecord;

    use super::*;
    use crate::hand_made::{found_at, record, shining, there, truth};
    use crate::{Settings, evaluate};

    const HERE: [f64; 3] = [0.0, 0.0, 5.0];
    const ELSEWHERE: [f64; 3] = [0.0, -3.0, 3.0];

    fn claiming(position_m: [f64; 3], probability: f64) -> NeighbourRecord {
        NeighbourRecord { probability: Some(probability), ..found_at(position_m) }
    }

    /// A frame with one neighbour for each list of what is reported.
    fn scored(reported: &[&[NeighbourRecord]]) -> Option<ProbabilityScore> {
        let truth: Vec<_> = (0..reported.len() as u64)
            .map(|frame| truth(frame, vec![shining(1, HERE, &[[9.0, 9.0]])]))
            .collect();
        let results: Vec<_> =
            (0..).zip(reported).map(|(frame, reported)| record(frame, vec![], reported.to_vec())).collect();
        evaluate(&truth, &results, &Settings::default()).unwrap().scores.probability
    }

    fn is_near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    #[test]
    fn reliability_by_hand() {
        let score = scored(&[
            &[claiming(HERE, 0.9), claiming(ELSEWHERE, 0.22)],
            &[claiming(HERE, 1.0)],
            &[claiming(ELSEWHERE, 0.94)],
            &[claiming(HERE, 0.28)],
        ])
        .unwrap();
        assert_eq!((score.count, score.right), (5, 3));
        assert!(is_near(score.claimed, 3.34 / 5.0));
        let [low, high] = score.deciles[..] else { panic!("{:?}", score.deciles) };
        assert!(is_near(low.from, 0.2) && is_near(low.to, 0.3) && is_near(low.claimed, 0.25));
        assert_eq!((low.count, low.right), (2, 1));
        assert!(is_near(high.from, 0.9) && is_near(high.to, 1.0) && is_near(high.claimed, 2.84 / 3.0));
        assert_eq!((high.count, high.right), (3, 2));
        // |1 - 0.5| and |2 - 2.84|, of five
        assert!(is_near(score.expected_calibration_error, (0.5 + 0.84) / 5.0));
        assert!(is_near(score.brier, (0.01 + 0.22 * 0.22 + 0.0 + 0.94 * 0.94 + 0.72 * 0.72) / 5.0));
    }

    #[test]
    fn precision_and_recall_by_hand() {
        let score = scored(&[
            &[claiming(HERE, 0.95), claiming(ELSEWHERE, 0.5)],
            &[claiming(HERE, 0.5)],
            &[claiming(ELSEWHERE, 0.7)],
            &[],
        ])
        .unwrap();
        let at = |least: f64| *score.kept.iter().find(|kept| is_near(kept.min_probability, least)).unwrap();
        let told =
            |least: f64| (at(least).found, at(least).false_neighbours, at(least).recall, at(least).precision);
        assert_eq!(told(0.0), (2, 2, Some(0.5), Some(0.5)));
        assert_eq!(told(0.5), (2, 2, Some(0.5), Some(0.5)), "what is just as likely is kept");
        assert_eq!(told(0.6), (1, 1, Some(0.25), Some(0.5)));
        assert_eq!(told(0.95), (1, 0, Some(0.25), Some(1.0)));
        assert_eq!(told(0.99), (0, 0, Some(0.0), None));
        // The first at precision 1, the second with its equal at 2 / 4, two of four never.
        assert!(is_near(score.average_precision.unwrap(), (1.0 + 0.5) / 4.0));
    }

    #[test]
    fn a_right_neighbour_at_a_wrong_place_is_right_and_far_off() {
        // sigma is 0.1 m per axis
        let score = scored(&[&[claiming([0.0, 0.0, 5.6], 0.8)], &[claiming([0.0, 0.0, 5.4], 0.8)]]).unwrap();
        assert_eq!((score.deciles[0].right, score.deciles[0].far_off), (2, 1));
        assert!(is_near(score.deciles[0].from, 0.8), "the lower end belongs to a decile");
    }

    #[test]
    fn what_claims_nothing_or_cannot_be_judged_takes_no_part() {
        assert_eq!(scored(&[&[found_at(HERE)]]), None);
        assert_eq!(scored(&[&[found_at(HERE), claiming(ELSEWHERE, 0.4)]]).unwrap().count, 1);
        // The second neighbour of truth has no LED in the image.
        let truth = [truth(0, vec![shining(1, HERE, &[[9.0, 9.0]]), there(2, ELSEWHERE)])];
        let results = [record(0, vec![], vec![claiming(HERE, 1.0), claiming(ELSEWHERE, 0.9)])];
        let score = evaluate(&truth, &results, &Settings::default()).unwrap().scores.probability.unwrap();
        assert_eq!((score.count, score.right, score.kept[0].recall), (1, 1, Some(1.0)));
    }
}
