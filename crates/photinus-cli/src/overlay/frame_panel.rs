//! The frame with what was found in it.

use nalgebra::Vector3;
use photinus::camera::Pixel;
use photinus::frame::FrameView;
use photinus_io::results::{Distance, FrameRecord, NeighbourRecord, RejectedRecord, SpotRecord};
use tiny_skia::{ColorU8 as Colour, Point, Rect};

use super::canvas::{Align, Canvas, Pen, Words};
use super::colours;
use super::followed::Followed;
use super::labels::Labels;
use super::names::Name;
use super::zoom::Zoom;

/// Grey level to which the middle level of a dark frame is lifted.
const LIFTED_MIDDLE: f64 = 44.0;
/// More neighbours than this are named in the frame by their letter alone.
const CROWD: usize = 16;
/// Of more rejected regions than this each has its mark, but the heading alone says why.
const MOST_TOLD: usize = 10;
/// The strongest lift, as an exponent.
const STRONGEST_LIFT: f64 = 0.35;

/// What tells where a place of the camera frame, m, is in the frame.
type Seen<'a> = dyn Fn(&Vector3<f64>) -> Option<Pixel> + 'a;

/// Where the frame stands in the picture.
#[derive(Clone, Copy)]
pub(super) struct FramePanel {
    pub(super) left: u32,
    pub(super) top: u32,
    /// Of the frame, px.
    pub(super) size: (u32, u32),
    pub(super) zoom: Zoom,
    /// What lines and words are measured in, px.
    pub(super) unit: f32,
}

impl FramePanel {
    /// Draws everything, neighbours by their names; beside who is followed stands what tells where a place of the camera frame, m, is
    /// in the frame.
    pub(super) fn draw(
        &self,
        canvas: &mut Canvas<'_>,
        record: &FrameRecord,
        names: &[Name],
        frame: Option<FrameView<'_>>,
        (followed, seen): (&[Followed<'_>], &Seen<'_>),
    ) {
        let Some(area) = self.area() else { return };
        match frame {
            Some(frame) => canvas.frame(&frame, (self.left, self.top), self.zoom, &lifted_levels(&frame)),
            None => canvas.rectangle(area, colours::SHADE),
        }
        let mut labels = Labels::new(area);
        for spot in &record.spots {
            labels.take(self.at(spot.u_px, spot.v_px), self.radius_of(record, spot));
        }
        followed.iter().for_each(|followed| self.followed(canvas, &mut labels, followed, seen));
        for (neighbour, name) in record.neighbours.iter().zip(names) {
            self.neighbour(canvas, &mut labels, record, neighbour, name);
        }
        for (index, spot) in record.spots.iter().enumerate() {
            let mark = (self.radius_of(record, spot), colour_of_spot(record, names, index));
            self.spot(canvas, &mut labels, spot, index, mark);
        }
        let are_told = record.rejected.len() <= MOST_TOLD;
        for rejected in &record.rejected {
            self.rejected(canvas, rejected);
            if are_told {
                let (centre, reach) = self.rejected_at(rejected);
                self.label(canvas, &mut labels, centre, reach, &rejected.reason, colours::REJECTED);
            }
        }
    }

    /// A square where a neighbour truly is.
    pub(super) fn truth(&self, canvas: &mut Canvas<'_>, place: Pixel) {
        canvas.square(
            self.at(place.u, place.v),
            7.0 * self.unit,
            Pen::new(colours::PAPER, 1.8 * self.unit).on(colours::SHADE),
        );
    }

    fn neighbour(
        &self,
        canvas: &mut Canvas<'_>,
        labels: &mut Labels,
        record: &FrameRecord,
        neighbour: &NeighbourRecord,
        name: &Name,
    ) {
        let colour = name.colour();
        let spots: Vec<&SpotRecord> =
            neighbour.spots.iter().filter_map(|&spot| record.spots.get(spot)).collect();
        let path: Vec<Point> = chain(&spots).iter().map(|spot| self.at(spot.u_px, spot.v_px)).collect();
        for pair in path.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            let (dx, dy) = (to.x - from.x, to.y - from.y);
            let length = (dx * dx + dy * dy).sqrt();
            let gap = 10.0 * self.unit;
            // A line stops before the circles that it joins, and shows only where there is room for it.
            if length > 2.0 * gap {
                let (x, y) = (dx / length * gap, dy / length * gap);
                let ends = [Point::from_xy(from.x + x, from.y + y), Point::from_xy(to.x - x, to.y - y)];
                canvas.line(&ends, Pen::new(colour, 1.6 * self.unit).on(colours::SHADE));
            }
        }
        let Some(middle) = middle_of(&path) else { return };
        let is_crowd = record.neighbours.len() > CROWD;
        let (first, second) = match is_crowd {
            true => (name.word.clone(), String::new()),
            false => distance_lines(&neighbour.distance_m, name),
        };
        let size = 15.0 * self.unit;
        let words = |text| Words { text, size, colour, halo: Some(colours::SHADE) };
        let width = canvas.width_of(words(&first)).max(canvas.width_of(words(&second)));
        let reach = path.iter().fold((0.0_f32, 0.0_f32), |(across, down), point| {
            (across.max((point.x - middle.x).abs()), down.max((point.y - middle.y).abs()))
        });
        let gap = 22.0 * self.unit;
        let (room, gap) = match is_crowd {
            true => ((width, size), 0.5 * gap),
            false => ((width, 2.4 * size), gap),
        };
        let reach = (reach.0 + gap, reach.1 + gap);
        let placed = match is_crowd {
            true => labels.place(middle, reach, room).map(|corner| (corner, 1.0)),
            false => labels.place_near(middle, reach, room),
        };
        let Some((corner, times)) = placed else { return };
        if times > 1.0 {
            // From what is named to its words, where they found no room beside it.
            let end = Point::from_xy(
                middle.x.clamp(corner.x, corner.x + room.0),
                middle.y.clamp(corner.y, corner.y + room.1),
            );
            canvas.line(&[middle, end], Pen::new(colour, self.unit).on(colours::SHADE));
        }
        canvas.words(words(&first), Point::from_xy(corner.x, corner.y + size), Align::Left);
        canvas.words(words(&second), Point::from_xy(corner.x, corner.y + 2.2 * size), Align::Left);
    }

