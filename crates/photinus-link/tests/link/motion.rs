//! The vehicle's motion in a recording that rosbags wrote.

use nalgebra::Vector3;
use photinus_link::recording::Motions;
use photinus_testing::python_with;

const SCRIPT: &str = r#"
import sys
from pathlib import Path
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
import numpy as np

none, unknown = np.zeros(9), np.array([-1.0] + 8 * [0.0])


def write(bag, store, encode, numbered):
    types = store.types
    Time, Header = types["builtin_interfaces/msg/Time"], types["std_msgs/msg/Header"]
    Vector, Turn = types["geometry_msgs/msg/Vector3"], types["geometry_msgs/msg/Quaternion"]

    def head(step):
        return Header(*([step] if numbered else []), Time(10 + step // 100, step % 100 * 10_000_000), "base_link")

    imus = bag.add_connection("/imu", "sensor_msgs/msg/Imu", typestore=store)
    odometries = bag.add_connection("/odom", "nav_msgs/msg/Odometry", typestore=store)
    for step in range(250):
        imu = types["sensor_msgs/msg/Imu"](
            head(step), Turn(0.0, 0.0, 0.0, 1.0), unknown, Vector(0.1, 0.2, 0.01 * step), none, Vector(0.0, 0.0, 9.8), none
        )
        bag.write(imus, 10**9 * 1000 + step * 10**7, encode(imu, "sensor_msgs/msg/Imu"))
        pose = types["geometry_msgs/msg/Pose"](types["geometry_msgs/msg/Point"](1.0, 2.0, 3.0), Turn(0.0, 0.0, 0.6, 0.8))
        pose = types["geometry_msgs/msg/PoseWithCovariance"](pose, np.zeros(36))
        twist = types["geometry_msgs/msg/Twist"](Vector(0.0, 0.0, 0.0), Vector(9.0, 9.0, 9.0))
        twist = types["geometry_msgs/msg/TwistWithCovariance"](twist, np.diag([0.09, 0.09, 0.09, 0.0, 0.0, 0.0]).flatten())
        odometry = types["nav_msgs/msg/Odometry"](head(step), "base_link", pose, twist)
        bag.write(odometries, 10**9 * 1000 + step * 10**7, encode(odometry, "nav_msgs/msg/Odometry"))


folder = Path(sys.argv[1])
store = get_typestore(Stores.ROS2_JAZZY)
with Writer(folder / "bag", version=9, storage_plugin=StoragePlugin.MCAP) as bag:
    write(bag, store, store.serialize_cdr, False)
store = get_typestore(Stores.ROS1_NOETIC)
bag = BagWriter(folder / "flight.bag")
bag.set_compression(BagWriter.CompressionFormat.LZ4)
with bag:
    write(bag, store, store.serialize_ros1, True)
"#;

#[test]
fn rates_of_the_imu_and_attitudes_of_the_odometry_are_read_from_bags_of_rosbags() {
    let Some(mut python) = python_with(&["rosbags", "numpy"]) else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let done = python.args(["-c", SCRIPT]).arg(folder.path()).output().expect("Python runs");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    // Of ROS 2, and of ROS 1.
    for file in ["bag/bag.mcap", "flight.bag"] {
        let motions = Motions::read(folder.path().join(file)).expect("a recording");
        assert_eq!((motions.rates.len(), motions.attitudes.len()), (250, 250), "{file}");
        let (time_s, rate) = motions.rates[123];
        assert!(
            (time_s - 11.23).abs() < 1e-9 && (rate - Vector3::new(0.1, 0.2, 1.23)).norm() < 1e-12,
            "{file}: {time_s}, {rate}"
        );
        let velocity = motions.velocities[123].1;
        assert!(
            (velocity.sigma_m_s - 0.3).abs() < 1e-12 && velocity.velocity_m_s.norm() == 0.0,
            "{velocity:?}"
        );
        // The IMU says that it has no attitude, so the odometry's counts: 0.6, 0.8 are the sine and cosine of half the turn.
        let (time_s, attitude) = motions.attitudes[249];
        let turn = attitude.scaled_axis();
        assert!(
            (time_s - 12.49).abs() < 1e-9 && (turn - Vector3::z() * 2.0 * libm::asin(0.6)).norm() < 1e-12,
            "{file}: {time_s}, {turn}"
        );
    }
}
