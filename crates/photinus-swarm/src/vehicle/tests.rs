//! The motion against closed forms, and its limits.

use super::*;

fn frictionless() -> Build {
    Build { drag_n_s_m: 0.0, drag_n_s2_m2: 0.0, ..Build::default() }
}

fn still(state: &State) -> Command {
    Command { thrust_n: state.thrust_n, turn_rad_s: Vector3::zeros() }
}

#[test]
fn a_throw_without_air_is_a_parabola_and_keeps_its_energy() {
    let build = frictionless();
    let mut state = State { thrust_n: 0.0, ..State::hover(&build, Vector3::new(0.0, 0.0, 50.0), 0.3) };
    state.velocity_m_s = Vector3::new(3.0, -2.0, 4.0);
    let energy = |state: &State| 0.5 * state.velocity_m_s.norm_squared() + GRAVITY_M_S2 * state.position_m.z;
    let before = energy(&state);
    for _ in 0..400 {
        state.step(
            &build,
            &Command { thrust_n: 0.0, turn_rad_s: Vector3::zeros() },
            &Vector3::zeros(),
            0.005,
        );
    }
    let fallen = Vector3::new(6.0, -4.0, 50.0 + 8.0 - 0.5 * GRAVITY_M_S2 * 4.0);
    assert!((state.position_m - fallen).norm() < 1e-9, "{}", state.position_m);
    assert!((energy(&state) / before - 1.0).abs() < 1e-12);
}

#[test]
fn a_fall_through_air_follows_the_hyperbolic_tangent() {
    // quadratic drag: v = v_t tanh(g t / v_t), y = v_t^2 / g ln cosh(g t / v_t)
    let build = Build { drag_n_s_m: 0.0, drag_n_s2_m2: 0.05, ..Build::default() };
    let mut state = State { thrust_n: 0.0, ..State::hover(&build, Vector3::zeros(), 0.0) };
    for _ in 0..2000 {
        state.step(&build, &Command { thrust_n: 0.0, turn_rad_s: Vector3::zeros() }, &Vector3::zeros(), 1e-3);
    }
    let terminal = (build.mass_kg * GRAVITY_M_S2 / build.drag_n_s2_m2).sqrt();
    let share = GRAVITY_M_S2 * 2.0 / terminal;
    assert!((state.velocity_m_s.z + terminal * libm::tanh(share)).abs() < 1e-5, "{}", state.velocity_m_s);
    let way_m = terminal * terminal / GRAVITY_M_S2 * libm::log(libm::cosh(share));
    assert!((state.position_m.z + way_m).abs() < 1e-5, "{}", state.position_m);
}

#[test]
fn a_hover_in_wind_is_blown_along_as_linear_drag_has_it() {
    let build = Build { drag_n_s2_m2: 0.0, ..Build::default() };
    let mut state = State::hover(&build, Vector3::zeros(), 0.0);
    let wind = Vector3::new(4.0, 0.0, 0.0);
    for _ in 0..3000 {
        state.step(&build, &still(&state), &wind, 2e-3);
    }
    let speed = 4.0 * (1.0 - libm::exp(-build.drag_n_s_m / build.mass_kg * 6.0));
    assert!((state.velocity_m_s.x - speed).abs() < 1e-6 && state.position_m.z.abs() < 1e-9, "{state:?}");
}

#[test]
fn the_error_of_a_step_is_of_second_order() {
    let build = Build::default();
    let fly = |steps: u32| {
        let mut state = State::hover(&build, Vector3::zeros(), 0.0);
        let step_s = 1.0 / f64::from(steps);
        for step in 0..steps {
            let sign = if step < steps / 2 { 1.0 } else { -1.0 };
            let turn_rad_s = Vector3::new(0.8, -0.5, 1.0) * sign;
            state.step(&build, &Command { thrust_n: 25.0, turn_rad_s }, &Vector3::x(), step_s);
        }
        state.position_m
    };
    let exact = fly(32_768);
    let [coarse, fine] = [fly(64), fly(128)].map(|end| (end - exact).norm());
    assert!((3.2..5.0).contains(&(coarse / fine)), "{coarse} {fine}: halves give a quarter");
    assert!(fly(240).metric_distance(&exact) < 1e-3);
}

