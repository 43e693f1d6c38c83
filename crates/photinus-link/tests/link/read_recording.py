"""Prints the last message of every topic of a recording as JSON, as a library that nobody here wrote decodes it."""

import json
import math
import pathlib
import sys

import numpy


def plain(value):
    """What JSON holds; numbers that it does not hold are null."""
    if isinstance(value, (bool, str)):
        return value
    if isinstance(value, (bytes, bytearray, memoryview)):
        return list(value)
    if isinstance(value, numpy.ndarray):
        return [plain(item) for item in value.tolist()]
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, int):
        return value
    names = getattr(value, "__dataclass_fields__", None) or getattr(value, "__slots__", None) or vars(value)
    names = [name for name in names if not name.startswith("_") and not name.isupper() and name != "structure_needs_at_least_one_member"]
    return {name: plain(getattr(value, name)) for name in names}


def by_mcap_ros2(path):
    from mcap_ros2.reader import read_ros2_messages

    for message in read_ros2_messages(path):
        yield message.channel.topic, message.ros_msg


def by_rosbags(path):
    from rosbags.highlevel import AnyReader

    with AnyReader([pathlib.Path(path)]) as reader:
        for connection, _, data in reader.messages():
            yield connection.topic, reader.deserialize(data, connection.msgtype)


LIBRARIES = {"mcap_ros2": by_mcap_ros2, "rosbags": by_rosbags}
print(json.dumps({topic: plain(message) for topic, message in LIBRARIES[sys.argv[1]](sys.argv[2])}))
