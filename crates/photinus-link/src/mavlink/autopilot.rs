//! The link to an autopilot: a socket that never blocks, and a clock that the caller reads.

use std::cmp::Ordering;
use std::collections::{BTreeSet, VecDeque};
use std::io::{self, ErrorKind};
use std::net::{SocketAddr, ToSocketAddrs, UdpSocket};

use mavlink::dialects::common::{
    HEARTBEAT_DATA, MavAutopilot, MavMessage, MavModeFlag, MavSeverity, MavState, MavType, STATUSTEXT_DATA,
};
use mavlink::{MAVLinkV2MessageRaw, MavHeader};
use photinus_io::results::FrameRecord;

use super::heard::{self, Attitude, Speed, Turn};
use super::{Obstacles, Outlook, Own, Ring, follow_target};
use crate::clock_offset::ClockOffset;

/// How the link behaves.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// The vehicle that this computer is on.
    pub system: u8,
    /// This computer on it: 191 is the first onboard computer.
    pub component: u8,
    /// What neighbours are taken for.
    pub obstacles: Obstacles,
    /// Most OBSTACLE_DISTANCE a second, and FOLLOW_TARGET.
    pub most_hz: f64,
    /// An answer that is older than this, s, no longer counts: it is told within 100 ms that there is none.
    pub stale_s: f64,
}

impl Default for Settings {
    fn default() -> Self {
        let obstacles = Obstacles { radius_m: 0.5, reach_m: 20.0, tells_free: false };
        Self { system: 1, component: 191, obstacles, most_hz: 15.0, stale_s: 0.08 }
    }
}

/// What was heard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Heard {
    /// How the vehicle is turned.
    Attitude(Attitude),
    /// How fast it turns.
    Turn(Turn),
    /// How fast it moves.
    Speed(Speed),
    /// Where it is.
    Own(Own),
}

const HEARTBEAT_S: f64 = 1.0;
/// No more messages than this are taken at once: a flood must not keep the caller.
const MOST_AT_ONCE: usize = 256;
/// MAVLink 2 frames have at most 280 bytes; a datagram may hold several.
const DATAGRAM_BYTES: usize = 2048;

/// A camera whose answers are told.
struct Camera {
    name: String,
    outlook: Outlook,
    mounting: (nalgebra::UnitQuaternion<f64>, nalgebra::Vector3<f64>),
    last: Option<FrameRecord>,
    last_s: f64,
    is_stale: bool,
}

/// The link to an autopilot.
pub struct Autopilot {
    socket: UdpSocket,
    peer: SocketAddr,
    settings: Settings,
    sequence: u8,
    cameras: Vec<Camera>,
    clock: ClockOffset,
    /// Odometries are stamped by whoever makes them, not always by the autopilot.
    odometry_clock: ClockOffset,
    attitude: Option<Attitude>,
    own: Option<Own>,
    began_s: f64,
    heartbeat_s: Option<f64>,
    obstacles_s: Option<f64>,
    targets_s: Option<f64>,
    refused: u64,
    /// Of the datagram that came last: what was not handed on yet.
    heard: VecDeque<Heard>,
}

impl Autopilot {
    /// A link from `local` (`0.0.0.0:0` for any port) to the autopilot at `peer`; nothing is sent before the first [`Autopilot::tick`].
    ///
    /// # Errors
    /// When an address is not valid, or the port is taken.
    pub fn new(
        local: impl ToSocketAddrs,
        peer: impl ToSocketAddrs,
        settings: Settings,
        now_s: f64,
    ) -> io::Result<Self> {
        let none =
            || io::Error::new(ErrorKind::InvalidInput, "the autopilot's address is not a host and a port");
        let peer = peer.to_socket_addrs()?.next().ok_or_else(none)?;
        let socket = UdpSocket::bind(local)?;
        socket.set_nonblocking(true)?;
        Ok(Self {
            socket,
            peer,
            settings,
            sequence: 0,
            cameras: Vec::new(),
            clock: ClockOffset::default(),
            odometry_clock: ClockOffset::default(),
            attitude: None,
            own: None,
            began_s: now_s,
            heartbeat_s: None,
            obstacles_s: None,
            targets_s: None,
            refused: 0,
            heard: VecDeque::new(),
        })
    }

    /// Where it listens.
    ///
    /// # Errors
    /// When the system does not say.
    pub fn local(&self) -> io::Result<SocketAddr> {
        self.socket.local_addr()
    }

