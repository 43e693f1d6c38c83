//! A frame's sightings -> the marker tracks, moved on: a line per stage.

use alloc::vec::Vec;

use nalgebra::{Matrix2, Matrix3, Rotation3};

use super::association::Association;
use super::frame::{Frame, Turn};
use super::hearing::Listeners;
use super::near::{Directions, near};
use super::presence::Passage;
use super::seen::Seen;
use super::told::MarkerTrack;
use super::track::{Candidate, Expected, Track};
use super::turn::OwnTurn;
use super::{Settings, SettingsError};
use crate::camera::{Bearing, Camera};
use crate::identity::decoder::{Decoder, TimeStands, Who};
use crate::optics::LogLight;

/// Tracks at most: beyond, no new ones begin.
const MOST_TRACKS: usize = 512;
/// Sightings that no track explains are counted over so long, s.
const COUNTED_S: f64 = 1.0;
/// There are never fewer of them than this in a frame.
const LEAST_UNEXPLAINED: f64 = 0.1;
/// A sighting that some track explains better than this begins none.
const WORTH_BEGINNING: f64 = 0.2;
/// A first sighting is never more probably a marker.
const MOST_NEW: f64 = 0.5;
/// Half of all new markers come so near to others, rad: to the arms of a vehicle of 0.8 m across, 5 m away.
const BESIDE_RAD: f64 = 0.1;
const BESIDE_SR: f64 = core::f64::consts::PI * BESIDE_RAD * BESIDE_RAD;
/// For how long at least a frame is looked at for what is new: the first has none before it, s.
const SHORTEST_S: f64 = 1.0 / 60.0;
/// After so long without a frame nobody is where they were, s.
const LONGEST_S: f64 = 5.0;
/// However near two tracks are, they are told apart at times.
const MOST_MELTED: f64 = 0.9;

/// Follows blinking markers from frame to frame.
#[derive(Debug)]
pub struct Follower {
    settings: Settings,
    listeners: Listeners,
    field_sr: f64,
    last_s: Option<f64>,
    /// First those that have a number, in its order.
    tracks: Vec<Track>,
    next_number: u64,
    own_turn: OwnTurn,
    /// Sightings in a frame that no track explains.
    unexplained: f64,
    sightings: Directions,
    seen: Vec<Seen>,
    confirmed: Directions,
    association: Association,
    candidates: Vec<Candidate>,
    /// Where the candidates of each track begin.
    first: Vec<usize>,
    claims: Vec<f64>,
    told: Vec<MarkerTrack>,
}

impl Follower {
    /// Of a camera, with the code book of the fleet; without one all markers are taken for steady lights.
    ///
    /// # Errors
    /// [`SettingsError`] for settings that have no meaning.
    pub fn new(camera: &Camera, decoder: Option<Decoder>, settings: Settings) -> Result<Self, SettingsError> {
        settings.check()?;
        Ok(Self {
            listeners: Listeners::new(decoder),
            field_sr: core::f64::consts::TAU * (1.0 - libm::cos(camera.field_limit_rad())),
            last_s: None,
            tracks: Vec::new(),
            next_number: 0,
            own_turn: OwnTurn::new(&settings),
            unexplained: 1.0,
            sightings: Directions::default(),
            seen: Vec::new(),
            confirmed: Directions::default(),
            association: Association::default(),
            candidates: Vec::new(),
            first: Vec::new(),
            claims: Vec::new(),
            told: Vec::new(),
            settings,
        })
    }

    /// The tracks of the last frame, oldest first.
    pub fn tracks(&self) -> &[MarkerTrack] {
        &self.told
    }

    /// Fills in how likely the track of this number is each word of the book, in its order, if anything shines there; nothing where there is no such track,
    /// no book, or too little was heard.
    pub fn tell_words(&self, number: u64, words: &mut Vec<f64>) {
        words.clear();
        let own = self.tracks.iter().find(|own| own.number == Some(number));
        let listener = own.and_then(|own| own.hearing.listener());
        if let Some((decoder, listener)) = self.listeners.decoder().zip(listener) {
            let shines = (1.0 - decoder.probability(listener, Who::Dark)).max(f64::MIN_POSITIVE);
            words.extend(
                (0..decoder.words()).map(|word| decoder.probability(listener, Who::Word(word)) / shines),
            );
        }
    }

    /// Forgets all tracks: a clock was set back, or frames are of another place. Numbers are not used again.
    pub fn restart(&mut self) {
        for mut track in self.tracks.drain(..) {
            self.listeners.take(&mut track.hearing);
        }
        self.told.clear();
        self.last_s = None;
        self.unexplained = 1.0;
        self.own_turn.forget(&self.settings);
    }

