//! What a frame brings: its time, how the camera turned, what was sighted and located, who blinks; and the copy of it that is kept for replays.

use alloc::vec::Vec;

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

use super::error::TrackError;
use super::motion::{Faster, Turn};
use crate::camera::{Bearing, Mounting, Rig};
use crate::locator::{Located, Neighbour, Sighting};
use crate::pose::{LogLight, Mode, Observation, POWER_RANGE};

/// Most ways in which a neighbour can be its airframe that are taken over.
const MOST_MODES: usize = 16;
/// Markers and neighbours that a frame has room for beforehand.
const FOLLOWED: usize = 128;
const NEIGHBOURS: usize = 4;
/// A marker is lit in no smaller share of the frames.
const LEAST_LIT: f64 = 0.05;
/// A light is a vehicle's, by what it blinks, from this probability on; and sightings of several vehicles are no neighbour.
pub(crate) const SURELY_HEARD: f64 = 0.95;
/// A signal that comes with its sighting is right so often.
const SIGNAL_IS_RIGHT: f64 = 0.99;

/// A frame, as the tracker takes it.
#[derive(Clone, Copy, Debug)]
pub struct Look<'a> {
    /// Which of the rig's cameras took it; 0 of one alone.
    pub camera: usize,
    /// When, s, on a clock of the caller's.
    pub time_s: f64,
    /// How it turned since the frame before in time, whichever camera of the rig took that one, in the axes of this camera; where that is known.
    pub turned: Option<Turned>,
    /// How the vehicle that it sits on moves over the ground, in the camera's axes, where that is known: of a camera alone its own movement.
    pub moving: Option<Moving>,
    /// Down in the camera frame, where it is known.
    pub gravity: Option<Unit<Vector3<f64>>>,
    /// What the locator makes of it.
    pub located: &'a Located,
    /// Which of the airframe's signals each sighting blinks, by sighting; those beyond its end blink what the locator was told.
    pub signals: &'a [Option<Signalled>],
    /// Which markers of which tracks are likely dark in this frame; all others are lit. Where markers are followed as they blink, `blinking` says it all.
    pub lit: &'a [Lit],
    /// Where markers blink and are followed one by one, whether they are lit in this frame.
    pub blinking: Option<Blinking<'a>>,
}

/// Markers that blink, as far as they are followed: they are lit by their place, whichever vehicle's they are, and however that is turned.
#[derive(Clone, Copy, Debug)]
pub struct Blinking<'a> {
    /// The markers that are followed.
    pub followed: &'a [Followed],
    /// How likely any other marker is lit.
    pub others: f64,
    /// No LED that blinks is dark for longer, s.
    pub longest_dark_s: f64,
    /// Whether all LEDs of a vehicle blink alike. Where they do not, a frame shows parts of vehicles, and what looks like a neighbour in it may be parts of
    /// several, so that nobody appears who is only seen.
    pub alike: bool,
    /// Vehicles whose words are heard and that have no track of their own.
    pub called: &'a [Called],
    /// By sighting, whether it surely is a light of nobody in the fleet; those beyond its end are not.
    pub strangers: &'a [bool],
    /// Tracks, and which vehicle of the fleet each surely is.
    pub named: &'a [(u64, u32)],
}

/// A vehicle whose words are heard, with its pose from all markers that blink them, also those that are dark in the frame.
#[derive(Clone, Debug, Default)]
pub struct Called {
    /// Who it is.
    pub vehicle: u32,
    /// Whose track it is.
    pub as_track: Calls,
    /// How likely its markers are one vehicle with these words, 0 to 1.
    pub probability: f64,
    /// Those of its markers that are sightings of the frame, ascending.
    pub members: Vec<usize>,
    /// The ways in which its markers can be the airframe, the likeliest first; yaw is told as far as signals differ.
    pub modes: Vec<Mode>,
}

/// Whose track a vehicle is that calls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Calls {
    /// Nobody's: it is a new one.
    #[default]
    New,
    /// That of this track, which has another vehicle's markers with its own: it begins anew.
    InsteadOf(u64),
    /// That of this track, which is in doubt.
    Doubting(u64),
}

/// A marker that is followed through its dark frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Followed {
    /// Where it is expected.
    pub bearing: Bearing,
    /// How likely it is lit while the frame is exposed, as far as those before tell: 0 dark to 1 lit.
    pub lit: f64,
    /// Whose it surely is, where that is known: the track, and which of the airframe's signals it blinks.
    pub signal: Option<(u64, u32)>,
}

