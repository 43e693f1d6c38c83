//! How large a pixel of the frame is drawn: small frames grow, giant and narrow ones shrink, so that a picture's size has a
//! bound whatever the frame's.

/// The longer side that a frame is drawn at, px, as near as whole pixels come to it.
const WANTED_PX: u32 = 1450;
/// The longest side that a frame is drawn with, px: longer ones are drawn smaller.
pub(super) const LONGEST_PX: u32 = 4096;

/// Pixels of the picture for one of the frame, or the other way round; never zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Zoom {
    /// A pixel of the frame is this many pixels of the picture wide and high.
    In(u32),
    /// A pixel of the picture shows the brightest of this many columns and rows of the frame.
    Out(u32),
}

impl Zoom {
    /// For a frame of this many columns and rows.
    pub(super) fn of(columns: u32, rows: u32) -> Self {
        let longer = columns.max(rows).max(1);
        match longer.div_ceil(LONGEST_PX) {
            1 => Self::In(((WANTED_PX + longer / 2) / longer).max(1)),
            shrink => Self::Out(shrink),
        }
    }

    /// How long this many pixels of the frame are in the picture, px.
    pub(super) fn drawn_px(self, px: u32) -> u32 {
        match self {
            Self::In(times) => px * times,
            Self::Out(times) => px.div_ceil(times),
        }
    }

    /// Pixels of the picture for one of the frame.
    pub(super) fn factor(self) -> f64 {
        match self {
            Self::In(times) => f64::from(times),
            Self::Out(times) => 1.0 / f64::from(times),
        }
    }

    /// Which columns (or rows) of a frame `length` long the picture's pixel `at` shows.
    pub(super) fn shown(self, at: usize, length: usize) -> std::ops::Range<usize> {
        let (begin, end) = match self {
            Self::In(times) => (at / times as usize, at / times as usize + 1),
            Self::Out(times) => (at * times as usize, (at + 1) * times as usize),
        };
        begin.min(length)..end.min(length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_of_the_frame_is_in_the_picture_and_the_picture_ends() {
        for length in [1, 2, 64, 480, 752, 1449, 2900, 4096, 4097, 8193, 32_767] {
            let zoom = Zoom::of(length, 1);
            assert_eq!(zoom, Zoom::of(1, length));
            let drawn = zoom.drawn_px(length);
            assert!(drawn <= LONGEST_PX && (length > 4096 || drawn >= length), "{length}: {drawn}");
            let mut last = 0;
            for at in 0..drawn as usize {
                let shown = zoom.shown(at, length as usize);
                assert!(!shown.is_empty() && shown.start <= last && shown.end >= last, "{length}: {shown:?}");
                last = shown.end;
            }
            assert_eq!(last, length as usize);
            assert!((f64::from(length) * zoom.factor() - f64::from(drawn)).abs() < 1.0);
        }
        assert_eq!([Zoom::of(752, 480), Zoom::of(32_767, 1)], [Zoom::In(2), Zoom::Out(8)]);
    }
}
