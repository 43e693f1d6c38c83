use super::*;

fn lenses() -> Vec<Lens> {
    let kb = LensModel::kannala_brandt(2).unwrap();
    let mut lens = Lens::equidistant(300.0, 464.0, [509.6, 275.7]).in_model(kb, 1.2);
    let numbers = [0.9993, 0.0006, 464.0 / 300.0, -0.19, 0.017];
    lens.parameters.as_mut_slice()[AFFINE..AFFINE + 5].copy_from_slice(&numbers);
    let others = (4..=10).filter_map(LensModel::ocam).chain((1..=4).filter_map(LensModel::kannala_brandt));
    others.map(|model| lens.in_model(model, 1.2)).collect()
}

#[test]
fn models_follow_each_other() {
    let lenses = lenses();
    let truth = lenses.iter().find(|lens| lens.model == LensModel::kannala_brandt(2).unwrap()).unwrap();
    for lens in &lenses {
        let most_px = if lens.model.radial() < 4 { 30.0 } else { 3.0 };
        for i in 0..=24 {
            let angle = 0.05 * f64::from(i);
            let off = (lens.radius_px(angle).unwrap() - truth.radius_px(angle).unwrap()).abs();
            assert!(off < most_px, "{} at {angle}: {off}", lens.model);
        }
    }
}

#[test]
fn derivatives_are_those_of_finite_differences() {
    for lens in lenses() {
        for point in [
            Vector3::new(0.3, -0.2, 1.0),
            Vector3::new(-0.9, 0.1, 0.4),
            Vector3::new(0.01, 0.02, 2.0),
            Vector3::new(-0.3, 0.25, 0.13),
        ] {
            let Projection { by_point, by_parameters, .. } = lens.project(&point).unwrap();
            let step = 1e-6;
            for k in 0..3 {
                let moved = |sign: f64| {
                    let mut point = point;
                    point[k] += sign * step;
                    lens.pixel(&point).unwrap()
                };
                let expected = (moved(1.0) - moved(-1.0)) / (2.0 * step);
                assert!((by_point.column(k) - expected).norm() < 1e-4, "{} {point:?} {k}", lens.model);
            }
            for k in 0..lens.model.parameters() {
                let moved = |sign: f64| {
                    let mut parameters = lens.parameters;
                    parameters[k] += sign * step;
                    lens.with_parameters(parameters).pixel(&point).unwrap()
                };
                let expected = (moved(1.0) - moved(-1.0)) / (2.0 * step);
                let off = (by_parameters.column(k) - expected).norm();
                assert!(
                    off < 1e-4 * (1.0 + expected.norm()),
                    "{} {point:?} parameter {k}: {off}",
                    lens.model
                );
            }
        }
    }
}

#[test]
fn a_pixel_goes_back_to_its_direction() {
    for lens in lenses() {
        let limit = lens.rises_to_rad(1.25);
        for direction in
            [Vector3::new(0.2, -0.4, 1.0), Vector3::new(0.0, 0.0, 1.0), Vector3::new(-0.9, 0.3, 0.5)]
        {
            let bearing = lens.bearing(&lens.pixel(&direction).unwrap(), limit).unwrap();
            assert!((bearing - direction.normalize()).norm() < 1e-12, "{}", lens.model);
        }
        assert!(lens.bearing(&Vector2::new(5000.0, 0.0), limit).is_none());
    }
}

#[test]
fn past_a_right_angle_there_is_an_answer_and_behind_the_axis_none_is_invented() {
    let lens = Lens::equidistant(250.0, 250.0, [376.0, 240.0]);
    let pixel = lens.pixel(&Vector3::new(1.0, 0.0, -0.2)).unwrap();
    assert!(pixel.x > 376.0 + 250.0 * std::f64::consts::FRAC_PI_2);
    for nothing in [Vector3::zeros(), Vector3::new(f64::NAN, 0.0, 1.0), Vector3::new(f64::INFINITY, 0.0, 1.0)]
    {
        assert!(lens.pixel(&nothing).is_none());
    }
}
