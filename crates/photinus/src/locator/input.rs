//! What is looked at: the pixels of a frame, or the spots that another detector found in it.

use nalgebra::{Unit, Vector3};

use super::{Stage, Sun};
use crate::frame::FrameView;
use crate::spots::Spot;

/// What [`super::Locator::locate`] looks at, with what is known beside.
///
/// ```
/// # use photinus::{frame::FrameView, locator::Input};
/// # use nalgebra::Vector3;
/// # let (pixels, width, height) = (vec![0; 12], 4, 3);
/// let frame = FrameView::packed(&pixels, width, height)?;
/// let level = Input::frame(&frame).gravity(&Vector3::y_axis());
/// # Ok::<(), photinus::frame::FrameError>(())
/// ```
#[must_use]
pub struct Input<'a> {
    pub(super) seen: Seen<'a>,
    pub(super) gravity: Option<&'a Unit<Vector3<f64>>>,
    pub(super) sun: Option<Sun>,
    pub(super) exposure_s: Option<f64>,
    finished: Option<&'a mut dyn FnMut(Stage)>,
}

/// What there is to see.
#[derive(Clone, Copy)]
pub(super) enum Seen<'a> {
    Frame(&'a FrameView<'a>),
    Spots(&'a [Spot]),
    Signalled(&'a [(Spot, Option<u32>)]),
}

impl<'a> Input<'a> {
    /// A frame of the camera's size.
    pub fn frame(frame: &'a FrameView<'a>) -> Self {
        Self::of(Seen::Frame(frame))
    }

    /// The spots of a frame, of another detector.
    pub fn spots(spots: &'a [Spot]) -> Self {
        Self::of(Seen::Spots(spots))
    }

    /// Spots with the signal that each was seen to blink, `None` where that is not known: with them a symmetric airframe's yaw is told as far as its
    /// signals differ. A signal that no LED of the airframe carries tells nothing, a wrong one little.
    pub fn signalled(spots: &'a [(Spot, Option<u32>)]) -> Self {
        Self::of(Seen::Signalled(spots))
    }

    fn of(seen: Seen<'a>) -> Self {
        Self { seen, gravity: None, sun: None, exposure_s: None, finished: None }
    }

    /// Down in the camera frame, where it is known.
    pub fn gravity(self, down: impl Into<Option<&'a Unit<Vector3<f64>>>>) -> Self {
        Self { gravity: down.into(), ..self }
    }

    /// The sun, where it is known where it stands.
    pub fn sun(self, sun: impl Into<Option<Sun>>) -> Self {
        Self { sun: sun.into(), ..self }
    }

    /// How long it was exposed, s, where that is known: the light of frames is compared as at one exposure. What is not positive is unknown.
    pub fn exposure(self, exposure_s: impl Into<Option<f64>>) -> Self {
        let exposure_s = exposure_s.into().filter(|exposure_s| *exposure_s > 0.0 && exposure_s.is_finite());
        Self { exposure_s, ..self }
    }

    /// Who is told each stage as it ends, so that a caller with a clock can time it.
    pub fn finished(self, finished: &'a mut dyn FnMut(Stage)) -> Self {
        Self { finished: Some(finished), ..self }
    }

    /// Tells that a stage has ended.
    pub(super) fn tell(&mut self, stage: Stage) {
        if let Some(finished) = &mut self.finished {
            finished(stage);
        }
    }
}
