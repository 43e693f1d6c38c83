//! Core, simulator and planner as the page calls them: numbers, grey pixels and text enter, JSON leaves.
//!
//! ```text
//! photinus_set_up    camera and airframe by their numbers       -> 1, or 0 where there are none such
//! photinus_pixels    room for a picture of that camera's size   -> where the page writes it, or reads what was rendered
//! photinus_locate    the picture                                -> JSON: spots, neighbours, tracks
//! photinus_fly       an exposure and a sky                      -> two robots before that camera
//! photinus_steer     where a robot is wanted
//! photinus_step      how much later it is                       -> the picture; JSON: when, and where the robots truly are
//! photinus_text      room for text                              -> where the page writes it
//! photinus_plan      a set-up as text                           -> JSON: its plan
//! photinus_parts     the parts that set-ups may name, as text
//! photinus_example   a set-up to begin with, as text
//! photinus_told      where the JSON or the text is
//! ```
//!
//! What tells something says how many bytes it told. Nothing is asked of the browser: the module has no imports. The page measures the time.

mod bench;
mod flight;
mod planner;
mod told;

use std::cell::RefCell;
use std::ptr::null_mut;

use nalgebra::Vector3;
use photinus::airframe::Ring;

pub use bench::{Bench, SetUp};
pub use flight::{Behind, Flight, Goal};
pub use planner::plan;

/// Where the robots of a flight begin: camera frame, m.
const STARTS: [Goal; 2] = [
    Goal { position_m: Vector3::new(-1.5, 0.2, 5.0), heading_rad: 0.2 },
    Goal { position_m: Vector3::new(2.0, -0.4, 7.0), heading_rad: 0.6 },
];

/// What the page works with.
#[derive(Debug, Default)]
struct Page {
    bench: Option<Bench>,
    flight: Option<Flight>,
    text: Vec<u8>,
    told: String,
}

impl Page {
    fn tell(&mut self, told: Option<String>) -> usize {
        self.told = told.unwrap_or_default();
        self.told.len()
    }
}

thread_local! {
    static PAGE: RefCell<Page> = RefCell::default();
}

/// Sets up an equidistant camera and a ring of LEDs. Locator and tracks begin anew, and no robot flies. 1 when there are such, else 0.
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
    let (arms, leds_per_arm) = (arms as usize, leds_per_arm as usize);
    let ring = Ring { arms, radius_m, leds_per_arm, splay_rad: splay_deg.to_radians() };
    let bench = Bench::new(&SetUp { size_px: [width_px as usize, height_px as usize], focal_px, ring });
    let is_set = u32::from(bench.is_some());
    PAGE.with_borrow_mut(|page| *page = Page { bench, ..Page::default() });
    is_set
}

/// Where the picture is, row by row, a byte for each pixel; nothing before a set-up.
#[expect(unsafe_code, reason = "a name for the page")]
#[unsafe(no_mangle)]
pub extern "C" fn photinus_pixels() -> *mut u8 {
    PAGE.with_borrow_mut(|page| page.bench.as_mut().map_or(null_mut(), |bench| bench.picture().as_mut_ptr()))
}

/// Locates the neighbours in the picture; gravity is known to be down in the picture when `is_level` is not 0. With a time, s, neighbours are
/// followed from picture to picture; without (not a number) they are not. The length of what is told.
#[expect(unsafe_code, reason = "a name for the page")]
#[unsafe(no_mangle)]
pub extern "C" fn photinus_locate(is_level: u32, time_s: f64) -> usize {
    PAGE.with_borrow_mut(|page| {
        let time_s = time_s.is_finite().then_some(time_s);
        let told = page.bench.as_mut().and_then(|bench| bench.locate(is_level != 0, time_s));
        page.tell(told)
    })
}

/// Puts two robots with the airframe of the set-up before its camera, by night (`sky` 0), under clouds (1) or under a blue sky (2). 1 when there
/// is a set-up and an exposure of more than nothing, else 0.
#[expect(unsafe_code, reason = "a name for the page")]
#[unsafe(no_mangle)]
pub extern "C" fn photinus_fly(exposure_us: f64, sky: u32) -> u32 {
    let behind = match sky {
        0 => Behind::Night,
        1 => Behind::Overcast,
        _ => Behind::Clear,
    };
    PAGE.with_borrow_mut(|page| {
        let bench = page.bench.as_ref().filter(|_| exposure_us > 0.0 && exposure_us.is_finite());
        page.flight = bench.map(|bench| {
            let (camera, airframe) = (bench.camera().clone(), bench.airframe().clone());
            Flight::new(camera, airframe, &STARTS, exposure_us * 1e-6, behind)
        });
        u32::from(page.flight.is_some())
    })
}

/// Says where a robot, 0 or 1, is wanted: camera frame, m; its heading to the left of the view, rad. What is no number is not obeyed.
#[expect(unsafe_code, reason = "a name for the page")]
#[unsafe(no_mangle)]
pub extern "C" fn photinus_steer(robot: u32, x_m: f64, y_m: f64, z_m: f64, heading_rad: f64) {
    let position_m = Vector3::new(x_m, y_m, z_m);
    if position_m.iter().all(|value| value.is_finite()) && heading_rad.is_finite() {
        PAGE.with_borrow_mut(|page| {
            if let Some(flight) = &mut page.flight {
                flight.steer(robot as usize, &Goal { position_m, heading_rad });
            }
        });
    }
}

/// Flies on for `step_s`, 1 s at most, and renders the picture. The length of what is told: the seconds since the start, and where
/// the robots truly are.
#[expect(unsafe_code, reason = "a name for the page")]
#[unsafe(no_mangle)]
pub extern "C" fn photinus_step(step_s: f64) -> usize {
    PAGE.with_borrow_mut(|page| {
        let told = match (&mut page.flight, &mut page.bench) {
            (Some(flight), Some(bench)) => flight.fly(step_s.clamp(0.0, 1.0), bench.picture()),
            _ => None,
        };
        page.tell(told)
    })
}

/// Room for text of so many bytes.
#[expect(unsafe_code, reason = "a name for the page")]
#[unsafe(no_mangle)]
pub extern "C" fn photinus_text(bytes: usize) -> *mut u8 {
    PAGE.with_borrow_mut(|page| {
        page.text.clear();
        page.text.resize(bytes, 0);
        page.text.as_mut_ptr()
    })
}

/// Plans the set-up whose text was written. The length of what is told.
#[expect(unsafe_code, reason = "a name for the page")]
#[unsafe(no_mangle)]
pub extern "C" fn photinus_plan() -> usize {
    PAGE.with_borrow_mut(|page| {
        let told = plan(&String::from_utf8_lossy(&page.text));
        page.tell(told)
    })
}

/// The parts that set-ups may name. The length of what is told.
#[expect(unsafe_code, reason = "a name for the page")]
#[unsafe(no_mangle)]
pub extern "C" fn photinus_parts() -> usize {
    PAGE.with_borrow_mut(|page| page.tell(Some(photinus_plan::PARTS.to_owned())))
}

/// A set-up to begin with. The length of what is told.
#[expect(unsafe_code, reason = "a name for the page")]
#[unsafe(no_mangle)]
pub extern "C" fn photinus_example() -> usize {
    PAGE.with_borrow_mut(|page| page.tell(Some(photinus_plan::EXAMPLE.to_owned())))
}

/// Where the text of what was told begins.
#[expect(unsafe_code, reason = "a name for the page")]
#[unsafe(no_mangle)]
pub extern "C" fn photinus_told() -> *const u8 {
    PAGE.with_borrow(|page| page.told.as_ptr())
}