/// How the camera turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turned {
    /// Maps coordinates in the axes of the frame before to those of this frame.
    pub now_from_before: Rotation3<f64>,
    /// Standard deviation per axis, rad.
    pub sigma_rad: f64,
}

impl Turned {
    /// The same in the axes that a camera is mounted in.
    pub(crate) fn of_body(&self, mounting: &Mounting) -> Self {
        let body_from_camera = &mounting.body_from_camera;
        let now_from_before = body_from_camera * self.now_from_before * body_from_camera.inverse();
        Self { now_from_before, ..*self }
    }
}

/// How the camera moves: what it gains in speed would else be taken for its neighbours'.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moving {
    /// Its velocity over the ground at the stamp, m/s, in its own axes.
    pub velocity_m_s: Vector3<f64>,
    /// Standard deviation of how it changes from frame to frame, per axis, m/s. An error that lasts is none of it.
    pub sigma_m_s: f64,
}

/// Whose light a sighting is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signalled {
    /// Which of the airframe's signals; `None` where several are alike.
    pub signal: Option<u32>,
    /// With what probability.
    pub probability: f64,
    /// Whose it is, where vehicles blink different words.
    pub vehicle: Option<u32>,
}

/// How likely a marker of a track is lit while a frame is exposed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lit {
    /// The track.
    pub track: u64,
    /// The marker of the airframe.
    pub marker: u16,
    /// 0 dark to 1 lit.
    pub probability: f64,
}

impl Followed {
    /// Whether it is so near to a direction.
    pub(super) fn is_near(&self, ahead: &Vector3<f64>, reach_rad: f64) -> bool {
        (self.bearing.vector() - ahead).norm() < reach_rad
    }
}

impl Look<'_> {
    /// Refuses what has no meaning.
    pub(crate) fn check(&self, rig: &Rig) -> Result<(), TrackError> {
        if self.camera >= rig.cameras().len() {
            return Err(TrackError::Camera { number: self.camera, of: rig.cameras().len() });
        }
        if !self.time_s.is_finite() {
            return Err(TrackError::Time(self.time_s));
        }
        let is_sigma = |sigma: f64| sigma.is_finite() && sigma >= 0.0;
        if let Some(Turned { sigma_rad, .. }) = self.turned.filter(|turned| !is_sigma(turned.sigma_rad)) {
            return Err(TrackError::Turn(sigma_rad));
        }
        let is_known = |own: &Moving| is_sigma(own.sigma_m_s) && own.velocity_m_s.norm().is_finite();
        match self.moving.filter(|own| !is_known(own)) {
            Some(own) => Err(TrackError::Moving(own.velocity_m_s.norm(), own.sigma_m_s)),
            None => Ok(()),
        }
    }
}

/// A neighbour of the frame: who may be a new track.
#[derive(Clone, Copy, Debug)]
pub(super) struct Appearance {
    pub(super) probability: f64,
    /// Who it is, where that was heard.
    pub(super) vehicle: Option<u32>,
    /// Whose track it is, where it was heard.
    pub(super) as_track: Calls,
    first_member: usize,
    members: usize,
    first_mode: usize,
    modes: usize,
}

impl Appearance {
    /// Whether it may be a vehicle that was heard to be this one.
    pub(super) fn may_be(&self, vehicle: Option<u32>) -> bool {
        self.vehicle.is_none() || self.vehicle == vehicle
    }
}

/// A frame, kept.
#[derive(Debug, Default)]
pub(super) struct Moment {
    pub(super) camera: usize,
    pub(super) time_s: f64,
    /// In the body's axes.
    pub(super) turned: Option<Turned>,
    pub(super) moving: Option<Moving>,
    /// In the camera's.
    pub(super) up: Option<Unit<Vector3<f64>>>,
    /// Light at which a marker is found half of the time, and how much that differs from marker to marker.
    pub(super) detection_limit: Option<LogLight>,
    /// How often a marker that must show does not.
    pub(super) miss_rate: Option<f64>,
    /// How far vehicles tilt, where frames tell it, rad.
    pub(super) tilt_sigma_rad: Option<f64>,
    /// How many times as much as supposed the power of LEDs spreads, where frames tell it.
    pub(super) light_times: Option<f64>,
    /// With the density of clutter per unit of the logarithm of its light, for one point of clutter per sr.
    pub(super) observations: Vec<Observation>,
    /// What the camera's calibration adds to the covariance of each.
    pub(super) calibrations: Vec<Matrix3<f64>>,
    pub(super) signals: Vec<Option<Signalled>>,
    pub(super) appearances: Vec<Appearance>,
    members: Vec<usize>,
    modes: Vec<Mode>,
    pub(super) lit: Vec<Lit>,
    pub(super) followed: Vec<Followed>,
    /// Which share of the frames in which a vehicle shows has each of its markers: 1 where all of them blink alike.
    pub(super) share_lit: f64,
    /// How likely markers are lit that are not among them; `None` where they do not blink.
    pub(super) others_lit: Option<f64>,
    /// No marker is dark for longer, s.
    pub(super) longest_dark_s: f64,
    /// Whether all LEDs of a vehicle blink alike.
    pub(super) blinks_alike: bool,
    /// Tracks, and which vehicle each surely is.
    pub(super) named: Vec<(u64, u32)>,
}

