//! Real photos of an LED grid: what a calibration reaches on them. Skips without the data.

use crate::grid_photos::{Set, eight_by_six, seven_by_five};
use nalgebra::Vector2;
use photinus::spots::{Detector, Settings};
use photinus_calibrate::adjust::View;
use photinus_calibrate::camera::{
    BoardChoice, CalibrateError, Calibration, Choices, MisfitReason, Summary, Warning, calibrate,
};
use photinus_calibrate::lens::LensModel;
use photinus_calibrate::photo::Photo;
use photinus_calibrate::solve::Board;

impl Set {
    fn calibrate(&self, model: &str, board: BoardChoice) -> Result<Calibration, CalibrateError> {
        self.calibrate_views(&self.views, model, board)
    }

    fn calibrate_views(
        &self,
        views: &[View],
        model: &str,
        board: BoardChoice,
    ) -> Result<Calibration, CalibrateError> {
        let choices = Choices { models: vec![model.parse::<LensModel>().expect("a model")], board };
        calibrate(views, &self.grid, self.photos[0].size_px, &choices, |_| ())
    }
}

fn summary(calibration: &Calibration) -> Summary {
    Summary::of(calibration.residuals().iter().map(|residual| residual.off_px.norm()))
}

#[test]
fn every_led_of_every_photo_is_found_and_ordered() {
    for set in [seven_by_five(), eight_by_six()].into_iter().flatten() {
        assert!(set.views.iter().all(|view| view.observations.len() == set.grid.leds()));
    }
}

#[test]
fn the_leds_are_more_likely_markers_than_not_and_their_reflections_less() {
    let mut reflections = Vec::new();
    for set in [seven_by_five(), eight_by_six()].into_iter().flatten() {
        let mut detector = Detector::new(Settings::default()).expect("settings");
        for image in &set.images {
            let found = detector.detect(&image.view(), None).expect("a frame");
            let likely = found.spots.iter().filter(|spot| spot.marker_log_odds > 0.0).count();
            assert_eq!(likely, set.grid.leds());
            reflections.push(found.spots.len() - likely);
        }
    }
    assert!(reflections.is_empty() || reflections.iter().sum::<usize>() == 7, "{reflections:?}");
}

#[test]
fn a_flat_board_gives_what_the_board_allows() {
    let Some(set) = seven_by_five() else { return };
    let ocam = summary(&set.calibrate("ocam:4", BoardChoice::Flat).expect("a camera"));
    assert!(ocam.mean_px < 0.160, "{ocam:?}");
    let best = summary(&set.calibrate("kannala-brandt:2", BoardChoice::Flat).expect("a camera"));
    assert!(best.mean_px < 0.135 && best.count == 700, "{best:?}");
}

#[test]
fn the_solved_board_goes_down_to_the_scatter_of_the_spots() {
    let Some(set) = seven_by_five() else { return };
    let calibration = set.calibrate("kannala-brandt:2", BoardChoice::Auto).expect("a camera");
    assert_eq!(calibration.board(), Board::Solved);
    let all = summary(&calibration);
    assert!(all.mean_px < 0.045 && all.max_px < 0.25 && all.count == 700, "{all:?}");
    let ocam = calibration.ocam().expect("an OCam camera");
    assert!(ocam.max_off_rad < 0.15e-3, "{}", ocam.max_off_rad);

    let splits: Vec<_> = (0..4).map(|repeat| calibration.split(repeat)).collect();
    let field = calibration.field();
    let claimed = field.claimed(calibration.camera());
    let mut differences = vec![0.0; claimed.len()];
    for split in &splits {
        let [Some(a), Some(b)] = &split.halves else { panic!("a split failed") };
        for half in [a, b] {
            assert!(half.held_out.mean_px < 0.07, "{:?}", half.held_out);
        }
        for (sum, ring) in differences.iter_mut().zip(field.rings_of(&field.difference(&a.lens, &b.lens))) {
            *sum += ring.rms_rad / splits.len() as f64;
        }
    }
    for ((ring, difference), limit_mrad) in
        claimed.iter().zip(&differences).zip([0.2, 0.6, 0.6, 0.6, 1.0, 1.0])
    {
        let ratio = difference / (2.0 * ring.rms_rad);
        assert!(ring.rms_rad < 1e-3 * limit_mrad && (0.5..2.0).contains(&ratio), "{ring:?} {ratio}");
    }
}

