//! What the markers of a vehicle blink -> who it is, and how it is turned.
//!
//! ```text
//! testimony   P(words of m | v, turn) = share * (which signal its marker carries) + 1 - share     for each marker track m that belongs to the vehicle
//! vehicle     the product over its markers; those that ended count once more, as far as a memory goes
//! nobody      words that are in no list look like one of them by chance, for all markers that blink the same at once: that counts once a word
//! fleet       no two vehicles are one: messages between tracks and ids
//! ```
//!
//! A marker track's own probabilities hold all that was heard of it: each enters once, as it stands, and not once per frame. Somebody who is in no list may
//! blink the words of one who is, by mistake, so that nobody is ever sure beyond that; and where two blink the words of one vehicle, both are less than sure.

use alloc::vec::Vec;

use super::belonging::{Belonging, Belongings};
use super::fleet::{Fleet, Vehicle};
use crate::airframe::Airframe;
use crate::following::Association;
use crate::pose::Symmetry;
use crate::tracking::Tracked;

/// A vehicle is one of the fleet so likely, beforehand.
const KNOWN: f64 = 0.5;
/// One that is in no list blinks the words of one that is: a slip of whoever set them.
const COPIES: f64 = 1e-6;
/// A sighting is the marker that it is taken for so likely.
const PLACED: f64 = 0.98;
/// What markers said that are no longer followed is remembered, but for no more than a factor of this: news outweighs it.
const REMEMBERED_NATS: f64 = 7.0;
/// A share that no marker goes below.
const LEAST: f64 = 1e-9;
/// A name that is likelier than not.
const RATHER: f64 = 0.5;
/// A name that is less likely than this is not told.
const TOLD: f64 = 0.01;
/// How a vehicle is turned is told from this probability on.
const SURE_TURN: f64 = 0.95;
/// A claim that would be this sure without the others, and is not with them, is contested.
const SURE: f64 = 0.99;
const UNSURE: f64 = 0.9;

/// Who a track may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Name {
    /// The track.
    pub track: u64,
    /// The vehicle of the fleet.
    pub id: u32,
    /// How likely it is that one, if it exists; what is missing to 1 over all is nobody of the fleet.
    pub probability: f64,
    /// Whether another track blinks the same words and makes it unsure: two vehicles carry one id, or one was split.
    pub is_contested: bool,
}

/// What is known of a track.
#[derive(Debug, Default)]
struct File {
    track: u64,
    /// What markers said that ended, by hypothesis, nats.
    remembered: Vec<f64>,
    /// What all said, by hypothesis, nats below the best.
    said: Vec<f64>,
    /// How much likelier than nobody the best of the fleet is, if chance counts once a word, nats.
    odds_nats: f64,
    /// Which turn of the symmetric airframe is the true one, where signals tell, or told last.
    turn: Option<usize>,
}

/// Names tracks. Keeps its room.
#[derive(Debug)]
pub(super) struct Naming {
    vehicles: Vec<Vehicle>,
    /// Words that somebody of the fleet blinks.
    words: Vec<usize>,
    /// How likely a marker is any one word, beforehand.
    beforehand: f64,
    symmetry: Symmetry,
    /// By marker: the signals that it carries.
    signals: Vec<Vec<usize>>,
    /// How many turns signals tell apart.
    turns: usize,
    files: Vec<File>,
    spare: Vec<File>,
    association: Association,
    /// Weight, and place of track and vehicle, of each claim.
    claims: Vec<(f64, usize, usize)>,
    names: Vec<Name>,
    /// What each marker of a vehicle says, one after the other, by hypothesis, nats.
    testimony: Vec<f64>,
    /// By word: the most that a marker with it says for the fleet.
    surest: Vec<(usize, f64)>,
}

impl Naming {
    /// Of this fleet, with this airframe; a marker is any one word of the book so likely `beforehand`.
    pub(super) fn new(fleet: &Fleet, airframe: &Airframe, beforehand: f64) -> Self {
        let mut words: Vec<usize> =
            fleet.vehicles().iter().flat_map(|vehicle| vehicle.words.clone()).collect();
        words.sort_unstable();
        words.dedup();
        let signal = |&led: &usize| airframe.leds()[led].signal.unwrap_or(0) as usize;
        let symmetry = Symmetry::of(airframe);
        Self {
            vehicles: fleet.vehicles().to_vec(),
            words,
            beforehand,
            turns: symmetry.told_apart(),
            symmetry,
            signals: airframe
                .markers()
                .iter()
                .map(|marker| marker.leds.iter().map(signal).collect())
                .collect(),
            files: Vec::new(),
            spare: Vec::new(),
            association: Association::default(),
            claims: Vec::new(),
            names: Vec::new(),
            testimony: Vec::new(),
            surest: Vec::new(),
        }
    }

    /// Who each track may be, in the order of tracks, the likeliest first.
    pub(super) fn names(&self) -> &[Name] {
        &self.names
    }

