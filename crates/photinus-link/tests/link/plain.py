"""Messages as rosbags and mcap-ros2-support read them -> what JSON holds."""

import math

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
