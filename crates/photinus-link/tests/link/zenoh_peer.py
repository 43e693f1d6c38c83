"""Prints the first message of each key that it is told, as eclipse-zenoh hears it and rosbags reads it, and puts images, points and motion meanwhile."""

import json
import sys
import time

import zenoh
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

link, asked = sys.argv[1], json.loads(sys.argv[2])
store = get_typestore(Stores.ROS2_JAZZY)
added = {}
for name, text in asked["definitions"].items():
    if name not in store.fielddefs:
        added.update(get_types_from_msg(text, name))
store.register(added)
of = store.types


def peer(listen, connect):
    config = zenoh.Config()
    config.insert_json5("mode", '"peer"')
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("listen/endpoints", json.dumps(listen))
    config.insert_json5("connect/endpoints", json.dumps(connect))
    return zenoh.open(config)


heard = {}


def hear(sample):
    key = str(sample.key_expr)
    kind = asked["keys"].get(key)
    if kind is not None and key not in heard:
        read = store.deserialize_cdr(sample.payload.to_bytes(), kind)
        heard[key] = {"encoding": str(sample.encoding), "message": plain(read)}


session, driver = peer([], [link]), peer([asked["listen"]], [])
subscriber = session.declare_subscriber("photinus/*/**", hear)
began = time.monotonic()
Header, Time, Vector3, Quaternion = (
    of[name] for name in ["std_msgs/msg/Header", "builtin_interfaces/msg/Time", "geometry_msgs/msg/Vector3", "geometry_msgs/msg/Quaternion"]
)


def stamped():
    passed = time.monotonic() - began
    return Header(stamp=Time(sec=100 + int(passed), nanosec=int(passed % 1 * 1e9)), frame_id="base_link")


def put(at, key, kind, message):
    at.put(key, bytes(store.serialize_cdr(message, kind)))


def put_all():
    rows = numpy.array([(7 * place) % 256 for place in range(16 * 24)], dtype=numpy.uint8)
    stamp = Time(sec=12, nanosec=500000000)
    header = Header(stamp=stamp, frame_id="cam")
    image = of["sensor_msgs/msg/Image"](header=header, height=16, width=20, encoding="mono8", is_bigendian=0, step=24, data=rows)
    put(driver, "uav1/image", "sensor_msgs/msg/Image", image)
    point = of["uvdar_core/msg/Point2DWithCovariance"](
        x=20.5, y=30.25, covariance_00=1.0, covariance_01=0.0, covariance_10=0.0, covariance_11=1.0
    )
    points = of["uvdar_core/msg/ImagePointsWithCovariancesStamped"](stamp=stamp, image_height=48, image_width=64, points=[point])
    put(driver, "uav1/points", "uvdar_core/msg/ImagePointsWithCovariancesStamped", points)
    none = numpy.zeros(9)
    imu = of["sensor_msgs/msg/Imu"](
        header=stamped(), orientation=Quaternion(x=0.0, y=0.0, z=0.0, w=0.0), orientation_covariance=numpy.array([-1.0] + 8 * [0.0]),
        angular_velocity=Vector3(x=0.1, y=0.2, z=0.3), angular_velocity_covariance=none,
        linear_acceleration=Vector3(x=0.0, y=0.0, z=9.8), linear_acceleration_covariance=none,
    )
    put(session, "uav1/imu", "sensor_msgs/msg/Imu", imu)
    # What is no message, on keys that are listened to.
    session.put("uav1/imu", b"nothing")


end = time.monotonic() + 40
while len(heard) < len(asked["keys"]) and time.monotonic() < end:
    put_all()
    time.sleep(0.02)
print(json.dumps(heard), flush=True)
# Until nobody wants them any more.
while time.monotonic() < end:
    put_all()
    time.sleep(0.02)
