#!/usr/bin/env python3
"""Makes a bag of a session's views, byte by byte from the formats' pages: what `rgbdt import` reads
is written here by nobody who shares its code. Packing is by the libraries themselves (ctypes), sqlite
by Python's module.

Usage: make_bag.py SESSION BAG[:none|zstd|lz4|bz2]... [options]

BAG's ending says which: .mcap, .db3 (ROS 2) or .bag (ROS 1); .ros1 is ROS 1's messages in MCAP. Each
view of the session lasts for --seconds; clouds come once a second, images --rate times.
"""
import argparse
import bz2
import ctypes
import functools
import itertools
import os
import re
import sqlite3
import struct
import zlib

EPOCH_NS = 1_700_000_000_000_000_000
FIELD_TYPES = {("I", 1): 1, ("U", 1): 2, ("I", 2): 3, ("U", 2): 4, ("I", 4): 5, ("U", 4): 6,
               ("F", 4): 7, ("F", 8): 8}


@functools.lru_cache(maxsize=None)
def unpack_png(path):
    """width, height, channels, bytes per sample (little-endian), pixels (RGB as stored)"""
    data = open(path, "rb").read()
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack_from(">IIBB", data, at + 8)
        if kind == b"IDAT":
            packed += data[at + 8:at + 8 + length]
        at += 12 + length
    raw, channels = zlib.decompress(packed), 3 if colour == 2 else 1
    step, row_bytes = channels * depth // 8, width * channels * depth // 8
    rows, above = [], bytes(row_bytes)
    for y in range(height):
        begin = y * (row_bytes + 1)
        rows.append(unfilter(raw[begin], raw[begin + 1:begin + 1 + row_bytes], above, step))
        above = rows[-1]
    pixels = b"".join(rows)
    if depth == 16:
        swapped = bytearray(pixels)
        swapped[0::2], swapped[1::2] = pixels[1::2], pixels[0::2]
        pixels = bytes(swapped)
    return width, height, channels, depth // 8, pixels


def unfilter(kind, row, above, step):
    if kind == 0:
        return row
    out = bytearray(len(row))
    if kind == 1:
        for c in range(step):
            out[c::step] = bytes(itertools.accumulate(row[c::step], lambda a, b: (a + b) & 255))
        return bytes(out)
    if kind == 2:
        return bytes((a + b) & 255 for a, b in zip(row, above))
    for i, value in enumerate(row):
        a, b = (out[i - step] if i >= step else 0), above[i]
        c = above[i - step] if i >= step else 0
        if kind == 3:
            guess = (a + b) // 2
        else:
            guess = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
        out[i] = (value + guess) & 255
    return bytes(out)


def read_pcd(path):
    """fields (name, type, size), width, height, records"""
    data = open(path, "rb").read()
    end = data.index(b"DATA binary\n") + len(b"DATA binary\n")
    header = {line.split()[0]: line.split()[1:] for line in data[:end].decode().splitlines()}
    fields = list(zip(header["FIELDS"], header["TYPE"], map(int, header["SIZE"])))
    return fields, int(header["WIDTH"][0]), int(header["HEIGHT"][0]), data[end:]


