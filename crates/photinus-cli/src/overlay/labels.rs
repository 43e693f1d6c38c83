//! Where words find room: beside what they name, on nothing that was placed before.

use tiny_skia::{Point, Rect};

/// The room of a panel.
pub(super) struct Labels {
    panel: Rect,
    taken: Vec<Rect>,
}

impl Labels {
    /// A panel with all its room.
    pub(super) fn new(panel: Rect) -> Self {
        Self { panel, taken: Vec::new() }
    }

    /// Keeps words off a square around `centre`.
    pub(super) fn take(&mut self, centre: Point, reach: f32) {
        self.taken.extend(Rect::from_ltrb(
            centre.x - reach,
            centre.y - reach,
            centre.x + reach,
            centre.y + reach,
        ));
    }

    /// Takes room for a box of `size` beside `centre`, or farther away where there is none near: the second value says how far,
    /// in multiples of `reach`.
    pub(super) fn place_near(
        &mut self,
        centre: Point,
        reach: (f32, f32),
        size: (f32, f32),
    ) -> Option<(Point, f32)> {
        [1.0, 1.7, 2.6, 4.0, 6.0].into_iter().find_map(|times| {
            let far = (reach.0 + 0.7 * (times - 1.0) * size.1, reach.1 + 0.7 * (times - 1.0) * size.1);
            Some((self.place(centre, far, size)?, times))
        })
    }

    /// Takes room for a box of `width` x `height` beside `centre`, at least `reach` away across and down, and gives its
    /// upper left corner; `None` when there is none.
    pub(super) fn place(
        &mut self,
        centre: Point,
        reach: (f32, f32),
        (width, height): (f32, f32),
    ) -> Option<Point> {
        // Right, left, above, below, then the corners.
        let (x, y) = (centre.x, centre.y);
        let (left, right) = (x - reach.0 - width, x + reach.0);
        let (above, below) = (y - reach.1 - height, y + reach.1);
        let (across, down) = (x - width / 2.0, y - height / 2.0);
        let corners = [
            (right, down),
            (left, down),
            (across, above),
            (across, below),
            (right, above),
            (right, below),
            (left, above),
            (left, below),
        ];
        let free = |&(x, y): &(f32, f32)| {
            let rect = Rect::from_xywh(x, y, width, height)?;
            let inside = rect.left() >= self.panel.left()
                && rect.right() <= self.panel.right()
                && rect.top() >= self.panel.top()
                && rect.bottom() <= self.panel.bottom();
            (inside && !self.taken.iter().any(|other| overlap(&rect, other))).then_some(rect)
        };
        let rect = corners.iter().find_map(free)?;
        self.taken.push(rect);
        Some(Point::from_xy(rect.left(), rect.top()))
    }
}

/// Whether two boxes share more than an edge.
fn overlap(a: &Rect, b: &Rect) -> bool {
    a.left() < b.right() && b.left() < a.right() && a.top() < b.bottom() && b.top() < a.bottom()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_go_elsewhere_or_nowhere_when_there_is_no_room() {
        let mut labels = Labels::new(Rect::from_ltrb(0.0, 0.0, 100.0, 40.0).unwrap());
        let centre = Point::from_xy(50.0, 20.0);
        labels.take(centre, 3.0);
        let places: Vec<_> = (0..9).map(|_| labels.place(centre, (5.0, 5.0), (40.0, 10.0))).collect();
        assert_eq!(places[0], Some(Point::from_xy(55.0, 15.0)), "right of it first");
        assert_eq!(places[1], Some(Point::from_xy(5.0, 15.0)), "then left");
        assert_eq!(places[2], Some(Point::from_xy(30.0, 5.0)), "then above");
        assert_eq!(places[3], Some(Point::from_xy(30.0, 25.0)), "then below");
        assert_eq!(places[8], None);
    }
}
