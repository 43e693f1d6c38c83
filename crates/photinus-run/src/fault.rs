//! A panic is a fault of Photinus, not of its input: it is told in a line like other errors, by whoever catches it.

use std::any::Any;
use std::panic;
use std::sync::Mutex;

/// What to do about a fault.
pub const ADVICE: &str = "please report it, with the file if you may";

/// Where the last panic came from, on whichever thread.
static PLACE: Mutex<String> = Mutex::new(String::new());

/// From now on panics print nothing by themselves. Whoever looks for one sets RUST_BACKTRACE and sees them as ever.
pub fn be_quiet() {
    if std::env::var_os("RUST_BACKTRACE").is_some() {
        return;
    }
    panic::set_hook(Box::new(|info| {
        let place = info.location().map(ToString::to_string).unwrap_or_default();
        if let Ok(mut last) = PLACE.lock() {
            *last = place;
        }
    }));
}

/// What a panic that was caught says, with its place where that is known.
pub fn told(payload: &(dyn Any + Send)) -> String {
    let reason = payload
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| payload.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("it does not say why");
    let place = PLACE.lock().map(|place| place.clone()).unwrap_or_default();
    match place.is_empty() {
        true => format!("a fault in Photinus: {reason}"),
        false => format!("a fault in Photinus, at {place}: {reason}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_told_whatever_it_carries() {
        let told = |work: fn()| told(panic::catch_unwind(work).unwrap_err().as_ref());
        assert!(told(|| panic!("plain")).ends_with(": plain"));
        assert!(told(|| panic!("{} of {}", 3, 2)).ends_with(": 3 of 2"));
        assert!(told(|| panic::panic_any(7)).ends_with("it does not say why"));
    }
}
