//! Samples of a point spread as text: millionths of the light, a line for every row, only the square that holds what is not 0.
//!
//! Rounding costs half a millionth of the light in a pixel; the sharpest lens whose error is known to a thousandth of a pixel's
//! light would notice it in pixels with less than a thousandth.

use std::fmt::Write;

use photinus::optics::PointSpread;

/// Parts of the light.
const PARTS: f64 = 1e6;
const SIDE: usize = PointSpread::SIDE;
const MIDDLE: usize = SIDE / 2;

/// A share as the text keeps it.
#[cfg(test)]
pub(super) fn rounded(share: f64) -> f64 {
    parts(share) as f64 / PARTS
}

fn parts(share: f64) -> i64 {
    (share * PARTS).round() as i64
}

/// The samples as text.
pub(super) fn text(spread: &PointSpread) -> String {
    let rows: Vec<Vec<i64>> = spread
        .samples()
        .chunks_exact(SIDE)
        .map(|row| row.iter().map(|share| parts(*share)).collect())
        .collect();
    let half = (0..=MIDDLE).rev().find(|&half| is_lit(&rows, half)).unwrap_or(0);
    let kept = MIDDLE - half..=MIDDLE + half;
    let mut text = String::new();
    for row in &rows[kept.clone()] {
        for (index, parts) in row[kept.clone()].iter().enumerate() {
            let _ = write!(text, "{}{parts}", if index == 0 { "" } else { " " });
        }
        text.push('\n');
    }
    text
}

/// Whether any sample so far from the middle along a row or a column is not 0.
fn is_lit(rows: &[Vec<i64>], half: usize) -> bool {
    let (first, last) = (MIDDLE - half, MIDDLE + half);
    let lit = |row: usize, column: usize| rows[row][column] != 0;
    (first..=last).any(|k| lit(first, k) || lit(last, k) || lit(k, first) || lit(k, last))
}

/// The spread of a text; samples outside of its square are 0.
pub(super) fn read(text: &str) -> Result<PointSpread, String> {
    let rows: Vec<Vec<f64>> =
        text.lines().filter(|line| !line.trim().is_empty()).map(row).collect::<Result<_, _>>()?;
    let side = rows.len();
    if side.is_multiple_of(2) || side > SIDE || rows.iter().any(|row| row.len() != side) {
        return Err(format!(
            "{side} rows, of {} samples: it must be a square of an odd number, at most {SIDE}",
            rows.first().map_or(0, Vec::len)
        ));
    }
    let mut samples = vec![0.0; SIDE * SIDE];
    let first = MIDDLE - side / 2;
    for (index, row) in rows.iter().enumerate() {
        samples[(first + index) * SIDE + first..][..side].copy_from_slice(row);
    }
    PointSpread::new(samples).map_err(|error| error.to_string())
}

fn row(line: &str) -> Result<Vec<f64>, String> {
    let number =
        |word: &str| word.parse::<i32>().map_err(|_| format!("'{word}' is no whole number of millionths"));
    line.split_whitespace().map(|word| Ok(f64::from(number(word)?) / PARTS)).collect()
}

#[cfg(test)]
mod tests {
    use photinus::optics::Gaussian;

    use super::*;

    #[test]
    fn rounding_is_far_below_what_a_calibration_knows() {
        for sigma_px in [0.3, 1.5] {
            let parts = [Gaussian { share: 0.9, sigma_px }, Gaussian { share: 0.1, sigma_px: 3.0 }];
            let spread = PointSpread::gaussians(&parts).unwrap();
            let back = read(&text(&spread)).unwrap();
            for (a, b) in spread.samples().iter().zip(back.samples()) {
                // error of shape known to a thousandth, of pixels that are brighter than noise
                assert!((a - b).abs() <= 0.5e-6 + 1e-12 && (a - b).abs() < 1e-3 * a.max(1e-3));
            }
        }
    }

    #[test]
    fn what_is_no_square_of_whole_numbers_is_refused() {
        assert!(read("1 2 3\n4 5 6\n").unwrap_err().contains("2 rows"));
        assert!(read("1 2\n3 4\n5 6\n").unwrap_err().contains("of 2 samples"));
        assert!(read("1.5\n").unwrap_err().contains("'1.5'"));
        assert!(read("0\n").unwrap_err().contains("light"));
        assert!(read("").is_err());
        assert!(read("1000000\n").is_ok());
    }
}
