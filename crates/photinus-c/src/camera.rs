//! Calibrations -> cameras, and what they say of pixels and directions.

use std::ffi::c_char;
use std::path::Path;

use photinus::camera::{Bearing, Pixel};
use photinus_io::camera::{parse_camera, read_camera};

use crate::border::{Refusal, Result, Status, cross};
use crate::handles::Camera;
use crate::pointers::{self, Place, Places};

/// A file that was refused.
pub(crate) fn file(error: photinus_io::Error) -> Refusal {
    Refusal::new(Status::File, error)
}

/// Reads a camera's calibration of any format that Photinus knows; its content decides which. `path` is UTF-8.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_read_camera(path: *const c_char, camera: *mut Camera) -> Status {
    cross(|| {
        // SAFETY: as the header asks of its pointers.
        let (path, camera) =
            unsafe { (pointers::text(path, "the path")?, Place::new(camera, "the camera's handle")?) };
        camera.put(Camera::open(read_camera(Path::new(path)).map_err(file)?));
        Ok(())
    })
}

/// Reads a camera's calibration from the content of a file, `length` bytes. `name` stands for it in messages.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_parse_camera(
    content: *const u8,
    length: usize,
    name: *const c_char,
    camera: *mut Camera,
) -> Status {
    cross(|| {
        // SAFETY: as the header asks of its pointers.
        let (content, name, camera) = unsafe {
            (
                pointers::bytes(content, length, "the content")?,
                pointers::text(name, "the name")?,
                Place::new(camera, "the camera's handle")?,
            )
        };
        camera.put(Camera::open(parse_camera(content, Path::new(name)).map_err(file)?));
        Ok(())
    })
}

/// The size of its images, px: that of the frames that it can be used for.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_camera_size(
    camera: Camera,
    width: *mut usize,
    height: *mut usize,
) -> Status {
    cross(|| {
        // SAFETY: as the header asks of its pointers.
        let (width, height) = unsafe { (Place::new(width, "the width")?, Place::new(height, "the height")?) };
        let file = camera.get()?;
        width.put(file.camera.width());
        height.put(file.camera.height());
        Ok(())
    })
}

/// Number `index` of what is odd about its file, a sentence of UTF-8 that ends with a zero: as much of it as fits, and in `length` its bytes
/// without the zero. `PHOTINUS_STATUS_INDEX` where there are no more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_camera_note(
    camera: Camera,
    index: usize,
    note: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> Status {
    cross(|| {
        // SAFETY: as the header asks of its pointers.
        let places = unsafe { Places::new(note, capacity, length, "the note")? };
        put_note(&camera.get()?.oddities, index, places)
    })
}

/// Puts a note of a file with its closing zero.
pub(crate) fn put_note(notes: &[String], index: usize, places: Places<c_char>) -> Result<()> {
    let note = notes.get(index).ok_or_else(|| {
        Refusal::new(Status::Index, format!("there is no note {index}: the file has {}", notes.len()))
    })?;
    places.fill_text(note);
    Ok(())
}

/// The direction, a unit vector of 3 numbers in the camera frame, from which light falls on a place of the image: column `u_px` and row `v_px` from the
/// middle of the first pixel. NaN outside of the calibrated field.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_camera_bearing(
    camera: Camera,
    u_px: f64,
    v_px: f64,
    bearing: *mut f64,
) -> Status {
    cross(|| {
        // SAFETY: as the header asks of its pointers.
        let place = unsafe { Place::new(bearing.cast::<[f64; 3]>(), "the bearing")? };
        let seen = camera.get()?.camera.bearing(Pixel::new(u_px, v_px));
        place.put(seen.map_or([f64::NAN; 3], |bearing| (*bearing.vector()).into()));
        Ok(())
    })
}

/// Where a direction of the camera frame, 3 numbers of any length, is seen: 2 numbers, column and row, px. NaN outside of the field, and for a direction that is
/// none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_camera_pixel(
    camera: Camera,
    direction: *const f64,
    pixel: *mut f64,
) -> Status {
    cross(|| {
        // SAFETY: as the header asks of its pointers.
        let (direction, place) = unsafe {
            (
                pointers::read(direction.cast::<[f64; 3]>(), "the direction")?,
                Place::new(pixel.cast::<[f64; 2]>(), "the pixel")?,
            )
        };
        let file = camera.get()?;
        let pixel = Bearing::new(direction.into()).and_then(|bearing| file.camera.pixel(&bearing));
        place.put(pixel.map_or([f64::NAN; 2], |pixel| [pixel.u, pixel.v]));
        Ok(())
    })
}

/// Closes a camera. Locators that were made with it go on.
#[unsafe(no_mangle)]
pub extern "C" fn photinus_close_camera(camera: Camera) -> Status {
    cross(|| camera.close())
}