    /// Adds the tracks whose vehicle is sure.
    pub(super) fn tell_sure(&self, named: &mut Vec<(u64, u32)>) {
        let sure = self.names.iter().filter(|name| name.probability > SURE);
        named.extend(sure.map(|name| (name.track, name.id)));
    }

    /// The track that is rather this vehicle than not.
    pub(super) fn likely_track(&self, vehicle: u32) -> Option<u64> {
        let rather = |name: &&Name| name.id == vehicle && name.probability > RATHER;
        self.names.iter().find(rather).map(|name| name.track)
    }

    /// The airframe's symmetry, and the turn that is the true one, where signals tell.
    pub(super) fn turn(&self, track: u64) -> Option<(&Symmetry, usize)> {
        let turn = self.file(track).and_then(|file| file.turn)?;
        Some((&self.symmetry, turn))
    }

    fn file(&self, track: u64) -> Option<&File> {
        self.files.iter().find(|file| file.track == track)
    }

    /// Forgets all.
    pub(super) fn forget(&mut self) {
        self.spare.append(&mut self.files);
        self.names.clear();
    }

    /// The track that a marker surely belongs to, and which signal of its vehicle it surely blinks.
    pub(super) fn signal(&self, own: &Belonging) -> Option<(u64, u32)> {
        let name =
            self.names.iter().find(|name| name.track == own.track).filter(|name| name.probability > SURE)?;
        let vehicle = self.vehicles.iter().find(|vehicle| vehicle.id == name.id)?;
        let is_sure =
            |&(_, &word): &(usize, &usize)| own.words.get(word).is_some_and(|&likely| likely > SURE);
        let (signal, _) = vehicle.words.iter().enumerate().find(is_sure).filter(|_| own.share > SURE)?;
        Some((own.track, signal as u32))
    }

    /// What a marker said that is no longer followed stays with its vehicle.
    pub(super) fn remember(&mut self, over: &Belonging) {
        let Some(place) = self.files.iter().position(|file| file.track == over.track) else { return };
        let mut file = core::mem::take(&mut self.files[place]);
        self.testimony.clear();
        self.hear(over);
        add(&self.testimony, &mut file.remembered);
        settle(&mut file.remembered);
        file.remembered.iter_mut().for_each(|nats| *nats = nats.max(-REMEMBERED_NATS));
        self.files[place] = file;
    }

    /// Names all tracks anew.
    pub(super) fn name(&mut self, tracked: &Tracked, belongings: &Belongings) {
        self.open_files(tracked);
        for place in 0..self.files.len() {
            let mut file = core::mem::take(&mut self.files[place]);
            file.said.clone_from(&file.remembered);
            self.testimony.clear();
            for own in belongings.of(file.track) {
                self.hear(own);
            }
            self.testimony.chunks_exact(file.said.len()).for_each(|own| add(own, &mut file.said));
            file.odds_nats = self.odds_by_chance(belongings, &file);
            settle(&mut file.said);
            file.turn = self.sure_turn(&file.said).or(file.turn);
            self.files[place] = file;
        }
        self.share_out(tracked);
    }

    /// A file for each track, in their order.
    fn open_files(&mut self, tracked: &Tracked) {
        let Self { files, spare, vehicles, turns, .. } = self;
        spare.extend(files.extract_if(.., |file| !tracked.tracks.iter().any(|track| track.id == file.track)));
        for track in &tracked.tracks {
            if !files.iter().any(|file| file.track == track.id) {
                let mut file = spare.pop().unwrap_or_default();
                file.track = track.id;
                file.turn = None;
                file.remembered.clear();
                file.remembered.resize(vehicles.len() * *turns + 1, 0.0);
                files.push(file);
            }
        }
        files.sort_unstable_by_key(|file| tracked.tracks.iter().position(|track| track.id == file.track));
    }

    /// Hears what a marker says of each hypothesis: vehicles and their turns, at last nobody of the fleet.
    fn hear(&mut self, own: &Belonging) {
        let Self { testimony, vehicles, words, turns, signals, symmetry, beforehand, .. } = self;
        if own.words.is_empty() {
            testimony.resize(testimony.len() + vehicles.len() * *turns + 1, 0.0);
            return;
        }
        let weigh = |ratio: f64| libm::log(own.share * ratio.max(LEAST) + 1.0 - own.share);
        let of_word = |word: usize| own.words[word] / *beforehand;
        for vehicle in vehicles.iter() {
            let any = mean(vehicle.words.iter().map(|&word| of_word(word)));
            testimony.extend((0..*turns).map(|turn| {
                let placed = own.marker.map(|marker| {
                    let signals = signals[usize::from(symmetry.turned(turn, marker))].iter();
                    mean(signals.map(|&signal| vehicle.words.get(signal).map_or(0.0, |&word| of_word(word))))
                });
                weigh(placed.map_or(any, |placed| PLACED * placed + (1.0 - PLACED) * any))
            }));
        }
        let known: f64 = words.iter().map(|&word| own.words[word]).sum();
        let nobody = (1.0 - known).max(LEAST) / (1.0 - *beforehand * words.len() as f64).max(LEAST);
        testimony.push(weigh(nobody));
    }