#[test]
fn thrust_and_rates_follow_as_a_lag_and_stay_within_their_limits() {
    let build = Build::default();
    let mut state = State::hover(&build, Vector3::zeros(), 0.0);
    let begin_n = state.thrust_n;
    let wild = Command { thrust_n: 1e6, turn_rad_s: Vector3::new(1e6, -1e6, 0.5) };
    state.step(&build, &wild, &Vector3::zeros(), 0.02);
    let left = libm::exp(-0.02 / build.thrust_lag_s);
    assert!((state.thrust_n - (build.thrust_n + (begin_n - build.thrust_n) * left)).abs() < 1e-9);
    for _ in 0..1000 {
        state.step(&build, &wild, &Vector3::zeros(), 0.02);
        assert!(state.thrust_n <= build.thrust_n && state.turn_rad_s.amax() <= build.turn_rad_s);
        assert!(state.is_finite() && (state.attitude.norm() - 1.0).abs() < 1e-12);
    }
}

/// Flies with an autopilot that knows the true attitude.
fn flown(wanted: Wanted, seconds: f64, wind_m_s: Vector3<f64>, build: &Build) -> State {
    let mut state = State::hover(build, Vector3::zeros(), 0.7);
    for _ in 0..(seconds * 240.0) as u32 {
        let command = Autopilot::default().command(build, &state.attitude, &wanted);
        state.step(build, &command, &wind_m_s, 1.0 / 240.0);
    }
    state
}

#[test]
fn a_wanted_acceleration_is_reached_and_the_heading_stays() {
    let build = frictionless();
    let wanted = Wanted { acceleration_m_s2: Vector3::new(2.0, 1.0, 0.5), heading_rate_rad_s: 0.0 };
    let state = flown(wanted, 2.0, Vector3::zeros(), &build);
    let level = UnitQuaternion::from_scaled_axis(Vector3::z() * -0.7);
    let is = level * state.acceleration_m_s2(&build, &Vector3::zeros());
    assert!((is - wanted.acceleration_m_s2).norm() < 1e-2, "{is}");
    assert!((state.heading_rad() - 0.7).abs() < 1e-2, "{}", state.heading_rad());
    let turned =
        flown(Wanted { heading_rate_rad_s: 0.5, ..Wanted::default() }, 2.0, Vector3::zeros(), &build);
    assert!((turned.heading_rad() - 1.7).abs() < 0.05, "{}", turned.heading_rad());
}

#[test]
fn what_is_too_much_is_cut_to_the_tilt_and_the_height_is_kept() {
    let build = Build { drag_n_s_m: 0.0, drag_n_s2_m2: 0.0, ..Build::default() };
    let wanted = Wanted { acceleration_m_s2: Vector3::new(1e4, 0.0, 0.0), heading_rate_rad_s: 0.0 };
    let state = flown(wanted, 3.0, Vector3::zeros(), &build);
    let tilt_rad = libm::acos((state.attitude * Vector3::z()).z);
    assert!((tilt_rad - build.tilt_rad).abs() < 1e-3, "{tilt_rad}");
    let is = state.acceleration_m_s2(&build, &Vector3::zeros());
    assert!(is.z.abs() < 1e-3 && (is.norm() - GRAVITY_M_S2 * libm::tan(build.tilt_rad)).abs() < 1e-2, "{is}");
    // one that can hardly lift itself has nothing left to go sideways with
    let weak = Build { thrust_n: 20.0, ..build };
    let state = flown(wanted, 3.0, Vector3::zeros(), &weak);
    assert!(state.thrust_n <= 20.0 && state.position_m.z > -5.0, "{state:?}");
}
