//! What a function wants to do -> a status for C, and the words for it.

use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// How a call ended.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// As it should.
    Ok = 0,
    /// A pointer is null or not aligned for what it should point to.
    Pointer = 1,
    /// A handle is 0, closed, or of something else.
    Handle = 2,
    /// Another thread is using the locator.
    Busy = 3,
    /// A text is not UTF-8.
    Text = 4,
    /// A file cannot be read or does not follow its format.
    File = 5,
    /// An image of another size than the camera's, or whose rows cannot be.
    Image = 6,
    /// An option or an argument has no meaning.
    Setting = 7,
    /// A time is missing where vehicles are followed, is no number, or came twice or too late.
    Time = 8,
    /// There is nothing with this index.
    Index = 9,
    /// A fault of Photinus itself; please report it.
    Fault = 10,
}

/// The names of all statuses, by their numbers.
const NAMES: [&CStr; 11] = [
    c"ok", c"pointer", c"handle", c"busy", c"text", c"file", c"image", c"setting", c"time", c"index",
    c"fault",
];

/// Why a call did not do what it should.
#[derive(Debug)]
pub(crate) struct Refusal {
    status: Status,
    message: String,
}

impl Refusal {
    /// A refusal; the message says what is wrong and what to do.
    pub(crate) fn new(status: Status, message: impl ToString) -> Self {
        Self { status, message: message.to_string() }
    }
}

pub(crate) type Result<T> = std::result::Result<T, Refusal>;

thread_local! {
    /// What went wrong last in this thread.
    static LAST: RefCell<Option<CString>> = const { RefCell::new(None) };
}

/// Does `work`; neither an error nor a panic goes farther than this.
pub(crate) fn cross(work: impl FnOnce() -> Result<()>) -> Status {
    // What a panic leaves behind in a locator is made anew by the next frame.
    let done = catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|payload| Err(fault(payload.as_ref())));
    let Err(Refusal { status, message }) = done else { return Status::Ok };
    let message = CString::new(message.replace('\0', "\u{fffd}")).ok();
    // A thread that is ending keeps no message.
    let _ = LAST.try_with(|last| last.replace(message));
    status
}

fn fault(payload: &(dyn Any + Send)) -> Refusal {
    let reason = payload
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| payload.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("it does not say why");
    Refusal::new(Status::Fault, format!("a fault in Photinus: {reason}; please report it"))
}

/// What went wrong last in the calling thread, in words: what is wrong, and what to do. Empty where nothing did. Stays in place until
/// the next call of this thread that fails.
#[unsafe(no_mangle)]
pub extern "C" fn photinus_error() -> *const c_char {
    let told = LAST.try_with(|last| last.borrow().as_ref().map(|message| message.as_ptr()));
    told.ok().flatten().unwrap_or(c"".as_ptr())
}

/// The name of a status in one word, such as "image"; "unknown" for a number that is none.
#[unsafe(no_mangle)]
pub extern "C" fn photinus_status_name(status: i32) -> *const c_char {
    usize::try_from(status).ok().and_then(|number| NAMES.get(number)).unwrap_or(&c"unknown").as_ptr()
}

/// The version of the library, such as "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn photinus_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn last() -> String {
        // SAFETY: the text is this thread's and ends with a zero.
        unsafe { CStr::from_ptr(photinus_error()) }.to_str().expect("UTF-8").to_owned()
    }

    #[test]
    fn a_panic_is_a_status_with_words() {
        assert_eq!(cross(|| panic!("the {}", "reason")), Status::Fault);
        assert_eq!(last(), "a fault in Photinus: the reason; please report it");
        assert_eq!(cross(|| std::panic::panic_any(7)), Status::Fault);
        assert_eq!(last(), "a fault in Photinus: it does not say why; please report it");
    }

    #[test]
    fn words_stay_with_their_thread_and_hold_no_zero() {
        assert_eq!(cross(|| Err(Refusal::new(Status::Image, "a\0b"))), Status::Image);
        std::thread::spawn(|| assert_eq!(last(), "")).join().expect("no panic");
        assert_eq!(cross(|| Ok(())), Status::Ok);
        assert_eq!(last(), "a\u{fffd}b");
    }

    #[test]
    fn every_status_has_its_name() {
        let name = |status: i32| {
            // SAFETY: names are static texts.
            unsafe { CStr::from_ptr(photinus_status_name(status)) }.to_str().expect("ASCII")
        };
        assert_eq!([name(0), name(Status::Time as i32), name(Status::Fault as i32)], ["ok", "time", "fault"]);
        assert_eq!([name(-1), name(11)], ["unknown"; 2]);
    }
}
