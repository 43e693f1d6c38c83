"""Prints the first message of each topic that it is told, as cyclonedds hears it, and sends images meanwhile."""

import json
import sys
import time

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

domain, asked = int(sys.argv[1]), json.loads(sys.argv[2])
wire = Wire(asked["definitions"])
participant = DomainParticipant(domain)
reliable = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10))
# As tf2 does: the last one of every publisher, all on one topic.
latched = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(100), Policy.Durability.TransientLocal)
readers = {}
for name, kind in asked["topics"].items():
    qos = latched if name == "/tf_static" else reliable
    readers[name] = DataReader(participant, Topic(participant, "rt" + name, wire.of(kind), qos=qos), qos=qos)
sensor = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(5))
images = Topic(participant, "rt/camera/image", wire.of("sensor_msgs/msg/Image"), qos=sensor)
writer = DataWriter(participant, images, qos=sensor)
header = wire.of("std_msgs/msg/Header")(stamp=wire.of("builtin_interfaces/msg/Time")(sec=12, nanosec=500000000), frame_id="cam")
image = wire.of("sensor_msgs/msg/Image")(
    header=header, height=16, width=20, encoding="mono8", is_bigendian=0, step=24,
    data=[(7 * place) % 256 for place in range(16 * 24)],
)
imus = DataWriter(participant, Topic(participant, "rt/imu", wire.of("sensor_msgs/msg/Imu"), qos=sensor), qos=sensor)
odometries = DataWriter(participant, Topic(participant, "rt/odom", wire.of("nav_msgs/msg/Odometry"), qos=sensor), qos=sensor)
points = DataWriter(
    participant, Topic(participant, "rt/points", wire.of("uvdar_core/msg/ImagePointsWithCovariancesStamped"), qos=sensor), qos=sensor
)
# Who listens to /tf hears this, too.
transforms = DataWriter(participant, Topic(participant, "rt/tf", wire.of("tf2_msgs/msg/TFMessage"), qos=reliable), qos=reliable)
vector, turn = wire.of("geometry_msgs/msg/Vector3"), wire.of("geometry_msgs/msg/Quaternion")
began = time.monotonic()


def stamped():
    passed = time.monotonic() - began
    stamp = wire.of("builtin_interfaces/msg/Time")(sec=100 + int(passed), nanosec=int(passed % 1 * 1e9))
    return wire.of("std_msgs/msg/Header")(stamp=stamp, frame_id="base_link")


def transform(parent, child, rotation):
    told = wire.of("geometry_msgs/msg/TransformStamped")(
        header=wire.of("std_msgs/msg/Header")(stamp=stamped().stamp, frame_id=parent), child_frame_id=child,
        transform=wire.of("geometry_msgs/msg/Transform")(translation=vector(x=1.0, y=2.0, z=3.0), rotation=rotation),
    )
    return wire.of("tf2_msgs/msg/TFMessage")(transforms=[told])


def write_motion():
    imus.write(wire.of("sensor_msgs/msg/Imu")(
        header=stamped(), orientation=turn(x=0.0, y=0.0, z=0.0, w=0.0), orientation_covariance=[-1.0] + 8 * [0.0],
        angular_velocity=vector(x=0.1, y=0.2, z=0.3), angular_velocity_covariance=9 * [0.0],
        linear_acceleration=vector(x=0.0, y=0.0, z=9.8), linear_acceleration_covariance=9 * [0.0],
    ))
    pose = wire.of("geometry_msgs/msg/Pose")(
        position=wire.of("geometry_msgs/msg/Point")(x=1.0, y=2.0, z=3.0), orientation=turn(x=0.6, y=0.0, z=0.0, w=0.8)
    )
    twist = wire.of("geometry_msgs/msg/Twist")(linear=vector(x=0.0, y=0.0, z=0.0), angular=vector(x=float("nan"), y=0.0, z=0.0))
    odometries.write(wire.of("nav_msgs/msg/Odometry")(
        header=stamped(), child_frame_id="base_link",
        pose=wire.of("geometry_msgs/msg/PoseWithCovariance")(pose=pose, covariance=36 * [0.0]),
        twist=wire.of("geometry_msgs/msg/TwistWithCovariance")(twist=twist, covariance=36 * [0.0]),
    ))
    transforms.write(transform("odom", "frame", turn(x=0.6, y=0.0, z=0.0, w=0.8)))
    point = wire.of("uvdar_core/msg/Point2DWithCovariance")(
        x=20.5, y=30.25, covariance_00=1.0, covariance_01=0.0, covariance_10=0.0, covariance_11=1.0
    )
    points.write(wire.of("uvdar_core/msg/ImagePointsWithCovariancesStamped")(
        stamp=header.stamp, image_height=48, image_width=64, points=[point]
    ))


# The body is turned by half a circle about its nose in a frame that stands between it and the odometry's, said once.
fixed_transforms = DataWriter(participant, Topic(participant, "rt/tf_static", wire.of("tf2_msgs/msg/TFMessage"), qos=latched), qos=latched)
fixed_transforms.write(transform("frame", "uav1/base_link", turn(x=1.0, y=0.0, z=0.0, w=0.0)))

heard, end = {}, time.monotonic() + 40
while len(heard) < len(readers) and time.monotonic() < end:
    writer.write(image)
    write_motion()
    for name, reader in readers.items():
        for message in reader.take(10):
            own = name in ("/tf", "/tf_static") and message.transforms[0].header.frame_id in ("odom", "frame")
            if name not in heard and not own:
                heard[name] = plain(message)
    time.sleep(0.02)
print(json.dumps(heard), flush=True)
# Images are sent until nobody wants them any more.
while time.monotonic() < end:
    writer.write(image)
    write_motion()
    time.sleep(0.02)
