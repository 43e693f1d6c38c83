"""Writes bags of ROS 1 with images of one camera, as rosbags writes them: mono8, mono16 and PNG. Arguments: a folder, how many."""

import pathlib
import struct
import sys
import zlib

import numpy
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore

folder, count = pathlib.Path(sys.argv[1]), int(sys.argv[2])
store = get_typestore(Stores.ROS1_NOETIC)
IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
WIDTH, HEIGHT = 20, 16


def pixels(number):
    return ((7 * numpy.arange(WIDTH * HEIGHT) + number) % 256).astype(numpy.uint8).reshape(HEIGHT, WIDTH)


def png(grey):
    def part(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + row.tobytes() for row in grey)
    size = struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + part(b"IHDR", size) + part(b"IDAT", zlib.compress(rows)) + part(b"IEND", b"")


def raw(header, encoding, grey, big=0):
    width = grey.dtype.itemsize
    # Four bytes at the end of a row are no pixels.
    rows = numpy.pad(numpy.ascontiguousarray(grey).view(numpy.uint8), ((0, 0), (0, 4)))
    return IMAGE, store.types[IMAGE](
        header=header, height=HEIGHT, width=WIDTH, encoding=encoding, is_bigendian=big, step=WIDTH * width + 4, data=rows.reshape(-1)
    )


def message(name, header, grey):
    deep = grey.astype(numpy.uint16) * 256 + 77
    match name:
        case "mono8":
            return raw(header, "mono8", grey)
        case "mono16":
            return raw(header, "mono16", deep.astype("<u2"))
        case "mono16-big":
            return raw(header, "mono16", deep.astype(">u2"), 1)
        case _:
            data = numpy.frombuffer(png(grey), dtype=numpy.uint8)
            return COMPRESSED, store.types[COMPRESSED](header=header, format="mono8; png compressed", data=data)


for name in ["mono8", "mono16", "mono16-big", "png"]:
    writer = Writer(folder / f"{name}.bag")
    writer.set_compression(Writer.CompressionFormat.LZ4)
    with writer:
        other = writer.add_connection("/said", "std_msgs/msg/String", typestore=store)
        topic = None
        for number in range(count):
            time = store.types["builtin_interfaces/msg/Time"](sec=1_700_000_000 + number, nanosec=250_000_000)
            header = store.types["std_msgs/msg/Header"](seq=number, stamp=time, frame_id="cam")
            kind, image = message(name, header, pixels(number))
            topic = topic or writer.add_connection("/camera/image_raw", kind, typestore=store)
            writer.write(topic, (1_700_000_000 + number) * 1_000_000_000, store.serialize_ros1(image, kind))
            said = store.types["std_msgs/msg/String"](data="x" * number)
            writer.write(other, (1_700_000_000 + number) * 1_000_000_000, store.serialize_ros1(said, "std_msgs/msg/String"))
