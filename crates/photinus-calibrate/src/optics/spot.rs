//! Where a spot is, how much light it has and on what level it stands: weighted least squares with a table.

use nalgebra::{SMatrix, SVector};

use super::ground::{self, Ground};
use super::noise::Noise;
use super::table::{FARTHEST_PX, Shares, Table};
use super::window::Window;

/// A spot as far as it is known.
#[derive(Clone, Debug)]
pub(super) struct Spot<'a> {
    pub(super) window: &'a Window,
    /// Pixels that are full, or beside one that is: they do not say how much light they got.
    full: Option<Box<[bool]>>,
    /// Place from the middle of the window, px.
    pub(super) u: f64,
    pub(super) v: f64,
    /// Light, grey levels.
    pub(super) light: f64,
    /// Level that it stands on at the middle of the window, grey levels.
    pub(super) level: f64,
    /// How it rises and bends from there.
    pub(super) ground: Ground,
    /// Weighted squares of what is left, per degree of freedom.
    pub(super) misfit: f64,
    /// Whether it is one of the spots that the table explains.
    pub(super) is_used: bool,
}

/// A pixel of a spot with what is expected of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pixel {
    pub(super) column: isize,
    pub(super) row: isize,
    /// Expected light above the level, grey levels.
    pub(super) light: f64,
    /// What is left of the value, grey levels.
    pub(super) left: f64,
    /// One over its variance.
    pub(super) weight: f64,
    /// How its value changes with place, light and level of the spot.
    pub(super) jacobian: SVector<f64, 4>,
}

/// Darkness that is cut off but for this share of its readings tells nothing.
const LEAST_TOLD: f64 = 0.1;
/// A spot with full pixels is used where the others tell its light to this share of it.
const LIGHT_TOLD: f64 = 0.1;
/// A pixel farther off than this many sigmas counts as so far off.
const CLIP: f64 = 4.0;

/// The spots of windows; pixels from grey level `full_from` on are full.
pub(super) fn of(windows: &[Window], full_from: u8) -> Vec<Spot<'_>> {
    let spot = |(window, ground)| Spot::new(window, ground, full_from);
    windows.iter().zip(ground::under(windows)).map(spot).collect()
}

impl<'a> Spot<'a> {
    fn new(window: &'a Window, ground: Ground, full_from: u8) -> Self {
        let level = f64::from(window.border());
        let above = |(column, row, value): (isize, isize, u8)| {
            f64::from(value) - level - ground.above_middle(column, row)
        };
        let (mut light, mut u, mut v) = (0.0, 0.0, 0.0);
        for (column, row, value) in window.within(4) {
            let above = above((column, row, value));
            light += above;
            if column.abs().max(row.abs()) <= 1 {
                u += above.max(0.0) * column as f64;
                v += above.max(0.0) * row as f64;
            }
        }
        let middle: f64 = window.within(1).map(|pixel| above(pixel).max(0.0)).sum();
        let full = (window.peak() >= full_from).then(|| full_or_beside(window, full_from));
        let (u, v) = (u / middle.max(1.0), v / middle.max(1.0));
        Self { window, full, u, v, light: light.max(middle), level, ground, misfit: 0.0, is_used: true }
    }

    /// Whether no pixel of it is full.
    pub(super) fn is_linear(&self) -> bool {
        self.full.is_none()
    }

    /// Place in the image, px.
    pub(super) fn place_px(&self) -> [f64; 2] {
        [self.window.column as f64 + self.u, self.window.row as f64 + self.v]
    }

    /// Fits place, light and level in this many steps; a fit that leads nowhere makes the spot one that is not used.
    pub(super) fn fit(
        &mut self,
        table: &Table,
        noise: &Noise,
        reach: usize,
        steps: usize,
        shares: &mut Shares,
    ) {
        let mut light_sigma = f64::INFINITY;
        for _ in 0..steps {
            let mut normal = SMatrix::<f64, 4, 4>::zeros();
            let mut right = SVector::<f64, 4>::zeros();
            self.each_pixel(table, noise, reach, shares, |pixel| {
                let off = pixel.left * pixel.weight.sqrt();
                let weight = pixel.weight * (CLIP / off.abs().max(CLIP));
                normal += pixel.jacobian * pixel.jacobian.transpose() * weight;
                right += pixel.jacobian * (pixel.left * weight);
            });
            let Some(factor) = normal.cholesky() else {
                self.is_used = false;
                return;
            };
            let step = factor.solve(&right);
            light_sigma = factor.inverse()[(2, 2)].max(0.0).sqrt();
            self.u = (self.u + step[0].clamp(-0.4, 0.4)).clamp(-FARTHEST_PX, FARTHEST_PX);
            self.v = (self.v + step[1].clamp(-0.4, 0.4)).clamp(-FARTHEST_PX, FARTHEST_PX);
            self.light = (self.light + step[2]).max(0.1 * self.light.abs().max(1.0));
            self.level += step[3];
        }
        let (mut squares, mut count) = (0.0, 0.0);
        self.each_pixel(table, noise, reach, shares, |pixel| {
            squares += pixel.left * pixel.left * pixel.weight;
            count += 1.0;
        });
        self.misfit = squares / f64::max(count - 4.0, 1.0);
        let is_inside = self.u.abs().max(self.v.abs()) < 0.95 * FARTHEST_PX;
        let is_told = self.is_linear() || light_sigma < LIGHT_TOLD * self.light;
        self.is_used = is_inside && is_told && self.misfit.is_finite() && self.light.is_finite();
    }

