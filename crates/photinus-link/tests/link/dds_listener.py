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
latched = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(1), Policy.Durability.TransientLocal)
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
heard, end = {}, time.monotonic() + 40
while len(heard) < len(readers) and time.monotonic() < end:
    writer.write(image)
    for name, reader in readers.items():
        for message in reader.take(10):
            if name not in heard:
                heard[name] = plain(message)
    time.sleep(0.02)
print(json.dumps(heard), flush=True)
# Images are sent until nobody wants them any more.
while time.monotonic() < end:
    writer.write(image)
    time.sleep(0.02)
