"""Writes the poses of one flight as other programs write them: bags of ROS 1, and MCAP by two libraries. Arguments: a folder, how many."""

import math
import pathlib
import sys

import numpy
from mcap.writer import CompressionType
from mcap_ros2.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin, Writer as Writer2
from rosbags.typesys import Stores, get_typestore

ODOMETRY, POSE = "nav_msgs/msg/Odometry", "geometry_msgs/msg/PoseStamped"
folder, count = pathlib.Path(sys.argv[1]), int(sys.argv[2])


def stamp(number):
    return 1_700_000_000 + number // 10, number % 10 * 100_000_000


def nanoseconds(number):
    seconds, rest = stamp(number)
    return seconds * 1_000_000_000 + rest


def place(number):
    return dict(x=0.5 * number, y=-2.0, z=1.0 + 0.125 * number)


def turn(number):
    return dict(x=0.0, y=0.0, z=0.01 * number, w=math.sqrt(1.0 - 0.01 * number * 0.01 * number))


def messages(store, number, unsure=numpy.full(36, 0.25), **sequence):
    """The odometry and the pose of one time, as the types of a store."""
    of = lambda name, **fields: store.types[name](**fields)
    seconds, rest = stamp(number)
    time = of("builtin_interfaces/msg/Time", sec=seconds, nanosec=rest)
    header = of("std_msgs/msg/Header", stamp=time, frame_id="map", **sequence)
    pose = of("geometry_msgs/msg/Pose", position=of("geometry_msgs/msg/Point", **place(number)),
              orientation=of("geometry_msgs/msg/Quaternion", **turn(number)))
    still = of("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=0.0)
    twist = of("geometry_msgs/msg/Twist", linear=still, angular=still)
    yield "/odom", of(ODOMETRY, header=header, child_frame_id="base_link",
                      pose=of("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=unsure),
                      twist=of("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=unsure))
    yield "/pose", of(POSE, header=header, pose=pose)


ros1, ros2 = get_typestore(Stores.ROS1_NOETIC), get_typestore(Stores.ROS2_JAZZY)
for name, packing in [("plain", None), ("packed", "LZ4"), ("bzip2", "BZ2")]:
    writer = Writer1(folder / f"{name}.bag")
    if packing:
        writer.set_compression(Writer1.CompressionFormat[packing])
    with writer:
        topics = {topic: writer.add_connection(topic, kind, typestore=ros1) for topic, kind in [("/odom", ODOMETRY), ("/pose", POSE)]}
        for number in range(count):
            for topic, message in messages(ros1, number, seq=number):
                kind = topics[topic].msgtype
                writer.write(topics[topic], nanoseconds(number), ros1.serialize_ros1(message, kind))

with Writer2(folder / "rosbags", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
    topics = {topic: writer.add_connection(topic, kind, typestore=ros2) for topic, kind in [("/odom", ODOMETRY), ("/pose", POSE)]}
    for number in range(count):
        for topic, message in messages(ros2, number):
            writer.write(topics[topic], nanoseconds(number), ros2.serialize_cdr(message, topics[topic].msgtype))
(folder / "rosbags" / "rosbags.mcap").rename(folder / "rosbags.mcap")

with open(folder / "mcap_ros2.mcap", "wb") as file:
    writer = McapWriter(file, compression=CompressionType.LZ4)
    schemas = {topic: writer.register_msgdef(kind, ros2.generate_msgdef(kind, ros_version=2)[0]) for topic, kind in [("/odom", ODOMETRY), ("/pose", POSE)]}
    for number in range(count):
        # This library takes lists alone.
        for topic, message in messages(ros2, number, unsure=[0.25] * 36):
            writer.write_message(topic, schemas[topic], message, nanoseconds(number), nanoseconds(number))
    writer.finish()
