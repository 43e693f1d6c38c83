//! Located frames, one after the other -> vehicles that are followed, and who each of them is.
//!
//! ```text
//! frame, when and how turned   -> Glance
//! sightings -> marker tracks   through their dark frames, each with its word        crate::following, crate::identity
//! words -> who appears         where the LEDs of a vehicle blink differently        calling (directory, starts)
//! which of them will shine     what is dark is not held against a vehicle
//! sightings -> vehicles        where, how fast, how turned                          crate::tracking
//! marker tracks -> vehicles    whose marker each is                                 belonging
//! words -> names               who a vehicle is, with probability                   naming, fleet
//! ```
//!
//! ```no_run
//! # use photinus::{locator::{self, Input, Locator}, lookout::{Glance, Lookout}, tracking, airframe::Airframe, camera::Camera, frame::FrameView};
//! # fn see(camera: Camera, airframe: Airframe, frame: FrameView<'_>) -> Result<(), Box<dyn core::error::Error>> {
//! let settings = locator::Settings::default();
//! let mut locator = Locator::new(camera.clone(), &airframe, None, settings)?;
//! let mut lookout = Lookout::new(camera, &airframe, &settings, tracking::Settings::default(), None)?;
//! // and for every frame
//! let located = locator.locate(Input::frame(&frame))?;
//! let seen = lookout.look(&Glance { time_s: 0.0, exposure_s: 1e-3, turned: None, moving: None, gravity: None, located })?;
//! for track in &seen.tracks {
//!     println!("{} at {}", track.id, track.position_m);
//! }
//! # Ok(())
//! # }
//! ```

mod belonging;
mod calling;
mod directory;
mod fleet;
mod naming;
mod starts;
#[cfg(test)]
mod tests;

use alloc::vec::Vec;

use nalgebra::{Unit, Vector3};

use crate::airframe::Airframe;
use crate::camera::{Camera, Watched};
use crate::following::{self, Follower, Frame, MarkerTrack};
use crate::frame::Mask;
use crate::identity::decoder::{self, Decoder, DecoderError};
use crate::locator::{self, Located};
use crate::pose::{LogLight, SettingsError};
use crate::tracking::{
    self, Appearing, Followed, Look, Moving, Placed, Signalled, TrackError, Tracked, Tracker, TrackerError,
    Turned,
};
use belonging::Belongings;
use calling::Calling;
use directory::Directory;
pub use fleet::{Fleet, FleetError, Vehicle};
pub use naming::Name;
use naming::Naming;

/// A marker of which nothing is known is lit so likely: of the bits of a word about half are.
const ANY_BIT: f64 = 0.5;
/// A light is nobody's from this probability on.
const SURE_STRANGER: f64 = 0.95;

/// A frame that was located.
#[derive(Clone, Copy, Debug)]
pub struct Glance<'a> {
    /// When its exposure began, s, on a clock of the caller's.
    pub time_s: f64,
    /// How long it lasted, s.
    pub exposure_s: f64,
    /// How the camera turned since the frame before, where that is known.
    pub turned: Option<Turned>,
    /// How it moves over the ground, where that is known.
    pub moving: Option<Moving>,
    /// Down in the camera frame, where it is known.
    pub gravity: Option<Unit<Vector3<f64>>>,
    /// What the locator makes of it.
    pub located: &'a Located,
}

/// Follows the vehicles that one camera sees, all with the same airframe, and says who they are. Keeps its room from frame to frame, so that a warm one
/// allocates nothing.
#[derive(Debug)]
pub struct Lookout {
    camera: Camera,
    mask: Option<Mask>,
    tracker: Tracker,
    tracked: Tracked,
    blinking: Option<Blinking>,
}

/// What following words takes.
#[derive(Debug)]
struct Blinking {
    follower: Follower,
    belongings: Belongings,
    naming: Naming,
    /// Where they are expected in a frame, and whether lit.
    followed: Vec<Followed>,
    /// Where the LEDs of a vehicle blink differently.
    parts: Option<Parts>,
}

/// What it takes where a frame shows parts of vehicles only.
#[derive(Debug)]
struct Parts {
    directory: Directory,
    calling: Calling,
    /// By sighting: whose marker it was heard to be, and whether nobody's.
    signals: Vec<Option<Signalled>>,
    strangers: Vec<bool>,
}

