"""Prints the last message of every topic of a recording as JSON, as a library that nobody here wrote decodes it."""

import json
import pathlib
import sys


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