impl Moment {
    /// Room for a frame: each of those that are kept would else grow by itself.
    pub(super) fn with_room() -> Self {
        Self {
            modes: Vec::with_capacity(NEIGHBOURS * MOST_MODES),
            followed: Vec::with_capacity(FOLLOWED),
            ..Self::default()
        }
    }

    /// Takes over a frame.
    pub(super) fn keep(&mut self, look: &Look<'_>, mounting: &Mounting, kind: usize) {
        let Look { camera, time_s, turned, moving, gravity, located, signals, lit, blinking } = *look;
        (self.camera, self.time_s) = (camera, time_s);
        self.turned = turned.map(|turned| turned.of_body(mounting));
        let of_body =
            |own: Moving| Moving { velocity_m_s: mounting.body_from_camera * own.velocity_m_s, ..own };
        self.moving = moving.map(of_body);
        self.detection_limit = located.detection_limit;
        self.miss_rate = located.miss_rate;
        self.tilt_sigma_rad = located.tilt_sigma_rad;
        self.light_times = located.light_times;
        self.up = gravity.map(|down| -down);
        self.observations.clear();
        self.calibrations.clear();
        self.signals.clear();
        for (index, sighting) in located.sightings.iter().enumerate() {
            self.observations.push(observe(sighting));
            self.calibrations.push(sighting.covariance_rad2 - sighting.spot_covariance_rad2);
            let told = sighting.signal.map(|signal| Signalled {
                signal: Some(signal),
                probability: SIGNAL_IS_RIGHT,
                vehicle: None,
            });
            self.signals.push(signals.get(index).copied().unwrap_or(told));
        }
        self.lit.clear();
        self.lit.extend_from_slice(lit);
        self.followed.clear();
        self.followed.extend_from_slice(blinking.map_or(&[], |blinking| blinking.followed));
        self.others_lit = blinking.map(|blinking| blinking.others.clamp(0.0, 1.0));
        self.appearances.clear();
        self.members.clear();
        self.modes.clear();
        self.longest_dark_s = blinking.map_or(f64::INFINITY, |blinking| blinking.longest_dark_s);
        self.blinks_alike = blinking.is_some_and(|blinking| blinking.alike);
        let parts = blinking.filter(|blinking| !blinking.alike);
        self.share_lit = parts.and(self.others_lit).unwrap_or(1.0).max(LEAST_LIT);
        self.named.clear();
        self.named.extend_from_slice(blinking.map_or(&[], |blinking| blinking.named));
        let is_stranger = |spot: &usize| {
            parts.is_none_or(|Blinking { strangers, .. }| strangers.get(*spot).copied().unwrap_or(false))
        };
        for neighbour in located.neighbours.iter().filter(|neighbour| neighbour.kind == kind) {
            let Neighbour { probability, kind_probability, sightings, modes, .. } = neighbour;
            if sightings.iter().all(is_stranger) && !self.are_of_several(sightings) {
                let probability = probability * kind_probability;
                self.keep_appearance((None, Calls::New), probability, sightings, modes);
            }
        }
        for Called { vehicle, as_track, probability, members, modes } in
            blinking.map_or(&[][..], |blinking| blinking.called)
        {
            self.keep_appearance((Some(*vehicle), *as_track), *probability, members, modes);
        }
    }

    /// Whether these sightings were heard to be markers of different vehicles.
    fn are_of_several(&self, sightings: &[usize]) -> bool {
        let mut heard = sightings.iter().filter_map(|&spot| {
            self.signals[spot].filter(|own| own.probability > SURELY_HEARD).and_then(|own| own.vehicle)
        });
        let first = heard.next();
        heard.any(|own| Some(own) != first)
    }

