//! The pages: a flight to look at, or a table of many.

use photinus_io::{Error, Result};
use photinus_swarm::metrics::pair;
use photinus_swarm::world::Obstacle;
use photinus_swarm::{Metrics, Scenario, World};
use serde_json::{Value, json};

use super::seeds::Report;
use super::told;
use crate::page::{Page, escaped};

/// Pictures per second of the film.
const FILM_HZ: f64 = 10.0;
/// The film shows what this many vehicles saw, the first ones.
const VIEWERS: usize = 12;

/// What the page plays.
pub(super) struct Film {
    every: u64,
    viewers: usize,
    shots: Vec<Value>,
}

impl Film {
    pub(super) fn new(scenario: &Scenario) -> Self {
        let every = (scenario.rate_hz / FILM_HZ).round().max(1.0) as u64;
        Self { every, viewers: scenario.vehicles.len().min(VIEWERS), shots: Vec::new() }
    }

    /// Takes a picture, if it is time.
    pub(super) fn take(&mut self, world: &World, frame: u64) {
        if !frame.is_multiple_of(self.every) {
            return;
        }
        let places: Vec<Value> = world
            .robots()
            .iter()
            .map(|robot| {
                let p = robot.state.position_m;
                json!([short(p.x), short(p.y), short(p.z), short(robot.state.heading_rad())])
            })
            .collect();
        let seen: Vec<Vec<Value>> = (0..self.viewers).map(|viewer| seen(world, viewer)).collect();
        self.shots
            .push(json!({ "t": short(world.time_s()), "p": places, "s": seen, "e": world.exposure_us() }));
    }
}

/// Whom a vehicle saw: place in its level frame, bounds of the distance, whom that is in truth (-1: nobody).
fn seen(world: &World, viewer: usize) -> Vec<Value> {
    let paired = pair(world, viewer);
    let told = world.robots()[viewer].seen.iter().enumerate().filter_map(|(index, seen)| {
        let p = seen.position_m?.mean;
        let is = paired.iter().find(|pair| pair.seen == index).map_or(-1, |pair| pair.target as i64);
        let bounds = seen.distance.bounds;
        let upper = if bounds.max_m().is_finite() { short(bounds.max_m()) } else { -1.0 };
        Some(json!([short(p.x), short(p.y), short(p.z), short(bounds.min_m()), upper, is]))
    });
    told.collect()
}

fn short(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

/// The page of a flight.
///
/// # Errors
/// [`Error`] where a number is not finite.
pub(super) fn flight(scenario: &Scenario, metrics: &Metrics, film: &Film) -> Result<Page> {
    let data = json!({
        "radii": scenario.vehicles.iter().map(|v| v.kind.build.radius_m).collect::<Vec<_>>(),
        "names": scenario.vehicles.iter().map(|v| format!("{} ({})", v.id, v.kind.name)).collect::<Vec<_>>(),
        "viewers": film.viewers,
        "obstacles": scenario.obstacles.iter().map(obstacle).collect::<Vec<_>>(),
        "shots": film.shots,
    });
    let data = serde_json::to_string(&data)
        .map_err(|error| Error::format("index.html", error.to_string()))?
        .replace('<', "\\u003c");
    let collided = match metrics.collisions + metrics.obstacle_collisions {
        0 => String::new(),
        count => format!("<p class=\"warning\">{count} collisions: metrics.json says when and who.</p>"),
    };
    Ok(Page::new(&format!("swarm, {}", scenario.name))
        .text(&scenario.about)
        .html(&collided)
        .html(include_str!("stage.html"))
        .html(&format!("<script type=\"application/json\" id=\"film\">{data}</script>"))
        .heading("How it went")
        .html(&table(&told::rows(metrics)))
        .text(&format!(
            "Perception: {}. Seed {}. What each number means stands in docs/swarm.md.",
            metrics.perception, metrics.seed
        ))
        .links(&[
            ("metrics.json", "every number"),
            ("truth.jsonl", "where everybody was"),
            ("vehicles", "what each vehicle saw and decided"),
        ])
        .script(include_str!("stage.js")))
}

/// The page of many flights.
pub(super) fn seeds(scenario: &Scenario, report: &Report) -> Page {
    let header = "<tr><th>number</th><th>mean</th><th>sigma</th><th>least</th><th>most</th></tr>";
    let row = |mean: &super::seeds::Mean| {
        format!(
            "<tr><td>{}</td><td>{:.3}</td><td>{:.3}</td><td>{:.3}</td><td>{:.3}</td></tr>",
            mean.key, mean.mean, mean.sigma, mean.least, mean.most
        )
    };
    let rows: String = report.mean.iter().map(row).collect();
    let flight = |metrics: &Metrics| {
        format!(
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            metrics.seed,
            metrics.collisions,
            metrics.obstacle_collisions,
            metrics.smallest_distance_m.map_or("-".to_owned(), |m| format!("{m:.3}"))
        )
    };
    let flights: String = report.each.iter().map(flight).collect();
    let head = report.told();
    Page::new(&format!("swarm, {}", scenario.name))
        .text(&scenario.about)
        .text(head.lines().next().unwrap_or_default())
        .heading("Over all flights")
        .html(&format!("<div class=\"wide\"><table>{header}{rows}</table></div>"))
        .heading("Each flight")
        .html(&format!(
            "<div class=\"wide\"><table><tr><th>seed</th><th>collisions</th><th>with obstacles</th>\
             <th>smallest distance, m</th></tr>{flights}</table></div>"
        ))
        .links(&[("metrics.json", "every number of every flight")])
}

fn table(rows: &[(&str, String)]) -> String {
    let row = |(name, value): &(&str, String)| {
        format!("<tr><td>{}</td><td>{}</td></tr>", escaped(name), escaped(value))
    };
    format!("<div class=\"wide\"><table>{}</table></div>", rows.iter().map(row).collect::<String>())
}

/// An obstacle for the page: the ends of its axis, and its radius.
fn obstacle(obstacle: &Obstacle) -> Value {
    let ends = [obstacle.from_m, obstacle.to_m].map(|end| [end.x, end.y, end.z].map(short));
    json!({ "ends": ends, "radius": obstacle.radius_m })
}
