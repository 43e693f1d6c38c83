//! `compat = "uvdar"`: the topics of UVDAR's own stack, so that it can be put in the place of theirs.

use super::{Node, Publisher, Quality, Ros2Error};
use crate::messages::Uvdar;
use crate::ros::{
    BearingObservationArrayStamped, ImagePointsWithCovariancesStamped, PoseWithCovarianceArrayStamped,
};

type Boxed<M> = Box<dyn Publisher<M> + Send>;

/// The topics, those of each camera among them.
pub struct UvdarTopics {
    cameras: Vec<OfCamera>,
    measured: Boxed<PoseWithCovarianceArrayStamped>,
    filtered: Boxed<PoseWithCovarianceArrayStamped>,
    tentative: Boxed<PoseWithCovarianceArrayStamped>,
}

struct OfCamera {
    points: Boxed<ImagePointsWithCovariancesStamped>,
    sun: Boxed<ImagePointsWithCovariancesStamped>,
    bearings: Boxed<BearingObservationArrayStamped>,
}

impl UvdarTopics {
    /// Announces them for cameras of these names.
    ///
    /// # Errors
    /// [`Ros2Error`] when a name is none.
    pub fn new<'a>(node: &mut Node, cameras: impl IntoIterator<Item = &'a str>) -> Result<Self, Ros2Error> {
        let mut of_camera = |camera: &str| {
            let camera = camera.replace('-', "_");
            Ok(OfCamera {
                points: Box::new(
                    node.publisher(&format!("/uvdar/{camera}/detector/points_seen"), Quality::Results)?,
                ),
                sun: Box::new(
                    node.publisher(&format!("/uvdar/{camera}/detector/points_seen/sun"), Quality::Results)?,
                ),
                bearings: Box::new(
                    node.publisher(&format!("/uvdar/bearing/{camera}/observations"), Quality::Results)?,
                ),
            })
        };
        let cameras = cameras.into_iter().map(&mut of_camera).collect::<Result<_, Ros2Error>>()?;
        Ok(Self {
            cameras,
            measured: Box::new(node.publisher("/uvdar/measuredPoses", Quality::Results)?),
            filtered: Box::new(node.publisher("/uvdar/filteredPoses", Quality::Results)?),
            tentative: Box::new(node.publisher("/uvdar/filteredPoses/tentative", Quality::Results)?),
        })
    }

    /// Tells what was found in a frame of this camera, by number; leaves how many messages the network did not take.
    pub fn tell(&self, camera: usize, told: Uvdar) -> u64 {
        let Some(own) = self.cameras.get(camera) else { return 0 };
        let results = [
            own.points.publish(told.points),
            own.sun.publish(told.sun),
            own.bearings.publish(told.bearings),
            self.measured.publish(told.measured),
            self.filtered.publish(told.filtered),
            self.tentative.publish(told.tentative),
        ];
        results.iter().filter(|result| result.is_err()).count() as u64
    }
}
