//! Photos of the board, or a table of corners -> their spots, read and searched side by side.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::Vector2;
use photinus::spots::Detector;
use photinus_calibrate::adjust::View;
use photinus_calibrate::grid::{Grid, OrderError};
use photinus_calibrate::photo::{Photo, PhotoSpot, board_settings};
use photinus_io::corners::read_corners;
use photinus_io::image::read_image;

use crate::failure::Failure;
use crate::number;
use crate::terminal::Terminal;

/// What the user says about photos and the board in them.
#[derive(Debug, clap::Args)]
pub(crate) struct PhotoArgs {
    /// Photos of the grid, or one table of corners (.csv: image,u,v or image,row,col, optionally grid_i,grid_j)
    #[arg(value_name = "PHOTOS", required = true)]
    photos: Vec<PathBuf>,
    /// LEDs along the two sides of the grid
    #[arg(long, value_name = "COLUMNSxROWS", value_parser = counts)]
    grid: [usize; 2],
    /// Distance between neighbouring LEDs, m
    #[arg(long, value_name = "METRES", default_value_t = 0.05, value_parser = number::metres)]
    pitch: f64,
    /// Size of the photos, where corners come from a table
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = counts)]
    size: Option<[usize; 2]>,
}

/// Photos with what was found in them.
pub(crate) struct Searched {
    pub(crate) grid: Grid,
    pub(crate) size_px: [usize; 2],
    pub(crate) photos: Vec<Photo>,
    /// Those that show the grid.
    pub(crate) views: Vec<View>,
    /// Those that do not, and why.
    pub(crate) refused: Vec<(usize, OrderError)>,
}

/// Two whole numbers with an x between them.
fn counts(text: &str) -> Result<[usize; 2], String> {
    let numbers = text.split_once('x').and_then(|(a, b)| Some([a.parse().ok()?, b.parse().ok()?]));
    numbers.ok_or_else(|| "give two whole numbers with an x between them, such as 7x5".to_owned())
}

impl PhotoArgs {
    /// The files that are read.
    pub(crate) fn files(&self) -> &[PathBuf] {
        &self.photos
    }

    /// Reads the photos and finds the grid in each. A photo that cannot be read is reported and skipped.
    pub(crate) fn search(&self, terminal: &mut Terminal) -> Result<Searched, Failure> {
        let [columns, rows] = self.grid;
        let grid = Grid::new(columns, rows, self.pitch).map_err(|error| Failure::Input(error.to_string()))?;
        let photos = match self.photos.as_slice() {
            [table] if table.extension().is_some_and(|end| end == "csv") => self.table(table)?,
            files => images(files, terminal),
        };
        let Some(first) = photos.first() else {
            return Err(Failure::Input("none of the photos could be read".to_owned()));
        };
        let size_px = first.size_px;
        if let Some(other) = photos.iter().find(|photo| photo.size_px != size_px) {
            return Err(Failure::Input(format!(
                "{}: {}x{} pixels, but {} has {}x{}: a calibration is of one camera at one size; sort the photos",
                other.name, other.size_px[0], other.size_px[1], first.name, size_px[0], size_px[1]
            )));
        }
        let ordered = side_by_side(photos.len(), |index| photos[index].view(index, &grid));
        let (mut views, mut refused) = (Vec::new(), Vec::new());
        for (index, view) in ordered.into_iter().enumerate() {
            match view {
                Ok(view) => views.push(view),
                Err(error) => refused.push((index, error)),
            }
        }
        Ok(Searched { grid, size_px, photos, views, refused })
    }

    fn table(&self, path: &Path) -> Result<Vec<Photo>, Failure> {
        let Some(size_px) = self.size else {
            let reason = "a table of corners does not say how large the photos are; give --size, such as --size 752x480";
            return Err(Failure::Input(format!("{}: {reason}", path.display())));
        };
        let photos = read_corners(path).map_err(Failure::input)?.into_iter().map(|photo| {
            let spots = photo.corners.iter().map(|corner| PhotoSpot {
                centre: Vector2::new(corner.u, corner.v),
                width_px2: None,
                led: corner.place,
            });
            Photo { name: photo.image, size_px, spots: spots.collect() }
        });
        Ok(photos.collect())
    }
}

fn images(files: &[PathBuf], terminal: &mut Terminal) -> Vec<Photo> {
    let read = side_by_side(files.len(), |index| {
        let path = &files[index];
        let image = read_image(path).map_err(|error| error.to_string())?.image;
        let name = path.display().to_string();
        let mut detector = Detector::new(board_settings()).map_err(|error| error.to_string())?;
        Photo::of_frame(name, &image.view(), &mut detector)
            .map_err(|error| format!("{}: {error}", path.display()))
    });
    let mut photos = Vec::new();
    for photo in read {
        match photo {
            Ok(photo) => photos.push(photo),
            Err(error) => terminal.error(error),
        }
    }
    photos
}

/// `work` for 0 to `count`, on all processors; the results come in their order.
pub(crate) fn side_by_side<T: Send>(count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(count.max(1));
    let next = AtomicUsize::new(0);
    let mut done: Vec<(usize, T)> = std::thread::scope(|scope| {
        let worker = || {
            let mut own = Vec::new();
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                if index >= count {
                    return own;
                }
                own.push((index, work(index)));
            }
        };
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
        // a worker that panicked takes the program down with its message
        workers
            .into_iter()
            .flat_map(|worker| worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .collect()
    });
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, result)| result).collect()
}
