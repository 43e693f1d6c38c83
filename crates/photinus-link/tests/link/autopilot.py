"""An autopilot as pymavlink speaks: it prints what it hears, a line each, and says how it flies."""

import json
import math
import os
import sys
import time

os.environ["MAVLINK20"] = "1"
from pymavlink import mavutil  # noqa: E402

link = mavutil.mavlink_connection("udpin:127.0.0.1:0", source_system=7, source_component=1)
print(link.port.getsockname()[1], flush=True)


def plain(value):
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return value


begun, seconds = time.monotonic(), float(sys.argv[1])
while time.monotonic() - begun < seconds:
    message = link.recv_match(timeout=0.05, blocking=True)
    if message is None:
        continue
    if message.get_type() == "BAD_DATA":
        print(json.dumps({"mavpackettype": "BAD_DATA"}), flush=True)
        continue
    told = {name: plain(value) for name, value in message.to_dict().items()}
    told["from"] = [message.get_srcSystem(), message.get_srcComponent()]
    print(json.dumps(told), flush=True)
    boot_ms = 5000 + int(1000 * (time.monotonic() - begun))
    # It looks east, leans 0.1 rad to its right and turns to the right.
    yaw, roll = math.pi / 2, 0.1
    q = [math.cos(yaw / 2) * math.cos(roll / 2), math.cos(yaw / 2) * math.sin(roll / 2),
         math.sin(yaw / 2) * math.sin(roll / 2), math.sin(yaw / 2) * math.cos(roll / 2)]
    link.mav.attitude_quaternion_send(boot_ms, *q, 0.1, 0.2, 0.3)
    link.mav.highres_imu_send(1000 * boot_ms, 0, 0, -9.81, 0.4, 0.5, 0.6, 0, 0, 0, 0, 0, 0, 0, 0b111000)
    # Once 3 m/s east, 2 south, 1 down, and once 1 m/s ahead, 2 to the right, 3 down.
    link.mav.local_position_ned_send(boot_ms, 0, 0, 0, -2.0, 3.0, 1.0)
    # The upper triangle by rows: 0.2 m/s each way.
    nothing, by_0_2 = [float("nan")] * 21, [0.04 if place in (0, 6, 11) else 0.0 for place in range(21)]
    link.mav.odometry_send(1000 * boot_ms + 1, 1, 12, 0, 0, 0, [1, 0, 0, 0], 1.0, 2.0, 3.0, 0, 0, 0, nothing, by_0_2)
    link.mav.global_position_int_send(boot_ms, 501000000, 144000000, 300000, 10000, 100, 200, -300, 9000)
