//! The view from above: range rings, what the camera sees, and where every neighbour can be.

use nalgebra::{Vector2, Vector3};
use photinus_io::results::{FrameRecord, NeighbourRecord};
use tiny_skia::{ColorU8 as Colour, Point, Rect};

use super::canvas::{Align, Canvas, Pen, Words};
use super::colours;
use super::followed::Followed;
use super::ground::Ground;
use super::labels::Labels;
use super::names::Name;

/// The ranges that the plot may show, m: few, so that it seldom changes from frame to frame.
const RANGES_M: [f64; 11] = [2.0, 4.0, 6.0, 10.0, 16.0, 25.0, 40.0, 60.0, 100.0, 200.0, 400.0];
/// What it shows when there is nobody, m.
const EMPTY_RANGE_M: f64 = 10.0;

/// A plot with the camera's place in the picture and its scale.
pub(super) struct MapPanel<'a> {
    area: Rect,
    ground: Ground,
    field: &'a [bool],
    unit: f32,
    camera: Point,
    range_m: f64,
    px_per_m: f64,
}

impl<'a> MapPanel<'a> {
    /// A plot in `area` that reaches as far as `range_m`. `field`: see [`Ground::field`].
    pub(super) fn new(area: Rect, ground: Ground, field: &'a [bool], range_m: f64, unit: f32) -> Self {
        // How far the field reaches behind the camera, as a share of the range.
        let cos = |degree: usize| libm::cos((degree as f64).to_radians());
        let seen = (0..field.len()).filter(|&degree| field[degree]);
        let behind = (-seen.map(cos).fold(1.0, f64::min)).clamp(0.0, 1.0);
        // Words stand past the rim: the ranges at the sides, the title above.
        let (margin, title) = (24.0 * unit, 30.0 * unit);
        let width = f64::from(area.width() - 2.0 * margin);
        let height = f64::from(area.height() - 2.0 * margin - title);
        // Below the camera there must be room for the numbers of the rings.
        let below_px = f64::from(24.0 * unit);
        let radius_px = (width / 2.0).min(height / (1.0 + behind)).min(height - below_px).max(1.0);
        let depth_px = radius_px * (1.0 + behind).max(1.0 + below_px / radius_px);
        let top = f64::from(area.top() + margin + title) + (height - depth_px).max(0.0) / 2.0;
        let camera = Point::from_xy(area.left() + area.width() / 2.0, (top + radius_px) as f32);
        Self { area, ground, field, unit, camera, range_m, px_per_m: radius_px / range_m }
    }

    /// Draws what is the same whoever is there.
    pub(super) fn draw_ground(&self, canvas: &mut Canvas<'_>) {
        self.title(canvas);
        self.field(canvas);
        self.rings(canvas);
    }

