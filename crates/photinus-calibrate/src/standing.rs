//! Frames of a camera that moves -> what stays with the camera: its own airframe and LEDs, hot pixels, dirt that shines.
//!
//! In: each frame with what the detector found in it, rejected or not. Out: the pixels that were bright in most frames, with a margin: a mask. Whatever stays
//! in the scene moves through the image as the camera turns, and is not among them.

use photinus::frame::FrameView;
use photinus::spots::{Detections, Extent};

/// A pixel of something bright is at least so bright, as a share of its peak over its background.
const OF_PEAK: f64 = 0.25;

/// How often each pixel was bright.
#[derive(Clone, Debug)]
pub struct Standing {
    width: usize,
    height: usize,
    frames: u32,
    bright: Vec<u32>,
    /// The last frame that counted, by pixel: what two detections share counts once.
    counted: Vec<u32>,
}

/// Pixels to ignore.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StandingMask {
    /// By row: 0 where nothing is to be looked for, 255 elsewhere.
    pub pixels: Vec<u8>,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// How many places stay, margins touching counted as one.
    pub places: usize,
}

impl Standing {
    /// Nothing yet, of frames of this size, px.
    pub fn new(width: usize, height: usize) -> Self {
        let pixels = width * height;
        Self { width, height, frames: 0, bright: vec![0; pixels], counted: vec![0; pixels] }
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// How many frames were added.
    pub fn frames(&self) -> u32 {
        self.frames
    }

    /// Adds a frame of that size, with what was found in it.
    pub fn add(&mut self, frame: &FrameView<'_>, found: &Detections) {
        self.frames += 1;
        for spot in &found.spots {
            self.count(frame, &spot.extent, spot.background, spot.peak);
        }
        for rejected in &found.rejected {
            self.count(frame, &rejected.extent, 0.0, rejected.peak);
        }
    }

    fn count(&mut self, frame: &FrameView<'_>, extent: &Extent, background: f64, peak: u8) {
        let level = background + OF_PEAK * (f64::from(peak) - background);
        let rows = extent.top as usize..=(extent.bottom as usize).min(self.height - 1);
        for v in rows {
            let columns = extent.left as usize..=(extent.right as usize).min(self.width - 1);
            for u in columns.filter(|&u| f64::from(frame.row(v)[u]) >= level) {
                let pixel = v * self.width + u;
                if self.counted[pixel] != self.frames {
                    self.counted[pixel] = self.frames;
                    self.bright[pixel] += 1;
                }
            }
        }
    }

    /// The pixels that were bright in at least this share of the frames, 0 to 1, and those up to `margin_px` around them.
    pub fn mask(&self, share: f64, margin_px: usize) -> StandingMask {
        let least = (share * f64::from(self.frames)).max(1.0);
        let mut pixels = vec![255; self.bright.len()];
        let reach = margin_px as isize;
        let stays = (0..self.bright.len()).filter(|&pixel| f64::from(self.bright[pixel]) >= least);
        for pixel in stays {
            let (u, v) = (pixel % self.width, pixel / self.width);
            for dv in -reach..=reach {
                for du in (-reach..=reach).filter(|du| du * du + dv * dv <= reach * reach) {
                    if let Some(near) = self.pixel(u.checked_add_signed(du), v.checked_add_signed(dv)) {
                        pixels[near] = 0;
                    }
                }
            }
        }
        let places = places(&pixels, self.width);
        StandingMask { pixels, width: self.width, height: self.height, places }
    }

    fn pixel(&self, u: Option<usize>, v: Option<usize>) -> Option<usize> {
        let (u, v) = (u.filter(|&u| u < self.width)?, v.filter(|&v| v < self.height)?);
        Some(v * self.width + u)
    }
}

impl StandingMask {
    /// The share of the image that is ignored.
    pub fn ignored(&self) -> f64 {
        self.pixels.iter().filter(|&&pixel| pixel == 0).count() as f64 / self.pixels.len() as f64
    }
}

/// How many places of pixels that are 0 there are, neighbours by side or corner being one.
fn places(pixels: &[u8], width: usize) -> usize {
    let mut seen = vec![false; pixels.len()];
    let mut places = 0;
    let mut open = Vec::new();
    for start in 0..pixels.len() {
        if pixels[start] != 0 || seen[start] {
            continue;
        }
        places += 1;
        seen[start] = true;
        open.push(start);
        while let Some(pixel) = open.pop() {
            let (u, v) = (pixel % width, pixel / width);
            for (du, dv) in [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)] {
                let (Some(u), Some(v)) = (u.checked_add_signed(du), v.checked_add_signed(dv)) else {
                    continue;
                };
                let near = v * width + u;
                if u < width && near < pixels.len() && pixels[near] == 0 && !seen[near] {
                    seen[near] = true;
                    open.push(near);
                }
            }
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use photinus::spots::{Detector, Settings};

    use super::*;

    const SIZE: [usize; 2] = [160, 120];

    /// A frame with a neighbour's LED that wanders, two hot pixels, and a bright arm at the border.
    fn frame(number: usize) -> Vec<u8> {
        let mut pixels = vec![3; SIZE[0] * SIZE[1]];
        let mut blob = |u: usize, v: usize, half: usize| {
            for row in v - half..=v + half {
                pixels[row * SIZE[0]..][u - half..=u + half].fill(200);
            }
        };
        blob(20 + 2 * number, 40 + number % 7, 1);
        blob(30, 90, 0);
        blob(120, 20, 0);
        for v in 100..120 {
            pixels[v * SIZE[0]..][154..SIZE[0]].fill(250);
        }
        pixels
    }

    fn after(frames: usize) -> Standing {
        let mut standing = Standing::new(SIZE[0], SIZE[1]);
        let mut detector = Detector::new(Settings::default()).unwrap();
        for number in 0..frames {
            let pixels = frame(number);
            let view = FrameView::packed(&pixels, SIZE[0], SIZE[1]).unwrap();
            standing.add(&view, detector.detect(&view, None).unwrap());
        }
        standing
    }

    #[test]
    fn what_stays_is_masked_and_what_moves_is_not() {
        let mask = after(50).mask(0.5, 2);
        let ignores = |u: usize, v: usize| mask.pixels[v * SIZE[0] + u] == 0;
        assert_eq!(mask.places, 3);
        for (u, v) in [(30, 90), (32, 90), (120, 20), (154, 100), (159, 119), (153, 105)] {
            assert!(ignores(u, v), "{u} {v}");
        }
        for (u, v) in [(33, 90), (70, 43), (120, 24), (150, 110)] {
            assert!(!ignores(u, v), "{u} {v}");
        }
        assert!((0.008..0.02).contains(&mask.ignored()), "{}", mask.ignored());
    }

    #[test]
    fn nothing_is_masked_of_frames_in_which_nothing_stays() {
        let mut standing = Standing::new(SIZE[0], SIZE[1]);
        let mut detector = Detector::new(Settings::default()).unwrap();
        for number in 0..50 {
            let mut pixels = vec![3; SIZE[0] * SIZE[1]];
            pixels[(30 + number) * SIZE[0]..][10 + 2 * number..13 + 2 * number].fill(180);
            let view = FrameView::packed(&pixels, SIZE[0], SIZE[1]).unwrap();
            standing.add(&view, detector.detect(&view, None).unwrap());
        }
        let mask = standing.mask(0.5, 2);
        assert_eq!((mask.places, mask.ignored()), (0, 0.0));
        assert_eq!(standing.frames(), 50);
    }
}
