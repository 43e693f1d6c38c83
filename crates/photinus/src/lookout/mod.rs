//! Located frames, one after the other -> vehicles that are followed, and who each of them is.
//!
//! ```text
//! frame, when and how turned   -> Glance
//! sightings -> marker tracks   through their dark frames, each with its word        crate::following, crate::identity
//! words -> who appears         of whom has no track of its own                      calling (directory, missing, starts)
//! which of them will shine     what is dark is not held against a vehicle
//! sightings -> vehicles        where, how fast, how turned                          crate::tracking
//! marker tracks -> vehicles    whose marker each is                                 belonging
//! words -> names               who a vehicle is, with probability                   naming, fleet
//! ```
//!
//! Of cameras on one vehicle each has marker tracks of its own; vehicles and their names are those of all.
//!
//! ```no_run
//! # use photinus::{locator::{self, Input, Locator}, lookout::{Glance, Lookout}, tracking, airframe::Airframe, camera::Camera, frame::FrameView};
//! # fn see(camera: Camera, airframe: Airframe, frame: FrameView<'_>) -> Result<(), Box<dyn core::error::Error>> {
//! let settings = locator::Settings::default();
//! let mut locator = Locator::new(camera.clone(), &airframe, None, settings)?;
//! let mut lookout = Lookout::new(camera, &airframe, &settings, tracking::Settings::default(), None)?;
//! // and for every frame
//! let located = locator.locate(Input::frame(&frame))?;
//! let seen = lookout.look(&Glance::new(0.0, located))?;
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
mod missing;
mod naming;
mod starts;
#[cfg(test)]
mod tests;

use alloc::vec::Vec;

use nalgebra::{Unit, Vector3};

use crate::airframe::Airframe;
use crate::camera::{Mounted, Rig, RigError, Watched};
use crate::following::{self, Follower, Frame, MarkerTrack};
use crate::frame::Mask;
use crate::identity::Properties;
use crate::identity::decoder::{self, Decoder, DecoderError};
use crate::locator::{self, Located};
use crate::pose::{LogLight, SettingsError};
use crate::tracking::{
    self, Calls, Followed, Look, Moving, Placed, Signalled, TrackError, Tracked, Tracker, TrackerError,
    Turned,
};
use belonging::Belongings;
use calling::Calling;
use directory::Directory;
pub use fleet::{Fleet, FleetError, Vehicle};
use missing::Missing;
pub use naming::Name;
use naming::Naming;

/// A marker of which nothing is known is lit so likely: of the bits of a word about half are.
const ANY_BIT: f64 = 0.5;
/// A light is nobody's from this probability on.
const SURE_STRANGER: f64 = 0.95;

/// A frame that was located.
#[derive(Clone, Copy, Debug)]
pub struct Glance<'a> {
    /// Which of the rig's cameras took it; 0 of one alone.
    pub camera: usize,
    /// When its exposure began, s, on a clock of the caller's.
    pub time_s: f64,
    /// How long it lasted, s.
    pub exposure_s: f64,
    /// How the camera turned since its own frame before, where that is known.
    pub turned: Option<Turned>,
    /// How it turned since the frame before in time of any camera of its rig, in its own axes, where that is known; of one camera alone nobody asks.
    pub turned_since_any: Option<Turned>,
    /// How the vehicle that it sits on moves over the ground, in the camera's axes, where that is known: of a camera alone its own movement.
    pub moving: Option<Moving>,
    /// Down in the camera frame, where it is known.
    pub gravity: Option<Unit<Vector3<f64>>>,
    /// What the locator makes of it.
    pub located: &'a Located,
}

impl<'a> Glance<'a> {
    /// A frame of a camera alone, exposed for 1 ms, of which nothing else is known.
    pub fn new(time_s: f64, located: &'a Located) -> Self {
        Self {
            camera: 0,
            time_s,
            exposure_s: 1e-3,
            turned: None,
            turned_since_any: None,
            moving: None,
            gravity: None,
            located,
        }
    }
}

/// Follows the vehicles that one camera sees, or the cameras of one rig, all with the same airframe, and says who they are. Keeps its room from frame to
/// frame, so that a warm one allocates nothing.
#[derive(Debug)]
pub struct Lookout {
    tracker: Tracker,
    tracked: Tracked,
    blinking: Option<Blinking>,
}