    /// Adds a camera, mounted so, and gives its number. Until its first answer it is silent, which is told.
    pub fn camera(
        &mut self,
        name: &str,
        outlook: Outlook,
        mounting: (nalgebra::UnitQuaternion<f64>, nalgebra::Vector3<f64>),
    ) -> usize {
        let name = name.to_owned();
        self.cameras.push(Camera {
            name,
            outlook,
            mounting,
            last: None,
            last_s: self.began_s,
            is_stale: false,
        });
        self.cameras.len() - 1
    }

    /// How many datagrams held something that is no message.
    #[must_use]
    pub fn refused(&self) -> u64 {
        self.refused
    }

    /// How much later the clock of arrivals is than the autopilot's, s.
    #[must_use]
    pub fn clock_offset_s(&self) -> Option<f64> {
        self.clock.offset_s()
    }

    /// Tells what a camera found. `exposed_s` is when the frame was taken and `now_s` the time, both on the caller's clock.
    pub fn located(&mut self, camera: usize, record: &FrameRecord, exposed_s: f64, now_s: f64) {
        let stale_s = self.settings.stale_s;
        let Some(camera) = self.cameras.get_mut(camera) else { return };
        (camera.last, camera.last_s) = (Some(record.clone()), exposed_s);
        let was_stale = std::mem::replace(&mut camera.is_stale, now_s - exposed_s > stale_s);
        let text = (was_stale && !camera.is_stale).then(|| format!("photinus: {} is back", camera.name));
        if let Some(text) = text {
            self.say(MavSeverity::MAV_SEVERITY_NOTICE, &text);
        }
        self.obstacles(now_s, false);
        self.targets(now_s);
    }

    /// What is due: the heartbeat, and word of cameras that have fallen silent. To be called every 20 ms or more often.
    pub fn tick(&mut self, now_s: f64) {
        let stale_s = self.settings.stale_s;
        let mut silent = Vec::new();
        for camera in self.cameras.iter_mut().filter(|camera| !camera.is_stale) {
            if now_s - camera.last_s > stale_s {
                (camera.is_stale, camera.last) = (true, None);
                silent.push(format!(
                    "photinus: no answer of {} for {:.0} ms",
                    camera.name,
                    1e3 * (now_s - camera.last_s)
                ));
            }
        }
        for text in &silent {
            self.say(MavSeverity::MAV_SEVERITY_ERROR, text);
        }
        if !silent.is_empty() {
            self.obstacles(now_s, true);
        }
        if !silent.is_empty() || is_due(self.heartbeat_s, now_s, HEARTBEAT_S) {
            self.heartbeat_s = Some(now_s);
            self.heartbeat();
        }
    }

    /// Takes the next message that means something to Photinus; `None` where there is none by now.
    pub fn hear(&mut self, now_s: f64) -> Option<Heard> {
        let mut bytes = [0; DATAGRAM_BYTES];
        for _ in 0..MOST_AT_ONCE {
            if !self.heard.is_empty() {
                break;
            }
            let (length, _) = self.socket.recv_from(&mut bytes).ok()?;
            let mut heard = std::mem::take(&mut self.heard);
            self.understand(&bytes[..length], now_s, |one| heard.push_back(one));
            self.heard = heard;
        }
        self.heard.pop_front()
    }

    /// Hands over what the messages of a datagram say that means something, in their order, for those who receive it otherwise than [`Self::hear`].
    pub fn understand(&mut self, datagram: &[u8], now_s: f64, mut hand_over: impl FnMut(Heard)) {
        let mut reader = mavlink::MavlinkReader::new(datagram);
        let mut any = false;
        while let Ok((header, message)) = reader.read_any_message::<MavMessage>() {
            any = true;
            if header.system_id != u32::from(self.settings.system) {
                continue;
            }
            if let Some(heard) = self.meaning(&message, now_s) {
                hand_over(heard);
            }
        }
        self.refused += u64::from(!any);
    }

