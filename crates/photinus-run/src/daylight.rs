//! Where the sun stands in frame after frame: enters the sky, when a frame was taken and which way is down; leaves the sun in the camera frame.

use nalgebra::{Unit, Vector3};
use photinus::locator::Sun;
use photinus_io::sky::Sky;

/// The sun over a camera, where place and time are known.
#[derive(Clone, Debug, Default)]
pub struct Daylight {
    sky: Option<Sky>,
    /// The second that the sun was looked for last, and where it stood.
    last: Option<(f64, Option<Unit<Vector3<f64>>>)>,
}

impl Daylight {
    /// Under this sky.
    pub fn under(sky: Option<Sky>) -> Self {
        Self { sky, last: None }
    }

    /// The sun in a frame, where its time and gravity are known: the place in the sky is worked out once a second.
    pub fn sun(&mut self, time_s: Option<f64>, down: Option<&Unit<Vector3<f64>>>) -> Option<Sun> {
        let (sky, down, second) = (self.sky.as_ref()?, down?, time_s?.floor());
        let sun = match self.last {
            Some((known, sun)) if known.total_cmp(&second).is_eq() => sun,
            _ => sky.direction(second),
        };
        self.last = Some((second, sun));
        Some(sky.seen(&sun?, down))
    }
}