    /// Draws the neighbours by their names, and who is followed.
    pub(super) fn draw(
        &self,
        canvas: &mut Canvas<'_>,
        record: &FrameRecord,
        names: &[Name],
        followed: &[Followed<'_>],
    ) {
        let mut labels = Labels::new(self.area);
        labels.take(self.camera, 12.0 * self.unit);
        for (neighbour, name) in record.neighbours.iter().zip(names) {
            self.neighbour(canvas, &mut labels, neighbour, name.colour());
        }
        followed.iter().for_each(|followed| self.followed(canvas, followed));
        for (neighbour, name) in record.neighbours.iter().zip(names) {
            let distance = &neighbour.distance_m;
            let place_m = Vector3::from(neighbour.bearing) * distance.estimate.unwrap_or(distance.min);
            let text = match distance.estimate {
                Some(estimate_m) => format!("{}  {estimate_m:.1} m", name.word),
                None => name.word.clone(),
            };
            self.label(canvas, &mut labels, &place_m, &text);
        }
        for unseen in followed.iter().filter(|followed| followed.is_unseen) {
            let text = format!("{}  {:.1} m, unseen", unseen.name.word, unseen.position_m.norm());
            self.label(canvas, &mut labels, &unseen.position_m, &text);
        }
        self.own_camera(canvas);
    }

    fn title(&self, canvas: &mut Canvas<'_>) {
        let frame =
            if self.ground.is_level { "level, by gravity" } else { "camera frame, x right, z forward" };
        let text = format!("From above ({frame}), {} m", self.range_m);
        let words = Words { text: &text, size: 14.0 * self.unit, colour: colours::INK, halo: None };
        let at = Point::from_xy(self.camera.x, self.on_rim(0.0).y - 16.0 * self.unit);
        canvas.words(words, at, Align::Middle);
    }

    fn field(&self, canvas: &mut Canvas<'_>) {
        for (from, to) in stretches(self.field) {
            let rim = (from..=to).map(|degree| self.on_rim(degree as f64));
            let corners: Vec<Point> = std::iter::once(self.camera).chain(rim).collect();
            canvas.polygon(&corners, colours::FIELD);
        }
    }

    fn rings(&self, canvas: &mut Canvas<'_>) {
        let step_m = ring_step(self.range_m);
        let count = (self.range_m / step_m).round() as u32;
        for ring in 1..=count {
            let radius_m = step_m * f64::from(ring);
            let arc: Vec<Point> =
                (-90..=90).map(|degree| self.at(on_circle(f64::from(degree)) * radius_m)).collect();
            canvas.line(&arc, Pen::new(colours::RING, self.unit));
            if self.field.iter().skip(91).take(179).any(|&seen| seen) {
                let behind: Vec<Point> =
                    (90..=270).map(|degree| self.at(on_circle(f64::from(degree)) * radius_m)).collect();
                canvas.line(&behind, Pen::new(colours::pale(colours::RING, 0.6), self.unit));
            }
            let text = if ring == count { format!("{radius_m} m") } else { format!("{radius_m}") };
            let words = Words {
                text: &text,
                size: 12.0 * self.unit,
                colour: colours::FAINT_INK,
                halo: Some(colours::PAPER),
            };
            for side in [-1.0, 1.0] {
                let at = self.at(Vector2::new(side * radius_m, 0.0));
                canvas.words(words, Point::from_xy(at.x, at.y + 15.0 * self.unit), Align::Middle);
            }
        }
    }

    fn neighbour(
        &self,
        canvas: &mut Canvas<'_>,
        labels: &mut Labels,
        neighbour: &NeighbourRecord,
        colour: Colour,
    ) {
        let way = self.ground.of(&neighbour.bearing.into());
        let (distance, slant) = (&neighbour.distance_m, way.norm());
        if !(1e-3..=1.0 + 1e-9).contains(&slant) {
            // Straight above or below (or no direction at all, in results of others): a point.
            return canvas.disc(self.camera, 6.0 * self.unit, colour);
        }
        let across = Vector2::new(way.y, -way.x) / slant;
        let rim_m = self.rim_m(way);
        let far_m = distance.max.unwrap_or(f64::INFINITY);
        let near_m = distance.min.min(rim_m);
        for step in 0..=40 {
            let at_m = near_m + (far_m.min(rim_m) - near_m) * f64::from(step) / 40.0;
            labels.take(self.at(way * at_m), 5.0 * self.unit);
        }
        let bounds = [self.at(way * near_m), self.at(way * far_m.min(rim_m))];
        canvas.line(&bounds, Pen::new(colours::pale(colour, 0.45), 9.0 * self.unit));
        let cap = |canvas: &mut Canvas<'_>, at_m: f64, half_px: f32, width: f32| {
            let half = across * (f64::from(half_px) / self.px_per_m);
            canvas.line(&[self.at(way * at_m - half), self.at(way * at_m + half)], Pen::new(colour, width));
        };
        cap(canvas, near_m, 8.0 * self.unit, 1.6 * self.unit);
        if far_m <= rim_m {
            cap(canvas, far_m, 8.0 * self.unit, 1.6 * self.unit);
        } else {
            self.arrow(canvas, (way / slant, rim_m * slant), across, colour);
        }
        let Some(estimate_m) = distance.estimate else { return };
        if let Some(sigma_m) = distance.sigma {
            let ends = [estimate_m - sigma_m, estimate_m + sigma_m].map(|m| m.clamp(0.0, rim_m));
            canvas.line(&ends.map(|m| self.at(way * m)), Pen::new(colour, 2.6 * self.unit));
            ends.iter().for_each(|&end_m| cap(canvas, end_m, 4.5 * self.unit, 2.6 * self.unit));
        }
        if estimate_m <= rim_m {
            canvas.disc(self.at(way * estimate_m), 6.5 * self.unit, colours::PAPER);
            canvas.disc(self.at(way * estimate_m), 5.0 * self.unit, colour);
        }
    }

