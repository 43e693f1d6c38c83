//! One marker that is followed, and what a frame says of it.

use super::Settings;
use super::hearing::Hearing;
use super::motion::{Motion, Offset};
use super::presence::Presence;
use super::seen::Seen;
use crate::identity::{Evidence, Level, SHARES, density_of_light, probability_of_absence};
use crate::locator::Sighting;

/// Range of the logarithm of light over which what is no marker of a track is even.
const LIGHT_RANGE: f64 = 6.0;
/// How much more likely a spot without light is of an LED that shines than of clutter, by the share of the exposure.
const WITHOUT_LIGHT: [f64; SHARES] = [0.01, 0.26, 0.51, 0.76, 1.0];
/// How likely the exposure holds an edge of the signal, beforehand: short exposures hold one in 30 frames, ...
const PARTLY: f64 = 0.03;
/// ... and where they do in this frame, they do in the next: LEDs and camera have nearly one rate. The mean of so many frames in which the marker shines tells,
const PARTLY_FRAMES: f64 = 16.0;
/// and is never surer than this.
const MOST_PARTLY: f64 = 0.5;
/// Shares between none and all.
const PARTS: f64 = (SHARES - 2) as f64;
/// A track is a marker from this probability on.
const CONFIRMED: f64 = 0.99;
/// It gets a listener from this probability on.
const LISTENS: f64 = 0.7;
/// It ends below this probability, or this share of that with which it began.
const LEAST: f64 = 0.02;
const LEAST_OF_FIRST: f64 = 0.2;
/// It ends when its bearing is less sure than this, rad.
const LOST_RAD: f64 = 0.15;

/// Sightings less likely its own than this do not move a track.
const NEGLIGIBLE: f64 = 1e-4;

/// A marker that is followed.
#[derive(Debug)]
pub(super) struct Track {
    /// Given when it is confirmed.
    pub(super) number: Option<u64>,
    pub(super) motion: Motion,
    pub(super) presence: Presence,
    pub(super) level: Option<Level>,
    pub(super) hearing: Hearing,
    pub(super) rad_per_px: f64,
    pub(super) resolution_rad: f64,
    /// It ends when its existence is less probable.
    least: f64,
    /// How likely an exposure in which it shines holds an edge of its signal.
    pub(super) partly: f64,
    pub(super) frame: Expected,
    pub(super) told: Told,
}

/// What is expected of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Expected {
    /// The mean share of the exposure that the marker shines.
    pub(super) lit: f64,
    /// Probability of no spot by the share of the exposure that it shines, if it is in sight.
    pub(super) absence: [f64; SHARES],
    /// With what probability its light merges with that of another track, and how far that is, rad.
    pub(super) melted: (f64, f64),
}

/// What a frame told.
#[derive(Clone, Copy, Debug)]
pub(super) struct Told {
    /// The sighting that it most probably is, with the probability.
    pub(super) sighting: Option<(usize, f64)>,
    /// The probability that it shone.
    pub(super) lit: f64,
}

/// A sighting near a track.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) sighting: usize,
    pub(super) offset: Offset,
    /// How much more likely it is there if it is the marker than if it is not.
    pub(super) place: f64,
    /// The same of its light, by the share of the exposure that the marker shone.
    pub(super) light: [f64; SHARES],
}

impl Track {
    /// A sighting that may be a new marker, with this probability.
    pub(super) fn new(
        index: usize,
        sighting: &Sighting,
        seen: &Seen,
        probability: f64,
        settings: &Settings,
    ) -> Self {
        let lit = 1.0;
        Self {
            number: None,
            motion: Motion::new(&sighting.bearing, &sighting.covariance_rad2, settings.rate_rad_s),
            presence: Presence::new(probability),
            level: seen.light.and_then(|(light, _)| Level::of_first(light)),
            hearing: Hearing::default(),
            rad_per_px: sighting.rad_per_px,
            resolution_rad: sighting.resolution_rad,
            least: LEAST.min(LEAST_OF_FIRST * probability),
            partly: PARTLY,
            frame: Expected { lit, absence: [1.0; SHARES], melted: (0.0, 0.0) },
            told: Told { sighting: Some((index, probability)), lit },
        }
    }

    pub(super) fn is_confirmed(&self) -> bool {
        self.number.is_some()
    }

    pub(super) fn is_sure(&self) -> bool {
        self.presence.exists() > CONFIRMED
    }

    pub(super) fn may_listen(&self) -> bool {
        self.presence.exists() > LISTENS
    }

    /// Whether it is most probably gone, or could be anywhere.
    pub(super) fn is_over(&self) -> bool {
        let place = self.motion.covariance().bearing;
        !(self.presence.exists() > self.least && place.trace() < 2.0 * LOST_RAD * LOST_RAD)
    }

    /// How likely no spot is, by the share of the exposure, where a frame shows half of the spots of this light, which has this spread.
    pub(super) fn expect_absence(
        &mut self,
        (light, spread): (f64, f64),
        is_watched: bool,
        settings: &Settings,
    ) {
        let dark = |level: &Level| probability_of_absence(light, spread, level);
        let absence = match (is_watched, &self.level) {
            (false, _) => [1.0; SHARES],
            (true, Some(level)) => dark(level),
            (true, None) => WITHOUT_LIGHT.map(|found| 1.0 - found),
        };
        self.frame.absence = absence.map(|one| (one + settings.missed).min(1.0));
    }

