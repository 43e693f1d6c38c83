//! Two points so near each other that neither is seen alone: fitted together.
//!
//! In: two parts, each the other's nearest. Out: centre and light of both. Fitted in turn, each would take the other's error for light of its
//! own, and lean towards it; fitted together, what cannot be told apart is in the covariances.

use nalgebra::{Matrix2, SVector};

use super::beside::{Beside, Guess};
use super::fit::{self, Fitted, PointSource, WIDTH};
use super::fitting::{Fitter, Model, Point, radius_px, spread, surroundings_at};
use super::neighbourhood::Neighbourhood;
use super::part::Part;
use super::window::WIDEST_PX;
use crate::camera::Pixel;
use crate::frame::FrameView;

/// Points further apart than this many resolutions, and with more than this between what is bright of them, px, are fitted one by one.
const NEAR: f64 = 2.5;
const BETWEEN_PX: f64 = 2.0;
/// Two points of the same size, and their numbers.
type Pair<'a> = Beside<PointSource<'a>, PointSource<'a>, { WIDTH + 1 }, { WIDTH + 1 }>;
const NUMBERS: usize = WIDTH + 4;

impl Fitter {
    /// The part that part `index` is to be fitted together with: the nearest, if this one is its nearest, too.
    pub(super) fn twin(&self, parts: &[Part], index: usize, near: &Neighbourhood) -> Option<usize> {
        let nearest = |from: usize| {
            let by_resolution_px = NEAR * self.resolution_px;
            let by_brightness_px = |edge_px: f64| edge_px < parts[from].radius_px + BETWEEN_PX;
            let reach_px = by_resolution_px.max(parts[from].radius_px + BETWEEN_PX);
            let mut nearest = (f64::INFINITY, None);
            near.each_near(from, reach_px, |other, edge_px| {
                let gap_px = gap_px(parts[from].guess, parts[other].guess);
                let is_near = gap_px < by_resolution_px || by_brightness_px(edge_px);
                if is_near && gap_px < nearest.0 && self.may_be_point(&parts[other]) {
                    nearest = (gap_px, Some(other));
                }
            });
            nearest.1
        };
        nearest(index).filter(|&other| nearest(other) == Some(index))
    }

    /// Two parts as two points; `None` where they are none.
    pub(super) fn pair(
        &mut self,
        frame: &FrameView<'_>,
        parts: &[Part],
        [one, other]: [usize; 2],
        near: &Neighbourhood,
        full_from: u8,
    ) -> Option<[Model; 2]> {
        let both = [&parts[one], &parts[other]];
        let middle =
            Pixel::new(0.5 * (both[0].guess.u + both[1].guess.u), 0.5 * (both[0].guess.v + both[1].guess.v));
        let radius_px =
            radius_px(both[0]).max(radius_px(both[1])) + 0.5 * gap_px(both[0].guess, both[1].guess);
        let window_px = radius_px.min(WIDEST_PX as f64);
        let around = surroundings_at(frame, both[0], middle, window_px, &self.window.cut_off);
        self.read(frame, middle, window_px, &around, full_from);
        self.add_others(one, Some(other), window_px, near);
        let noise = self.window_noise(around);
        let places = both.map(|part| self.window.local(part.guess));
        let is_full = both.iter().any(|part| part.outline.peak >= full_from);
        let lights = both.map(|part| part.seeming_light(around.level, is_full));
        let flux = self.window.flux().max(2.0);
        let light = flux * lights[0] / (lights[0] + lights[1]);
        let spread = spread(self.optics.as_deref(), &self.belief, middle);
        let point = PointSource::new(spread, self.source_size(), self.spill());
        let second = Guess { place_px: places[1], ln_ratio: libm::log(lights[1] / lights[0]) };
        let mut pair: Pair<'_> = Beside::new(point, point, second);
        let guess = (places[0].0, places[0].1, light);
        let fitted: Fitted<NUMBERS> = fit::fit(&mut self.window, &mut pair, guess, noise)?;
        let points = points(&fitted)
            .map(|point| Point { centre: self.window.place(point.centre.u, point.centre.v), ..point });
        let is_within = |(point, part): (&Point, &Part)| {
            libm::hypot(point.centre.u - part.guess.u, point.centre.v - part.guess.v)
                < part.radius_px.max(1.0)
        };
        if !points.iter().zip(both).all(is_within) {
            return None;
        }
        let model = |point: &Point| {
            let model = self.point(point, &fitted, noise)?;
            Some(Model { is_of_pair: true, ..model })
        };
        Some([model(&points[0])?, model(&points[1])?])
    }
}

pub(super) fn gap_px(one: Pixel, other: Pixel) -> f64 {
    libm::hypot(one.u - other.u, one.v - other.v)
}

/// The two points of a fit, as seen from the middle of the window.
fn points(fitted: &Fitted<NUMBERS>) -> [Point; 2] {
    let Fitted { numbers, covariance, .. } = fitted;
    let times = libm::exp(numbers[Pair::RATIO]);
    let mut by_number = SVector::<f64, NUMBERS>::zeros();
    (by_number[fit::LIGHT], by_number[Pair::RATIO]) = (times, times * fitted.light());
    let first = Point {
        centre: Pixel::new(numbers[fit::U], numbers[fit::V]),
        covariance_px2: fitted.centre_covariance_px2(),
        light: fitted.light(),
        light_variance: fitted.light_variance(),
    };
    let second = Point {
        centre: Pixel::new(numbers[Pair::U], numbers[Pair::V]),
        covariance_px2: Matrix2::from_fn(|i, j| covariance[(Pair::U + i, Pair::U + j)]),
        light: times * fitted.light(),
        light_variance: (by_number.transpose() * covariance * by_number)[0],
    };
    [first, second]
}
