//! The colours of a picture, few enough for a byte a pixel: a third of the time and of the file that full colour takes.
//!
//! The frame keeps 128 levels of grey, which is more than a screen tells apart; marks keep their colours, and their edges the
//! nearest of a few mixtures.

use tiny_skia::{ColorU8 as Colour, PremultipliedColorU8};

use super::colours;

/// Levels of grey: every second one.
const GREYS: u16 = 128;
/// Pixels that are looked at together: most are grey side by side, and those need no table.
const SIDE_BY_SIDE: usize = 32;
/// Bits of each part of a colour by which the nearest one is looked up.
const BITS: u32 = 5;

/// A palette, and the way from any colour to the nearest of it.
pub(super) struct Palette {
    /// Red, green and blue of each entry.
    entries: Vec<[u8; 3]>,
    /// The nearest entry, by the first bits of red, green and blue.
    nearest: Vec<u8>,
}

impl Palette {
    /// The colours of overlays.
    pub(super) fn new() -> Self {
        let mut entries: Vec<[u8; 3]> =
            (0..GREYS).map(|grey| [(grey * 255 / (GREYS - 1)) as u8; 3]).collect();
        let pure: Vec<Colour> =
            [colours::SPOT, colours::REJECTED].into_iter().chain((0..4).map(colours::neighbour)).collect();
        let pale = (0..4).map(|number| colours::pale(colours::neighbour(number), 0.45));
        for colour in pure.iter().copied().chain(pale).chain([colours::FIELD]) {
            let colour = [colour.red(), colour.green(), colour.blue()];
            entries.push(colour);
            for share in [1, 2, 3] {
                entries.push(colour.map(|part| mixed(part, 0, share)));
                entries.push(colour.map(|part| mixed(part, u8::MAX, share)));
            }
        }
        entries.truncate(256);
        let nearest = (0..1_usize << (3 * BITS)).map(|place| nearest(&entries, colour_at(place))).collect();
        Self { entries, nearest }
    }

    /// Red, green and blue of each entry, one after the other.
    pub(super) fn bytes(&self) -> Vec<u8> {
        self.entries.concat()
    }

    /// The entries of pixels, into a buffer that is used again.
    pub(super) fn entries_of(&self, pixels: &[PremultipliedColorU8], entries: &mut Vec<u8>) {
        entries.resize(pixels.len(), 0);
        for (pixels, entries) in pixels.chunks(SIDE_BY_SIDE).zip(entries.chunks_mut(SIDE_BY_SIDE)) {
            let coloured = pixels
                .iter()
                .fold(0, |sum, pixel| sum | (pixel.red() ^ pixel.green()) | (pixel.green() ^ pixel.blue()));
            let shown = pixels.iter().zip(entries);
            match coloured {
                0 => shown.for_each(|(pixel, entry)| *entry = grey(pixel.red())),
                _ => shown.for_each(|(&pixel, entry)| *entry = self.entry_of(pixel)),
            }
        }
    }

    fn entry_of(&self, pixel: PremultipliedColorU8) -> u8 {
        let [red, green, blue] = [pixel.red(), pixel.green(), pixel.blue()];
        if red == green && green == blue { grey(red) } else { self.nearest[place_of([red, green, blue])] }
    }
}

/// The entry of a level of grey.
fn grey(level: u8) -> u8 {
    level >> 1
}

/// Three quarters, half or a quarter of the way from one level to another.
fn mixed(from: u8, to: u8, share: u16) -> u8 {
    ((u16::from(from) * (4 - share) + u16::from(to) * share) / 4) as u8
}

fn place_of(colour: [u8; 3]) -> usize {
    colour.iter().fold(0, |place, part| place << BITS | usize::from(part >> (8 - BITS)))
}

/// The middle of the colours that have a place in common.
fn colour_at(place: usize) -> [u8; 3] {
    [2 * BITS, BITS, 0]
        .map(|shift| ((place >> shift & ((1 << BITS) - 1)) << (8 - BITS)) as u8 + (1 << (7 - BITS)))
}

/// The entry whose squared difference is least; the first of several.
fn nearest(entries: &[[u8; 3]], colour: [u8; 3]) -> u8 {
    let off = |entry: &[u8; 3]| -> u32 {
        entry.iter().zip(colour).map(|(&a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
    };
    let best = (0..entries.len()).min_by_key(|&number| off(&entries[number]));
    best.map_or(0, |number| number as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(palette: &Palette, colour: [u8; 3]) -> [u8; 3] {
        let pixel = PremultipliedColorU8::from_rgba(colour[0], colour[1], colour[2], u8::MAX).unwrap();
        let mut entries = Vec::new();
        palette.entries_of(&[pixel], &mut entries);
        palette.entries[usize::from(entries[0])]
    }

    #[test]
    fn greys_keep_half_their_levels_and_marks_their_colours() {
        let palette = Palette::new();
        assert!(palette.entries.len() <= 256);
        for level in 0..=255 {
            let grey = shown(&palette, [level; 3]);
            assert!(grey[0].abs_diff(level) <= 1 && grey == [grey[0]; 3], "{level}: {grey:?}");
        }
        let marks = [colours::SPOT, colours::REJECTED].into_iter().chain((0..4).map(colours::neighbour));
        for mark in marks {
            let mark = [mark.red(), mark.green(), mark.blue()];
            let off = shown(&palette, mark).iter().zip(mark).map(|(a, b)| a.abs_diff(b)).max();
            assert!(off <= Some(8), "{mark:?} is shown as {:?}", shown(&palette, mark));
        }
    }
}