    /// Its tail, its way ahead, and a ring with its name where it is thought to be unseen.
    fn followed(
        &self,
        canvas: &mut Canvas<'_>,
        labels: &mut Labels,
        followed: &Followed<'_>,
        seen: &Seen<'_>,
    ) {
        let colour = followed.name.colour();
        let shown = |place_m: &Vector3<f64>| seen(place_m).map(|pixel| self.at(pixel.u, pixel.v));
        let tail: Vec<Point> = followed.tail_m.iter().filter_map(shown).collect();
        canvas.line(&tail, Pen::new(colour, self.unit));
        let Some(at) = shown(&followed.position_m) else { return };
        if let Some(ahead) = shown(&followed.ahead_m) {
            canvas.arrow(at, ahead, Pen::new(colour, 1.6 * self.unit), 6.0 * self.unit);
        }
        if followed.is_unseen {
            let radius = 14.0 * self.unit;
            canvas.circle(at, radius, Pen::new(colour, self.unit));
            labels.take(at, radius);
            self.label(canvas, labels, at, radius, &format!("{} unseen", followed.name.word), colour);
        }
    }

    fn spot(
        &self,
        canvas: &mut Canvas<'_>,
        labels: &mut Labels,
        spot: &SpotRecord,
        index: usize,
        (radius, colour): (f32, Colour),
    ) {
        let centre = self.at(spot.u_px, spot.v_px);
        let is_unlikely = spot.marker_log_odds < 0.0;
        let width = if is_unlikely { 0.8 } else { 1.6 };
        canvas.circle(centre, radius, Pen::new(colour, width * self.unit).on(colours::SHADE));
        let chance = if is_unlikely { format!(" {:.0} %", 100.0 * spot.probability) } else { String::new() };
        self.label(canvas, labels, centre, radius, &format!("{index}{chance}"), colour);
    }

    /// Where the mark of something rejected stands, and how far it reaches.
    fn rejected_at(&self, rejected: &RejectedRecord) -> (Point, f32) {
        (self.at(rejected.u_px, rejected.v_px), 1.25 * self.radius(rejected.area_px))
    }

    fn rejected(&self, canvas: &mut Canvas<'_>, rejected: &RejectedRecord) {
        let (centre, r) = self.rejected_at(rejected);
        let corners = [(r, 0.0), (0.0, r), (-r, 0.0), (0.0, -r)];
        let diamond = corners.map(|(x, y)| Point::from_xy(centre.x + x, centre.y + y));
        canvas.outline(&diamond, Pen::new(colours::REJECTED, 1.4 * self.unit).on(colours::SHADE));
    }

    /// A short word beside a mark, where there is room.
    fn label(
        &self,
        canvas: &mut Canvas<'_>,
        labels: &mut Labels,
        centre: Point,
        reach: f32,
        text: &str,
        colour: Colour,
    ) {
        let size = 12.0 * self.unit;
        let words = Words { text, size, colour, halo: Some(colours::SHADE) };
        let (room, gap) = ((canvas.width_of(words), size), reach + 2.0 * self.unit);
        if let Some(corner) = labels.place(centre, (gap, gap), room) {
            canvas.words(words, Point::from_xy(corner.x, corner.y + 0.86 * size), Align::Left);
        }
    }

    /// A place of the frame in the picture; the centre of a pixel is at the integer.
    fn at(&self, u_px: f64, v_px: f64) -> Point {
        let scale = self.zoom.factor();
        let x = f64::from(self.left) + (u_px + 0.5) * scale;
        let y = f64::from(self.top) + (v_px + 0.5) * scale;
        Point::from_xy(x as f32, y as f32)
    }

