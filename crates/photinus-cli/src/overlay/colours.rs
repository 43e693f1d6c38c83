//! Colours that stay apart for colour-blind eyes (Okabe and Ito 2008), dark and light ground alike; where colour
//! carries meaning, shape carries it too.

use tiny_skia::ColorU8 as Colour;

/// Around the panels.
pub(super) const PAPER: Colour = opaque(0xFF, 0xFF, 0xFF);
/// Words on paper.
pub(super) const INK: Colour = opaque(0x22, 0x22, 0x22);
/// Words on paper that matter less, and range rings.
pub(super) const FAINT_INK: Colour = opaque(0x77, 0x7C, 0x80);
/// Range rings.
pub(super) const RING: Colour = opaque(0xBF, 0xC4, 0xC9);
/// What the camera sees, from above.
pub(super) const FIELD: Colour = opaque(0xEE, 0xF3, 0xF7);
/// Behind lines and words on the frame.
pub(super) const SHADE: Colour = opaque(0x00, 0x00, 0x00);
/// A spot of no neighbour.
pub(super) const SPOT: Colour = opaque(0xF0, 0xE4, 0x42);
/// What was rejected: vermillion.
pub(super) const REJECTED: Colour = opaque(0xE8, 0x6A, 0x17);

/// Sky blue, orange, bluish green, reddish purple; blue and green a shade off the published ones, for both grounds.
const NEIGHBOURS: [Colour; 4] =
    [opaque(0x3F, 0xA7, 0xE0), opaque(0xE6, 0x9F, 0x00), opaque(0x19, 0xB4, 0x88), opaque(0xCC, 0x79, 0xA7)];

/// The colour of neighbour `number`: after the last one the first follows again, told apart by their numbers.
pub(super) fn neighbour(number: usize) -> Colour {
    NEIGHBOURS[number % NEIGHBOURS.len()]
}

/// The same colour, mixed with white so that `share` of it, 0 to 1, remains.
pub(super) fn pale(colour: Colour, share: f32) -> Colour {
    let mix = |part: u8| (255.0 - share * (255.0 - f32::from(part))) as u8;
    opaque(mix(colour.red()), mix(colour.green()), mix(colour.blue()))
}

const fn opaque(red: u8, green: u8, blue: u8) -> Colour {
    Colour::from_rgba(red, green, blue, u8::MAX)
}