    /// How much likelier than nobody of the fleet the best of it is, nats, if a word that is in no list looks like one that is to all markers that blink it at once: of those the
    /// surest tells. What tells against the fleet counts each time. Several words do not look like those of one vehicle by chance.
    fn odds_by_chance(&mut self, belongings: &Belongings, file: &File) -> f64 {
        let Some((nobody, of_fleet)) = file.said.split_last() else { return 0.0 };
        let best = (0..of_fleet.len()).max_by(|&a, &b| of_fleet[a].total_cmp(&of_fleet[b]));
        let Some(best) = best.filter(|&best| of_fleet[best] > *nobody) else { return 0.0 };
        let words = &self.vehicles[best / self.turns].words;
        if words.iter().any(|word| *word != words[0]) {
            return f64::INFINITY;
        }
        let over_nobody = |said: &[f64]| said[best] - said[said.len() - 1];
        let mut odds_nats = over_nobody(&file.remembered);
        self.surest.clear();
        let testimony = self.testimony.chunks_exact(file.said.len());
        for (marker, own) in belongings.of(file.track).zip(testimony) {
            let words = &marker.words;
            let Some(word) = (0..words.len()).max_by(|&a, &b| words[a].total_cmp(&words[b])) else {
                continue;
            };
            let nats = over_nobody(own);
            match self.surest.iter_mut().find(|surest| surest.0 == word) {
                _ if nats <= 0.0 => odds_nats += nats,
                Some((_, surest)) => *surest = surest.max(nats),
                None => self.surest.push((word, nats)),
            }
        }
        odds_nats + self.surest.iter().map(|surest| surest.1).sum::<f64>()
    }

    /// The turn that is nearly certain.
    fn sure_turn(&self, said: &[f64]) -> Option<usize> {
        if self.turns == 1 {
            return None;
        }
        let of_fleet = &said[..said.len() - 1];
        let all: f64 = said.iter().map(|&nats| libm::exp(nats)).sum();
        let of_turn = |turn: usize| {
            of_fleet.iter().skip(turn).step_by(self.turns).map(|&nats| libm::exp(nats)).sum::<f64>()
        };
        (0..self.turns).find(|&turn| of_turn(turn) > SURE_TURN * all)
    }

    /// No two tracks are one vehicle.
    fn share_out(&mut self, tracked: &Tracked) {
        let count = self.vehicles.len() as f64;
        self.association.begin(self.vehicles.len());
        self.claims.clear();
        for (place, (file, track)) in self.files.iter().zip(&tracked.tracks).enumerate() {
            let of_vehicle = |vehicle: &[f64]| mean(vehicle.iter().map(|&nats| libm::exp(nats)));
            let Some((nobody, of_fleet)) = file.said.split_last() else { continue };
            let copied = mean(of_fleet.chunks(self.turns).map(of_vehicle));
            let none = (1.0 - KNOWN) * (libm::exp(*nobody) + COPIES * copied);
            for (vehicle, said) in of_fleet.chunks(self.turns).enumerate() {
                let weight = track.existence * KNOWN / count * of_vehicle(said) / none;
                self.association.add(place, vehicle, weight);
                self.claims.push((weight, place, vehicle));
            }
        }
        self.association.solve();
        self.tell();
    }

    fn tell(&mut self) {
        let Self { association, claims, names, files, vehicles, .. } = self;
        names.clear();
        let mut first = 0;
        for own in claims.chunk_by(|a, b| a.1 == b.1) {
            let free = |pair: usize| own[pair].0 * association.free(first + pair);
            let shared = 1.0 + (0..own.len()).map(free).sum::<f64>();
            let alone = 1.0 + own.iter().map(|claim| claim.0).sum::<f64>();
            let begun = names.len();
            let by_chance =
                libm::exp(-files[own[0].1].odds_nats) * vehicles.len() as f64 * (1.0 - KNOWN) / KNOWN;
            let surest = 1.0 / (1.0 + by_chance);
            for (pair, &(weight, place, vehicle)) in own.iter().enumerate() {
                let among_all = free(pair) / shared;
                let probability = among_all.min(surest);
                if probability > TOLD {
                    names.push(Name {
                        track: files[place].track,
                        id: vehicles[vehicle].id,
                        probability,
                        is_contested: weight / alone > SURE && among_all < UNSURE,
                    });
                }
            }
            names[begun..]
                .sort_unstable_by(|a, b| b.probability.total_cmp(&a.probability).then(a.id.cmp(&b.id)));
            first += own.len();
        }
    }
}

/// Adds what one marker says.
fn add(own: &[f64], nats: &mut [f64]) {
    nats.iter_mut().zip(own).for_each(|(nats, own)| *nats += own);
}

/// Sets the best to 0.
fn settle(nats: &mut [f64]) {
    let best = nats.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    nats.iter_mut().for_each(|nats| *nats -= best);
}

fn mean(all: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = all.len() as f64;
    all.sum::<f64>() / count
}
