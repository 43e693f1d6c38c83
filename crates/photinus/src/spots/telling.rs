//! Which spots of a frame tell of a camera that nobody measured.
//!
//! In: the parts of a frame. Out: those that are plain and bright, each by itself if it stands alone. Where none does, those beside one or two others, which
//! are fitted together: far away all of a vehicle's markers are as near to each other as their light reaches.

use alloc::vec::Vec;

use super::beside::Guess;
use super::fitting::{Fitter, WIDEST_POINT_PX, radius_px, surroundings_at};
use super::neighbourhood::Neighbourhood;
use super::pairs::gap_px;
use super::part::Part;
use super::patch::Surroundings;
use super::window::WIDEST_PX;
use crate::camera::Pixel;
use crate::frame::FrameView;

/// A spot with less contrast than this says little of the spread, grey levels.
const TELLING_DN: f64 = 30.0;
/// Nor one that noise may have made, sigmas.
const TELLING_SIGMAS: f64 = 6.0;
/// The light of a spot reaches no further than this, px.
const ALONE_PX: f64 = 9.0;
/// So many are fitted together at most, ...
const MOST_TOGETHER: usize = 3;
/// ... looked for among so many, for where there are more it is clutter, ...
const MOST_LOOKED_AT: usize = 320;
/// ... no nearer to each other than this, px: there may be more of them than were told apart.
const APART_PX: f64 = 3.0;

/// A spot that stands alone, or a few beside each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Telling {
    indices: [usize; MOST_TOGETHER],
    count: usize,
}

impl Telling {
    fn alone(index: usize) -> Self {
        Self { indices: [index; MOST_TOGETHER], count: 1 }
    }

    /// Whether it is a spot by itself.
    pub(super) fn is_alone(&self) -> bool {
        self.count == 1
    }

    fn indices(&self) -> &[usize] {
        &self.indices[..self.count]
    }

    /// The parts that it is of.
    pub(super) fn parts<'a>(&'a self, parts: &'a [Part]) -> impl Iterator<Item = &'a Part> + Clone {
        self.indices().iter().map(|&index| &parts[index])
    }

    /// All parts beside part `index` and beside these; none where they are more than can be fitted together.
    fn around(index: usize, parts: &[Part], near: &Neighbourhood) -> Option<Self> {
        let (mut all, mut done, mut too_many) = (Self::alone(index), 0, false);
        while done < all.count && !too_many {
            let from = all.indices[done];
            near.each_near(from, ALONE_PX + parts[from].radius_px, |other, edge_px| {
                let wider_px = (parts[from].radius_px - parts[other].radius_px).max(0.0);
                if edge_px - wider_px >= ALONE_PX || all.indices().contains(&other) {
                    return;
                }
                match all.indices.get_mut(all.count) {
                    Some(place) => (*place, all.count) = (other, all.count + 1),
                    None => too_many = true,
                }
            });
            done += 1;
        }
        all.indices[..all.count].sort_unstable();
        (!too_many).then_some(all)
    }

    /// Whether they lie apart, and within a window.
    fn can_be_fitted(&self, parts: &[Part]) -> bool {
        let pairs = self.parts(parts).enumerate();
        let apart = pairs.clone().all(|(first, one)| {
            pairs.clone().skip(first + 1).all(|(_, other)| gap_px(one.guess, other.guess) >= APART_PX)
        });
        apart && self.window(parts).1 <= WIDEST_PX as f64
    }

    /// The middle of a window on all of them, and how far it reaches, px.
    fn window(&self, parts: &[Part]) -> (Pixel, f64) {
        let (mut least, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for Part { guess, .. } in self.parts(parts) {
            for (axis, place) in [guess.u, guess.v].into_iter().enumerate() {
                (least[axis], most[axis]) = (least[axis].min(place), most[axis].max(place));
            }
        }
        let middle = Pixel::new(0.5 * (least[0] + most[0]), 0.5 * (least[1] + most[1]));
        let reach_px = |part: &Part| gap_px(part.guess, middle) + radius_px(part);
        (middle, self.parts(parts).map(reach_px).fold(0.0, f64::max))
    }
}

fn is_plain(part: &Part) -> bool {
    let height = f64::from(part.outline.peak) - f64::from(part.level);
    part.reason.is_none()
        && !part.outline.cut
        && part.radius_px < WIDEST_POINT_PX
        && height > TELLING_DN.max(TELLING_SIGMAS * part.noise_dn)
}

/// Finds the spots that stand alone.
pub(super) fn find(parts: &[Part], near: &Neighbourhood, telling: &mut Vec<Telling>) {
    let tells = |(index, part): &(usize, &Part)| is_plain(part) && near.room_px(*index, ALONE_PX) >= ALONE_PX;
    telling.clear();
    telling.extend(parts.iter().enumerate().filter(tells).map(|(index, _)| Telling::alone(index)));
}

/// Finds those beside each other, none of them full: full pixels read `full_from` or more.
pub(super) fn find_beside(parts: &[Part], near: &Neighbourhood, full_from: u8, telling: &mut Vec<Telling>) {
    let tells = |part: &Part| is_plain(part) && part.outline.peak < full_from;
    telling.clear();
    let bright = parts.iter().enumerate().filter(|(_, part)| tells(part)).map(|(index, _)| index);
    let together = bright
        .take(MOST_LOOKED_AT)
        .filter_map(|index| Telling::around(index, parts, near).filter(|all| all.indices[0] == index));
    telling.extend(
        together.filter(|all| all.count > 1 && all.parts(parts).all(tells) && all.can_be_fitted(parts)),
    );
}

impl Fitter {
    /// Opens the window on what tells.
    pub(super) fn open_telling(
        &mut self,
        frame: &FrameView<'_>,
        parts: &[Part],
        telling: &Telling,
        full_from: u8,
    ) -> Opened {
        let (first, all) = (&parts[telling.indices[0]], telling.parts(parts));
        if telling.is_alone() {
            let (_, around) = self.open(frame, first, f64::INFINITY, full_from);
            return Opened::alone(around, self.guess(first));
        }
        let (middle, window_px) = telling.window(parts);
        let around = surroundings_at(frame, first, middle, window_px, &self.window.cut_off);
        self.read(frame, middle, window_px, &around, full_from);
        let light = |part: &Part| part.seeming_light(around.level, false);
        let share = self.window.flux().max(telling.count as f64) / all.clone().map(light).sum::<f64>();
        let (u, v) = self.window.local(first.guess);
        let mut beside = [Guess::NOWHERE; MOST_TOGETHER - 1];
        for (guess, part) in beside.iter_mut().zip(all.skip(1)) {
            let ln_ratio = libm::log(light(part) / light(first));
            *guess = Guess { place_px: self.window.local(part.guess), ln_ratio };
        }
        Opened { around, guess: (u, v, share * light(first)), beside, count: telling.count - 1 }
    }
}

/// A window on what tells.
#[derive(Debug)]
pub(super) struct Opened {
    pub(super) around: Surroundings,
    /// Where the first spot is, px from the middle of the window, and its light.
    pub(super) guess: (f64, f64, f64),
    beside: [Guess; MOST_TOGETHER - 1],
    count: usize,
}

impl Opened {
    /// On one that stands alone.
    pub(super) fn alone(around: Surroundings, guess: (f64, f64, f64)) -> Self {
        Self { around, guess, beside: [Guess::NOWHERE; MOST_TOGETHER - 1], count: 0 }
    }

    /// The others.
    pub(super) fn beside(&self) -> &[Guess] {
        &self.beside[..self.count]
    }
}
