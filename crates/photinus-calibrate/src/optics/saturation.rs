//! Where pixels are full: grey levels at which the brightest pixels of spots pile up.
//!
//! Lights of all brightnesses have summits of all heights; a sensor that is full gathers those above its level there.
//! Nothing lies above the pile, so its upper half tells its width.

use super::window::Window;

/// Grey levels of full pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pile {
    /// Mean.
    pub(super) level_dn: f64,
    /// Standard deviation of single pixels.
    pub(super) spread_dn: f64,
    /// Standard deviation of the mean.
    pub(super) sigma_dn: f64,
    /// Spots that have a full pixel.
    pub(super) count: usize,
}

/// A pile holds at least this many summits.
const LEAST: f64 = 12.0;
/// Darker than this, no sensor is full.
const LOWEST: usize = 100;
/// Width of what is compared, grey levels.
const WIDTH: usize = 12;

impl Pile {
    /// Lowest grey level of a full pixel.
    pub(super) fn least_dn(&self) -> u8 {
        (self.level_dn - 3.0 * self.spread_dn - 0.5).ceil().clamp(1.0, 255.0) as u8
    }
}

/// How many summits have each grey level.
pub(super) fn summits(windows: &[Window]) -> [u32; 256] {
    let mut counts = [0; 256];
    windows.iter().for_each(|window| counts[usize::from(window.middle())] += 1);
    counts
}

/// The pile of the brightest summits; `None` where they do not pile up.
pub(super) fn find(counts: &[u32; 256]) -> Option<Pile> {
    let top = counts.iter().rposition(|&count| count > 0)?;
    if top < LOWEST {
        return None;
    }
    let sum = |from: usize, to: usize| counts[from..to].iter().map(|&count| f64::from(count)).sum::<f64>();
    // the fullest stretch near the top against the two below it: heights thin out slowly, a pile stands
    let first = |from: usize| from.saturating_sub(WIDTH - 1);
    let lowest = top.saturating_sub(2 * WIDTH).max(LOWEST);
    let end = (lowest..=top).max_by(|&a, &b| sum(first(a), a + 1).total_cmp(&sum(first(b), b + 1)))?;
    let start = first(end);
    let inside = sum(start, top + 1);
    let below = 0.5 * sum(start.saturating_sub(2 * WIDTH), start);
    if inside < LEAST || inside < 2.0 * below + 4.0 * below.sqrt() {
        return None;
    }
    let level = mode(counts, start, top);
    Some(measure(counts, level, start, top))
}

/// The highest place of the pile, smoothed.
fn mode(counts: &[u32; 256], start: usize, top: usize) -> usize {
    let smooth = |at: usize| -> u32 {
        let from = at.saturating_sub(1);
        counts[from..=(at + 1).min(255)].iter().sum::<u32>() + counts[at]
    };
    (start..=top).max_by_key(|&at| smooth(at)).unwrap_or(top)
}

/// Mean and width: the middle is where what lies above mirrors what lies below.
fn measure(counts: &[u32; 256], mode: usize, start: usize, top: usize) -> Pile {
    let mut level = mode as f64;
    let (mut spread, mut count) = (0.0_f64, 0.0);
    for _ in 0..8 {
        let (mut number, mut sum, mut square) = (0.0, 0.0, 0.0);
        let reach = (3.0 * spread).max(2.5);
        for (grey, &times) in counts.iter().enumerate().take(top + 1).skip(start.saturating_sub(WIDTH)) {
            let off = grey as f64 - level;
            if off.abs() <= reach {
                let times = f64::from(times);
                (number, sum, square) = (number + times, sum + times * off, square + times * off * off);
            }
        }
        let mean = sum / f64::max(number, 1.0);
        level += mean;
        spread = (square / f64::max(number, 1.0) - mean * mean).max(0.0).sqrt();
        count = number;
    }
    Pile {
        level_dn: level,
        spread_dn: spread,
        sigma_dn: (spread * spread + 1.0 / 12.0).sqrt() / f64::max(count, 1.0).sqrt(),
        count: count as usize,
    }
}
