//! Records of results and truth as light objects: enters what the method found, leaves properties by the names of
//! docs/file-formats.md.
//!
//! An object is an index into its record, which all of them share: nothing is converted before it is asked for.

mod frame;
mod neighbour;
mod spot;
mod track;
mod truth;

use numpy::{Element, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

pub(crate) use frame::{Record, empty, read_results};
pub(crate) use neighbour::{Distance, Misfit, Mode, Neighbour, RunnerUp};
pub(crate) use spot::{Rejected, Spot};
pub(crate) use track::{Identity, Track};
pub(crate) use truth::{Truth, TruthLed, TruthNeighbour, read_truth};

/// Rows of numbers as an array.
pub(crate) fn rows<const N: usize>(
    py: Python<'_>,
    rows: impl IntoIterator<Item = [f64; N]>,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let numbers: Vec<f64> = rows.into_iter().flatten().collect();
    let count = numbers.len() / N;
    PyArray1::from_vec(py, numbers).reshape([count, N])
}

/// A vector as an array.
fn vector<T: Element + Copy, const N: usize>(py: Python<'_>, vector: [T; N]) -> Bound<'_, PyArray1<T>> {
    PyArray1::from_slice(py, &vector)
}

/// A matrix as an array, row by row.
fn matrix<const N: usize>(py: Python<'_>, matrix: [[f64; N]; N]) -> PyResult<Bound<'_, PyArray2<f64>>> {
    PyArray1::from_slice(py, matrix.as_flattened()).reshape([N, N])
}
