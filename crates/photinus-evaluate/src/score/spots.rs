//! Spots against the LEDs of truth: how many, and how far off their centres are.

use std::collections::BTreeMap;

use nalgebra::{Matrix2, Vector2};
use photinus_io::dataset::TruthLed;
use photinus_io::results::SpotRecord;
use serde::Serialize;

use super::classes::{ClassScore, SpotClass};
use super::range::{ByRange, RangeBins};
use super::spread::{Spread, mean, share};
use crate::frames::ComparedFrame;
use crate::pairing::leds::{LedFate, SpotFate};

/// LEDs that are no further apart are seen in one place, px.
const SAME_PLACE_PX: f64 = 0.05;

/// Spots against the LEDs of truth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Spots {
    /// Over all, and by the distance of the LED's neighbour. A false spot is binned by the distance that the results say
    /// its neighbour is at; one of no neighbour counts over all alone.
    #[serde(flatten)]
    pub by_range: ByRange<SpotScore>,
    /// Spots of one LED alone, by what they look like.
    pub classes: BTreeMap<SpotClass, ClassScore>,
    /// LEDs missed because what is there was rejected, by the reason.
    pub rejected_leds: BTreeMap<String, usize>,
}

/// How many spots, and how far off their centres are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SpotScore {
    /// LEDs of truth.
    pub leds: usize,
    /// LEDs that have a spot of their own.
    pub found: usize,
    /// LEDs whose light is in the spot of another: they count neither as found nor as missed.
    pub merged: usize,
    /// LEDs without a spot, those that were rejected included.
    pub missed: usize,
    /// Spots near an LED that has another spot.
    pub double: usize,
    /// Spots near no LED.
    #[serde(rename = "false")]
    pub false_spots: usize,
    /// found / (found + missed).
    pub recall: Option<f64>,
    /// found / (found + double + false).
    pub precision: Option<f64>,
    /// Distance of a spot's centre from its LED, px, for spots of one LED alone.
    pub centroid_error_px: Spread,
    /// Mean of column minus true column, px.
    pub centroid_bias_u_px: Option<f64>,
    /// Mean of row minus true row, px.
    pub centroid_bias_v_px: Option<f64>,
    /// Mean squared error over covariance; 2 where covariances are right.
    pub centroid_nees: Option<f64>,
}

/// Something to count.
enum Count<'a> {
    Led(LedFate, Option<Centroid<'a>>),
    Double,
    False,
}

/// A spot of one LED alone, and how far off it is.
#[derive(Clone, Copy)]
pub(crate) struct Centroid<'a> {
    spot: &'a SpotRecord,
    class: SpotClass,
    pub(crate) error_px: Vector2<f64>,
}

