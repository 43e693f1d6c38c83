use super::*;

/// A grid seen a little from the side, turned by some degrees.
fn spots(columns: usize, rows: usize) -> Vec<Vector2<f64>> {
    let place = |led: usize| {
        let (x, y) = ((led % columns) as f64, (led / columns) as f64);
        let depth = 1.0 + 0.02 * x + 0.01 * y;
        Vector2::new(300.0 + (30.0 * x - 8.0 * y) / depth, 200.0 + (8.0 * x + 28.0 * y) / depth)
    };
    (0..columns * rows).map(place).collect()
}

#[test]
fn turning_a_grid_brings_it_back() {
    for grid in [Grid::new(7, 5, 0.05).unwrap(), Grid::new(4, 4, 0.05).unwrap()] {
        for turn in 0..grid.turns() {
            let back = (grid.turns() - turn) % grid.turns();
            for led in 0..grid.leds() {
                assert_eq!(grid.turned(grid.turned(led, turn), back), led);
            }
        }
    }
}

#[test]
fn spots_become_leds_and_the_one_that_is_none_stays_out() {
    let grid = Grid::new(7, 5, 0.05).unwrap();
    let mut seen = spots(7, 5);
    seen.remove(9);
    seen.push(Vector2::new(700.0, 30.0));
    let ordered = order(&seen, &grid).unwrap();
    assert_eq!((ordered.observations.len(), ordered.foreign), (34, 1));
    let truth = spots(7, 5);
    let turn = usize::from(ordered.observations.iter().any(|seen| seen.pixel == truth[0] && seen.led != 0));
    assert!(ordered.observations.iter().all(|seen| truth[grid.turned(seen.led, turn)] == seen.pixel));
}

#[test]
fn what_cannot_be_read_is_refused_with_its_reason() {
    let grid = Grid::new(7, 5, 0.05).unwrap();
    let refused = |spots: &[Vector2<f64>]| order(spots, &grid).unwrap_err();
    assert_eq!(refused(&spots(7, 5)[..10]), OrderError::TooFew { found: 10, needed: 25, leds: 35 });
    assert_eq!(refused(&spots(8, 6)), OrderError::OtherSize { columns: 8, rows: 6 });
    assert_eq!(refused(&spots(6, 5)), OrderError::OtherSize { columns: 6, rows: 5 });
    let mut column_short = spots(6, 5);
    column_short.remove(13);
    column_short.remove(3);
    assert!(
        matches!(refused(&column_short), OrderError::Ambiguous { ways: 2 }),
        "{}",
        refused(&column_short)
    );
    let scattered: Vec<_> =
        (0..40_u32).map(|i| Vector2::new(f64::from(i * 7919 % 601), f64::from(i * 104_729 % 407))).collect();
    assert!(order(&scattered, &grid).is_err());
    let nowhere = vec![Vector2::new(f64::NAN, f64::INFINITY); 40];
    assert!(matches!(refused(&nowhere), OrderError::TooFew { found: 0, .. }));
    let all_alike = vec![Vector2::new(5.0, 5.0); 40];
    assert!(order(&all_alike, &grid).is_err());
}

#[test]
fn numbers_that_are_no_grid_are_refused() {
    assert!(Grid::new(2, 5, 0.05).is_err() && Grid::new(7, 51, 0.05).is_err());
    for pitch_m in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Grid::new(7, 5, pitch_m).is_err());
    }
}
