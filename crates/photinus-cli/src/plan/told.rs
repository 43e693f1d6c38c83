//! A plan in words and tables.

use photinus_plan::{AtRange, Battery, Eyes, Layout, Plan, Reach};

use crate::aligned::{Aligned, Side};

/// All of it.
pub(super) fn whole(plan: &Plan) -> String {
    let parts = [
        Some(ranges(plan)),
        Some(over_distance(plan)),
        Some(layouts(plan)),
        plan.battery.as_ref().map(battery),
        Some(eyes(&plan.eyes)),
    ];
    parts.into_iter().flatten().collect::<Vec<_>>().join("\n\n")
}

/// How far.
pub(super) fn ranges(plan: &Plan) -> String {
    let reach = |Reach { nearly_all_m, half_m }: Reach| match nearly_all_m > 0.0 {
        true => format!("in 95 of 100 frames to {nearly_all_m:.1} m, in half of them to {half_m:.1} m"),
        false => format!("in half of all frames to {half_m:.1} m"),
    };
    format!(
        "A direction (one spot)   {}\nA distance (two spots)   {}\nYaw                      {}",
        reach(plan.direction),
        reach(plan.distance),
        yaw(plan.yaw_turn_rad),
    )
}

/// Which yaw can be told.
fn yaw(turn_rad: f64) -> String {
    match turn_rad.to_degrees().round() {
        360.0 => "in full".to_owned(),
        turn_deg => format!("modulo {turn_deg} deg; in full with blinked signals"),
    }
}

/// The table over distance.
pub(super) fn over_distance(plan: &Plan) -> String {
    let mut table = Aligned::new(0, &[Side::Right; 7]);
    table.row(["at m", "one spot %", "two %", "distance, half within m", "rms m", "bearing mrad", "yaw deg"]);
    for at in &plan.over_distance {
        let AtRange { distance_m, one, two, .. } = *at;
        table.row([
            format!("{distance_m:.1}"),
            format!("{:.0}", 100.0 * one),
            format!("{:.0}", 100.0 * two),
            number(at.distance_error_m, 1.0, 3),
            number(at.distance_rms_m, 1.0, 3),
            number(at.bearing_rms_rad, 1e3, 2),
            number(at.yaw_rms_rad, 1f64.to_degrees(), 1),
        ]);
    }
    table.to_string()
}

/// The table of layouts.
pub(super) fn layouts(plan: &Plan) -> String {
    let mut table =
        Aligned::new(2, &[Side::Left, Side::Right, Side::Right, Side::Right, Side::Right, Side::Left]);
    table.row(["layout", "two spots %", "distance, half within m", "half to m", "yaw deg", "modulo"]);
    for layout in &plan.layouts {
        let Layout { name, two, half_m, yaw_turn_rad, .. } = layout;
        table.row([
            name.clone(),
            format!("{:.0}", 100.0 * two),
            number(layout.distance_error_m, 1.0, 3),
            format!("{half_m:.1}"),
            number(layout.yaw_rms_rad, 1f64.to_degrees(), 1),
            format!("{:.0} deg", yaw_turn_rad.to_degrees()),
        ]);
    }
    format!("As many LEDs, spread otherwise, at {:.1} m, the best first:\n{table}", plan.wanted_m)
}

/// What the light costs.
pub(super) fn battery(battery: &Battery) -> String {
    let Battery { light_w, share, dark_min, lost_min } = battery;
    format!(
        "Light takes {light_w:.1} W, {:.1} % of hovering: {lost_min:.1} of {dark_min:.0} min are lost; half of it with words that are on \
         half of the time.",
        100.0 * share
    )
}

/// From where on the light harms no eye.
pub(super) fn eyes(eyes: &Eyes) -> String {
    let Eyes { long_m, day_m, at_assessment_w_m2, risk_group, .. } = eyes;
    let group = match risk_group {
        0 => "exempt".to_owned(),
        group => format!("of risk group {group}"),
    };
    format!(
        "Eyes: {at_assessment_w_m2:.1} W/m^2 of near ultraviolet at 0.2 m, {group} (IEC 62471:2006). Keep {long_m:.2} m away to look into it \
         for more than 1000 s\n(10 W/m^2, IEC 62471 4.3.2), {day_m:.2} m to work beside it for 8 h (10 kJ/m^2 a day, ICNIRP 2004)."
    )
}

fn number(value: Option<f64>, factor: f64, digits: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{:.digits$}", value * factor))
}
