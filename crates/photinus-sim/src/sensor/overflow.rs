//! Charge above the full well spills into the four neighbours; part of it is drained.
//!
//! A pixel above its well gives all the excess away: `spill` of it in equal parts to the neighbours, the rest to the
//! anti-blooming drain, and so on until none is above. Without a drain this is the divisible sandpile, whose limit shape is
//! a disc (L. Levine, Y. Peres, Potential Analysis 30, 2009), so that the area of an overflown spot grows with its energy,
//! as the paper's (13) does.

use super::Charge;

/// What becomes of charge above the full well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overflow {
    /// Share of a pixel's excess that reaches its neighbours, 0 to 1; the rest is drained. With 1 charge ends only past the
    /// borders of the image.
    pub spill: f64,
}

/// Where charge went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Overflown {
    /// Electrons that were drained.
    pub drained_e: f64,
    /// Electrons that left the image.
    pub lost_e: f64,
}

impl Overflow {
    /// Excess below this share of the full well stays: it changes no grey level.
    const TOLERANCE: f32 = 1e-3;

    /// Radius of the disc of full pixels that `wells` full wells of charge in one place make, px.
    ///
    /// Where s is spilled and the rest drained, the charge u that leaves a pixel obeys s/4 lap u - (1 - s) u = well: Bessel
    /// functions of r / d with d^2 = s / 4(1 - s). That u and its slope vanish at the border R gives
    /// x I1(x) = 2 wells (1 - s) / (pi s), x = R / d; without a drain the disc holds it all. A spill past 0.99 counts as none
    /// drained.
    pub fn full_radius_px(&self, wells: f64) -> f64 {
        const UNDRAINED: f64 = 0.99;
        if self.spill <= 0.0 || wells <= 0.0 {
            return 0.0;
        }
        if self.spill > UNDRAINED {
            return (wells / core::f64::consts::PI).sqrt();
        }
        let goal = 2.0 * wells * (1.0 - self.spill) / (core::f64::consts::PI * self.spill);
        let (mut low, mut high) = (0.0, 100.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if middle * bessel_i1(middle) < goal { low = middle } else { high = middle }
        }
        low * (self.spill / (4.0 * (1.0 - self.spill))).sqrt()
    }

    /// Lets charge overflow until no pixel holds more than `full_well_e`.
    pub fn settle(&self, charge: &mut Charge, full_well_e: f64) -> Overflown {
        self.settle_each(charge, |_, _| full_well_e as f32)
    }

    /// The same with a full well of each pixel's own, electrons, by column and row.
    pub fn settle_each(&self, charge: &mut Charge, well_e: impl Fn(usize, usize) -> f32) -> Overflown {
        const ABOVE: f32 = 1.0 + Overflow::TOLERANCE;
        let mut full: Vec<(usize, usize)> = Vec::new();
        for v in 0..charge.height() {
            let Some((first, pixels)) = charge.touched_row_mut(v) else { continue };
            let above = pixels.iter().enumerate().filter(|(i, e)| **e > well_e(first + i, v) * ABOVE);
            full.extend(above.map(|(i, _)| (first + i, v)));
        }
        let mut gone = Overflown::default();
        let mut next = Vec::new();
        while !full.is_empty() {
            for &place in &full {
                self.topple(charge, place, &well_e, &mut next, &mut gone);
            }
            full.clear();
            std::mem::swap(&mut full, &mut next);
        }
        gone
    }

    fn topple(
        &self,
        charge: &mut Charge,
        (u, v): (usize, usize),
        well_e: &impl Fn(usize, usize) -> f32,
        next: &mut Vec<(usize, usize)>,
        gone: &mut Overflown,
    ) {
        let well = well_e(u, v);
        let excess = charge.at(u, v) - well;
        if excess <= well * Self::TOLERANCE {
            return; // listed twice, and toppled already
        }
        charge.add(u, v, -excess);
        let part = excess * self.spill as f32 * 0.25;
        gone.drained_e += f64::from(excess - 4.0 * part);
        let (left, up) = (u.checked_sub(1), v.checked_sub(1));
        let (right, down) =
            (Some(u + 1).filter(|u| *u < charge.width()), Some(v + 1).filter(|v| *v < charge.height()));
        for place in [left.map(|u| (u, v)), right.map(|u| (u, v)), up.map(|v| (u, v)), down.map(|v| (u, v))] {
            match place {
                None => gone.lost_e += f64::from(part),
                Some((u, v)) => {
                    let limit = well_e(u, v) * (1.0 + Self::TOLERANCE);
                    let before = charge.at(u, v);
                    if charge.add(u, v, part) > limit && before <= limit {
                        next.push((u, v));
                    }
                }
            }
        }
    }
}

