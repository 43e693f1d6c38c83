//! Pictures of what was found: enters a record of results with its frame, leaves a PNG.
//!
//! ```text
//! frame_panel  the frame, its brightness lifted, with spots, rejections, neighbours
//! map_panel    the same from above (the plane of ground.rs): what can be where
//! legend       what the marks mean
//! zoom         how large a pixel of the frame is drawn
//! canvas, text, labels, colours: how to draw, how words are drawn and where they find room, in which colours
//! ```
//!
//! A picture has 6800 x 4400 px at most, whatever the frame: 120 MB while it is drawn.

mod canvas;
mod colours;
mod frame_panel;
mod ground;
mod labels;
mod legend;
mod map_panel;
mod text;
mod zoom;

use std::path::PathBuf;

use nalgebra::{Unit, Vector3};
use photinus::camera::{Bearing, Camera};
use photinus::frame::FrameView;
use photinus_io::results::FrameRecord;
use photinus_io::whole::{Existing, write_whole};
use photinus_io::{Error, Result};
use tiny_skia::{Point, Rect};

use canvas::{Align, Canvas, Words};
use frame_panel::FramePanel;
use ground::Ground;
use map_panel::MapPanel;
use text::Font;
use zoom::Zoom;

/// The map's largest side, px: there its words are as large as words get.
const LARGEST_MAP_PX: u32 = 2480;
/// The picture's smallest height without legend, px: the map needs room.
const SMALLEST_HEIGHT_PX: u32 = 480;

/// A folder of pictures.
pub(crate) struct Overlay {
    folder: PathBuf,
    cameras: Vec<Camera>,
    font: Font,
}

impl Overlay {
    /// Pictures into `folder`, which is there. With cameras they show the view from above, too.
    ///
    /// # Errors
    /// [`Error`] when the program's font is damaged.
    pub(crate) fn new(folder: PathBuf, cameras: Vec<Camera>) -> Result<Self> {
        let font =
            Font::new().ok_or_else(|| Error::format(&folder, "the font of the pictures is damaged"))?;
        Ok(Self { folder, cameras, font })
    }

    /// Writes the picture of a frame; without pixels, spots stand on black. `truth_m` is where neighbours are, camera frame, m,
    /// where that is known and to be shown.
    ///
    /// # Errors
    /// [`Error`] when it cannot be drawn or written.
    pub(crate) fn draw(
        &self,
        camera: usize,
        record: &FrameRecord,
        frame: Option<FrameView<'_>>,
        gravity: Option<&Unit<Vector3<f64>>>,
        truth_m: &[Vector3<f64>],
    ) -> Result<()> {
        let camera = self.cameras.get(camera);
        let path = self.folder.join(file_name(record.camera.as_deref(), record.frame.unwrap_or_default()));
        let layout = Layout::new(size(camera, record, frame), camera.is_some());
        let mut canvas = Canvas::new(layout.width, layout.height, colours::PAPER, &self.font)
            .ok_or_else(|| Error::format(&path, "no memory for a picture of this size"))?;
        layout.heading(&mut canvas, record);
        layout.frame.draw(&mut canvas, record, frame);
        let seen =
            |place_m: &Vector3<f64>| Bearing::new(*place_m).and_then(|bearing| camera?.pixel(&bearing));
        truth_m.iter().filter_map(seen).for_each(|place| layout.frame.truth(&mut canvas, place));
        if let (Some(camera), Some(area)) = (camera, layout.map) {
            let ground = Ground::new(gravity);
            let field = ground.field(camera);
            let map = MapPanel::new(area, ground, &field, record, layout.unit);
            map.draw(&mut canvas, record);
            truth_m.iter().for_each(|place_m| map.truth(&mut canvas, place_m));
        }
        let kinds = legend::Kinds { neighbours: camera.is_some(), truth: !truth_m.is_empty() };
        legend::draw(&mut canvas, layout.legend, kinds, layout.unit);
        let bytes = canvas.png().map_err(|reason| Error::format(&path, reason))?;
        write_whole(&path, &bytes, Existing::Replace)
    }
}

/// Columns and rows of the frame, px: of its pixels, else of the camera, else what holds every spot.
fn size(camera: Option<&Camera>, record: &FrameRecord, frame: Option<FrameView<'_>>) -> (u32, u32) {
    let of_frame = frame.map(|frame| (frame.width(), frame.height()));
    let of_camera = camera.map(|camera| (camera.width(), camera.height()));
    let of_spots = || {
        let farthest = |of: fn(&photinus_io::results::SpotRecord) -> f64| {
            record.spots.iter().map(of).fold(1.0, f64::max) as usize + 2
        };
        (farthest(|spot| spot.u_px), farthest(|spot| spot.v_px))
    };
    let (width, height) = of_frame.or(of_camera).unwrap_or_else(of_spots);
    let side = |px: usize| u32::try_from(px).unwrap_or(u32::MAX).min(FrameView::MAX_SIDE_PX as u32);
    (side(width), side(height))
}

/// What the picture of a frame is called, of a camera that has a name or has none.
pub(crate) fn file_name(camera: Option<&str>, frame: u64) -> String {
    let camera = camera.map_or(String::new(), |name| format!("{name}-"));
    format!("overlay-{camera}{frame:06}.png")
}

/// Where everything stands.
struct Layout {
    width: u32,
    height: u32,
    unit: f32,
    frame: FramePanel,
    map: Option<Rect>,
    legend: Point,
}

impl Layout {
    fn new((columns, rows): (u32, u32), has_map: bool) -> Self {
        let zoom = Zoom::of(columns, rows);
        let (frame_width, frame_height) = (zoom.drawn_px(columns), zoom.drawn_px(rows));
        let panel_height = frame_height.max(SMALLEST_HEIGHT_PX);
        let unit = (panel_height as f32 / 620.0).clamp(1.0, 4.0);
        let (margin, heading, foot) = ((10.0 * unit) as u32, (34.0 * unit) as u32, (40.0 * unit) as u32);
        // The legend needs as much when there is nothing beside a narrow frame.
        let map_height = panel_height.min(LARGEST_MAP_PX);
        let map_width = if has_map { map_height.max((560.0 * unit) as u32) } else { 0 };
        let least = (360.0 * unit) as u32;
        let width = (2 * margin + frame_width + map_width).max(least);
        let top = heading + (panel_height - frame_height) / 2;
        let map = Rect::from_xywh(
            (margin + frame_width) as f32,
            heading as f32,
            map_width as f32,
            map_height as f32,
        );
        Self {
            width,
            height: heading + panel_height + foot,
            unit,
            frame: FramePanel { left: margin, top, size: (columns, rows), zoom, unit },
            map: map.filter(|_| has_map),
            legend: Point::from_xy(margin as f32, (heading + panel_height) as f32 + foot as f32 / 2.0),
        }
    }

    fn heading(&self, canvas: &mut Canvas<'_>, record: &FrameRecord) {
        let time = record.time_s.map_or(String::new(), |time_s| format!("   {time_s:.3} s"));
        let text = format!("Frame {}{time}   {}", record.frame.unwrap_or_default(), record.source);
        let words = Words { text: &text, size: 14.0 * self.unit, colour: colours::INK, halo: None };
        canvas.words(words, Point::from_xy(self.frame.left as f32, 22.0 * self.unit), Align::Left);
    }
}

#[cfg(test)]
mod tests;
