//! Pictures of what was found: enters a record of results with its frame, leaves a PNG or a picture of a video.
//!
//! ```text
//! frame_panel  the frame, its brightness lifted, with spots, rejections, neighbours
//! map_panel    the same from above (the plane of ground.rs): what can be where
//! legend       what the marks mean
//! names        what neighbours are called from picture to picture
//! followed     where tracks were, are and go
//! place        where pictures go
//! palette      the colours of a PNG
//! zoom         how large a pixel of the frame is drawn
//! canvas, text, labels, colours: how to draw, how words are drawn and where they find room, in which colours
//! ```
//!
//! A picture has 6800 x 4400 px at most, whatever the frame: 120 MB while it is drawn.

mod canvas;
mod colours;
mod followed;
mod frame_panel;
mod ground;
mod labels;
mod legend;
mod map_panel;
mod names;
mod palette;
mod place;
mod text;
mod zoom;

use nalgebra::{Unit, Vector3};
use photinus::camera::{Bearing, Camera};
use photinus::frame::FrameView;
use photinus_io::results::FrameRecord;
use photinus_io::{Error, Result};
use tiny_skia::{Pixmap, Point, Rect};

use canvas::{Align, Canvas, Words};
use followed::Tails;
use frame_panel::FramePanel;
use ground::Ground;
use map_panel::MapPanel;
use names::Names;
use palette::Palette;
pub(crate) use place::{Place, numbered};
use text::Font;
use zoom::Zoom;

/// The map's largest side, px: there its words are as large as words get.
const LARGEST_MAP_PX: u32 = 2480;
/// The picture's smallest height without legend, px: the map needs room.
const SMALLEST_HEIGHT_PX: u32 = 480;

/// Pictures in the making, one after the other, and where they go.
pub(crate) struct Overlay {
    place: Place,
    drawing: Drawing,
    palette: Palette,
    bytes: Vec<u8>,
}

/// Draws pictures, one after the other.
pub(crate) struct Drawing {
    cameras: Vec<Camera>,
    has_map: bool,
    font: Font,
    /// What was seen in the last picture of each camera.
    last: Vec<Last>,
    /// What is under the marks of the last picture, and what it was drawn for.
    under: Option<(Under, Pixmap)>,
    picture: Option<Pixmap>,
}

/// What pictures of a camera take over from the one before, so that names, colours and the range of the map stay.
#[derive(Default)]
struct Last {
    names: Names,
    tails: Tails,
    range_m: Option<f64>,
}

/// All that shows under the marks: pictures with the same are begun with a copy.
#[derive(Clone, PartialEq)]
struct Under {
    frame_px: (u32, u32),
    kinds: legend::Kinds,
    /// Range of the map, m, whether it is level, and what the camera sees.
    map: Option<(f64, bool, Vec<bool>)>,
}

impl Overlay {
    /// Pictures to `place`. With cameras they show the view from above, too.
    ///
    /// # Errors
    /// [`Error`] when the program's font is damaged.
    pub(crate) fn new(place: Place, cameras: Vec<Camera>) -> Result<Self> {
        let drawing = Drawing::new(cameras, true)?;
        Ok(Self { place, drawing, palette: Palette::new(), bytes: Vec::new() })
    }

    /// Writes the picture of a frame; without pixels, spots stand on black. `truth_m` is where neighbours are, camera frame, m,
    /// where that is known and to be shown.
    ///
    /// # Errors
    /// [`Error`] when it cannot be drawn or written.
    pub(crate) fn draw(
        &mut self,
        camera: usize,
        record: &FrameRecord,
        frame: Option<FrameView<'_>>,
        gravity: Option<&Unit<Vector3<f64>>>,
        truth_m: &[Vector3<f64>],
    ) -> Result<()> {
        let picture = self.drawing.draw(camera, record, frame, gravity, truth_m)?;
        self.place.write(picture, &self.palette, record, &mut self.bytes)
    }

    /// Takes note of a record that is not drawn: names stay, and tails have it.
    pub(crate) fn pass(&mut self, camera: usize, record: &FrameRecord) {
        if let Some(last) = self.drawing.last.get_mut(camera) {
            let called = last.names.follow(record);
            last.tails.follow(record, &called.tracks);
        }
    }
}

impl Drawing {
    /// Pictures of frames; with `has_map`, of those whose camera is known with the view from above.
    ///
    /// # Errors
    /// As [`Overlay::new`].
    pub(crate) fn new(cameras: Vec<Camera>, has_map: bool) -> Result<Self> {
        let font =
            Font::new().ok_or_else(|| Error::format("the pictures", "the font of the program is damaged"))?;
        let last = cameras.iter().map(|_| Last::default()).collect();
        Ok(Self { cameras, has_map, font, last, under: None, picture: None })
    }