class Ros1:
    """Packed, little-endian."""
    def __init__(self):
        self.bytes = bytearray()

    def put(self, format_, *values):
        for kind, value in zip(format_, values):
            self.bytes += struct.pack("<" + kind, value)

    def text(self, text):
        self.put("I", len(text))
        self.bytes += text.encode()

    def header(self, stamp_ns, frame):
        self.put("III", 0, stamp_ns // 10**9, stamp_ns % 10**9)
        self.text(frame)

    def blob(self, data):
        self.put("I", len(data))
        self.bytes += data

    def done(self):
        return bytes(self.bytes)


class Cdr(Ros1):
    """XCDR1: aligned, texts with a zero."""
    def __init__(self, big_endian=False):
        super().__init__()
        self.order = ">" if big_endian else "<"

    def put(self, format_, *values):
        for kind, value in zip(format_, values):
            size = struct.calcsize(kind)
            self.bytes += bytes(-len(self.bytes) % size) + struct.pack(self.order + kind, value)

    def text(self, text):
        self.put("I", len(text) + 1)
        self.bytes += text.encode() + b"\0"

    def header(self, stamp_ns, frame):
        self.put("iI", stamp_ns // 10**9, stamp_ns % 10**9)
        self.text(frame)

    def done(self):
        return (b"\0\0\0\0" if self.order == ">" else b"\0\1\0\0") + bytes(self.bytes)


def image(new, stamp_ns, frame, path, mosaic):
    width, height, channels, sample, pixels = unpack_png(path)
    encoding = "rgb8" if channels == 3 else ("mono16" if sample == 2 else "mono8")
    if mosaic and encoding == "mono8":
        encoding = "bayer_rggb8"
    m = new()
    m.header(stamp_ns, frame)
    m.put("II", height, width)
    m.text(encoding)
    m.put("BI", 0, width * channels * sample)
    m.blob(pixels)
    return m.done()


def compressed_image(new, stamp_ns, frame, path):
    m = new()
    m.header(stamp_ns, frame)
    m.text("mono8; png compressed mono8")
    m.blob(open(path, "rb").read())
    return m.done()


def camera_info(new, stamp_ns, frame, lens):
    m = new()
    m.header(stamp_ns, frame)
    m.put("II", lens["height"], lens["width"])
    m.text("plumb_bob")
    m.put("I", len(lens["d"]))
    m.put("d" * len(lens["d"]), *lens["d"])
    k = [lens["fx"], 0, lens["cx"], 0, lens["fy"], lens["cy"], 0, 0, 1]
    m.put("d" * 9, *k)
    m.put("d" * 9, 1, 0, 0, 0, 1, 0, 0, 0, 1)
    m.put("d" * 12, *k[:3], 0, *k[3:6], 0, *k[6:], 0)
    m.put("IIIIIIB", 0, 0, 0, 0, 0, 0, 0)
    return m.done()


def with_timestamps(fields, count, data):
    """Fields (name, offset, datatype) and points as of a PointCloud2, which has no whole numbers of
    64 bits: `utime` [us] becomes `timestamp` [s]."""
    step = sum(size for _, _, size in fields)
    out, described, at = bytearray(data), [], 0
    for name, kind, size in fields:
        if name == "utime":
            for i in range(count):
                utime, = struct.unpack_from("<d" if kind == "F" else "<q", data, i * step + at)
                struct.pack_into("<d", out, i * step + at, utime / 1e6)
            name, kind = "timestamp", "F"
        described.append((name, at, FIELD_TYPES[kind, size]))
        at += size
    return described, bytes(out)


def point_cloud(new, stamp_ns, frame, path):
    fields, width, height, data = read_pcd(path)
    described, data = with_timestamps(fields, width * height, data)
    step = sum(size for _, _, size in fields)
    m = new()
    m.header(stamp_ns, frame)
    m.put("II", height, width)
    m.put("I", len(described))
    for name, offset, datatype in described:
        m.text(name)
        m.put("IBI", offset, datatype, 1)
    m.put("BII", 0, step, step * width)
    m.blob(data)
    m.put("B", 0)
    return m.done()


def transforms(new, stamp_ns, poses):
    """(parent, child, translation, rotation x y z w)"""
    m = new()
    m.put("I", len(poses))
    for parent, child, translation, rotation in poses:
        m.header(stamp_ns, parent)
        m.text(child)
        m.put("ddddddd", *translation, *rotation)
    return m.done()


def zstd(data):
    library = ctypes.CDLL("libzstd.so.1")
    library.ZSTD_compressBound.restype = library.ZSTD_compress.restype = ctypes.c_size_t
    room = library.ZSTD_compressBound(ctypes.c_size_t(len(data)))
    out = ctypes.create_string_buffer(room)
    size = library.ZSTD_compress(out, ctypes.c_size_t(room), data, ctypes.c_size_t(len(data)), 1)
    return out.raw[:size]


def lz4(data):
    library = ctypes.CDLL("liblz4.so.1")
    library.LZ4F_compressFrameBound.restype = ctypes.c_size_t
    library.LZ4F_compressFrame.restype = ctypes.c_size_t
    room = library.LZ4F_compressFrameBound(ctypes.c_size_t(len(data)), None)
    out = ctypes.create_string_buffer(room)
    size = library.LZ4F_compressFrame(out, ctypes.c_size_t(room), data,
                                      ctypes.c_size_t(len(data)), None)
    return out.raw[:size]


PACK = {"none": bytes, "zstd": zstd, "lz4": lz4, "bz2": bz2.compress}


class Mcap:
    def __init__(self, path, args, encoding, compression):
        self.file, self.args, self.encoding = open(path, "wb"), args, encoding
        self.compression = compression
        self.topics, self.chunk, self.count = {}, bytearray(), 0
        self.file.write(b"\x89MCAP0\r\n")
        self.file.write(self.record(1, self.text("ros2") + self.text("make_bag.py")))

    def record(self, opcode, content):
        return struct.pack("<BQ", opcode, len(content)) + content

    def text(self, text):
        return struct.pack("<I", len(text)) + text.encode()

    def write(self, topic, type_, log_ns, data):
        records = b""
        if topic not in self.topics:
            self.topics[topic] = channel = len(self.topics) + 1
            records += self.record(3, struct.pack("<H", channel) + self.text(type_) +
                                   self.text("ros2msg") + self.text("# not needed"))
            records += self.record(4, struct.pack("<HH", channel, channel) + self.text(topic) +
                                   self.text(self.encoding) + struct.pack("<I", 0))
        records += self.record(5, struct.pack("<HIQQ", self.topics[topic], self.count, log_ns,
                                              log_ns) + data)
        self.count += 1
        if self.args.no_chunks:
            self.file.write(records)
            return
        self.chunk += records
        if len(self.chunk) > 4_000_000:
            self.end_chunk()

    def end_chunk(self):
        if not self.chunk:
            return
        packed = PACK[self.compression](bytes(self.chunk))
        name = "" if self.compression == "none" else self.compression
        self.file.write(self.record(6, struct.pack("<QQQI", 0, 0, len(self.chunk),
                                                   zlib.crc32(self.chunk)) + self.text(name) +
                                    struct.pack("<Q", len(packed)) + packed))
        self.file.write(self.record(7, struct.pack("<HI", 1, 0)))  # an index that nobody needs
        self.chunk = bytearray()

    def close(self):
        self.end_chunk()
        if not self.args.no_summary:
            self.file.write(self.record(15, struct.pack("<I", 0)))
            self.file.write(self.record(2, struct.pack("<QQI", 0, 0, 0)) + b"\x89MCAP0\r\n")
        self.file.close()


class Ros2Sqlite:
    def __init__(self, path, _args, _encoding, compression):
        if os.path.exists(path):
            os.remove(path)
        self.database, self.compression, self.topics = sqlite3.connect(path), compression, {}
        self.database.execute(
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
            "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)")
        self.database.execute(
            "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
            "timestamp INTEGER NOT NULL, data BLOB NOT NULL)")

    def write(self, topic, type_, log_ns, data):
        if topic not in self.topics:
            self.topics[topic] = len(self.topics) + 1
            self.database.execute("INSERT INTO topics VALUES (?, ?, ?, 'cdr', '')",
                                  (self.topics[topic], topic, type_))
        self.database.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)",
                              (self.topics[topic], log_ns, PACK[self.compression](data)))

    def close(self):
        self.database.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
        self.database.commit()
        self.database.close()