/// What following words takes.
#[derive(Debug)]
struct Blinking {
    /// By camera.
    followers: Vec<Follower>,
    /// Whether the last frame was heard: a late one of its camera is not.
    is_heard: bool,
    belongings: Belongings,
    naming: Naming,
    /// Where they are expected in a frame, and whether lit.
    followed: Vec<Followed>,
    /// No LED is dark for longer, s.
    longest_dark_s: f64,
    words: Words,
}

/// Who blinks what, and who calls by it.
#[derive(Debug)]
struct Words {
    /// Whether all LEDs of a vehicle blink alike: else frames show parts of vehicles.
    alike: bool,
    directory: Directory,
    missing: Missing,
    calling: Calling,
    /// Tracks, and which vehicle each surely is.
    named: Vec<(u64, u32)>,
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
    /// Light at which a marker is found half of the time, and how much that differs from marker to marker.
    detection_limit: Option<LogLight>,
    /// How often a marker that must show does not.
    miss_rate: Option<f64>,
    /// How far neighbours tilt, rad.
    tilt_sigma_rad: Option<f64>,
    /// How many times as much as supposed the power of LEDs spreads.
    light_times: Option<f64>,
    /// The light of an LED of intensity 1 at 1 m, where several tracks tell it.
    power: Option<LogLight>,
}