    /// The picture of a frame, as [`Overlay::draw`] says.
    ///
    /// # Errors
    /// [`Error`] when there is no memory for it.
    pub(crate) fn draw(
        &mut self,
        camera: usize,
        record: &FrameRecord,
        frame: Option<FrameView<'_>>,
        gravity: Option<&Unit<Vector3<f64>>>,
        truth_m: &[Vector3<f64>],
    ) -> Result<&Pixmap> {
        let mut alone = Last::default();
        let last = self.last.get_mut(camera).unwrap_or(&mut alone);
        let range_m = map_panel::range_after(last.range_m, record);
        last.range_m = Some(range_m);
        let called = last.names.follow(record);
        let followed = last.tails.follow(record, &called.tracks);
        let names = &called.neighbours;
        let camera = self.cameras.get(camera);
        let layout = Layout::new(size(camera, record, frame), camera.is_some() && self.has_map);
        let ground = Ground::new(gravity);
        let field = camera.map_or(Vec::new(), |camera| ground.field(camera));
        let map = layout.map.map(|area| MapPanel::new(area, ground, &field, range_m, layout.unit));
        let under = Under {
            frame_px: layout.frame.size,
            kinds: legend::Kinds {
                neighbours: camera.is_some(),
                followed: camera.is_some() && !followed.is_empty(),
                truth: !truth_m.is_empty(),
            },
            map: map.as_ref().map(|_| (range_m, ground.is_level, field.clone())),
        };
        let no_memory = || Error::format(&record.source, "no memory for a picture of this size");
        if self.under.as_ref().is_none_or(|(drawn, _)| *drawn != under) {
            let mut pixmap = Pixmap::new(layout.width, layout.height).ok_or_else(no_memory)?;
            layout.draw_under(&mut Canvas::on(&mut pixmap, &mut self.font), map.as_ref(), under.kinds);
            self.picture = Some(pixmap.clone());
            self.under = Some((under, pixmap));
        }
        let (Some((_, under)), Some(picture)) = (&self.under, &mut self.picture) else {
            return Err(no_memory());
        };
        picture.data_mut().copy_from_slice(under.data());
        let mut canvas = Canvas::on(picture, &mut self.font);
        layout.heading(&mut canvas, record);
        let seen =
            |place_m: &Vector3<f64>| Bearing::new(*place_m).and_then(|bearing| camera?.pixel(&bearing));
        layout.frame.draw(&mut canvas, record, names, frame, (&followed, &seen));
        truth_m.iter().filter_map(seen).for_each(|place| layout.frame.truth(&mut canvas, place));
        if let Some(map) = map {
            map.draw(&mut canvas, record, names, &followed);
            truth_m.iter().for_each(|place_m| map.truth(&mut canvas, place_m));
        }
        Ok(picture)
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

    /// Draws what is under the marks: paper, the ground of the map, the legend.
    fn draw_under(&self, canvas: &mut Canvas<'_>, map: Option<&MapPanel<'_>>, kinds: legend::Kinds) {
        canvas.fill_all(colours::PAPER);
        if let Some(map) = map {
            map.draw_ground(canvas);
        }
        legend::draw(canvas, self.legend, kinds, self.unit);
    }

    fn heading(&self, canvas: &mut Canvas<'_>, record: &FrameRecord) {
        let time = record.time_s.map_or(String::new(), |time_s| format!("   {time_s:.3} s"));
        let rejected = counted(record);
        let text = format!("Frame {}{time}   {}{rejected}", record.frame.unwrap_or_default(), record.source);
        let words = Words { text: &text, size: 14.0 * self.unit, colour: colours::INK, halo: None };
        canvas.words(words, Point::from_xy(self.frame.left as f32, 22.0 * self.unit), Align::Left);
    }
}

/// How many regions were rejected, by reason, the most frequent first; nothing where none was.
fn counted(record: &FrameRecord) -> String {
    let mut reasons: Vec<(&str, usize)> = Vec::new();
    for rejected in &record.rejected {
        match reasons.iter_mut().find(|(reason, _)| *reason == rejected.reason) {
            Some((_, count)) => *count += 1,
            None => reasons.push((&rejected.reason, 1)),
        }
    }
    reasons.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(b.0)));
    let told: Vec<String> = reasons.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
    if told.is_empty() { String::new() } else { format!("   rejected: {}", told.join(", ")) }
}

#[cfg(test)]
mod tests;