    /// The circle of a spot: clear of its light, and of the next circle where there is room for that.
    fn radius_of(&self, record: &FrameRecord, spot: &SpotRecord) -> f32 {
        let squared = |other: &SpotRecord| {
            let (du, dv) = (other.u_px - spot.u_px, other.v_px - spot.v_px);
            du * du + dv * dv
        };
        // The spot itself, and another in the very same place, leave no room to speak of.
        let others = record.spots.iter().map(squared).filter(|&squared| squared > 0.0);
        let room =
            others.fold(f64::INFINITY, f64::min).sqrt() as f32 * self.zoom.factor() as f32 / 2.0 - self.unit;
        self.radius(spot.area_px).min(room).max(self.radius(spot.area_px) - 3.0 * self.unit)
    }

    /// A circle a little larger than this many pixels.
    fn radius(&self, area_px: u32) -> f32 {
        (f64::from(area_px) / std::f64::consts::PI).sqrt() as f32 * self.zoom.factor() as f32
            + 5.0 * self.unit
    }

    fn area(&self) -> Option<Rect> {
        let side = |px: u32| self.zoom.drawn_px(px) as f32;
        Rect::from_xywh(self.left as f32, self.top as f32, side(self.size.0), side(self.size.1))
    }
}

/// Distance, then its bounds.
fn distance_lines(distance: &Distance, name: &Name) -> (String, String) {
    let sigma = distance.sigma.map_or(String::new(), |sigma| format!(" ± {sigma:.2}"));
    let estimate = distance.estimate.map_or("no estimate".to_owned(), |m| format!("{m:.2}{sigma} m"));
    let bounds = match distance.max {
        Some(max) => format!("{:.2} to {max:.2} m", distance.min),
        None => format!("{:.2} m or more", distance.min),
    };
    (format!("{}  {estimate}", name.word), bounds)
}

/// The neighbour's colour, or that of spots that belong to none.
fn colour_of_spot(record: &FrameRecord, names: &[Name], index: usize) -> Colour {
    let owner = record.neighbours.iter().zip(names).find(|(neighbour, _)| neighbour.spots.contains(&index));
    owner.map_or(colours::SPOT, |(_, name)| name.colour())
}

/// Spots in the order along their longer side, so that a line joins neighbours of each other.
fn chain<'a>(spots: &[&'a SpotRecord]) -> Vec<&'a SpotRecord> {
    let spread = |of: fn(&SpotRecord) -> f64| {
        let (low, high) = spots.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), spot| {
            (low.min(of(spot)), high.max(of(spot)))
        });
        high - low
    };
    let along: fn(&SpotRecord) -> f64 = if spread(|spot| spot.u_px) >= spread(|spot| spot.v_px) {
        |spot| spot.u_px
    } else {
        |spot| spot.v_px
    };
    let mut sorted = spots.to_vec();
    sorted.sort_by(|a, b| along(a).total_cmp(&along(b)));
    sorted
}

fn middle_of(path: &[Point]) -> Option<Point> {
    let count = path.len() as f32;
    let sum = path.iter().copied().reduce(|a, b| a + b)?;
    Some(Point::from_xy(sum.x / count, sum.y / count))
}

/// Levels of a frame -> levels of the picture: a dark frame is lifted by a power law, so that the sky shows and spots
/// stay the brightest.
fn lifted_levels(frame: &FrameView<'_>) -> [u8; 256] {
    let middle = f64::from(median(frame).max(1)) / 255.0;
    let power = (libm::log(LIFTED_MIDDLE / 255.0) / libm::log(middle.min(0.99))).clamp(STRONGEST_LIFT, 1.0);
    std::array::from_fn(|level| (255.0 * libm::pow(level as f64 / 255.0, power)).round() as u8)
}

fn median(frame: &FrameView<'_>) -> u8 {
    let mut counts = [0_usize; 256];
    for v in 0..frame.height() {
        frame.row(v).iter().for_each(|&level| counts[usize::from(level)] += 1);
    }
    let half = frame.width() * frame.height() / 2;
    let mut below = 0;
    let middle = counts.iter().position(|count| {
        below += count;
        below > half
    });
    middle.and_then(|level| u8::try_from(level).ok()).unwrap_or(u8::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dark_frame_is_lifted_and_a_bright_one_is_not() {
        let lift = |level: u8| lifted_levels(&FrameView::packed(&[level; 12], 4, 3).unwrap());
        let dark = lift(3);
        assert!(dark[3] >= 44 && dark[0] == 0 && dark[255] == 255, "{:?}", &dark[..5]);
        assert!(dark.windows(2).all(|pair| pair[0] <= pair[1]));
        assert_eq!(lift(120)[77], 77);
        assert_eq!(lift(255)[255], 255);
    }

    #[test]
    fn what_is_not_known_of_a_distance_is_not_shown() {
        let distance =
            Distance { estimate: None, sigma: None, min: 2.0, max: None, perpendicular: None, inline: None };
        assert_eq!(
            distance_lines(&distance, &Name::letter(1)),
            ("B  no estimate".into(), "2.00 m or more".into())
        );
        let known = Distance { estimate: Some(7.254), sigma: Some(0.5), max: Some(9.0), ..distance };
        assert_eq!(
            distance_lines(&known, &Name::letter(0)),
            ("A  7.25 ± 0.50 m".into(), "2.00 to 9.00 m".into())
        );
    }
}
