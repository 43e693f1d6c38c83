//! Labels of simulated grids: any roll, tilted to 70 deg, to 70 deg off the axis, LEDs missing, foreign spots.

use crate::simulation::{Dice, SIZE_PX, lens, pose};
use nalgebra::{Point3, Vector2, Vector3};
use photinus::camera::Bearing;
use photinus_calibrate::grid::{Grid, order};

/// How labels came out.
#[derive(Debug, Default)]
struct Count {
    right: u32,
    wrong: u32,
    refused: u32,
}

fn tried(seed: u64, trials: u32, missing: usize, foreign: usize) -> Count {
    let (grid, camera) = (Grid::new(7, 5, 0.05).expect("a grid"), lens());
    let (board_m, mut dice, mut count) = (grid.nominal_m(), Dice::new(seed), Count::default());
    while count.right + count.wrong + count.refused < trials {
        let pose = pose(&mut dice, 70_f64.to_radians(), 70_f64.to_radians());
        let pixel = |place: &Vector3<f64>| {
            let pixel = camera.pixel(&Bearing::new((pose * Point3::from(*place)).coords)?)?;
            Some(Vector2::new(pixel.u, pixel.v))
        };
        let Some(mut spots) = board_m.iter().map(pixel).collect::<Option<Vec<_>>>() else { continue };
        for spot in &mut spots {
            *spot += Vector2::from_fn(|_, _| dice.normal(0.1));
        }
        let mut truth: Vec<Option<usize>> = (0..spots.len()).map(Some).collect();
        for _ in 0..missing {
            let gone = dice.between(0.0, spots.len() as f64) as usize;
            spots.swap_remove(gone);
            truth.swap_remove(gone);
        }
        let (low, high) =
            spots.iter().fold((spots[0], spots[0]), |(low, high), spot| (low.inf(spot), high.sup(spot)));
        let room = (high - low) * 0.3;
        for _ in 0..foreign {
            let at = |dice: &mut Dice, axis: usize| {
                dice.between(low[axis] - room[axis], high[axis] + room[axis]).clamp(0.0, SIZE_PX[axis] as f64)
            };
            spots.push(Vector2::new(at(&mut dice, 0), at(&mut dice, 1)));
            truth.push(None);
        }
        match order(&spots, &grid) {
            Err(_) => count.refused += 1,
            Ok(ordered) => {
                let is_right = |turn: usize| {
                    ordered.observations.iter().all(|seen| {
                        let spot = spots.iter().position(|spot| *spot == seen.pixel);
                        spot.and_then(|spot| truth[spot]) == Some(grid.turned(seen.led, turn))
                    })
                };
                if (0..grid.turns()).any(is_right) { count.right += 1 } else { count.wrong += 1 }
            }
        }
    }
    count
}

#[test]
fn a_whole_grid_is_always_ordered() {
    let count = tried(1, 40, 0, 0);
    assert!(count.wrong == 0 && count.right >= 40, "{count:?}");
}

#[test]
fn missing_leds_and_foreign_spots_are_taken_in_or_refused() {
    let count = tried(2, 20, 2, 3);
    assert!(count.wrong == 0 && count.right >= 20, "{count:?}");
}

/// The same on more grids: `cargo test --release -p photinus-calibrate --test ordering -- --ignored
/// --nocapture`.
#[test]
#[ignore = "a minute of work; run it by hand"]
fn many_grids() {
    for (missing, foreign) in [(0, 0), (2, 0), (0, 3), (2, 3)] {
        let count = tried(3, 300, missing, foreign);
        println!("{missing} missing, {foreign} foreign: {count:?}");
        assert!(count.wrong <= 3 && count.right >= 297, "{count:?}");
    }
}
