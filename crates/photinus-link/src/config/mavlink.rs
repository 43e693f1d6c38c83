//! `[mavlink]`: an autopilot.

use photinus_io::{Error, Result};
use photinus_run::sink::Sink;
use serde::Deserialize;

use super::Camera;

/// `[mavlink]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mavlink {
    /// The autopilot's address, such as `127.0.0.1:14540`.
    pub peer: String,
    /// The own address; any free port where nothing is said.
    #[serde(default = "any_port")]
    pub local: String,
    /// The vehicle that this computer is on.
    pub system: Option<u8>,
    /// This computer on it.
    pub component: Option<u8>,
    /// How far from its origin a neighbour reaches, m.
    pub radius_m: Option<f64>,
    /// Neighbours are seen up to here, m.
    pub reach_m: Option<f64>,
    /// Whether a direction in which no neighbour is seen is told as free.
    #[serde(default)]
    pub tells_free: bool,
    /// Most OBSTACLE_DISTANCE a second.
    pub most_hz: Option<f64>,
    /// An answer that is older, ms, is none.
    pub stale_ms: Option<f64>,
}

impl Mavlink {
    /// Opens the link; what the autopilot says of its motion goes into `motion`.
    ///
    /// # Errors
    /// When an address is none, a port is taken, a number is not above 0, or a camera has no mounting.
    pub fn open(&self, cameras: &[Camera], motion: photinus_run::motion::Motion) -> Result<Box<dyn Sink>> {
        use crate::mavlink::{Autopilot, AutopilotSink, Obstacles, Outlook, Settings};
        let known = Settings::default();
        let numbers = [self.radius_m, self.reach_m, self.most_hz, self.stale_ms];
        if numbers.into_iter().flatten().any(|number| !(number > 0.0 && number.is_finite())) {
            return Err(Error::format("[mavlink]", "radius_m, reach_m, most_hz and stale_ms are above 0"));
        }
        let settings = Settings {
            system: self.system.unwrap_or(known.system),
            component: self.component.unwrap_or(known.component),
            obstacles: Obstacles {
                radius_m: self.radius_m.unwrap_or(known.obstacles.radius_m),
                reach_m: self.reach_m.unwrap_or(known.obstacles.reach_m),
                tells_free: self.tells_free,
            },
            most_hz: self.most_hz.unwrap_or(known.most_hz),
            stale_s: self.stale_ms.map_or(known.stale_s, |ms| ms * 1e-3),
        };
        if let Some(camera) = cameras.iter().find(|camera| camera.mounting.is_none()) {
            let reason = format!("how camera {} sits on the vehicle is not known", camera.view.camera);
            return Err(Error::format("[mavlink]", reason).advise("give its mounting"));
        }
        let open = |now_s: f64| {
            let mut link = Autopilot::new(self.local.as_str(), self.peer.as_str(), settings, now_s)?;
            for camera in cameras {
                let Some(mounting) = camera.mounting else { continue };
                let place = (mounting.body_from_camera, mounting.position_m.unwrap_or_default());
                let outlook = Outlook::new(&camera.lens, place, camera.mask.as_ref());
                link.camera(&camera.view.camera, outlook, place);
            }
            Ok(link)
        };
        let sink = AutopilotSink::new(motion, open).map_err(|error| Error::io("[mavlink]", error))?;
        Ok(Box::new(sink))
    }
}

fn any_port() -> String {
    "0.0.0.0:0".to_owned()
}
