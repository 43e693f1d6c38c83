//! Corners or spots that another tool found in photos of a grid, as a table.
//!
//! ```text
//! image,u,v               or  image,row,col ; any order of columns, others are refused
//! a.png,101.25,77.5
//! ```
//!
//! Optional columns `grid_i,grid_j` say which point of the grid it is: column and row, from 0.

use std::path::Path;

use crate::{Error, Place, Result, whole};

/// The points of one photo.
#[derive(Clone, Debug, PartialEq)]
pub struct PhotoCorners {
    /// The photo, as the table names it.
    pub image: String,
    /// Its points, in the order of the table.
    pub corners: Vec<Corner>,
}

/// A point in a photo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Column, px.
    pub u: f64,
    /// Row, px.
    pub v: f64,
    /// Column and row of the grid, where the table says it.
    pub place: Option<[usize; 2]>,
}

/// Where each value stands in a line.
struct Columns {
    image: usize,
    u: usize,
    v: usize,
    place: Option<[usize; 2]>,
    count: usize,
}

const ADVICE: &str = "the first line must be `image,u,v` or `image,row,col`, optionally with `grid_i,grid_j`";

/// Reads a table of corners.
///
/// # Errors
/// [`Error`] with the line when the file cannot be read, has other columns, or a value is no number.
pub fn read_corners(path: impl AsRef<Path>) -> Result<Vec<PhotoCorners>> {
    let path = path.as_ref();
    let bytes = whole::read_bytes(path)?;
    let text = std::str::from_utf8(&bytes)
        .map_err(|_| Error::format(path, "it is no text").advise("save it as a CSV in UTF-8"))?;
    parse_corners(text, path)
}

/// Reads the text of a table of corners; `path` is for messages. Photos come in the order in which they appear.
///
/// # Errors
/// As [`read_corners`].
pub fn parse_corners(text: &str, path: impl AsRef<Path>) -> Result<Vec<PhotoCorners>> {
    let path = path.as_ref();
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text.lines().zip(1..).filter(|(line, _)| !line.trim().is_empty());
    let header = lines.next().map_or("", |(line, _)| line);
    let columns = Columns::of(header).ok_or_else(|| {
        Error::format(path, format!("the columns are `{}`", header.trim())).at(Place::Line(1)).advise(ADVICE)
    })?;
    let mut photos: Vec<PhotoCorners> = Vec::new();
    for (line, number) in lines {
        let (image, corner) = columns.corner(line).map_err(|reason| {
            let advice = "correct it there, or write the table again";
            Error::format(path, reason).at(Place::Line(number)).advise(advice)
        })?;
        match photos.iter_mut().find(|photo| photo.image == image) {
            Some(photo) => photo.corners.push(corner),
            None => photos.push(PhotoCorners { image: image.to_owned(), corners: vec![corner] }),
        }
    }
    if photos.is_empty() {
        return Err(Error::format(path, "it lists no point").advise("add a line per point of the grid"));
    }
    Ok(photos)
}

impl Columns {
    fn of(header: &str) -> Option<Self> {
        let names: Vec<&str> = header.split(',').map(str::trim).collect();
        let at = |name: &str| names.iter().position(|other| *other == name);
        let (u, v) = at("u").zip(at("v")).or(at("col").zip(at("row")))?;
        let place = at("grid_i").zip(at("grid_j")).map(|(i, j)| [i, j]);
        let known = if place.is_some() { 5 } else { 3 };
        (names.len() == known).then_some(Self { image: at("image")?, u, v, place, count: known })
    }

    fn corner<'a>(&self, line: &'a str) -> std::result::Result<(&'a str, Corner), String> {
        let values: Vec<&str> = line.split(',').map(str::trim).collect();
        if values.len() != self.count {
            return Err(format!("{} values where {} are expected", values.len(), self.count));
        }
        let number = |at: usize| {
            let value: Option<f64> = values[at].parse().ok().filter(|value: &f64| value.is_finite());
            value.ok_or_else(|| format!("`{}` where a finite number of pixels is expected", values[at]))
        };
        let whole = |at: usize| {
            values[at]
                .parse()
                .map_err(|_| format!("`{}` where a column or row of the grid is expected", values[at]))
        };
        let place = match self.place {
            Some([i, j]) => Some([whole(i)?, whole(j)?]),
            None => None,
        };
        Ok((values[self.image], Corner { u: number(self.u)?, v: number(self.v)?, place }))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn read(text: &str) -> Result<Vec<PhotoCorners>> {
        parse_corners(text, Path::new("c.csv"))
    }

    #[test]
    fn both_orders_of_columns_are_read() {
        let photos = read("image,row,col,grid_i,grid_j\na,1.5,2.5,3,4\nb,0,0,0,0\n\na,7,8,1,0\n").unwrap();
        assert_eq!(photos[0].image, "a");
        assert_eq!(photos[0].corners[0], Corner { u: 2.5, v: 1.5, place: Some([3, 4]) });
        assert_eq!((photos.len(), photos[0].corners.len()), (2, 2));
        assert_eq!(
            read("\u{feff}v, u, image\r\n1,2,a\r\n").unwrap()[0].corners[0],
            Corner { u: 2.0, v: 1.0, place: None }
        );
    }

    #[test]
    fn mistakes_are_named_with_their_line() {
        for (text, message) in [
            ("", "c.csv, line 1: the columns are ``"),
            ("image,u\n", "c.csv, line 1: the columns are `image,u`"),
            ("image,u,v,w\n", "c.csv, line 1: the columns are"),
            ("image,u,v\n", "c.csv: it lists no point"),
            ("image,u,v\na,1\n", "c.csv, line 2: 2 values where 3 are expected"),
            ("image,u,v\na,1,nan\n", "c.csv, line 2: `nan` where a finite number"),
            ("image,u,v,grid_i,grid_j\na,1,1,-1,0\n", "c.csv, line 2: `-1` where a column or row"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.starts_with(message), "{error}\nnot {message}");
        }
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "(image|u|v|row|col|grid_i|grid_j|,|\n|[-0-9.e]|\\PC){0,80}") {
            let _ = read(&text);
        }
    }
}