    /// How far along a direction the plot reaches, m: to its rim, or to where its room ends behind the camera.
    fn rim_m(&self, way: Vector2<f64>) -> f64 {
        let rim_m = self.range_m / way.norm().max(1e-3);
        let below_m = f64::from(self.area.bottom() - self.camera.y - 12.0 * self.unit) / self.px_per_m;
        if way.y < 0.0 { rim_m.min(below_m.max(0.0) / -way.y) } else { rim_m }
    }

    /// It goes on past the rim, `rim_m` away on the plane.
    fn arrow(
        &self,
        canvas: &mut Canvas<'_>,
        (ahead, rim_m): (Vector2<f64>, f64),
        across: Vector2<f64>,
        colour: Colour,
    ) {
        let px = |px: f32| f64::from(px * self.unit) / self.px_per_m;
        let tip = ahead * (rim_m + px(8.0));
        let base = ahead * (rim_m - px(4.0));
        let corners = [tip, base + across * px(9.0), base - across * px(9.0)];
        canvas.polygon(&corners.map(|corner| self.at(corner)), colour);
    }

    /// Words beside a place, camera frame, m.
    fn label(&self, canvas: &mut Canvas<'_>, labels: &mut Labels, place_m: &Vector3<f64>, text: &str) {
        let distance_m = place_m.norm();
        let way = self.ground.of(place_m) / distance_m.max(f64::MIN_POSITIVE);
        let at = self.at(way * distance_m.min(self.rim_m(way)));
        let size = 13.0 * self.unit;
        let words = Words { text, size, colour: colours::INK, halo: Some(colours::PAPER) };
        labels.take(at, 6.0 * self.unit);
        let room = (canvas.width_of(words), size);
        if let Some((corner, times)) = labels.place_near(at, (10.0 * self.unit, 10.0 * self.unit), room) {
            if times > 1.0 {
                let end = Point::from_xy(
                    at.x.clamp(corner.x, corner.x + room.0),
                    at.y.clamp(corner.y, corner.y + room.1),
                );
                canvas.line(&[at, end], Pen::new(colours::FAINT_INK, self.unit));
            }
            canvas.words(words, Point::from_xy(corner.x, corner.y + 0.86 * size), Align::Left);
        }
    }

    /// Its tail, its way ahead, and a ring where it is thought to be unseen; what is past the rim is not drawn.
    fn followed(&self, canvas: &mut Canvas<'_>, followed: &Followed<'_>) {
        let colour = followed.name.colour();
        let shown = |place_m: &Vector3<f64>| {
            let place_m = self.ground.of(place_m);
            (place_m.norm() <= self.range_m).then(|| self.at(place_m))
        };
        let tail: Vec<Point> = followed.tail_m.iter().filter_map(shown).collect();
        canvas.line(&tail, Pen::new(colour, 1.2 * self.unit));
        let Some(at) = shown(&followed.position_m) else { return };
        if followed.is_unseen {
            canvas.circle(at, 6.0 * self.unit, Pen::new(colour, 1.6 * self.unit));
        }
        if let Some(ahead) = shown(&followed.ahead_m) {
            canvas.arrow(at, ahead, Pen::new(colour, 2.0 * self.unit), 7.0 * self.unit);
        }
    }

    /// A square where a neighbour truly is.
    pub(super) fn truth(&self, canvas: &mut Canvas<'_>, place_m: &Vector3<f64>) {
        let place_m = self.ground.of(place_m);
        if place_m.norm() <= self.range_m {
            canvas.square(
                self.at(place_m),
                7.0 * self.unit,
                Pen::new(colours::INK, 1.8 * self.unit).on(colours::PAPER),
            );
        }
    }