/// What is known before a frame.
#[derive(Clone, Copy, Debug)]
struct Before<'a> {
    /// Where anybody looks.
    watched: Watched<'a>,
    tracked: &'a Tracked,
    /// Light at which a marker is found half of the time.
    faintest_light: f64,
    /// The light of an LED of intensity 1 at 1 m, where several tracks tell it.
    power: Option<LogLight>,
}

/// Why there can be no lookout.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LookoutError {
    /// The tracker's settings.
    #[error("{0}")]
    Tracker(#[from] TrackerError),
    /// What is believed of words.
    #[error("{0}")]
    Decoder(#[from] DecoderError),
    /// What is believed of poses.
    #[error("{0}")]
    Pose(#[from] SettingsError),
    /// What is believed of markers.
    #[error("{0}")]
    Following(#[from] following::SettingsError),
}

impl Lookout {
    /// A lookout for what a locator with these settings tells. Without a fleet LEDs shine steadily, and nobody has a name.
    ///
    /// # Errors
    /// [`LookoutError`] when a setting has no meaning.
    pub fn new(
        camera: Camera,
        airframe: &Airframe,
        locator: &locator::Settings,
        settings: tracking::Settings,
        fleet: Option<&Fleet>,
    ) -> Result<Self, LookoutError> {
        let tracker = Tracker::new(camera.clone(), airframe, locator, settings)?;
        let blinking = fleet.map(|fleet| Blinking::new(&camera, airframe, locator, fleet)).transpose()?;
        Ok(Self { camera, mask: None, tracker, tracked: Tracked::default(), blinking })
    }

    /// Sets where the locator does not look.
    ///
    /// # Errors
    /// [`LookoutError`] when the mask is not of the camera's size.
    pub fn set_mask(&mut self, mask: Option<Mask>) -> Result<(), LookoutError> {
        self.tracker.set_mask(mask.clone())?;
        self.mask = mask;
        Ok(())
    }

    /// Takes a frame in, and tells the vehicles at the time of the newest frame: late frames and clocks that jump are as for [`Tracker::track`]; what
    /// blinks in a late frame is not heard. Where signals tell which turn of a symmetric airframe is the true one, attitudes are turned by it.
    ///
    /// # Errors
    /// As [`Tracker::track`]; nothing is changed then.
    pub fn look(&mut self, glance: &Glance<'_>) -> Result<&Tracked, TrackError> {
        let Glance { time_s, turned, moving, gravity, located, .. } = *glance;
        let (signals, lit) = (&[], &[]);
        let mut look = Look { time_s, turned, moving, gravity, located, signals, lit, blinking: None };
        look.check()?;
        if let Some(blinking) = &mut self.blinking {
            let watched = Watched::new(&self.camera, self.mask.as_ref());
            let faintest_light = located.faintest_light;
            let before =
                Before { watched, tracked: &self.tracked, faintest_light, power: self.tracker.power() };
            (look.blinking, look.signals) = blinking.hear(glance, &before);
        }
        self.tracked.take_over(self.tracker.track(&look)?);
        if let Some(blinking) = &mut self.blinking {
            blinking.conclude(&mut self.tracked);
        }
        Ok(&self.tracked)
    }

    /// What it told last.
    pub fn tracked(&self) -> &Tracked {
        &self.tracked
    }

    /// The markers that were followed last, oldest first; none without a fleet.
    pub fn markers(&self) -> &[MarkerTrack] {
        self.blinking.as_ref().map_or(&[], |blinking| blinking.follower.tracks())
    }

    /// Who the tracks may be, one after the other, the likeliest first: those of the fleet that are likelier than a hundredth.
    pub fn names(&self) -> &[Name] {
        self.blinking.as_ref().map_or(&[], |blinking| blinking.naming.names())
    }

    /// Who a track most likely is, if anybody of the fleet.
    pub fn name(&self, track: u64) -> Option<&Name> {
        self.names().iter().find(|name| name.track == track)
    }
}

impl Blinking {
    fn new(
        camera: &Camera,
        airframe: &Airframe,
        locator: &locator::Settings,
        fleet: &Fleet,
    ) -> Result<Self, LookoutError> {
        let settings = decoder::Settings { bit_rate_hz: fleet.bit_rate_hz(), ..decoder::Settings::default() };
        let decoder = Decoder::new(fleet.book(), settings)?;
        let naming = Naming::new(fleet, airframe, decoder.word_beforehand());
        let of_markers = match fleet.has_several_signals() {
            true => {
                following::Settings { listen_anew_s: decoder.round_s(), ..following::Settings::default() }
            }
            false => following::Settings::default(),
        };
        let follower = Follower::new(camera, Some(decoder), of_markers)?;
        let parts = fleet.has_several_signals().then(|| Parts::new(airframe, locator, fleet)).transpose()?;
        Ok(Self { follower, belongings: Belongings::default(), naming, followed: Vec::new(), parts })
    }

    /// Follows the markers, and says where each is and whether it must be lit in this frame, and what sightings blink.
    fn hear(
        &mut self,
        glance: &Glance<'_>,
        before: &Before<'_>,
    ) -> (Option<tracking::Blinking<'_>>, &[Option<Signalled>]) {
        let Before { watched, tracked, .. } = *before;
        if (glance.time_s - tracked.time_s).abs() > Tracker::JUMP_S {
            self.follower.restart();
        }
        let frame = Frame {
            time_s: glance.time_s,
            exposure_s: glance.exposure_s,
            sightings: &glance.located.sightings,
            faintest_light: glance.located.faintest_light,
            turn: glance.turned.map(following::Turn::from),
            watched,
        };
        self.followed.clear();
        // A late frame is not heard.
        let markers = self.follower.follow(&frame).unwrap_or_default();
        let signal = |number: u64| self.naming.signal(self.belongings.of_marker(number)?);
        self.followed.extend(markers.iter().map(|marker| Followed {
            bearing: marker.bearing,
            lit: marker.lit,
            signal: signal(marker.number),
        }));
        let (appearing, signals) = match &mut self.parts {
            Some(parts) => {
                let (appearing, signals) = parts.hear(glance, markers, before);
                (Some(appearing), signals)
            }
            None => (None, &[][..]),
        };
        (Some(tracking::Blinking { followed: &self.followed, others: ANY_BIT, appearing }), signals)
    }

    /// Gives the markers to the vehicles, names these, and turns them as their signals say.
    fn conclude(&mut self, tracked: &mut Tracked) {
        let Self { follower, belongings, naming, .. } = self;
        if tracked.placed == Placed::Reset {
            belongings.forget();
            naming.forget();
        }
        if tracked.placed != Placed::Late {
            belongings.follow(follower, tracked, |over| naming.remember(over));
        }
        naming.name(tracked, belongings);
        tracked.turn(|track| naming.turn(track));
    }
}

impl Parts {
    fn new(airframe: &Airframe, locator: &locator::Settings, fleet: &Fleet) -> Result<Self, SettingsError> {
        Ok(Self {
            directory: Directory::of(fleet),
            calling: Calling::new(airframe, locator)?,
            signals: Vec::new(),
            strangers: Vec::new(),
        })
    }

    /// Says whose marker each sighting is, as far as the marker was heard, and who appears.
    fn hear(
        &mut self,
        glance: &Glance<'_>,
        markers: &[MarkerTrack],
        before: &Before<'_>,
    ) -> (Appearing<'_>, &[Option<Signalled>]) {
        let Self { directory, calling, signals, strangers } = self;
        let sightings = glance.located.sightings.len();
        signals.clear();
        signals.resize(sightings, None);
        strangers.clear();
        strangers.resize(sightings, false);
        for marker in markers {
            let (Some(identity), Some(sighting)) = (marker.identity, marker.sighting) else { continue };
            let probability = identity.probability * marker.sighting_probability;
            if let Some(entry) = directory.entry(identity.who) {
                signals[sighting] =
                    Some(Signalled { signal: entry.signal, probability, vehicle: Some(entry.vehicle) });
            }
            strangers[sighting] = probability > SURE_STRANGER && directory.is_stranger(identity.who);
        }
        let called = calling.listen(markers, directory, glance.gravity, before);
        (Appearing { called, strangers }, signals)
    }
}
