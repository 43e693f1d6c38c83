//! A camera, an airframe and options -> a locator; an image -> what it tells, kept until the next.

use std::sync::{Mutex, MutexGuard, TryLockError};

use nalgebra::{Unit, Vector3};
use photinus::camera::Bearing;
use photinus::frame::Mask;
use photinus::locator::{self, Input};
use photinus::lookout::{Glance, Lookout};
use photinus::tracking;

use crate::border::{Refusal, Result, Status, cross};
use crate::handles::{Airframe, Camera, Locator};
use crate::options::Options;
use crate::pointers::{self, Image, Place};
use crate::records::Frame;

/// What a locator's handle stands for.
pub(crate) struct Session {
    size: [usize; 2],
    state: Mutex<State>,
}

/// What a locator knows.
pub(crate) struct State {
    pub(crate) locator: locator::Locator,
    pub(crate) lookout: Option<Lookout>,
}

impl Session {
    /// What it knows, for this thread alone. Waiting would hide that two threads mix their frames up.
    pub(crate) fn state(&self) -> Result<MutexGuard<'_, State>> {
        match self.state.try_lock() {
            Ok(state) => Ok(state),
            // What a fault left is made anew by the next frame.
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(Refusal::new(
                Status::Busy,
                "another thread is using the locator; give each thread one of its own, or let them take turns",
            )),
        }
    }
}

impl State {
    fn locate(
        &mut self,
        image: Image,
        size: [usize; 2],
        gravity: Option<Unit<Vector3<f64>>>,
        time_s: f64,
    ) -> Result<Frame> {
        let Self { locator, lookout } = self;
        if lookout.is_some() && time_s.is_nan() {
            return refuse_time("the locator follows vehicles: it needs the time of every frame, s");
        }
        // SAFETY: the caller of the border promises it for the time of the call.
        let view = unsafe { image.view(size)? };
        let located = locator
            .locate(Input::frame(&view).gravity(gravity.as_ref()))
            .map_err(|error| Refusal::new(Status::Image, error))?;
        if let Some(lookout) = lookout {
            // How long an exposure lasts matters to what blinks alone.
            let glance = Glance { exposure_s: 0.0, gravity, ..Glance::new(time_s, located) };
            lookout.look(&glance).map_err(|error| Refusal::new(Status::Time, error))?;
        }
        Ok(Frame::new(located, lookout.as_ref().map(Lookout::tracked), time_s))
    }
}

fn refuse_time<T>(message: impl ToString) -> Result<T> {
    Err(Refusal::new(Status::Time, message))
}

fn setting(error: impl ToString) -> Refusal {
    Refusal::new(Status::Setting, error)
}

/// Opens a locator for neighbours of one kind of airframe in the frames of one camera; `options` may be null for the defaults. Takes up to a second. It
/// learns optics, the power of LEDs and clutter from its frames. Camera and airframe may be closed afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_open_locator(
    camera: Camera,
    airframe: Airframe,
    options: *const Options,
    locator: *mut Locator,
) -> Status {
    cross(|| {
        // SAFETY: as the header asks of its pointers.
        let (options, place) =
            unsafe { (Options::read(options)?, Place::new(locator, "the locator's handle")?) };
        let (camera, airframe) = (camera.get()?, airframe.get()?);
        // SAFETY: as the header asks of its pointers.
        let (settings, curve) = unsafe { options.settings(airframe.tolerances)? };
        let (camera, airframe) = (&camera.camera, &airframe.airframe);
        let locator = locator::Locator::new(camera.clone(), airframe, curve, settings).map_err(setting)?;
        let follow =
            || Lookout::new(camera.clone(), airframe, &settings, tracking::Settings::default(), None);
        let lookout = (options.tracks != 0).then(follow).transpose().map_err(setting)?;
        let size = [camera.width(), camera.height()];
        place.put(Locator::open(Session { size, state: Mutex::new(State { locator, lookout }) }));
        Ok(())
    })
}