/// The modified Bessel function of order 1, by its series: terms (x/2)^(2k+1) / (k! (k+1)!).
fn bessel_i1(x: f64) -> f64 {
    let (mut term, mut sum) = (0.5 * x, 0.0);
    for k in 1..300_u32 {
        sum += term;
        term *= 0.25 * x * x / (f64::from(k) * f64::from(k + 1));
        if term < 1e-12 * sum {
            break;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settle(spill: f64, electrons: f32, at: (usize, usize)) -> (Charge, Overflown) {
        let mut charge = Charge::new(41, 41);
        charge.add(at.0, at.1, electrons);
        let gone = Overflow { spill }.settle(&mut charge, 1000.0);
        (charge, gone)
    }

    #[test]
    fn charge_is_conserved_but_for_what_is_drained_or_leaves_the_image() {
        for (spill, electrons, at) in
            [(0.9, 20_000.0, (20, 20)), (0.999, 60_000.0, (20, 20)), (0.99, 60_000.0, (0, 3))]
        {
            let (charge, gone) = settle(spill, electrons, at);
            let sum = charge.total() + gone.drained_e + gone.lost_e;
            assert!((sum / f64::from(electrons) - 1.0).abs() < 1e-4, "{sum} {gone:?}");
            assert!(gone.drained_e > 0.0);
            assert_eq!(gone.lost_e > 0.0, at == (0, 3));
            let brightest = (0..41).flat_map(|v| charge.row(v).to_vec()).fold(0.0, f32::max);
            assert!(brightest <= 1001.1, "{brightest}");
        }
    }

    #[test]
    fn what_is_kept_drained_and_spilled_sums_to_what_came_for_any_share_and_unequal_wells() {
        for spill in [0.0, 0.25, 0.5, 1.0] {
            let mut charge = Charge::new(41, 41);
            charge.add(20, 20, 9000.0);
            charge.add(21, 20, 4000.0);
            let well_e = |u: usize, v: usize| 1000.0 + 10.0 * ((7 * u + 13 * v) % 5) as f32;
            let gone = Overflow { spill }.settle_each(&mut charge, well_e);
            let sum = charge.total() + gone.drained_e + gone.lost_e;
            assert!((sum / 13_000.0 - 1.0).abs() < 1e-5, "{sum}");
            for v in 0..41 {
                (0..41).for_each(|u| assert!(charge.at(u, v) <= well_e(u, v) * 1.0011));
            }
            if spill <= 0.0 {
                let kept = well_e(20, 20) + well_e(21, 20);
                assert!((charge.total() - f64::from(kept)).abs() < 1e-2, "all the excess is drained");
            }
            assert_eq!(gone.drained_e < 1.0, spill >= 1.0, "nothing is drained where all is spilled");
        }
    }

    #[test]
    fn the_disc_of_a_bright_light_is_as_wide_as_its_charge_makes_it() {
        for (spill, wells) in [(1.0, 1500.0), (0.98, 3000.0), (0.95, 10_000.0), (0.9, 1e5), (0.5, 1e4)] {
            let mut charge = Charge::new(101, 101);
            charge.add(50, 50, wells as f32 * 1000.0);
            Overflow { spill }.settle(&mut charge, 1000.0);
            let full = (0..101).map(|v| charge.row(v).iter().filter(|e| **e > 500.0).count()).sum::<usize>();
            let radius_px = (full as f64 / core::f64::consts::PI).sqrt();
            let expected_px = Overflow { spill }.full_radius_px(wells);
            // pixels of half a pixel of border count or not
            assert!(
                (radius_px - expected_px).abs() < 0.6 + 0.05 * expected_px,
                "{radius_px} {expected_px} at {spill}"
            );
        }
        assert!(Overflow { spill: 0.0 }.full_radius_px(1e6) <= 0.0);
    }

    #[test]
    fn one_overflow_gives_each_neighbour_a_quarter() {
        let (charge, gone) = settle(0.8, 2000.0, (20, 20));
        for (u, v) in [(19, 20), (21, 20), (20, 19), (20, 21)] {
            assert!((charge.at(u, v) - 200.0).abs() < 0.01);
        }
        assert!((gone.drained_e - 200.0).abs() < 0.01);
    }

    #[test]
    fn nearly_undrained_charge_fills_a_disc_whose_area_is_its_energy() {
        let (charge, _) = settle(0.9999, 200_000.0, (20, 20));
        let mut full = Vec::new();
        for v in 0..41 {
            full.extend(
                (0..41).filter(|&u| charge.at(u, v) > 900.0).map(|u| (u as f64 - 20.0, v as f64 - 20.0)),
            );
        }
        assert!((170..=200).contains(&full.len()), "{}", full.len());
        let farthest = full.iter().map(|(x, y)| libm::hypot(*x, *y)).fold(0.0, f64::max);
        assert!(farthest < 9.0, "a disc of 200 px has a radius of 8: {farthest}");
    }
}