    /// Moves all tracks on by a frame.
    ///
    /// # Errors
    /// [`TimeStands`] when the frame is not after the one before, or its time is no number: nothing was changed.
    pub fn follow(&mut self, frame: &Frame<'_>) -> Result<&[MarkerTrack], TimeStands> {
        let passed_s = self.last_s.map_or(0.0, |last_s| frame.time_s - last_s);
        if !frame.time_s.is_finite() || (self.last_s.is_some() && passed_s <= 0.0) {
            return Err(TimeStands);
        }
        if passed_s > LONGEST_S {
            self.restart();
        }
        self.last_s = Some(frame.time_s);
        self.sightings.of_sightings(frame.sightings);
        self.wait(frame, passed_s);
        if passed_s > 0.0 {
            self.turn(frame, passed_s);
        }
        self.expect(frame, passed_s);
        self.look_at_each(frame, passed_s);
        self.associate(frame);
        self.learn(frame);
        self.number_tracks();
        self.begin_tracks(frame, passed_s);
        self.end_tracks();
        self.tell();
        Ok(&self.told)
    }

    /// Time passes for all tracks.
    fn wait(&mut self, frame: &Frame<'_>, passed_s: f64) {
        for track in &mut self.tracks {
            track.motion.wait(passed_s, self.settings.acceleration_rad2_s3);
            track.frame.lit = self.listeners.light_at(&track.hearing, frame.time_s, frame.exposure_s);
            if let Some(level) = &mut track.level {
                level.wait(passed_s);
            }
        }
    }

    /// Takes out how the observer turned: as told, or as all tracks together tell.
    fn turn(&mut self, frame: &Frame<'_>, passed_s: f64) {
        if let Some(Turn { now_from_before, sigma_rad }) = frame.turn {
            let covariance_rad2 = Matrix3::identity() * (sigma_rad * sigma_rad);
            self.own_turn.forget(&self.settings);
            self.turn_tracks(&now_from_before, Some(&covariance_rad2));
            return;
        }
        let (expected, covariance_rad2) = self.own_turn.expect(passed_s, &self.settings);
        self.turn_tracks(&expected, None);
        let others_per_sr = self.others_per_sr();
        for track in &self.tracks {
            let (place, by_turn) = (track.motion.covariance().bearing, track.motion.by_turn());
            let open = place + by_turn.transpose() * covariance_rad2 * by_turn;
            let odds = track.presence.in_sight() * track.frame.lit / others_per_sr;
            near(&track.motion, frame.sightings, &self.sightings, &open, |index, offset| {
                self.own_turn.add(index, &offset, &place, by_turn, odds);
            });
        }
        self.claims.resize(frame.sightings.len(), 0.0);
        let (turn, left_rad2) = self.own_turn.estimate(passed_s, &covariance_rad2, &mut self.claims);
        self.turn_tracks(&turn, Some(&left_rad2));
        let confirmed = self.tracks.iter().filter(|track| track.is_confirmed()).map(|track| &track.motion);
        let common_rad_s = self.own_turn.take_common(confirmed, &self.settings);
        for track in &mut self.tracks {
            track.motion.take_from_rate(track.motion.by_turn().transpose() * common_rad_s);
        }
    }

    fn turn_tracks(&mut self, turn: &Rotation3<f64>, covariance_rad2: Option<&Matrix3<f64>>) {
        for track in &mut self.tracks {
            track.motion.turn(turn);
            if let Some(covariance_rad2) = covariance_rad2 {
                track.motion.blur(covariance_rad2);
            }
        }
    }

    /// What the frame should show of each track.
    fn expect(&mut self, frame: &Frame<'_>, passed_s: f64) {
        let passage = Passage::of(passed_s, &self.settings);
        let faintest = frame.detection_limit.map_or((0.0, 0.0), |LogLight { value, sigma }| {
            let light = libm::exp(value);
            (light, sigma * light)
        });
        for track in &mut self.tracks {
            let bearing = Bearing::new(track.motion.ahead());
            let is_watched = bearing.is_some_and(|bearing| frame.watched.sees(&bearing));
            track.presence.wait(&passage, is_watched);
            track.expect_absence(faintest, is_watched, &self.settings);
        }
        let numbered = self.tracks.iter().enumerate().filter(|(_, track)| track.is_confirmed());
        self.confirmed.begin(numbered.map(|(index, track)| (index, track.motion.ahead())));
        for index in 0..self.tracks.len() {
            let melted = self.melted(index);
            let Expected { absence, melted: kept, .. } = &mut self.tracks[index].frame;
            *kept = melted;
            absence.iter_mut().for_each(|one| *one += melted.0 * (1.0 - *one));
        }
    }

    /// With what probability the light of a track merges with that of another, and how far that is, rad.
    fn melted(&self, index: usize) -> (f64, f64) {
        let own = &self.tracks[index];
        if !own.is_confirmed() {
            return (0.0, 0.0);
        }
        let resolution_rad = self.settings.resolution_px * own.rad_per_px;
        let ahead = own.motion.ahead();
        let into = |other: usize| {
            let other = &self.tracks[other];
            let gap_rad = (other.motion.ahead() - ahead).norm();
            let share = gap_rad / resolution_rad;
            let one = 1.0 / (1.0 + share * share * share * share * share * share);
            (MOST_MELTED * one * other.frame.lit * other.presence.in_sight(), gap_rad)
        };
        let others = self.confirmed.near(&ahead, 2.0 * resolution_rad).filter(|&other| other != index);
        others.map(into).fold((0.0, 0.0), |most, own| if own.0 > most.0 { own } else { most })
    }

