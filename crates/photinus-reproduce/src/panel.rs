//! What a figure shows: series of numbers, and what they mean. How they are drawn is the caller's affair.

use crate::{Figure, Row};

/// A figure's data and summary.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Which figure.
    pub figure: Figure,
    /// What it shows, from the top.
    pub panels: Vec<Panel>,
    /// Its lines of the summary.
    pub rows: Vec<Row>,
}

/// Axes with series on them.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// What it shows, in a few words.
    pub title: &'static str,
    /// What is along x, with its unit.
    pub x_label: &'static str,
    /// What is along y, with its unit.
    pub y_label: &'static str,
    /// Ends of the x axis, where they do not follow from the data.
    pub x_range: Option<[f64; 2]>,
    /// Ends of the y axis, where they do not follow from the data.
    pub y_range: Option<[f64; 2]>,
    /// Whether y is on a logarithmic axis.
    pub is_log_y: bool,
    /// What is shown.
    pub series: Vec<Series>,
    /// Lines across.
    pub marks: Vec<Mark>,
}

/// Numbers of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// What they are.
    pub label: String,
    /// What stands for them.
    pub kind: Kind,
    /// What they mean.
    pub role: Role,
    /// (x, y).
    pub points: Vec<(f64, f64)>,
}

/// How numbers hang together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Each stands alone.
    Points,
    /// In order of x.
    Line,
    /// In order of x, for comparison.
    Dashed,
}

/// What numbers mean, for whoever chooses colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// What is so.
    Truth,
    /// Photinus' own.
    Own,
    /// The paper's, where there is one kind of it, and l_A.
    Perpendicular,
    /// l_B.
    Inline,
    /// A bound or margin.
    Bound,
    /// What somebody else printed, for comparison.
    Printed,
    /// One of a family, from 0.
    Member(usize),
}

/// A line across a panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// What it marks; may be empty.
    pub label: String,
    /// Where.
    pub at: f64,
    /// Whether it stands upright, at an x; else it lies at a y.
    pub is_upright: bool,
    /// The member of a family that it belongs to, as [`Role::Member`].
    pub member: Option<usize>,
}

impl Panel {
    /// An empty panel.
    pub fn new(title: &'static str, x_label: &'static str, y_label: &'static str) -> Self {
        Self {
            title,
            x_label,
            y_label,
            x_range: None,
            y_range: None,
            is_log_y: false,
            series: Vec::new(),
            marks: Vec::new(),
        }
    }

    /// The same with ends of its axes.
    pub(crate) fn with_ranges(mut self, x_range: [f64; 2], y_range: [f64; 2]) -> Self {
        (self.x_range, self.y_range) = (Some(x_range), Some(y_range));
        self
    }

    /// The same with one more series.
    pub(crate) fn with(
        mut self,
        label: impl Into<String>,
        kind: Kind,
        role: Role,
        points: Vec<(f64, f64)>,
    ) -> Self {
        self.series.push(Series { label: label.into(), kind, role, points });
        self
    }

    /// The same with an upright line.
    pub(crate) fn with_upright(mut self, label: impl Into<String>, at: f64, member: Option<usize>) -> Self {
        self.marks.push(Mark { label: label.into(), at, is_upright: true, member });
        self
    }

    /// The same with a level line.
    pub(crate) fn with_level(mut self, label: impl Into<String>, at: f64) -> Self {
        self.marks.push(Mark { label: label.into(), at, is_upright: false, member: None });
        self
    }
}
