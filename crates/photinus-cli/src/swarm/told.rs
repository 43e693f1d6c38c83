//! Metrics as lines to read.

use photinus_swarm::Metrics;
use photinus_swarm::metrics::Contract;

/// The numbers of a flight, a line each: what it is, and how much.
pub(super) fn metrics(metrics: &Metrics) -> String {
    let mut lines = vec![format!(
        "{}: {} vehicles, {:.0} s, seed {}, perception {}",
        metrics.scenario, metrics.vehicles, metrics.duration_s, metrics.seed, metrics.perception
    )];
    for (name, value) in rows(metrics) {
        lines.push(format!("  {name:38} {value}"));
    }
    lines.join("\n")
}

/// Names and values, those that there are.
pub(super) fn rows(metrics: &Metrics) -> Vec<(&'static str, String)> {
    let number = |value: Option<f64>, unit: &str| value.map(|value| format!("{value:.3}{unit}"));
    let percent = |value: Option<f64>| value.map(|value| format!("{:.1} %", 100.0 * value));
    let count = |value: usize| Some(value.to_string());
    let rows = [
        ("collisions", count(metrics.collisions)),
        ("collisions with obstacles", count(metrics.obstacle_collisions)),
        ("smallest distance", number(metrics.smallest_distance_m, " m")),
        ("smallest clearance", number(metrics.smallest_clearance_m, " m")),
        ("smallest clearance from obstacles", number(metrics.smallest_obstacle_clearance_m, " m")),
        ("order", number(metrics.order, "")),
        ("order, last fifth", number(metrics.final_order, "")),
        ("extension", number(metrics.extension_m, " m")),
        ("extension, last fifth", number(metrics.final_extension_m, " m")),
        ("its standard deviation", number(metrics.extension_sigma_m, " m")),
        ("distance to the formation, last fifth", number(metrics.formation_error_m, " m")),
        ("formation settles after", number(metrics.formation_settles_s, " s")),
        ("mean speed", number(Some(metrics.mean_speed_m_s), " m/s")),
        ("sight graph connected", percent(Some(metrics.connected))),
        ("largest connected part", percent(Some(metrics.largest_part))),
        ("seen of those in view", percent(metrics.contact)),
        ("time with somebody in sight", percent(metrics.contact_with_anybody)),
        ("vehicle 1 sees vehicle 0", percent(metrics.contact_with_leader)),
        ("longest time alone", number(Some(metrics.longest_alone_s), " s")),
        ("position error, rms", number(metrics.position_error_m, " m")),
        ("error of distances, median", percent(metrics.range_error)),
        ("NEES, mean (3 is honest)", number(metrics.nees, "")),
        ("NEES, median (2.37 is honest)", number(metrics.nees_median, "")),
        ("within the 95 % ellipsoid", percent(metrics.nees_within_95)),
        ("bounds that truth left", Some(format!("{} of {}", metrics.bounds_broken, metrics.bounds))),
        ("identity switches", count(metrics.identity_switches)),
        ("wrong names", Some(format!("{} of {}", metrics.named_wrong, metrics.named))),
        ("phantoms among the seen", percent(metrics.phantoms)),
    ];
    let of_layer = metrics.contract.iter().flat_map(contract);
    rows.into_iter().filter_map(|(name, value)| Some((name, value?))).chain(of_layer).collect()
}

/// Whether the safety layer's proof applied, and what of its assumptions was broken.
fn contract(contract: &Contract) -> Vec<(&'static str, String)> {
    let share = |part: usize| 100.0 * part as f64 / contract.decisions.max(1) as f64;
    let applied = if contract.proof_applied { "yes".to_owned() } else { "no".to_owned() };
    let first = contract.first_broken_s.map(|first_s| format!("{first_s:.2} s"));
    let rests =
        [contract.proven, contract.braking, contract.slow].map(|part| format!("{:.1} %", share(part)));
    let unseen =
        contract.nearest_unseen_m.map_or(String::new(), |nearest_m| format!(", nearest {nearest_m:.2} m"));
    let rows = [
        ("the safety layer's proof applied", Some(applied)),
        ("first assumption broken at", first),
        ("decisions proven, braking, slow", Some(rests.join(", "))),
        (
            "faster than the limit",
            Some(format!("{} (top {:.2} m/s)", contract.too_fast, contract.top_speed_m_s)),
        ),
        (
            "strayed too far",
            Some(format!("{} (farthest {:.2} m)", contract.strayed, contract.farthest_stray_m)),
        ),
        (
            "own velocity off by too much",
            Some(format!("{} (most {:.2} m/s)", contract.velocity_off, contract.largest_velocity_error_m_s)),
        ),
        ("bounds of distance or bearing broken", Some(contract.bounds_broken.to_string())),
        ("unseen where nobody should be", Some(format!("{}{unseen}", contract.unseen_near))),
        ("vehicles outside of the contract", Some(contract.strangers.to_string())),
        ("pairs that began too near", Some(contract.began_too_near.to_string())),
    ];
    rows.into_iter().filter_map(|(name, value)| Some((name, value?))).collect()
}
