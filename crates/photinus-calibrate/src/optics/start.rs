//! A first point spread: a core and a halo, both round, by which spots are most likely.
//!
//! A table alone cannot begin: with a lens sharper than its pixels, a bent table with uneven places explains spots as well as a
//! straight one. Two Gaussians have no such freedom.

use photinus::optics::Gaussian;

use super::noise::{Noise, least};
use super::spot::Spot;
use super::table::{Shares, Table};

/// Brightest spots used.
const SPOTS: usize = 80;
const REACH: usize = 7;
/// Most searches for each of the three numbers, and the change of the cost that is too little to go on for: after three, halos came out a fifth too faint.
const SWEEPS: usize = 10;
const CONVERGED: f64 = 0.01;

/// A round core with a halo around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CoreAndHalo {
    core_px: f64,
    /// Width of the halo over that of the core.
    ratio: f64,
    halo: f64,
}

impl CoreAndHalo {
    /// Its table.
    pub(super) fn table(&self) -> Table {
        let core = Gaussian { share: 1.0 - self.halo, sigma_px: self.core_px };
        let halo = Gaussian { share: self.halo, sigma_px: self.core_px * self.ratio };
        let mut table = Table::gaussians(&[core, halo]);
        table.settle();
        table
    }
}

/// The core and halo that explain the brightest spots best.
pub(super) fn core_and_halo(spots: &[Spot<'_>], noise: &Noise) -> CoreAndHalo {
    let mut brightest: Vec<Spot<'_>> = spots.to_vec();
    brightest.sort_by(|a, b| {
        (b.is_linear(), b.window.reach.min(REACH), b.window.peak()).cmp(&(
            a.is_linear(),
            a.window.reach.min(REACH),
            a.window.peak(),
        ))
    });
    brightest.truncate(SPOTS);
    let cost = |shape: CoreAndHalo| {
        let table = shape.table();
        let mut shares = Shares::default();
        let mut sum = 0.0;
        for spot in &brightest {
            let mut spot = spot.clone();
            spot.fit(&table, noise, REACH, 4, &mut shares);
            // a spot of unknown scale of errors: two LEDs in one count little
            sum += libm::log(spot.misfit.max(1e-3));
        }
        sum
    };
    let mut best = CoreAndHalo { core_px: 0.6, ratio: 3.0, halo: 0.1 };
    let mut lowest = f64::INFINITY;
    for sweep in 0..SWEEPS {
        let (width, steps) = if sweep == 0 { (1.5, 9) } else { (0.3, 6) };
        let log_core = libm::log(best.core_px);
        let core = |log_core: f64| CoreAndHalo { core_px: libm::exp(log_core), ..best };
        best = core(least(
            |at| cost(core(at)),
            (log_core - width).max(libm::log(0.12)),
            (log_core + width).min(libm::log(3.0)),
            steps,
        ));
        let halo = |halo: f64| CoreAndHalo { halo, ..best };
        best = halo(least(|at| cost(halo(at)), 0.0, 0.7, 8));
        let ratio = |log_ratio: f64| CoreAndHalo { ratio: libm::exp(log_ratio), ..best };
        best = ratio(least(|at| cost(ratio(at)), libm::log(1.4), libm::log(9.0), 7));
        let reached = cost(best);
        if reached > lowest - CONVERGED {
            break;
        }
        lowest = reached;
    }
    best
}
