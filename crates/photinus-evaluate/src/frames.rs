//! Every frame of truth with its result, or without one; what cannot be compared is refused.

use std::collections::BTreeMap;
use std::fmt;

use nalgebra::Vector3;
use photinus_io::dataset::{TruthFrame, TruthNeighbour};
use photinus_io::results::{FrameRecord, NeighbourRecord, TrackRecord};

use crate::Settings;
use crate::pairing::leds::LedPairing;
use crate::pairing::neighbours::{bearing_error_rad, pair};

/// How much `distance_m` of truth may differ from the length of its position, as a share of it.
const DISTANCE_TOLERANCE: f64 = 1e-3;

/// One of the two things that are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// What was there.
    Truth,
    /// What was reported.
    Results,
}

/// Why results cannot be compared with truth.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluateError {
    /// No frame at all on one side.
    #[error("the {0} hold no frame")]
    Empty(Side),
    /// The two have no frame in common.
    #[error(
        "no frame is in both: truth has {} to {}, the results {} to {}",
        truth.0, truth.1, results.0, results.1
    )]
    NothingInCommon {
        /// First and last frame of truth.
        truth: (u64, u64),
        /// First and last frame of the results.
        results: (u64, u64),
    },
    /// The same frame at another time.
    #[error("the results have it at {results_s} s, truth at {truth_s} s")]
    Time {
        /// The frame.
        frame: u64,
        /// Its time in truth, s.
        truth_s: f64,
        /// Its time in the results, s.
        results_s: f64,
    },
    /// A frame that stands twice on one side.
    #[error("the frame stands twice in the {1}")]
    RepeatedFrame(u64, Side),
    /// A neighbour that stands twice in a frame of truth.
    #[error("neighbour {1} stands twice in the frame")]
    RepeatedNeighbour(u64, u32),
    /// A distance of truth that is not the length of its position.
    #[error("neighbour {id} is at {distance_m} m, but its position is {length_m} m away")]
    Distance {
        /// The frame.
        frame: u64,
        /// The neighbour.
        id: u32,
        /// Its distance.
        distance_m: f64,
        /// The length of its position.
        length_m: f64,
    },
}

impl EvaluateError {
    /// The frame that it is about, where it is one.
    pub fn frame(&self) -> Option<u64> {
        match *self {
            Self::Empty(_) | Self::NothingInCommon { .. } => None,
            Self::Time { frame, .. } | Self::Distance { frame, .. } => Some(frame),
            Self::RepeatedFrame(frame, _) | Self::RepeatedNeighbour(frame, _) => Some(frame),
        }
    }

    /// The side whose file is at fault.
    pub fn side(&self) -> Side {
        match *self {
            Self::Empty(side) | Self::RepeatedFrame(_, side) => side,
            Self::NothingInCommon { .. } | Self::Time { .. } => Side::Results,
            Self::RepeatedNeighbour(..) | Self::Distance { .. } => Side::Truth,
        }
    }
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Truth => "truth",
            Self::Results => "results",
        })
    }
}

/// A neighbour that was found, beside its truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair<'a> {
    /// The frame.
    pub frame: u64,
    /// Its time in truth, s.
    pub time_s: f64,
    /// What was there.
    pub truth: &'a TruthNeighbour,
    /// What was reported.
    pub found: &'a NeighbourRecord,
}

impl Pair<'_> {
    /// The angle between the reported bearing and truth, rad.
    pub fn bearing_error_rad(&self) -> Option<f64> {
        bearing_error_rad(self.truth, self.found)
    }
}

/// A frame of truth and what the results say of it.
#[derive(Debug)]
pub(crate) struct ComparedFrame<'a> {
    pub(crate) truth: &'a TruthFrame,
    pub(crate) record: Option<&'a FrameRecord>,
    pub(crate) leds: LedPairing<'a>,
    /// Indices of (truth, found) neighbours, by truth.
    pub(crate) neighbours: Vec<(usize, usize)>,
    /// Indices of (truth, followed) neighbours, by truth.
    pub(crate) tracks: Vec<(usize, usize)>,
}

/// All frames of truth, in the order of their numbers.
#[derive(Debug)]
pub(crate) struct Compared<'a> {
    pub(crate) frames: Vec<ComparedFrame<'a>>,
    pub(crate) pairs: Vec<Pair<'a>>,
    /// Frames of the results that truth says nothing about.
    pub(crate) without_truth: usize,
    /// Whether truth lists LEDs at all.
    pub(crate) has_leds: bool,
}