#[test]
fn photos_that_do_not_tell_the_board_say_so() {
    let Some(set) = eight_by_six() else { return };
    let calibration = set.calibrate("kannala-brandt:1", BoardChoice::Auto).expect("a camera");
    assert_eq!(calibration.board(), Board::Flat);
    let all = summary(&calibration);
    assert!(all.mean_px < 1.15, "{all:?}");
    let warnings = calibration.warnings(&set.photos);
    assert!(warnings.iter().any(|warning| matches!(warning, Warning::FlatBoard { .. })), "{warnings:?}");
    assert!(
        warnings
            .iter()
            .any(|warning| matches!(warning, Warning::PoorBearings { sigma_mrad, .. } if *sigma_mrad > 2.0)),
        "{warnings:?}"
    );
    let refused =
        set.calibrate("kannala-brandt:1", BoardChoice::Solve).expect_err("no board in these photos");
    assert!(matches!(refused, CalibrateError::BoardUnsupported { .. }), "{refused}");
}

#[test]
fn small_subsets_converge_from_nothing() {
    let Some(set) = seven_by_five() else { return };
    for first in 0..4 {
        let subset: Vec<View> = (0..8).map(|i| set.views[(first + i * (2 + first)) % 20].clone()).collect();
        let all =
            summary(&set.calibrate_views(&subset, "kannala-brandt:2", BoardChoice::Flat).expect("a camera"));
        assert!(all.mean_px < 0.2 && all.count == 8 * 35, "{first}: {all:?}");
    }
}

/// A photo seen in a mirror.
fn mirrored(photo: &Photo) -> Photo {
    let mut photo = photo.clone();
    for spot in &mut photo.spots {
        spot.centre = Vector2::new(photo.size_px[0] as f64 - 1.0 - spot.centre.x, spot.centre.y);
    }
    photo
}

#[test]
fn a_mirrored_photo_and_one_of_another_camera_are_left_out_by_name() {
    let Some(set) = seven_by_five() else { return };
    let mut views = set.views.clone();
    views[3] = mirrored(&set.photos[3]).view(3, &set.grid).expect("the grid");
    for seen in &mut views[7].observations {
        seen.pixel = 1.3 * seen.pixel - Vector2::new(90.0, 40.0);
    }
    let calibration = set.calibrate_views(&views, "kannala-brandt:2", BoardChoice::Auto).expect("a camera");
    let misfits: Vec<_> = calibration.misfits().iter().map(|misfit| (misfit.photo, misfit.reason)).collect();
    assert!(misfits.contains(&(3, MisfitReason::Mirrored)), "{misfits:?}");
    assert!(misfits.contains(&(7, MisfitReason::Foreign)), "{misfits:?}");
    assert!(misfits.len() == 2 && summary(&calibration).mean_px < 0.045);
    let said: Vec<String> = calibration.warnings(&set.photos).iter().map(ToString::to_string).collect();
    assert!(said[0].contains("grid_") && said[0].contains("left out"), "{said:?}");
}

#[test]
fn too_few_photos_and_one_pose_are_refused() {
    let Some(set) = seven_by_five() else { return };
    let refused = |views: &[View]| {
        set.calibrate_views(views, "kannala-brandt:2", BoardChoice::Auto).expect_err("refused")
    };
    assert_eq!(refused(&set.views[..2]), CalibrateError::TooFewPhotos { usable: 2 });
    let same: Vec<View> = (0..6).map(|photo| View { photo, ..set.views[5].clone() }).collect();
    let error = refused(&same);
    assert!(matches!(error, CalibrateError::OnePose { .. }), "{error}");
}

#[test]
fn a_blurred_photo_is_named() {
    let Some(mut set) = seven_by_five() else { return };
    for spot in &mut set.photos[4].spots {
        spot.width_px2 = spot.width_px2.map(|area| 4.0 * area);
    }
    let calibration = set.calibrate("kannala-brandt:2", BoardChoice::Flat).expect("a camera");
    let warnings = calibration.warnings(&set.photos);
    let blurred: Vec<_> =
        warnings.iter().filter(|warning| matches!(warning, Warning::Blurred { .. })).collect();
    assert!(blurred.len() == 1 && blurred[0].to_string().contains("grid_06"), "{blurred:?}");
}