    fn own_camera(&self, canvas: &mut Canvas<'_>) {
        let px = |px: f32| f64::from(px * self.unit) / self.px_per_m;
        let corners =
            [Vector2::new(0.0, px(9.0)), Vector2::new(px(7.0), -px(6.0)), Vector2::new(-px(7.0), -px(6.0))];
        canvas.polygon(&corners.map(|corner| self.at(corner)), colours::INK);
    }

    fn on_rim(&self, degree: f64) -> Point {
        self.at(on_circle(degree) * self.range_m)
    }

    /// A place on the plane, m right and forward, in the picture.
    fn at(&self, place_m: Vector2<f64>) -> Point {
        let [x, y]: [f64; 2] = (place_m * self.px_per_m).into();
        Point::from_xy(self.camera.x + x as f32, self.camera.y - y as f32)
    }
}

/// Stretches of whole degrees that are seen, the first and the last one of each; past 359 where one goes over 0.
fn stretches(field: &[bool]) -> Vec<(usize, usize)> {
    let count = field.len();
    let Some(gap) = field.iter().position(|&seen| !seen) else { return vec![(0, count)] };
    let (mut found, mut begin) = (Vec::new(), None);
    for degree in gap..=gap + count {
        match (field[degree % count], begin) {
            (true, None) => begin = Some(degree),
            (false, Some(from)) => {
                found.push((from, degree - 1));
                begin = None;
            }
            _ => {}
        }
    }
    found
}

/// Right and forward of an azimuth.
fn on_circle(degree: f64) -> Vector2<f64> {
    let (sin, cos) = libm::sincos(degree.to_radians());
    Vector2::new(sin, cos)
}

/// The range that a plot shows after one that showed `last_m`: as far unless more is needed, or less than half of it.
pub(super) fn range_after(last_m: Option<f64>, record: &FrameRecord) -> f64 {
    let needed_m = range_for(record);
    last_m.filter(|last_m| (needed_m..2.0 * needed_m + 1e-9).contains(last_m)).unwrap_or(needed_m)
}

/// The least range that shows every estimate with its sigma, every far bound that is not out of all proportion, and who is likely followed.
fn range_for(record: &FrameRecord) -> f64 {
    let need = |neighbour: &NeighbourRecord| {
        let distance = &neighbour.distance_m;
        let likely_m = distance.estimate.unwrap_or(2.0 * distance.min) + 2.0 * distance.sigma.unwrap_or(0.0);
        let bound_m = distance.max.unwrap_or(1.15 * likely_m).min(1.5 * likely_m);
        likely_m.max(bound_m)
    };
    let likely = record.tracks.iter().filter(|track| track.probability > 0.5);
    let followed = likely.map(|track| 1.15 * Vector3::from(track.position_m).norm());
    let farthest_m = record.neighbours.iter().map(need).chain(followed).fold(0.0, f64::max);
    let needed_m = if farthest_m > 0.0 { farthest_m } else { EMPTY_RANGE_M };
    RANGES_M.into_iter().find(|&range_m| range_m >= needed_m).unwrap_or(RANGES_M[RANGES_M.len() - 1])
}

/// A step of 1, 2 or 5 times a power of ten that divides the range into four or five, or a quarter of it.
fn ring_step(range_m: f64) -> f64 {
    let divides =
        |step_m: &f64| (3.9..=5.1).contains(&(range_m / step_m)) && (range_m / step_m).fract() < 1e-9;
    [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0].into_iter().find(divides).unwrap_or(range_m / 4.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_is_drawn_in_whole_stretches() {
        let field = |seen: fn(usize) -> bool| (0..360).map(seen).collect::<Vec<bool>>();
        assert_eq!(stretches(&field(|_| true)), [(0, 360)]);
        assert_eq!(stretches(&field(|_| false)), []);
        assert_eq!(stretches(&field(|degree| !(90..270).contains(&degree))), [(270, 360 + 89)]);
        assert_eq!(
            stretches(&field(|degree| degree < 10 || (20..30).contains(&degree))),
            [(20, 29), (360, 369)]
        );
    }

    #[test]
    fn rings_divide_every_range() {
        for range_m in RANGES_M {
            let rings = range_m / ring_step(range_m);
            assert!((4.0..=5.0).contains(&rings) && rings.fract() < 1e-9, "{range_m}: {rings}");
        }
    }
}