    /// What each sighting is worth to all tracks. New markers come anywhere, or beside others, as those of a vehicle do that turns.
    fn look_at_each(&mut self, frame: &Frame<'_>, passed_s: f64) {
        let new = self.settings.new_per_s * passed_s.max(SHORTEST_S);
        let anywhere = new / self.field_sr;
        let beside_one = new / (BESIDE_SR * self.confirmed.len().max(1) as f64);
        self.seen.clear();
        for sighting in frame.sightings {
            let ahead = sighting.bearing.vector();
            let is_beside = |&other: &usize| (self.tracks[other].motion.ahead() - ahead).norm() < BESIDE_RAD;
            let beside = self.confirmed.near(ahead, BESIDE_RAD).filter(is_beside).count();
            self.seen.push(Seen::of(sighting, 0.5 * (anywhere + beside as f64 * beside_one)));
        }
    }

    /// Which sighting is whose.
    fn associate(&mut self, frame: &Frame<'_>) {
        self.association.begin(frame.sightings.len());
        self.candidates.clear();
        self.first.clear();
        let others_per_sr = self.others_per_sr();
        for (index, track) in self.tracks.iter().enumerate() {
            self.first.push(self.candidates.len());
            let (melted, gap_rad) = track.frame.melted;
            // a merged sighting lies anywhere between the two
            let merged = Matrix2::identity() * (melted * gap_rad * gap_rad / 4.0);
            let open = track.motion.covariance().bearing + merged;
            near(&track.motion, frame.sightings, &self.sightings, &open, |sighting, mut offset| {
                offset.noise += merged;
                let candidate = track.compare(sighting, &self.seen[sighting], others_per_sr, offset);
                self.association.add(index, sighting, track.weight(&candidate));
                self.candidates.push(candidate);
            });
        }
        self.first.push(self.candidates.len());
        self.association.solve();
    }

    /// Each track learns from what is probably its own.
    fn learn(&mut self, frame: &Frame<'_>) {
        for (track, own) in self.tracks.iter_mut().zip(self.first.windows(2)) {
            let (candidates, association) = (&self.candidates[own[0]..own[1]], &self.association);
            let evidence = track.learn(&self.seen, candidates, |pair| association.free(own[0] + pair));
            self.listeners.hear(&mut track.hearing, frame.time_s, frame.exposure_s, evidence);
            self.listeners.doubt(&mut track.hearing, frame.time_s, self.settings.listen_anew_s);
            if track.may_listen() {
                self.listeners.give(&mut track.hearing);
            }
        }
    }

    /// Tracks that are sure get a number: they stand before all others, in its order.
    fn number_tracks(&mut self) {
        let first = self.tracks.partition_point(Track::is_confirmed);
        let mut new = 0;
        for index in first..self.tracks.len() {
            if self.tracks[index].is_sure() {
                self.tracks[index].number = Some(self.next_number);
                self.next_number += 1;
                self.tracks[first + new..=index].rotate_right(1);
                new += 1;
            }
        }
    }

    /// Sightings that no track explains may be new markers.
    fn begin_tracks(&mut self, frame: &Frame<'_>, passed_s: f64) {
        let new = self.settings.new_per_s * passed_s.max(SHORTEST_S);
        let share = (new / self.unexplained.max(LEAST_UNEXPLAINED)).min(MOST_NEW);
        let mut unexplained = 0.0;
        for (index, sighting) in frame.sightings.iter().enumerate() {
            let own = self.association.is_unexplained(index);
            unexplained += own;
            if own > WORTH_BEGINNING && self.tracks.len() < MOST_TRACKS {
                let odds = own * self.seen[index].looks * share / (1.0 - share);
                self.tracks.push(Track::new(
                    index,
                    sighting,
                    &self.seen[index],
                    odds / (1.0 + odds),
                    &self.settings,
                ));
            }
        }
        let weight = (passed_s / COUNTED_S).min(1.0);
        self.unexplained += weight * (unexplained - self.unexplained);
    }

    /// Tracks that are gone end.
    fn end_tracks(&mut self) {
        let listeners = &mut self.listeners;
        self.tracks.retain_mut(|track| {
            let is_over = track.is_over();
            if is_over {
                listeners.take(&mut track.hearing);
            }
            !is_over
        });
    }

    fn tell(&mut self) {
        self.told.clear();
        let (listeners, common) = (&self.listeners, self.own_turn.common_rad2_s2());
        self.told.extend(self.tracks.iter().filter_map(|track| MarkerTrack::of(track, listeners, common)));
    }

    /// Density of sightings that no track explains, 1/sr.
    fn others_per_sr(&self) -> f64 {
        self.unexplained.max(LEAST_UNEXPLAINED) / self.field_sr
    }
}
