//! Files of LEDs -> airframes.

use std::ffi::c_char;

use photinus_io::airframe::{parse_airframe, read_airframe};

use crate::border::{Status, cross};
use crate::camera::{file, put_note};
use crate::handles::Airframe;
use crate::pointers::{self, Place, Places};

/// Reads an airframe: Photinus TOML or a UVDAR layout, told apart by content. `path` is UTF-8.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_read_airframe(path: *const c_char, airframe: *mut Airframe) -> Status {
    cross(|| {
        // SAFETY: as the header asks of its pointers.
        let (path, airframe) =
            unsafe { (pointers::text(path, "the path")?, Place::new(airframe, "the airframe's handle")?) };
        airframe.put(Airframe::open(read_airframe(path).map_err(file)?));
        Ok(())
    })
}

/// Reads an airframe from the content of a file, `length` bytes. `name` stands for it in messages, and names an airframe that has no name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_parse_airframe(
    content: *const u8,
    length: usize,
    name: *const c_char,
    airframe: *mut Airframe,
) -> Status {
    cross(|| {
        // SAFETY: as the header asks of its pointers.
        let (content, name, airframe) = unsafe {
            (
                pointers::bytes(content, length, "the content")?,
                pointers::text(name, "the name")?,
                Place::new(airframe, "the airframe's handle")?,
            )
        };
        let text = pointers::utf8(content, "the content")?;
        airframe.put(Airframe::open(parse_airframe(text, name).map_err(file)?));
        Ok(())
    })
}

/// Number `index` of what was read otherwise than it stands in its file; as `photinus_camera_note`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn photinus_airframe_note(
    airframe: Airframe,
    index: usize,
    note: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> Status {
    cross(|| {
        // SAFETY: as the header asks of its pointers.
        let places = unsafe { Places::new(note, capacity, length, "the note")? };
        put_note(&airframe.get()?.notes, index, places)
    })
}

/// Closes an airframe. Locators that were made with it go on.
#[unsafe(no_mangle)]
pub extern "C" fn photinus_close_airframe(airframe: Airframe) -> Status {
    cross(|| airframe.close())
}