/// Sets where not to look: an image of the camera's size that is 0 there, copied; null: look everywhere.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_set_mask(locator: Locator, mask: *const Image) -> Status {
    cross(|| {
        // SAFETY: as the header asks of its pointers.
        let mask = unsafe { pointers::read_if_any(mask, "the mask")? };
        let session = locator.get()?;
        let mut state = session.state()?;
        // SAFETY: as the header asks of its pointers, for the time of the call.
        let mask = mask.map(|mask| unsafe { mask.view(session.size) }).transpose()?;
        let mask = mask.map(|mask| Mask::from_frame(&mask));
        state.locator.set_mask(mask.clone()).map_err(setting)?;
        match &mut state.lookout {
            Some(lookout) => lookout.set_mask(0, mask).map_err(setting),
            None => Ok(()),
        }
    })
}

/// Forgets what frames told of the power of LEDs and of clutter: for frames that do not follow on those before.
#[unsafe(no_mangle)]
pub extern "C" fn photinus_forget(locator: Locator) -> Status {
    cross(|| {
        locator.get()?.state()?.locator.forget();
        Ok(())
    })
}

/// Locates the neighbours in an image of the camera's size, which is borrowed, not copied. `gravity`, 3 numbers, is down in the camera frame, of
/// any length; null where it is not known. `time_s` is when the exposure began; null where nobody follows vehicles. `frame` gets
/// how much was found, and the other functions tell it until the next image of this locator.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_locate(
    locator: Locator,
    image: *const Image,
    gravity: *const f64,
    time_s: *const f64,
    frame: *mut Frame,
) -> Status {
    cross(|| {
        // SAFETY: as the header asks of its pointers.
        let (image, gravity, time_s, place) = unsafe {
            (
                pointers::read(image, "the image")?,
                pointers::read_if_any(gravity.cast::<[f64; 3]>(), "gravity")?,
                pointers::read_if_any(time_s, "the time")?,
                Place::new(frame, "the frame's summary")?,
            )
        };
        let gravity = gravity.map(direction).transpose()?;
        if let Some(time_s) = time_s.filter(|time_s| !time_s.is_finite()) {
            return refuse_time(format!("a time of {time_s} s: it must be a finite number"));
        }
        let session = locator.get()?;
        let summary = session.state()?.locate(image, session.size, gravity, time_s.unwrap_or(f64::NAN))?;
        place.put(summary);
        Ok(())
    })
}

/// Down in the camera frame, of any length but 0; what is a unit vector to the last digits stays as it is.
fn direction(gravity: [f64; 3]) -> Result<Unit<Vector3<f64>>> {
    let vector = Vector3::from(gravity);
    if (vector.norm() - 1.0).abs() < 1e-12 {
        return Ok(Unit::new_unchecked(vector));
    }
    let bearing = Bearing::new(vector).ok_or_else(|| {
        setting(format!("gravity {gravity:?} points nowhere: give down in the camera frame, such as 0, 1, 0"))
    })?;
    Ok(Unit::new_unchecked(*bearing.vector()))
}

/// Closes a locator. A thread that is using it gets its answer.
#[unsafe(no_mangle)]
pub extern "C" fn photinus_close_locator(locator: Locator) -> Status {
    cross(|| locator.close())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::handles::Locator;

    #[test]
    fn a_locator_that_another_thread_uses_is_busy() {
        let camera = "model = \"equidistant\"\nwidth_px = 64\nheight_px = 48\ncentre_px = [31.5, 23.5]\nfocal_px = [30.0, 30.0]\n";
        let airframe = "name = \"one\"\n[[led]]\nposition_m = [0.0, 0.0, 0.0]\naxis = [1.0, 0.0, 0.0]\nlobe = \"lambertian\"\n";
        let camera = photinus_io::camera::parse_camera(camera.as_bytes(), "camera").expect("a camera");
        let airframe = photinus_io::airframe::parse_airframe(airframe, "airframe").expect("an airframe");
        let (camera, airframe) = (Camera::open(camera), Airframe::open(airframe));
        let mut locator = Locator::default();
        // SAFETY: the handle has room, and null options are the defaults.
        let status = unsafe { photinus_open_locator(camera, airframe, std::ptr::null(), &raw mut locator) };
        assert_eq!(status, Status::Ok);
        let session = locator.get().expect("open");
        let used = session.state().expect("free");
        let elsewhere = std::thread::spawn(move || photinus_forget(locator));
        assert_eq!(elsewhere.join().expect("no panic"), Status::Busy);
        drop(used);
        assert_eq!(photinus_forget(locator), Status::Ok);
    }
}