/// Why there can be no lookout.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LookoutError {
    /// The cameras are no rig.
    #[error("{0}")]
    Rig(#[from] RigError),
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
    /// A lookout for what locators with these settings tell: of one camera, or of a rig. Without a fleet LEDs shine steadily, and nobody has a name.
    ///
    /// # Errors
    /// [`LookoutError`] when a setting has no meaning.
    pub fn new(
        rig: impl Into<Rig>,
        airframe: &Airframe,
        locator: &locator::Settings,
        settings: tracking::Settings,
        fleet: Option<&Fleet>,
    ) -> Result<Self, LookoutError> {
        let tracker = Tracker::new(rig, airframe, locator, settings)?;
        let blinking =
            fleet.map(|fleet| Blinking::new(tracker.rig(), airframe, locator, fleet)).transpose()?;
        Ok(Self { tracker, tracked: Tracked::default(), blinking })
    }

    /// Sets where the locator of a camera does not look.
    ///
    /// # Errors
    /// [`LookoutError`] when the mask is not of the camera's size.
    ///
    /// # Panics
    /// If there is no camera of this number.
    pub fn set_mask(&mut self, camera: usize, mask: Option<Mask>) -> Result<(), LookoutError> {
        Ok(self.tracker.set_mask(camera, mask)?)
    }

    /// Takes a frame in, and tells the vehicles at its time, in its camera's axes: late frames and clocks that jump are as for [`Tracker::track`]; what
    /// blinks in a frame that is late for its own camera is not heard. Where signals tell which turn of a symmetric airframe is the true one, attitudes are
    /// turned by it.
    ///
    /// # Errors
    /// As [`Tracker::track`]; nothing is changed then.
    pub fn look(&mut self, glance: &Glance<'_>) -> Result<&Tracked, TrackError> {
        let Glance { camera, time_s, moving, gravity, located, .. } = *glance;
        let is_alone = self.tracker.rig().cameras().len() == 1;
        let turned = if is_alone { glance.turned } else { glance.turned_since_any };
        let (signals, lit) = (&[], &[]);
        let mut look =
            Look { camera, time_s, turned, moving, gravity, located, signals, lit, blinking: None };
        look.check(self.tracker.rig())?;
        if let Some(blinking) = &mut self.blinking {
            let power = self.tracker.power(camera);
            let watched = self.tracker.rig().watched(camera);
            let Located { detection_limit, miss_rate, tilt_sigma_rad, light_times, .. } = *located;
            let tracked = &self.tracked;
            let before =
                Before { watched, tracked, detection_limit, miss_rate, tilt_sigma_rad, light_times, power };
            if self.tracker.is_of_another_clock(camera, time_s) {
                blinking.followers.iter_mut().for_each(Follower::restart);
            }
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

    /// The markers that were followed last in a camera, oldest first; none without a fleet.
    pub fn markers(&self, camera: usize) -> &[MarkerTrack] {
        let followers = self.blinking.as_ref().map_or(&[][..], |blinking| &blinking.followers);
        followers.get(camera).map_or(&[], Follower::tracks)
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
        rig: &Rig,
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
        let follower = |mounted: &Mounted| Follower::new(&mounted.camera, Some(decoder.clone()), of_markers);
        let followers = rig.cameras().iter().map(follower).collect::<Result<_, _>>()?;
        let words = Words::new(airframe, locator, fleet)?;
        let (belongings, followed) = (Belongings::default(), Vec::new());
        // Exposures stand anywhere in a bit.
        let longest_dark_s = (Properties::of(fleet.book()).longest_dark + 1) as f64 / fleet.bit_rate_hz();
        Ok(Self { followers, is_heard: false, belongings, naming, followed, longest_dark_s, words })
    }

    /// Follows the markers, and says where each is and whether it must be lit in this frame, and what sightings blink.
    fn hear(
        &mut self,
        glance: &Glance<'_>,
        before: &Before<'_>,
    ) -> (Option<tracking::Blinking<'_>>, &[Option<Signalled>]) {
        let Before { watched, .. } = *before;
        let frame = Frame {
            time_s: glance.time_s,
            exposure_s: glance.exposure_s,
            sightings: &glance.located.sightings,
            detection_limit: glance.located.detection_limit,
            turn: glance.turned.map(following::Turn::from),
            watched,
        };
        self.followed.clear();
        let markers = self.followers[glance.camera].follow(&frame);
        self.is_heard = markers.is_ok();
        let markers = markers.unwrap_or_default();
        let signal = |number: u64| self.naming.signal(self.belongings.of_marker(glance.camera, number)?);
        self.followed.extend(markers.iter().map(|marker| Followed {
            bearing: marker.bearing,
            lit: marker.lit,
            signal: signal(marker.number),
        }));
        self.words.hear(glance, markers, before, (&self.belongings, &self.naming));
        let Words { alike, signals, strangers, named, .. } = &self.words;
        let blinking = tracking::Blinking {
            followed: &self.followed,
            others: ANY_BIT,
            longest_dark_s: self.longest_dark_s,
            alike: *alike,
            called: self.words.calling.called(),
            strangers,
            named,
        };
        (Some(blinking), signals)
    }

    /// Gives the markers of the frame's camera to the vehicles, names these, and turns them as their signals say.
    fn conclude(&mut self, tracked: &mut Tracked) {
        let Self { followers, belongings, naming, .. } = self;
        if tracked.placed == Placed::Reset {
            belongings.forget();
            naming.forget();
        }
        if self.is_heard {
            let camera = tracked.camera;
            belongings.follow(camera, &followers[camera], tracked, |over| naming.remember(over));
        }
        // Who appeared after a late frame keeps its name.
        if tracked.placed != Placed::Late {
            naming.name(tracked, belongings);
        }
        tracked.turn(|track| naming.turn(track));
    }
}

impl Words {
    fn new(airframe: &Airframe, locator: &locator::Settings, fleet: &Fleet) -> Result<Self, SettingsError> {
        let alike = !fleet.has_several_signals();
        Ok(Self {
            alike,
            directory: Directory::of(fleet),
            missing: Missing::default(),
            calling: Calling::new(airframe, locator, alike)?,
            named: Vec::new(),
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
        (belongings, naming): (&Belongings, &Naming),
    ) {
        let Self { alike, directory, missing, calling, named, signals, strangers } = self;
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
            // Who shines for a part of many exposures is heard badly, and its light there tells no pose.
            let is_whole = 1.0 - marker.partly;
            strangers[sighting] =
                probability * is_whole > SURE_STRANGER && directory.is_stranger(identity.who);
        }
        named.clear();
        if !*alike {
            let may_call = |vehicle| (!before.tracked.is_followed(vehicle)).then_some(Calls::New);
            calling.listen(markers, directory, glance.gravity, before, may_call);
            return;
        }
        naming.tell_sure(named);
        missing.find((glance.camera, markers), directory, (belongings, naming), before.tracked);
        calling.listen(markers, directory, glance.gravity, before, |vehicle| missing.call(vehicle));
    }
}
