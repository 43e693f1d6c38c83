//! Spots of one photo -> which LED of the grid each of them is.
//!
//! The lattice is followed from spot to spot, so that neither the lens nor the pose need be known: growth (`growth.rs`) gives
//! spots whole-numbered places, `window.rs` finds the grid among them. A spot that is no LED, an LED that is dark or hidden and
//! any turn of the grid are ordinary. What could be read in two ways is refused: a wrong label costs more than a photo.
//!
//! Labels are right up to the grid's own symmetry: half a turn, a quarter for a square one. The order is that of a
//! board seen from the side that shines, never mirrored.

mod growth;
mod neighbours;
mod smooth;
mod window;

use nalgebra::{Vector2, Vector3};

use crate::adjust::Observation;

/// A flat grid of LEDs: columns along the board's x, rows along its y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    columns: usize,
    rows: usize,
    pitch_m: f64,
}

/// Numbers that make no grid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GridError {
    /// Too few or too many LEDs along a side.
    #[error("a grid of {columns}x{rows}: each side must have 3 to 50 LEDs")]
    Size {
        /// LEDs along a row.
        columns: usize,
        /// LEDs along a column.
        rows: usize,
    },
    /// A pitch that is no length.
    #[error(
        "a pitch of {pitch_m} m: it must be the distance between neighbouring LEDs in metres, above 0 and at most 10"
    )]
    Pitch {
        /// The pitch given, m.
        pitch_m: f64,
    },
}

impl Grid {
    /// A grid of `columns` x `rows` LEDs, `pitch_m` apart.
    ///
    /// # Errors
    /// [`GridError`] when a side has fewer than 3 or more than 50 LEDs, or the pitch is not a length up to 10 m.
    pub fn new(columns: usize, rows: usize, pitch_m: f64) -> Result<Self, GridError> {
        if !(3..=50).contains(&columns) || !(3..=50).contains(&rows) {
            return Err(GridError::Size { columns, rows });
        }
        if !(pitch_m > 0.0 && pitch_m <= 10.0) {
            return Err(GridError::Pitch { pitch_m });
        }
        Ok(Self { columns, rows, pitch_m })
    }

    /// LEDs along a row.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// LEDs along a column.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Distance between neighbours, m.
    pub fn pitch_m(&self) -> f64 {
        self.pitch_m
    }

    /// LEDs in all.
    pub fn leds(&self) -> usize {
        self.columns * self.rows
    }

    /// Where the LEDs belong: about the middle of the board, x along its columns, y along its rows, z = 0, m.
    pub fn nominal_m(&self) -> Vec<Vector3<f64>> {
        let middle = |count: usize| 0.5 * (count as f64 - 1.0);
        let place = |led: usize| {
            let (column, row) = (led % self.columns, led / self.columns);
            Vector3::new(column as f64 - middle(self.columns), row as f64 - middle(self.rows), 0.0)
                * self.pitch_m
        };
        (0..self.leds()).map(place).collect()
    }

    /// How many ways there are to lay the grid onto itself by turning it.
    pub fn turns(&self) -> usize {
        if self.columns == self.rows { 4 } else { 2 }
    }

    /// Which LED takes the place of `led` when the grid is laid onto itself the `turn`-th way; 0 leaves it.
    pub fn turned(&self, led: usize, turn: usize) -> usize {
        let (mut column, mut row) = (led % self.columns, led / self.columns);
        let quarters = if self.turns() == 4 { turn % 4 } else { 2 * (turn % 2) };
        for _ in 0..quarters / 2 {
            (column, row) = (self.columns - 1 - column, self.rows - 1 - row);
        }
        if quarters % 2 == 1 {
            (column, row) = (self.rows - 1 - row, column);
        }
        row * self.columns + column
    }
}