impl<'a> Compared<'a> {
    pub(crate) fn new(
        truth: &'a [TruthFrame],
        results: &'a [FrameRecord],
        settings: &Settings,
    ) -> Result<Self, EvaluateError> {
        let truth = by_number(truth.iter().map(|frame| (frame.frame, frame)), Side::Truth)?;
        // The reader numbers records that do not say their own.
        let numbered = results.iter().zip(0..).map(|(record, line)| (record.frame.unwrap_or(line), record));
        let mut records = by_number(numbered, Side::Results)?;
        if !truth.keys().any(|frame| records.contains_key(frame)) {
            return Err(EvaluateError::NothingInCommon { truth: ends(&truth), results: ends(&records) });
        }
        let mut frames = Vec::with_capacity(truth.len());
        for (number, truth) in truth {
            check(truth)?;
            let record = records.remove(&number);
            check_time(truth, record, settings)?;
            let found = record.map_or(&[][..], |record| &record.neighbours);
            frames.push(ComparedFrame {
                truth,
                record,
                leds: LedPairing::new(truth, record, settings.spot_gate_px),
                neighbours: pair(&truth.neighbours, found, settings),
                tracks: pair(&truth.neighbours, record.map_or(&[][..], |record| &record.tracks), settings),
            });
        }
        let has_leds = frames.iter().any(|frame| !frame.leds.leds.is_empty());
        let pairs = frames.iter().flat_map(ComparedFrame::pairs).collect();
        Ok(Self { frames, pairs, without_truth: records.len(), has_leds })
    }
}

impl<'a> ComparedFrame<'a> {
    /// Neighbours that were reported.
    pub(crate) fn found(&self) -> &'a [NeighbourRecord] {
        self.record.map_or(&[], |record| &record.neighbours)
    }

    /// Neighbours that are followed, seen or not.
    pub(crate) fn followed(&self) -> &'a [TrackRecord] {
        self.record.map_or(&[], |record| &record.tracks)
    }

    /// The neighbour of truth that a reported one is, with the two side by side.
    pub(crate) fn pair_of(&self, found: usize) -> Option<(usize, Pair<'a>)> {
        let place = self.neighbours.iter().position(|pair| pair.1 == found)?;
        self.pairs().nth(place).map(|pair| (self.neighbours[place].0, pair))
    }

    /// Indices of the neighbours of truth that can be seen: with an LED in the image, or all where truth lists no LED at all.
    pub(crate) fn visible(&self, has_leds: bool) -> impl Iterator<Item = usize> + use<'a> {
        let there = self.truth.neighbours.iter().enumerate();
        there.filter(move |(_, there)| !has_leds || !there.leds.is_empty()).map(|(index, _)| index)
    }

    fn pairs(&self) -> impl Iterator<Item = Pair<'a>> + use<'a, '_> {
        let pair = |&(truth, found): &(usize, usize)| Pair {
            frame: self.truth.frame,
            time_s: self.truth.time_s,
            truth: &self.truth.neighbours[truth],
            found: &self.found()[found],
        };
        self.neighbours.iter().map(pair)
    }
}

fn by_number<T>(
    frames: impl Iterator<Item = (u64, T)>,
    side: Side,
) -> Result<BTreeMap<u64, T>, EvaluateError> {
    let mut numbered = BTreeMap::new();
    for (number, frame) in frames {
        if numbered.insert(number, frame).is_some() {
            return Err(EvaluateError::RepeatedFrame(number, side));
        }
    }
    if numbered.is_empty() { Err(EvaluateError::Empty(side)) } else { Ok(numbered) }
}

fn ends<T>(frames: &BTreeMap<u64, T>) -> (u64, u64) {
    let end = |frame: Option<&u64>| frame.copied().unwrap_or_default();
    (end(frames.keys().next()), end(frames.keys().next_back()))
}

fn check(truth: &TruthFrame) -> Result<(), EvaluateError> {
    let frame = truth.frame;
    let mut ids: Vec<u32> = truth.neighbours.iter().map(|neighbour| neighbour.id).collect();
    ids.sort_unstable();
    if let Some(twice) = ids.windows(2).find(|two| two[0] == two[1]) {
        return Err(EvaluateError::RepeatedNeighbour(frame, twice[0]));
    }
    for &TruthNeighbour { id, distance_m, position_m, .. } in &truth.neighbours {
        let length_m = Vector3::from(position_m).norm();
        if !(length_m > 0.0 && (length_m - distance_m).abs() <= DISTANCE_TOLERANCE * length_m) {
            return Err(EvaluateError::Distance { frame, id, distance_m, length_m });
        }
    }
    Ok(())
}

fn check_time(
    truth: &TruthFrame,
    record: Option<&FrameRecord>,
    settings: &Settings,
) -> Result<(), EvaluateError> {
    match record.and_then(|record| record.time_s) {
        Some(results_s) if (results_s - truth.time_s).abs() > settings.time_tolerance_s => {
            Err(EvaluateError::Time { frame: truth.frame, truth_s: truth.time_s, results_s })
        }
        _ => Ok(()),
    }
}