    fn meaning(&mut self, message: &MavMessage, now_s: f64) -> Option<Heard> {
        match message {
            MavMessage::ATTITUDE_QUATERNION(data) => {
                let attitude = heard::attitude(data, &mut self.clock, now_s)?;
                self.attitude = Some(attitude);
                Some(Heard::Attitude(attitude))
            }
            MavMessage::HIGHRES_IMU(data) => heard::turn(data, &mut self.clock, now_s).map(Heard::Turn),
            MavMessage::LOCAL_POSITION_NED(data) => {
                heard::speed(data, &self.attitude?, &mut self.clock, now_s).map(Heard::Speed)
            }
            MavMessage::ODOMETRY(data) => {
                heard::odometry(data, &mut self.odometry_clock, now_s).map(Heard::Speed)
            }
            MavMessage::GLOBAL_POSITION_INT(data) => {
                self.own = Some(heard::own(data, &self.attitude?));
                self.own.map(Heard::Own)
            }
            _ => None,
        }
    }

    fn heartbeat(&mut self) {
        let is_well = self.cameras.iter().all(|camera| !camera.is_stale);
        let state = if is_well { MavState::MAV_STATE_ACTIVE } else { MavState::MAV_STATE_CRITICAL };
        self.send(&MavMessage::HEARTBEAT(HEARTBEAT_DATA {
            custom_mode: 0,
            mavtype: MavType::MAV_TYPE_ONBOARD_CONTROLLER,
            autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID,
            base_mode: MavModeFlag::empty(),
            system_status: state,
            mavlink_version: 3,
        }));
    }

    fn obstacles(&mut self, now_s: f64, at_once: bool) {
        if !at_once && !is_due(self.obstacles_s, now_s, 1.0 / self.settings.most_hz) {
            return;
        }
        self.obstacles_s = Some(now_s);
        let mut ring = Ring::unknown(self.settings.obstacles);
        for camera in self.cameras.iter().filter(|camera| !camera.is_stale) {
            if let Some(record) = &camera.last {
                ring.add(record, &camera.outlook);
            }
        }
        let message = ring.message(self.since_boot_us(now_s));
        self.send(&MavMessage::OBSTACLE_DISTANCE(message));
    }

    /// Who is followed, where the own place is known.
    fn targets(&mut self, now_s: f64) {
        let (Some(own), Some(attitude)) = (self.own, self.attitude) else { return };
        if !is_due(self.targets_s, now_s, 1.0 / self.settings.most_hz) {
            return;
        }
        self.targets_s = Some(now_s);
        let own = Own { enu_from_body: attitude.enu_from_body, ..own };
        let time_boot_ms = self.since_boot_us(now_s) / 1000;
        // Cameras of one vehicle all tell who is followed: the newest frame knows best.
        let fresh = self.cameras.iter().filter(|camera| !camera.is_stale);
        let mut told: Vec<_> =
            fresh.filter_map(|camera| Some((camera.last.as_ref()?, camera.mounting))).collect();
        told.sort_by(|a, b| b.0.time_s.partial_cmp(&a.0.time_s).unwrap_or(Ordering::Equal));
        let mut ids = BTreeSet::new();
        let mut targets = Vec::new();
        for (record, mounting) in told {
            let named = record.tracks.iter().filter(|track| track.id.is_some_and(|id| ids.insert(id)));
            targets.extend(named.map(|track| follow_target(track, &own, mounting, time_boot_ms)));
        }
        targets.into_iter().for_each(|target| self.send(&MavMessage::FOLLOW_TARGET(target)));
    }

    fn say(&mut self, severity: MavSeverity, text: &str) {
        self.send(&MavMessage::STATUSTEXT(STATUSTEXT_DATA {
            severity,
            text: text.into(),
            ..Default::default()
        }));
    }

    /// On the autopilot's clock, once it was heard; on that of this link before.
    fn since_boot_us(&self, now_s: f64) -> u64 {
        let boot_s = self.clock.offset_s().unwrap_or(self.began_s);
        ((now_s - boot_s).max(0.0) * 1e6) as u64
    }

    /// What the network does not take is lost: the next message is newer.
    fn send(&mut self, message: &MavMessage) {
        let (system_id, component_id) = (u32::from(self.settings.system), self.settings.component);
        let mut raw = MAVLinkV2MessageRaw::new();
        raw.serialize_message(MavHeader { system_id, component_id, sequence: self.sequence }, message);
        self.sequence = self.sequence.wrapping_add(1);
        let _ = self.socket.send_to(raw.raw_bytes(), self.peer);
    }
}

fn is_due(last_s: Option<f64>, now_s: f64, every_s: f64) -> bool {
    // A clock that was set back is due, too.
    last_s.is_none_or(|last_s| now_s - last_s >= every_s || now_s < last_s)
}