/// Why a photo's spots are not taken for the grid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OrderError {
    /// Not enough spots.
    #[error("{found} spots, at least {needed} of the grid's {leds} LEDs are needed")]
    TooFew {
        /// Spots in the photo.
        found: usize,
        /// The least that is taken.
        needed: usize,
        /// LEDs of the grid.
        leds: usize,
    },
    /// The spots follow no lattice, or one of too few.
    #[error("no grid among the {found} spots: the best lattice has {lattice}, at least {needed} are needed")]
    NoLattice {
        /// Spots in the photo.
        found: usize,
        /// Spots of the largest lattice.
        lattice: usize,
        /// The least that is taken.
        needed: usize,
    },
    /// A lattice of which the grid covers too little.
    #[error(
        "{lattice} spots form one lattice and the grid covers only {covered} of them: another grid, or lights in line with it?"
    )]
    Outside {
        /// Spots of the lattice.
        lattice: usize,
        /// Those that the grid can take.
        covered: usize,
    },
    /// A label that came with the spots and is not of the grid, or comes twice.
    #[error("the label column {column}, row {row} is not of the grid, or comes twice")]
    Label {
        /// Column given.
        column: usize,
        /// Row given.
        row: usize,
    },
    /// Labels that came with the spots and run the wrong way round.
    #[error("the labels are mirrored: their columns and rows turn the other way than those of the photo")]
    Mirrored,
    /// A lattice of another size.
    #[error("the spots form a full lattice of {columns}x{rows}, not the grid that was said")]
    OtherSize {
        /// Spots along its longer side.
        columns: usize,
        /// Spots along its shorter side.
        rows: usize,
    },
    /// A side of the grid that cannot be told: its outermost LEDs do not show.
    #[error("the grid can be read in {ways} ways: a whole row or column of its LEDs does not show")]
    Ambiguous {
        /// How many.
        ways: usize,
    },
    /// Labels that bend more than any lens bends a grid.
    #[error(
        "the order of the spots is not smooth (one is {off_spacings:.2} of a spacing off): spots that are no LEDs?"
    )]
    NotSmooth {
        /// Largest distance from a smooth grid, in spacings.
        off_spacings: f64,
    },
}

/// An ordered photo.
#[derive(Clone, Debug, PartialEq)]
pub struct Ordered {
    /// The LEDs, by their number.
    pub observations: Vec<Observation>,
    /// Spots that are no LED of the grid.
    pub foreign: usize,
}

/// Finds the grid among the spots of a photo.
///
/// # Errors
/// [`OrderError`] when the spots are too few, follow no lattice, follow one of another size, or can be read in several ways.
pub fn order(spots: &[Vector2<f64>], grid: &Grid) -> Result<Ordered, OrderError> {
    let needed = least_leds(grid);
    let spots: Vec<_> = spots.iter().copied().filter(|spot| spot.iter().all(|x| x.abs() < 1e6)).collect();
    if spots.len() < needed {
        return Err(OrderError::TooFew { found: spots.len(), needed, leds: grid.leds() });
    }
    let readings: Vec<_> = growth::largest_lattices(&spots, grid)
        .iter()
        .map(|lattice| reading(&spots, lattice, grid, needed))
        .collect();
    let observations = agreed(readings, grid)?;
    Ok(Ordered { foreign: spots.len() - observations.len(), observations })
}

/// The grid as one lattice shows it.
fn reading(
    spots: &[Vector2<f64>],
    lattice: &growth::Lattice,
    grid: &Grid,
    needed: usize,
) -> Result<Vec<Observation>, OrderError> {
    let too_small = |lattice| OrderError::NoLattice { found: spots.len(), lattice, needed };
    if lattice.len() < needed {
        return Err(too_small(lattice.len()));
    }
    let observations = window::place(spots, lattice, grid, needed)?;
    let observations = smooth::without_strangers(observations, spots, grid)?;
    if observations.len() < needed { Err(too_small(observations.len())) } else { Ok(observations) }
}

/// The reading that holds most LEDs, the smoothest of these.
fn agreed(
    readings: Vec<Result<Vec<Observation>, OrderError>>,
    grid: &Grid,
) -> Result<Vec<Observation>, OrderError> {
    let (mut best, mut why) = (None, None);
    for reading in readings {
        match reading {
            Ok(observations) => {
                let rough = smooth::mean_off_spacings(&observations, grid);
                let is_better = best.as_ref().is_none_or(|(most, least): &(Vec<Observation>, f64)| {
                    (observations.len(), *least) > (most.len(), rough)
                });
                if is_better {
                    best = Some((observations, rough));
                }
            }
            Err(error) => why = why.or(Some(error)),
        }
    }
    let nothing = OrderError::NoLattice { found: 0, lattice: 0, needed: least_leds(grid) };
    best.map(|(observations, _)| observations).ok_or(why.unwrap_or(nothing))
}

/// The least LEDs of a grid that a photo must show.
pub fn least_leds(grid: &Grid) -> usize {
    (grid.leds() * 7).div_ceil(10).max(8)
}

#[cfg(test)]
mod tests;
