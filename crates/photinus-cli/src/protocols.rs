//! Sinks that are linked elsewhere: enters a table of the configuration, leaves what takes results there. Each protocol is a feature of this program.

use photinus_io::{Error, table};
use photinus_link::config::{Camera, Record};
use photinus_link::messages::Viewpoint;
use photinus_run::config::{Config, Origin};
use photinus_run::live;
use photinus_run::motion::Motion;
use photinus_run::sink::Sink;
use photinus_run::source::Opener;
use serde::Deserialize;

use crate::failure::Failure;
use crate::replayed;
use crate::simulated::Simulated;

/// A sink, and where it can be looked at.
type Shown = (Box<dyn Sink>, String);

/// The page, if one is asked for, and its address.
pub(crate) fn page(config: &Config) -> Result<Option<Shown>, Failure> {
    let Some(address) = config.page() else { return Ok(None) };
    #[cfg(feature = "page")]
    {
        let page = photinus_page::Page::open(&address).map_err(Failure::input)?;
        let token = address.token.map_or(String::new(), |token| format!("?token={token}"));
        let told = format!("http://{}/{token}", page.address());
        Ok(Some((Box::new(page), told)))
    }
    #[cfg(not(feature = "page"))]
    {
        let _ = address;
        Err(missing(config, "page"))
    }
}

/// The tables of links, each read by its own crate; a program without one of them refuses its table.
#[derive(Deserialize)]
struct Tables {
    record: Option<Record>,
    #[cfg(feature = "ros2")]
    ros2: Option<photinus_link::config::Ros2>,
    #[cfg(feature = "mavlink")]
    mavlink: Option<photinus_link::config::Mavlink>,
    #[cfg(feature = "zenoh")]
    zenoh: Option<photinus_link::config::Zenoh>,
}

/// The sinks of a table such as `[mavlink]`; what arrives of the vehicle's own motion goes to `motion`.
pub(crate) fn sinks(
    config: &Config,
    table: &str,
    motion: &Motion,
    cameras: &[live::Camera],
) -> Result<Vec<Box<dyn Sink>>, Failure> {
    let tables: Tables = table::parse(config.text(), config.path()).map_err(Failure::input)?;
    let cameras: Vec<Camera> = cameras.iter().map(linked).collect();
    let one = |sink: photinus_io::Result<Box<dyn Sink>>| sink.map(|sink| vec![sink]);
    #[cfg(not(any(feature = "ros2", feature = "mavlink", feature = "zenoh")))]
    let _ = motion;
    let opened = match table {
        "record" => tables.record.map(|record| {
            let file = config.located(&record.file);
            one(Record { file, ..record }.open(&cameras))
        }),
        #[cfg(feature = "ros2")]
        "ros2" => tables
            .ros2
            .map(|ros2| drawing(&cameras).and_then(|draw| ros2.open(&cameras, motion.clone(), draw))),
        #[cfg(feature = "mavlink")]
        "mavlink" => tables.mavlink.map(|mavlink| one(mavlink.open(&cameras, motion.clone()))),
        #[cfg(feature = "zenoh")]
        "zenoh" => tables.zenoh.map(|zenoh| one(zenoh.open(&cameras, motion.clone()))),
        _ => return Err(missing(config, table)),
    };
    opened.transpose().map(Option::unwrap_or_default).map_err(Failure::input)
}

/// What draws the pictures that ROS 2 carries: as `locate --overlay` does, without the view from above.
#[cfg(feature = "ros2")]
fn drawing(cameras: &[Camera]) -> photinus_io::Result<photinus_link::ros2::Draw> {
    let lenses = cameras.iter().map(|camera| camera.lens.clone()).collect();
    let mut drawing = crate::overlay::Drawing::new(lenses, false)?;
    Ok(Box::new(move |entry| {
        let frame = entry.image.as_ref().map(photinus_io::image::GreyImage::view);
        let drawn = drawing.draw(entry.camera, &entry.record, frame, entry.gravity.as_ref(), &[])?;
        let rgb = drawn.data().chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        Ok(photinus_link::ros2::Picture { width: drawn.width(), height: drawn.height(), rgb })
    }))
}

/// What opens a recording, a scene or a topic as a camera's source; the tables `[ros2]` and `[zenoh]` say where a topic is. `None` where that is not in this
/// program, or where `[zenoh]` is missing.
pub(crate) fn source(
    config: &Config,
    origin: Origin<'_>,
    spots: bool,
) -> photinus_io::Result<Option<Opener>> {
    let tables: Tables = table::parse(config.text(), config.path())?;
    #[cfg(not(any(feature = "ros2", feature = "zenoh")))]
    let _ = (tables, spots);
    Ok(match origin {
        Origin::Recording { path, camera } => Some(replayed::opener(path, camera)?),
        Origin::Scene { path, camera, exposure_us, takeoff, repeat } => {
            Some(Simulated::opener(&path, camera, exposure_us, takeoff, repeat)?)
        }
        #[cfg(feature = "ros2")]
        Origin::Ros2(topic) => Some(tables.ros2.unwrap_or_default().source(topic, spots)),
        #[cfg(feature = "zenoh")]
        Origin::Zenoh(key) => tables.zenoh.map(|zenoh| zenoh.source(key, spots)),
        #[cfg(not(all(feature = "ros2", feature = "zenoh")))]
        _ => None,
    })
}

/// A camera as links need to know it.
fn linked(camera: &live::Camera) -> Camera {
    Camera {
        view: Viewpoint::new(Some(&camera.name), None),
        lens: camera.view.camera.clone(),
        mask: camera.view.mask().cloned(),
        mounting: camera.view.mounting().copied(),
    }
}

fn missing(config: &Config, table: &str) -> Failure {
    let reason = format!("[{table}] is not in this program");
    let advice = format!("remove the table, or build with --features {table}");
    Failure::input(Error::format(config.path(), reason).advise(advice))
}