    /// Hands over every pixel within reach that tells its light.
    pub(super) fn each_pixel(
        &self,
        table: &Table,
        noise: &Noise,
        reach: usize,
        shares: &mut Shares,
        mut take: impl FnMut(&Pixel),
    ) {
        let reach = reach.min(self.window.reach);
        table.window(self.u, self.v, reach, shares);
        for (column, row, value) in self.window.within(reach) {
            if self.full.as_ref().is_some_and(|full| full[index(column, row)]) {
                continue;
            }
            let share = shares.at(column, row);
            let light = self.light * share.value;
            let level = self.level + self.ground.above_middle(column, row);
            let expected = level + light;
            let (left, variance, slope) = match noise.read(expected, noise.variance(light)) {
                Some(read) if value == 0 && read.slope < LEAST_TOLD => continue,
                None if value == 0 && expected < 0.5 => continue,
                Some(read) => (
                    (f64::from(value) - read.mean) / read.slope,
                    read.variance / (read.slope * read.slope),
                    1.0,
                ),
                None => {
                    let (seen, slope) = noise.straightened(f64::from(value) - level);
                    (seen - light, noise.variance(light) + noise.dark * (slope * slope - 1.0), slope)
                }
            };
            take(&Pixel {
                column,
                row,
                light,
                left,
                weight: 1.0 / variance,
                jacobian: SVector::from([
                    self.light * share.by_u,
                    self.light * share.by_v,
                    share.value,
                    slope,
                ]),
            });
        }
    }

    /// Its pixels, and how well they tell place, light and level; `None` where they do not tell all of these.
    pub(super) fn told(&self, table: &Table, noise: &Noise, reach: usize) -> Option<Told> {
        let mut pixels = Vec::new();
        let mut normal = SMatrix::<f64, 4, 4>::zeros();
        self.each_pixel(table, noise, reach, &mut Shares::default(), |pixel| {
            normal += pixel.jacobian * pixel.jacobian.transpose() * pixel.weight;
            pixels.push(*pixel);
        });
        Some(Told { pixels, covariance: normal.try_inverse()? })
    }
}

/// What the pixels of a spot tell of it.
#[derive(Clone, Debug)]
pub(super) struct Told {
    pub(super) pixels: Vec<Pixel>,
    /// Of place, light and level.
    pub(super) covariance: SMatrix<f64, 4, 4>,
}

impl Told {
    /// Standard deviation of the light, grey levels.
    pub(super) fn light_sigma(&self) -> f64 {
        self.covariance[(2, 2)].max(0.0).sqrt()
    }

    /// The share of a pixel's noise that the fit of this spot takes away.
    pub(super) fn taken(&self, pixel: &Pixel) -> f64 {
        pixel.weight * (pixel.jacobian.transpose() * self.covariance * pixel.jacobian)[0]
    }
}

/// Marks pixels that are full and those around them.
fn full_or_beside(window: &Window, full_from: u8) -> Box<[bool]> {
    let mut marked = vec![false; window.pixels.len()].into_boxed_slice();
    let most = super::window::REACH as isize;
    for (column, row, _) in window.within(window.reach).filter(|(.., value)| *value >= full_from) {
        for (right, down) in (-1..=1).flat_map(|down| (-1..=1).map(move |right| (right, down))) {
            let (column, row) = (column + right, row + down);
            if column.abs().max(row.abs()) <= most {
                marked[index(column, row)] = true;
            }
        }
    }
    marked
}

fn index(column: isize, row: isize) -> usize {
    let at = |offset: isize| (super::window::REACH as isize + offset) as usize;
    at(row) * super::window::SIDE + at(column)
}

#[cfg(test)]
mod tests {
    use photinus::optics::Gaussian;

    use super::super::window::{SIDE, Seen};
    use super::*;

    /// A bright spot on level 6 as a table has it, cut off at 255.
    fn window(table: &Table, light: f64) -> Window {
        let mut shares = Shares::default();
        table.window(0.2, -0.1, super::super::window::REACH, &mut shares);
        let read =
            |share: &super::super::table::Share| (6.0 + light * share.value).round().clamp(0.0, 255.0) as u8;
        let pixels: Box<[u8]> = shares.of_pixels.iter().map(read).collect();
        assert_eq!(pixels.len(), SIDE * SIDE);
        let reach = super::super::window::REACH;
        Window { column: 100, row: 100, reach, seen: Seen::default(), pixels }
    }

    #[test]
    fn a_full_spot_is_used_where_the_pixels_around_it_tell_its_light() {
        let noise = Noise { dark: 0.45, shot: 0.03, shape: 0.02, bend: 0.0, is_dark_seen: true };
        let core = |share: f64| Gaussian { share, sigma_px: 0.3 };
        let halo = Gaussian { share: 0.5, sigma_px: 2.3 };
        for (table, is_told) in
            [(Table::gaussians(&[core(1.0)]), false), (Table::gaussians(&[core(0.5), halo]), true)]
        {
            let windows = [window(&table, 2000.0)];
            let mut spot = of(&windows, 255).remove(0);
            assert!(!spot.is_linear());
            spot.fit(&table, &noise, 8, 8, &mut Shares::default());
            assert_eq!(spot.is_used, is_told, "{spot:?}");
            assert!(!is_told || (spot.light / 2000.0 - 1.0).abs() < 0.05, "{}", spot.light);
        }
    }
}
