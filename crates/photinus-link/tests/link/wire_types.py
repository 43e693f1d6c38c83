"""The types of messages as DDS sees them: standard ones as rosbags ships them, the others from definitions that are handed in."""

import json
import math

from cyclonedds.idl import make_idl_struct
from cyclonedds.idl import types
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

BASE = {"string": str, "bool": bool, "byte": types.uint8, "octet": types.uint8}


class Wire:
    """Types by their names, such as std_msgs/msg/Header."""

    def __init__(self, definitions):
        self.store = get_typestore(Stores.ROS2_JAZZY)
        added = {}
        for name, text in definitions.items():
            if name not in self.store.fielddefs:
                added.update(get_types_from_msg(text, name))
        self.store.register(added)
        self.made = {}

    def of(self, name):
        if name not in self.made:
            package, _, kind = name.split("/")
            fields = {field: self._kind(told) for field, told in self.store.fielddefs[name][1]}
            self.made[name] = make_idl_struct(kind + "_", f"{package}.msg.dds_.{kind}_", fields)
        return self.made[name]

    def _kind(self, told):
        kind, what = told
        match kind.name:
            case "BASE":
                return BASE.get(what[0]) or getattr(types, what[0])
            case "NAME":
                return self.of(what)
            case "ARRAY":
                return types.array[self._kind(what[0]), what[1]]
            case _:
                return types.sequence[self._kind(what[0])]


def plain(value):
    """What JSON holds; numbers that it does not hold are null."""
    if isinstance(value, (bool, str, int)):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, (list, tuple, bytes)):
        return [plain(item) for item in value]
    return {name: plain(item) for name, item in vars(value).items() if not name.startswith("_") and name != "sample_info"}


def told(value):
    return json.dumps(plain(value))