class Ros1Bag:
    def __init__(self, path, _args, _encoding, compression):
        self.file, self.topics, self.chunk = open(path, "wb"), {}, bytearray()
        self.compression = compression
        self.file.write(b"#ROSBAG V2.0\n")
        fields = {"op": b"\3", "index_pos": bytes(8), "conn_count": bytes(4),
                  "chunk_count": bytes(4)}
        header = self.fields(fields)
        self.file.write(header + struct.pack("<I", 4096 - len(header) - 4) +
                        b" " * (4096 - len(header) - 4))

    def fields(self, values):
        texts = [name.encode() + b"=" + value for name, value in values.items()]
        joined = b"".join(struct.pack("<I", len(text)) + text for text in texts)
        return struct.pack("<I", len(joined)) + joined

    def record(self, values, data):
        return self.fields(values) + struct.pack("<I", len(data)) + data

    def write(self, topic, type_, log_ns, data):
        if topic not in self.topics:
            self.topics[topic] = struct.pack("<I", len(self.topics))
            about = self.fields({"topic": topic.encode(), "type": type_.encode(), "md5sum": b"*",
                                 "message_definition": b"# not needed"})[4:]
            self.chunk += self.record({"op": b"\7", "conn": self.topics[topic],
                                       "topic": topic.encode()}, about)
        time = struct.pack("<II", log_ns // 10**9, log_ns % 10**9)
        self.chunk += self.record({"op": b"\2", "conn": self.topics[topic], "time": time}, data)
        if len(self.chunk) > 4_000_000:
            self.end_chunk()

    def end_chunk(self):
        if not self.chunk:
            return
        packed = PACK[self.compression](bytes(self.chunk))
        self.file.write(self.record({"op": b"\5", "compression": self.compression.encode(),
                                     "size": struct.pack("<I", len(self.chunk))}, packed))
        self.file.write(self.record({"op": b"\4", "ver": struct.pack("<I", 1), "conn": bytes(4),
                                     "count": bytes(4)}, b""))
        self.chunk = bytearray()

    def close(self):
        self.end_chunk()
        self.file.close()


def read_session(session):
    """Per view: cloud, images by camera; the lenses of the rig."""
    rig = open(os.path.join(session, "rig.textproto")).read()
    lenses = {}
    for block in re.findall(r"^camera \{\n(.*?)^\}", rig, re.S | re.M):
        value = lambda key: float(re.search(rf"\b{key}: ([-+.e\d]+)", block).group(1))
        lenses[re.search(r'name: "(\w+)"', block).group(1)] = {
            "width": int(value("width")), "height": int(value("height")),
            **{key: value(key) for key in ("fx", "fy", "cx", "cy")},
            "d": [float(d) for d in re.search(r"distortion: \[(.*?)\]", block).group(1).split(",")]}
    views = sorted(os.listdir(os.path.join(session, "views")))
    return lenses, [os.path.join(session, "views", view) for view in views]


def clouds_of(view):
    """(name, file) of the view's LIDARs, the reference first"""
    names = sorted(name for name in os.listdir(view) if re.fullmatch(r"cloud_\w+\.pcd", name))
    return [("lidar", os.path.join(view, "cloud.pcd"))] + [
        (name[6:-4], os.path.join(view, name)) for name in names]


def write_views(bag, args, ros1, lenses, views):
    new = Ros1 if ros1 else (lambda: Cdr(args.big_endian))
    name = lambda type_: type_ if ros1 else type_.replace("/", "/msg/")
    if args.tf:
        poses = [("base", "lidar", (0, 0, 1), (0, 0, 0, 1)),
                 ("base", "rgb_link", (0, 0, 1.1), (0, 0, 0, 1)),
                 ("rgb_link", "rgb_optical", (0, 0, 0), (-0.5, 0.5, -0.5, 0.5))]
        bag.write("/tf_static", name("tf2_msgs/TFMessage"), EPOCH_NS, transforms(new, EPOCH_NS, poses))
    bag.write("/chatter", name("std_msgs/String"), EPOCH_NS, b"whatever")
    for second in range(args.seconds * len(views)):
        view, at = views[second // args.seconds], EPOCH_NS + second * 10**9
        for lidar, path in clouds_of(view):
            bag.write(f"/{lidar}/points", name("sensor_msgs/PointCloud2"), at + 150_000_000,
                      point_cloud(new, at, lidar, path))
        for frame, (camera, lens) in itertools.product(range(args.rate), lenses.items()):
            optical, path = camera + "_optical", os.path.join(view, camera + ".png")
            stamp = at + 20_000_000 + frame * 10**9 // args.rate
            if not args.no_info:
                bag.write(f"/{camera}/camera_info", name("sensor_msgs/CameraInfo"), stamp,
                          camera_info(new, stamp, optical, lens))
            if args.png:
                bag.write(f"/{camera}/image_raw/compressed", name("sensor_msgs/CompressedImage"),
                          stamp + 50_000_000, compressed_image(new, stamp, optical, path))
            else:
                bag.write(f"/{camera}/image_raw", name("sensor_msgs/Image"), stamp + 50_000_000,
                          image(new, stamp, optical, path, args.mosaic))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("session")
    parser.add_argument("bags", nargs="+")
    for flag in ("--no-summary", "--no-chunks", "--mosaic", "--big-endian", "--tf", "--png",
                 "--no-info"):
        parser.add_argument(flag, action="store_true")
    parser.add_argument("--views", type=int, default=9999, help="only so many")
    parser.add_argument("--seconds", type=int, default=1, help="that each view lasts")
    parser.add_argument("--rate", type=int, default=1, help="of the images [Hz]")
    parser.add_argument("--cut", type=int, default=0, help="bytes that are missing at the end")
    args = parser.parse_args()
    lenses, views = read_session(args.session)
    for bag in args.bags:
        path, _, compression = bag.partition(":")
        ros1 = path.endswith((".bag", ".ros1"))
        kind = (Ros1Bag if path.endswith(".bag") else Ros2Sqlite if path.endswith(".db3") else Mcap)
        writer = kind(path, args, "ros1" if ros1 else "cdr", compression or "none")
        write_views(writer, args, ros1, lenses, views[:args.views])
        writer.close()
        if args.cut:
            with open(path, "r+b") as file:
                file.truncate(os.path.getsize(path) - args.cut)


if __name__ == "__main__":
    main()
