//! The core as the page calls it: a set-up and grey pixels enter, what was located leaves as JSON.
//!
//! ```text
//! photinus_set_up    camera and airframe by their numbers       -> 1, or 0 where there are none such
//! photinus_pixels    room for a picture of that camera's size   -> where the page writes it
//! photinus_locate    the picture                                -> how many bytes of JSON
//! photinus_told      where these are
//! ```
//!
//! Nothing is asked of the browser: the module has no imports. The page measures the time.

mod bench;
mod told;

use std::cell::RefCell;

pub use bench::Bench;

thread_local! {
    static BENCH: RefCell<Option<Bench>> = const { RefCell::new(None) };
}

/// Sets up an equidistant camera and a ring of LEDs. The locator begins anew. 1 when there are such, else 0.
#[expect(unsafe_code, reason = "a name for the page")]
#[unsafe(no_mangle)]
pub extern "C" fn photinus_set_up(
    width_px: u32,
    height_px: u32,
    focal_px: f64,
    arms: u32,
    radius_m: f64,
    leds_per_arm: u32,
    splay_deg: f64,
) -> u32 {
    let size_px = [width_px as usize, height_px as usize];
    let bench = Bench::new(size_px, focal_px, [arms as usize, leds_per_arm as usize], radius_m, splay_deg);
    let is_set = u32::from(bench.is_some());
    BENCH.with_borrow_mut(|held| *held = bench);
    is_set
}

/// Where the page writes the picture, row by row, a byte for each pixel; nothing before a set-up.
#[expect(unsafe_code, reason = "a name for the page")]
#[unsafe(no_mangle)]
pub extern "C" fn photinus_pixels() -> *mut u8 {
    BENCH.with_borrow_mut(|bench| bench.as_mut().map_or(std::ptr::null_mut(), Bench::pixels))
}

/// Locates the neighbours in the picture; gravity is known to be down in the picture when `is_level` is not 0. The length of what is told.
#[expect(unsafe_code, reason = "a name for the page")]
#[unsafe(no_mangle)]
pub extern "C" fn photinus_locate(is_level: u32) -> usize {
    BENCH.with_borrow_mut(|bench| bench.as_mut().map_or(0, |bench| bench.locate(is_level != 0)))
}

/// Where the text of what was told begins; nothing before a set-up.
#[expect(unsafe_code, reason = "a name for the page")]
#[unsafe(no_mangle)]
pub extern "C" fn photinus_told() -> *const u8 {
    BENCH.with_borrow(|bench| bench.as_ref().map_or(std::ptr::null(), |bench| bench.told().as_ptr()))
}