    /// Where and how bright a sighting is beside what is expected.
    pub(super) fn compare(
        &self,
        index: usize,
        seen: &Seen,
        clutter_per_sr: f64,
        offset: Offset,
    ) -> Candidate {
        let (melted, _) = self.frame.melted;
        let covariance = self.motion.covariance().bearing + offset.noise;
        // What is not its own is clutter, which seldom looks like a marker, or a new one, which does.
        let others_per_sr = clutter_per_sr / seen.looks + seen.new_per_sr;
        let place = super::turn::density(&offset.value, &covariance) / others_per_sr;
        let by_light = match (seen.light, &self.level) {
            (Some((light, sigma)), Some(level)) => {
                density_of_light(light, sigma, level).map(|density| density * light * LIGHT_RANGE)
            }
            _ => WITHOUT_LIGHT,
        };
        // what shines with another may have any light
        let light = by_light.map(|ratio| ratio * (1.0 - melted) + melted);
        Candidate { sighting: index, offset, place, light }
    }

    /// How much more likely a frame is with this sighting than with none.
    pub(super) fn weight(&self, candidate: &Candidate) -> f64 {
        let in_sight = self.presence.in_sight();
        let none = 1.0 - in_sight + in_sight * self.over_light(&self.frame.absence);
        in_sight * candidate.place * self.over_light(&candidate.light) / none
    }

    /// Learns from the sightings near it, each with the probability that no other track has it. Returns the evidence for its code.
    pub(super) fn learn(
        &mut self,
        sightings: &[Seen],
        candidates: &[Candidate],
        free: impl Fn(usize) -> f64,
    ) -> Evidence {
        let mut by_share = self.frame.absence;
        for (pair, candidate) in candidates.iter().enumerate() {
            let place = candidate.place * free(pair);
            for (sum, light) in by_share.iter_mut().zip(&candidate.light) {
                *sum += place * light;
            }
        }
        let (lit, before) = (self.frame.lit, self.partly);
        let (all, shows) = (self.over_light(&by_share), self.presence.shows());
        // if it exists
        let share = shows / (1.0 + shows * (all - 1.0));
        let own = candidates.iter().enumerate().map(|(pair, candidate)| {
            (share * candidate.place * free(pair) * over_light(before, lit, &candidate.light), candidate)
        });
        self.told = Told { sighting: None, lit };
        for (probability, candidate) in own.clone() {
            if self.told.sighting.is_none_or(|(_, most)| probability > most) {
                self.told.sighting = Some((candidate.sighting, probability));
            }
        }
        let likely = own.filter(|&(probability, _)| probability > NEGLIGIBLE);
        self.motion.update(likely.map(|(probability, candidate)| (probability, candidate.offset)));
        self.presence.weigh(all);
        // where it is hidden a frame says nothing of its code, and little where it merges with another
        let (melted, _) = self.frame.melted;
        let mean = by_share.iter().sum::<f64>() / SHARES as f64;
        let evidence = by_share.map(|one| shows * (one + melted * (mean - one)) + 1.0 - shows);
        let on = (1.0 - self.partly) * lit * evidence[SHARES - 1];
        let [_, partly @ .., _] = evidence;
        let partly = self.partly * partly.iter().sum::<f64>() / PARTS;
        self.told.lit = on / self.over_light(&evidence);
        let shines = (on + partly) / self.over_light(&evidence);
        self.partly += (partly / (on + partly).max(f64::MIN_POSITIVE) - self.partly) * shines / PARTLY_FRAMES;
        self.partly = self.partly.clamp(PARTLY, MOST_PARTLY);
        self.see_light(sightings, melted);
        Evidence::of_likelihoods(evidence)
    }

    fn over_light(&self, by_share: &[f64; SHARES]) -> f64 {
        over_light(self.partly, self.frame.lit, by_share)
    }

    /// Learns how much light it shows from the sighting that it most probably is.
    fn see_light(&mut self, sightings: &[Seen], melted: f64) {
        let Some((index, probability)) = self.told.sighting else { return };
        let seen = &sightings[index];
        if probability > 0.5 {
            self.rad_per_px = seen.rad_per_px;
            self.resolution_rad = seen.resolution_rad;
        }
        let Some((light, sigma)) = seen.light else { return };
        match &mut self.level {
            Some(level) => {
                let lit = if level.is_exceeded(light, sigma) { 1.0 } else { self.told.lit };
                level.see(light, sigma, probability * lit * (1.0 - melted));
            }
            None => self.level = Level::of_first(light),
        }
    }
}

/// The mean over shining not at all, all the time, with probability `lit` unless it is for a part, and for a part.
fn over_light(partly: f64, lit: f64, by_share: &[f64; SHARES]) -> f64 {
    let [off, parts @ .., on] = by_share;
    (1.0 - partly) * (lit * on + (1.0 - lit) * off) + partly * parts.iter().sum::<f64>() / PARTS
}