impl Spots {
    pub(crate) fn new(frames: &[ComparedFrame<'_>], bins: &RangeBins) -> Self {
        let counts: Vec<(Option<f64>, Count<'_>)> = frames.iter().flat_map(counts).collect();
        let mut rejected_leds = BTreeMap::new();
        for frame in frames {
            for fate in &frame.leds.led_fates {
                if let (LedFate::Rejected(entry), Some(record)) = (fate, frame.record) {
                    *rejected_leds.entry(record.rejected[*entry].reason.clone()).or_default() += 1;
                }
            }
        }
        let mut by_class: BTreeMap<SpotClass, Vec<Centroid<'_>>> = BTreeMap::new();
        for centroid in counts.iter().filter_map(|(_, count)| count.centroid()) {
            by_class.entry(centroid.class).or_default().push(centroid);
        }
        Self {
            by_range: ByRange::new(bins, &counts, |(range_m, _)| *range_m, SpotScore::new),
            classes: by_class.into_iter().map(|(class, all)| (class, ClassScore::new(&all))).collect(),
            rejected_leds,
        }
    }
}

/// What one frame has to count, each with its range.
fn counts<'a>(frame: &ComparedFrame<'a>) -> Vec<(Option<f64>, Count<'a>)> {
    let pairing = &frame.leds;
    let spots = frame.record.map_or(&[][..], |record| &record.spots);
    // LEDs in one place are one light.
    let is_shared = |spot: usize, own: &TruthLed| {
        let others =
            pairing.leds.iter().zip(&pairing.led_fates).filter(|(_, fate)| **fate == LedFate::Merged(spot));
        others.into_iter().any(|(other, _)| {
            libm::hypot(other.led.u_px - own.u_px, other.led.v_px - own.v_px) > SAME_PLACE_PX
        })
    };
    let mut counts = Vec::new();
    for (led, &fate) in pairing.leds.iter().zip(&pairing.led_fates) {
        let centroid = match fate {
            LedFate::Found(index) if !is_shared(index, led.led) => {
                let spot = &spots[index];
                let error_px = Vector2::new(spot.u_px - led.led.u_px, spot.v_px - led.led.v_px);
                Some(Centroid { spot, class: SpotClass::of(index, spots), error_px })
            }
            _ => None,
        };
        counts.push((Some(led.range_m), Count::Led(fate, centroid)));
    }
    for (spot, fate) in pairing.spot_fates.iter().enumerate() {
        match fate {
            SpotFate::True(_) => {}
            SpotFate::Double(led) => counts.push((Some(pairing.leds[*led].range_m), Count::Double)),
            SpotFate::False => counts.push((reported_range_m(frame, spot), Count::False)),
        }
    }
    counts
}

/// How far away the results say that a spot is.
fn reported_range_m(frame: &ComparedFrame<'_>, spot: usize) -> Option<f64> {
    frame.found().iter().find(|found| found.spots.contains(&spot))?.distance_m.estimate
}

impl SpotScore {
    fn new(counts: &[&(Option<f64>, Count<'_>)]) -> Self {
        let count = |of: fn(&Count<'_>) -> bool| counts.iter().filter(|(_, count)| of(count)).count();
        let centroids: Vec<Centroid<'_>> = counts.iter().filter_map(|(_, count)| count.centroid()).collect();
        let found = count(|count| matches!(count, Count::Led(LedFate::Found(_), _)));
        let missed = count(|count| matches!(count, Count::Led(LedFate::Missed | LedFate::Rejected(_), _)));
        let double = count(|count| matches!(count, Count::Double));
        let false_spots = count(|count| matches!(count, Count::False));
        Self {
            leds: count(|count| matches!(count, Count::Led(..))),
            found,
            merged: count(|count| matches!(count, Count::Led(LedFate::Merged(_), _))),
            missed,
            double,
            false_spots,
            recall: share(found, found + missed),
            precision: share(found, found + double + false_spots),
            centroid_error_px: Spread::of(centroids.iter().map(|centroid| centroid.error_px.norm())),
            centroid_bias_u_px: mean(centroids.iter().map(|centroid| centroid.error_px.x)),
            centroid_bias_v_px: mean(centroids.iter().map(|centroid| centroid.error_px.y)),
            centroid_nees: mean(centroids.iter().filter_map(Centroid::nees)),
        }
    }
}

impl<'a> Count<'a> {
    fn centroid(&self) -> Option<Centroid<'a>> {
        match self {
            Self::Led(_, centroid) => *centroid,
            Self::Double | Self::False => None,
        }
    }
}

impl Centroid<'_> {
    /// The squared error over the covariance that the spot claims; `None` where that cannot be inverted.
    pub(crate) fn nees(&self) -> Option<f64> {
        let [[uu, uv], [vu, vv]] = self.spot.covariance_px2;
        let inverse = Matrix2::new(uu, uv, vu, vv).try_inverse()?;
        Some(self.error_px.dot(&(inverse * self.error_px))).filter(|nees| nees.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use photinus_io::results::{FrameRecord, NeighbourRecord};

    use super::*;
    use crate::hand_made::{found_at, record, rejected, shining, spot, truth};
    use crate::{Settings, evaluate};

    #[test]
    fn a_frame_scored_by_hand() {
        let far = [0.0, 0.0, 8.0];
        let leds = [[10.0, 10.0], [50.0, 50.0], [52.0, 50.0], [80.0, 80.0], [90.0, 10.0]];
        let truth = [truth(0, vec![shining(1, far, &leds), shining(2, [0.0, 0.0, 2.5], &[[200.0, 200.0]])])];
        // A spot 0.5 px off; one for two LEDs; two for one LED; nothing; something rejected; something false.
        let spots = vec![
            spot(10.3, 10.4, 4),
            spot(50.5, 50.0, 9),
            spot(80.0, 80.0, 1),
            spot(82.0, 80.0, 1),
            spot(300.0, 300.0, 4),
        ];
        let neighbour = NeighbourRecord { spots: vec![4], ..found_at([3.0, 0.0, 4.0]) };
        let results = [FrameRecord {
            rejected: vec![rejected(201.0, 200.0, "sun")],
            ..record(0, spots, vec![neighbour])
        }];
        let scores = evaluate(&truth, &results, &Settings::default()).unwrap().scores.spots.unwrap();
        let all = &scores.by_range.overall;
        assert_eq!((all.leds, all.found, all.merged, all.missed), (6, 3, 1, 2));
        assert_eq!((all.double, all.false_spots), (1, 1));
        assert_eq!((all.recall, all.precision), (Some(3.0 / 5.0), Some(3.0 / 5.0)));
        assert_eq!(scores.rejected_leds, BTreeMap::from([("sun".to_owned(), 1)]));
        // The spot of two LEDs says nothing about centres.
        assert_eq!(all.centroid_error_px.count, 2);
        assert!((all.centroid_error_px.rms.unwrap() - (0.25f64 / 2.0).sqrt()).abs() < 1e-12);
        assert!((all.centroid_bias_u_px.unwrap() - 0.15).abs() < 1e-12);
        assert!((all.centroid_bias_v_px.unwrap() - 0.2).abs() < 1e-12);
        assert!((all.centroid_nees.unwrap() - 0.25 * 12.0 / 2.0).abs() < 1e-9);
        // The second spot is of two LEDs, the fourth a double: one is left alone, one is beside its double.
        let classes: Vec<_> = scores.classes.iter().map(|(class, score)| (*class, score.count)).collect();
        assert_eq!(classes, [(SpotClass::Small, 1), (SpotClass::Beside, 1)]);
        assert!((scores.classes[&SpotClass::Small].nees.unwrap() - 0.25 * 12.0).abs() < 1e-9);
        let bins: Vec<_> = scores.by_range.bins.iter().map(|bin| (bin.from_m, bin.score.recall)).collect();
        assert_eq!(bins, [(2.0, Some(0.0)), (4.0, None), (8.0, Some(0.75))]);
        assert_eq!(
            scores.by_range.bins[1].score.precision,
            Some(0.0),
            "binned where its neighbour was said to be"
        );
    }

    #[test]
    fn leds_in_one_place_are_one_light() {
        let count = |apart_px: f64| {
            let leds = [[100.0, 100.0], [100.0 + apart_px, 100.0]];
            let truth = [truth(0, vec![shining(1, [0.0, 0.0, 4.0], &leds)])];
            let results = [record(0, vec![spot(100.0, 100.0, 4)], vec![])];
            let scores = evaluate(&truth, &results, &Settings::default()).unwrap().scores.spots.unwrap();
            scores.by_range.overall.centroid_error_px.count
        };
        assert_eq!((count(0.01), count(1.0)), (1, 0));
    }

    #[test]
    fn a_large_spot_is_found_by_its_own_size() {
        let truth = [truth(0, vec![shining(1, [0.0, 0.0, 1.0], &[[100.0, 100.0]])])];
        let recall = |area_px| {
            let results = [record(0, vec![spot(108.0, 100.0, area_px)], vec![])];
            let scores = evaluate(&truth, &results, &Settings::default()).unwrap().scores;
            scores.spots.unwrap().by_range.overall.recall
        };
        assert_eq!((recall(9), recall(300)), (Some(0.0), Some(1.0)));
    }
}
