//! Books of words that LEDs blink: read, checked, designed.

use std::path::PathBuf;

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use photinus::identity::design::{Effort, Requirements, design};
use photinus::identity::{self, Properties};
use photinus_io::codes::{PRESETS, codes_text, parse_codes, read_codes};
use pyo3::prelude::*;

use crate::error::{self, CodeError, SettingError, detached};

/// A book of words that LEDs blink: a word per vehicle or marker, one bit per camera frame.
#[pyclass(frozen, eq, module = "photinus")]
#[derive(PartialEq)]
pub(crate) struct CodeBook {
    book: identity::CodeBook,
    at_most: Option<usize>,
}

#[pymethods]
impl CodeBook {
    /// Reads a book: a word per line, bits of 0 and 1 with commas between. Raises FileError with the line that is no word.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        detached(py, || Ok(Self { book: read_codes(&path).map_err(error::file)?, at_most: None }))
    }

    /// A book that comes with Photinus, such as "l12-d3-r3": bits of a word, distance, longest run. Raises SettingError.
    #[staticmethod]
    fn preset(name: &str) -> PyResult<Self> {
        let Some(preset) = PRESETS.iter().find(|preset| preset.name == name) else {
            let names: Vec<&str> = PRESETS.iter().map(|preset| preset.name).collect();
            return Err(SettingError::new_err(format!(
                "{name}: no book of this name; there are {}",
                names.join(", ")
            )));
        };
        Ok(Self { book: parse_codes(preset.text, preset.name).map_err(error::file)?, at_most: None })
    }

    /// Searches for a book with as many words as can be found, as `photinus codes design` does; the same options give the same book.
    ///
    /// `length`: bits of a word; `distance`: the fewest bits in which two words differ, at any shift; `longest_run`: the most equal bits
    /// that follow each other; `self_distance`: the fewest bits in which a word differs from its own shifts; `duty`: the least and
    /// the largest share of bits that are on; `effort`: how many times longer to search than usual; `seed`: where the search begins.
    /// Raises SettingError, and CodeError when no book can be searched for.
    #[staticmethod]
    #[pyo3(signature = (length, distance, *, longest_run = None, self_distance = 2, duty = None, effort = 1, seed = None))]
    #[allow(clippy::too_many_arguments)] // the options of the program, by name
    fn design(
        py: Python<'_>,
        length: usize,
        distance: u32,
        longest_run: Option<usize>,
        self_distance: u32,
        duty: Option<(f64, f64)>,
        effort: u32,
        seed: Option<u64>,
    ) -> PyResult<Self> {
        let (from, to) = duty.unwrap_or((0.0, 1.0));
        if !(0.0 <= from && from <= to && to <= 1.0) {
            return Err(SettingError::new_err(format!(
                "duty is ({from}, {to}): give two shares from 0 to 1 in order"
            )));
        }
        if !(1..=100_000).contains(&effort) {
            return Err(SettingError::new_err(format!("effort is {effort}, it must be 1 to 100000")));
        }
        let refuse = |unmet: photinus::identity::design::Unmet| CodeError::new_err(unmet.to_string());
        let mut asked = Requirements::new(length, distance)
            .map_err(refuse)?
            .with_self_distance(self_distance)
            .with_duty(from..=to);
        if let Some(longest) = longest_run {
            asked = asked.with_longest_run(longest);
        }
        let times = u64::from(effort);
        let mut effort = Effort::default();
        effort.seed = seed.unwrap_or(effort.seed);
        effort.work *= times;
        effort.branches *= times;
        let designed = detached(py, || design(&asked, effort).map_err(refuse))?;
        Ok(Self { book: designed.book, at_most: Some(designed.at_most) })
    }

    /// The words, (N, length) of bool: whether each bit is on.
    #[getter]
    fn words<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        let bits: Vec<bool> = self.book.words().iter().flat_map(identity::Word::bits).collect();
        PyArray1::from_vec(py, bits).reshape([self.book.words().len(), self.book.length()])
    }

    /// No book of its requirements has more words; None where it was not designed here.
    #[getter]
    fn at_most(&self) -> Option<usize> {
        self.at_most
    }

    /// What the book truly has, whatever its name says.
    fn check(&self) -> CodeProperties {
        CodeProperties::from(Properties::of(&self.book))
    }

    /// The text of its file.
    fn to_text(&self) -> String {
        codes_text(&self.book)
    }

    fn __len__(&self) -> usize {
        self.book.words().len()
    }

    fn __repr__(&self) -> String {
        format!("CodeBook({} words of {} bits)", self.book.words().len(), self.book.length())
    }
}

/// What tells the words of a book apart. Distances are counted at any shift.
#[pyclass(frozen, get_all, module = "photinus")]
pub(crate) struct CodeProperties {
    /// The fewest bits in which two words differ; None for a single word.
    distance: Option<u32>,
    /// The two words that differ the least.
    nearest: Option<(usize, usize)>,
    /// The fewest bits in which a word differs from its own shifts; None for words of one bit.
    self_distance: Option<u32>,
    /// The fewest bits in which a word differs from steady light.
    steady_distance: u32,
    /// The longest run of bits that are off.
    longest_dark: usize,
    /// The longest run of bits that are on.
    longest_lit: usize,
    /// The least and the largest share of bits that are on.
    duty: (f64, f64),
    /// So many bits without error, begun anywhere, belong to one word only; None when no number does.
    unique_after: Option<usize>,
    /// So many bits without error belong to one word and one place in it only; None when no number does.
    in_phase_after: Option<usize>,
}

impl From<Properties> for CodeProperties {
    fn from(has: Properties) -> Self {
        Self {
            distance: has.distance.map(|(distance, _)| distance),
            nearest: has.distance.map(|(_, words)| words.into()),
            self_distance: has.self_distance.map(|(distance, _)| distance),
            steady_distance: has.steady_distance,
            longest_dark: has.longest_dark,
            longest_lit: has.longest_lit,
            duty: has.duty.into(),
            unique_after: has.unique_after,
            in_phase_after: has.in_phase_after,
        }
    }
}