    /// Whether nothing tells which turn of a symmetric airframe an appearance is: of LEDs that blink alike nothing does, else what is heard of them.
    pub(super) fn is_turned_anyhow(&self, appearance: &Appearance) -> bool {
        let is_dumb = |&spot: &usize| self.signals[spot].is_none();
        self.blinks_alike || appearance.vehicle.is_none() && self.members(appearance).iter().all(is_dumb)
    }

    /// Which vehicle a track is, where that was heard: when it appeared, or since.
    pub(super) fn who(&self, track: u64, when_it_appeared: Option<u32>) -> Option<u32> {
        let named = || self.named.iter().find(|named| named.0 == track).map(|named| named.1);
        when_it_appeared.or_else(named)
    }

    /// Whether a track surely is this vehicle.
    pub(super) fn is_named(&self, vehicle: u32) -> bool {
        self.named.iter().any(|named| named.1 == vehicle)
    }

    fn keep_appearance(
        &mut self,
        (vehicle, as_track): (Option<u32>, Calls),
        probability: f64,
        members: &[usize],
        modes: &[Mode],
    ) {
        let modes = &modes[..modes.len().min(MOST_MODES)];
        self.appearances.push(Appearance {
            probability,
            vehicle,
            as_track,
            first_member: self.members.len(),
            members: members.len(),
            first_mode: self.modes.len(),
            modes: modes.len(),
        });
        self.members.extend_from_slice(members);
        self.modes.extend_from_slice(modes);
    }

    /// The sightings of an appearance.
    pub(super) fn members(&self, appearance: &Appearance) -> &[usize] {
        &self.members[appearance.first_member..][..appearance.members]
    }

    /// The ways in which it can be the airframe, the likeliest first.
    pub(super) fn modes(&self, appearance: &Appearance) -> &[Mode] {
        &self.modes[appearance.first_mode..][..appearance.modes]
    }

    /// The direction of a sighting.
    pub(super) fn bearing(&self, sighting: usize) -> &Bearing {
        &self.observations[sighting].bearing
    }

    /// How the axes turned over the interval since the frame before, from those of its camera to those of this one; where nobody tells, the body turned
    /// anyhow.
    pub(super) fn turn(&self, rig: &Rig, before: usize, interval_s: f64, rate_sigma_rad_s: f64) -> Turn {
        let [before, now] = [before, self.camera].map(|camera| rig.mounting(camera));
        let told = self.turned.unwrap_or_else(|| Turned {
            now_from_before: Rotation3::identity(),
            sigma_rad: rate_sigma_rad_s * interval_s,
        });
        let now_from_body = now.body_from_camera.inverse();
        Turn {
            now_from_before: now_from_body * told.now_from_before * before.body_from_camera,
            sigma_rad: told.sigma_rad,
            before_m: before.lever_m(),
            now_m: now.lever_m(),
        }
    }

    /// How much faster the vehicle became since it moved so, where both are known, and how it turned meanwhile: its velocities are in its own axes.
    pub(super) fn faster(&self, rig: &Rig, before: Option<&Moving>) -> Option<Faster> {
        let (before, now, turned) = (before?, self.moving?, self.turned?);
        let by_m_s = now.velocity_m_s - turned.now_from_before * before.velocity_m_s;
        let camera_from_body = rig.mounting(self.camera).body_from_camera.inverse();
        Some(Faster { by_m_s: camera_from_body * by_m_s, sigma_m_s: now.sigma_m_s })
    }

    /// Puts a late frame before this one: this one's turn is since the late one from now on. Where the late one's own turn is not told, the camera is taken
    /// to have turned evenly. `before_s` is the time of the frame before both.
    pub(super) fn follow(&mut self, late: &mut Moment, before_s: f64) {
        let Some(whole) = self.turned else { return };
        let share = (late.time_s - before_s) / (self.time_s - before_s);
        let first = late.turned.unwrap_or_else(|| Turned {
            now_from_before: Rotation3::new(crate::pose::turn_of(&whole.now_from_before) * share),
            sigma_rad: whole.sigma_rad,
        });
        late.turned = Some(first);
        self.turned = Some(Turned {
            now_from_before: whole.now_from_before * first.now_from_before.inverse(),
            sigma_rad: whole.sigma_rad,
        });
    }
}

fn observe(sighting: &Sighting) -> Observation {
    let of_light = sighting.log_light.map_or(0.0, |_| libm::log(POWER_RANGE));
    Observation {
        bearing: sighting.bearing,
        covariance_rad2: sighting.spot_covariance_rad2,
        log_light: sighting.log_light,
        resolution_rad: sighting.resolution_rad,
        signal: None,
        clutter_log_density: -of_light - sighting.spot.marker_log_odds.min(0.0),
    }
}
