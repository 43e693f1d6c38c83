//! When the rows of a frame are exposed.

/// When a frame is exposed: its first row from `start_s` on for `length_s`, its last row `rows_s` later.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposure {
    /// Start of the first row, s.
    pub start_s: f64,
    /// How long each row is exposed, s.
    pub length_s: f64,
    /// How much later the last row is exposed than the first, s: 0 with a global shutter.
    pub rows_s: f64,
}

impl Exposure {
    /// From the start of the first row to the end of the last one, s.
    pub fn span_s(&self) -> f64 {
        self.length_s + self.rows_s
    }

    /// Start, middle and end of all rows together, s: the instants of a [`super::Moving`].
    pub fn instants_s(&self) -> [f64; 3] {
        [self.start_s, self.start_s + 0.5 * self.span_s(), self.start_s + self.span_s()]
    }

    /// The middle of the first row's exposure, s: the time of the frame.
    pub fn middle_s(&self) -> f64 {
        self.start_s + 0.5 * self.length_s
    }

    /// Which share of the span has passed, `after_s` seconds after the start.
    pub(crate) fn share(&self, after_s: f64) -> f64 {
        after_s / self.span_s()
    }
}
