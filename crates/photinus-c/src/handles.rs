//! What is open, by number. A number is never given twice, so that a handle that was closed is refused whatever came after it.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, PoisonError, RwLock};

use photinus_io::CameraFile;
use photinus_io::airframe::AirframeFile;

use crate::border::{Refusal, Result, Status};
use crate::locator::Session;

/// A camera. All zero is none.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Camera {
    /// Its number; for the library alone.
    pub number: u64,
}

/// Where the LEDs of a kind of robot sit. All zero is none.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Airframe {
    /// Its number; for the library alone.
    pub number: u64,
}

/// What locates neighbours in the frames of one camera. All zero is none.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Locator {
    /// Its number; for the library alone.
    pub number: u64,
}

/// What a number stands for. One that is closed while another thread uses it lives until that is done.
#[derive(Clone)]
enum Object {
    Camera(Arc<CameraFile>),
    Airframe(Arc<AirframeFile>),
    Locator(Arc<Session>),
}

static OPEN: RwLock<BTreeMap<u64, Object>> = RwLock::new(BTreeMap::new());
static NEXT: AtomicU64 = AtomicU64::new(1);

fn open(object: Object) -> u64 {
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    OPEN.write().unwrap_or_else(PoisonError::into_inner).insert(number, object);
    number
}

fn find(number: u64) -> Option<Object> {
    OPEN.read().unwrap_or_else(PoisonError::into_inner).get(&number).cloned()
}

fn close(number: u64) {
    let closed = OPEN.write().unwrap_or_else(PoisonError::into_inner).remove(&number);
    // Outside of the lock: a locator is large.
    drop(closed);
}

/// Why a number is no `wanted`.
fn refuse(number: u64, wanted: &str, found: Option<&Object>) -> Refusal {
    let what = match found {
        Some(Object::Camera(_)) => "is a camera's".to_owned(),
        Some(Object::Airframe(_)) => "is an airframe's".to_owned(),
        Some(Object::Locator(_)) => "is a locator's".to_owned(),
        None if number == 0 => "is 0: nothing was opened into it, or opening it failed".to_owned(),
        None if number < NEXT.load(Ordering::Relaxed) => format!("is {number}, which is closed"),
        None => format!("is {number}, which was never opened: it was not initialised, or overwritten"),
    };
    Refusal::new(Status::Handle, format!("the handle of the {wanted} {what}"))
}

/// A kind of handle: numbers of one kind of object.
macro_rules! handle {
    ($handle:ident, $object:ident, $value:ty, $name:literal) => {
        impl $handle {
            pub(crate) fn open(value: $value) -> Self {
                Self { number: open(Object::$object(Arc::new(value))) }
            }

            /// What is open under it.
            pub(crate) fn get(self) -> Result<Arc<$value>> {
                match find(self.number) {
                    Some(Object::$object(value)) => Ok(value),
                    other => Err(refuse(self.number, $name, other.as_ref())),
                }
            }

            pub(crate) fn close(self) -> Result<()> {
                self.get().map(|_| close(self.number))
            }
        }
    };
}

handle!(Camera, Camera, CameraFile, "camera");
handle!(Airframe, Airframe, AirframeFile, "airframe");
handle!(Locator, Locator, Session, "locator");
