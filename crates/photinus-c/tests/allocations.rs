//! A warm locator that is called through the interface of C allocates nothing: every request to the allocator is counted.

#![allow(unsafe_code, reason = "it calls what C calls")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::mem::MaybeUninit;
use std::ptr::null;

use photinus_c::*;

const WIDTH: usize = 64;
const HEIGHT: usize = 48;
const CAMERA: &str = "model = \"equidistant\"\nwidth_px = 64\nheight_px = 48\ncentre_px = [31.5, 23.5]\nfocal_px = [30.0, 30.0]\n";
const AIRFRAME: &str =
    "name = \"one\"\n[[led]]\nposition_m = [0.0, 0.0, 0.0]\naxis = [1.0, 0.0, 0.0]\nlobe = \"lambertian\"\n";

struct Counting;

thread_local! {
    /// Requests of this thread: the test harness has others.
    static REQUESTS: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: the arguments are passed on as they came, so the caller's promises are those that `System` needs.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        REQUESTS.with(|requests| requests.set(requests.get() + 1));
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Three square lights that wander.
fn draw(pixels: &mut [u8], number: usize) {
    pixels.fill(10);
    for light in 0..3 {
        let (left, top) =
            (2 + (number * (light + 1) / 3 + 19 * light) % 56, 2 + (number / 5 + 13 * light) % 42);
        for row in top..top + 3 {
            pixels[row * WIDTH + left..][..3].copy_from_slice(&[90, 220, 90]);
        }
    }
}

/// Locates a frame and reads all that it told; how many spots it has.
fn frame(locator: Locator, pixels: &[u8], number: usize) -> usize {
    let image = Image { pixels: pixels.as_ptr(), width: WIDTH, height: HEIGHT, stride: WIDTH as isize };
    let (gravity, time_s) = ([0.0, 1.0, 0.0], number as f64 / 60.0);
    let mut summary = MaybeUninit::<Frame>::uninit();
    let mut spots = [const { MaybeUninit::<Spot>::uninit() }; 16];
    let mut neighbours = [const { MaybeUninit::<Neighbour>::uninit() }; 16];
    let mut tracks = [const { MaybeUninit::<Track>::uninit() }; 16];
    let mut count = 0;
    // SAFETY: all pointers are to what is on the stack above, with room for 16.
    let done = unsafe {
        [
            photinus_locate(
                locator,
                &raw const image,
                gravity.as_ptr(),
                &raw const time_s,
                summary.as_mut_ptr(),
            ),
            photinus_neighbours(locator, neighbours.as_mut_ptr().cast(), 16, &raw mut count),
            photinus_tracks(locator, tracks.as_mut_ptr().cast(), 16, &raw mut count),
            photinus_spots(locator, spots.as_mut_ptr().cast(), 16, &raw mut count),
        ]
    };
    assert_eq!(done, [Status::Ok; 4]);
    count
}

#[test]
fn a_warm_locator_allocates_nothing() {
    let (mut camera, mut airframe, mut locator) =
        (Camera::default(), Airframe::default(), Locator::default());
    let mut options = MaybeUninit::<Options>::uninit();
    // SAFETY: all pointers are to values of their types; the options are read after they were filled.
    let done = unsafe {
        let parsed = [
            photinus_parse_camera(CAMERA.as_ptr(), CAMERA.len(), c"camera".as_ptr(), &raw mut camera),
            photinus_parse_airframe(
                AIRFRAME.as_ptr(),
                AIRFRAME.len(),
                c"airframe".as_ptr(),
                &raw mut airframe,
            ),
            photinus_default_options(options.as_mut_ptr()),
        ];
        assert_eq!(parsed, [Status::Ok; 3]);
        (*options.as_mut_ptr()).tracks = 1;
        photinus_open_locator(camera, airframe, options.as_ptr(), &raw mut locator)
    };
    assert_eq!(done, Status::Ok);

    let mut pixels = vec![0; WIDTH * HEIGHT];
    let mut spots = 0;
    let mut run = |numbers: std::ops::Range<usize>| {
        let before = REQUESTS.get();
        for number in numbers {
            draw(&mut pixels, number);
            spots += frame(locator, &pixels, number);
        }
        REQUESTS.get() - before
    };
    assert!(run(0..2000) > 0, "the counter counts");
    assert_eq!(run(2000..3000), 0);
    assert!(spots > 3000, "{spots} spots");

    // A refusal has words, which are allocated.
    let before = REQUESTS.get();
    // SAFETY: null is refused.
    let refused = unsafe { photinus_locate(locator, null(), null(), null(), std::ptr::null_mut()) };
    assert_eq!(refused, Status::Pointer);
    assert!(REQUESTS.get() > before);
    assert_eq!(photinus_close_locator(locator), Status::Ok);
}
