"""A recording of a LIDAR's packets (pcap, IPv4 without a link layer) as a bag, with a camera's images
beside. Usage: make_packet_bag.py IN.pcap METADATA.json OUT.mcap|OUT.bag [NAMESPACE...], each of which
publishes the same packets (ouster); the metadata are the first one's."""

import argparse
import os
import struct
import sys
import tempfile
import zlib

import make_bag

NS = 1000  # of a microsecond


def recorded(path):
    """(microseconds, payload)"""
    data, at = open(path, "rb").read(), 24
    while at < len(data):
        seconds, micro, size, _ = struct.unpack_from("<IIII", data, at)
        yield seconds * 10**6 + micro, data[at + 16 + 28:at + 16 + size]
        at += 16 + size


def grey_png(path, width, height):
    def chunk(kind, body):
        return (struct.pack(">I", len(body)) + kind + body +
                struct.pack(">I", zlib.crc32(kind + body)))
    rows = b"".join(b"\0" + bytes([y % 251] * width) for y in range(height))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def main():
    pcap, metadata, out = sys.argv[1:4]
    lidars = sys.argv[4:] or ["ouster"]
    ros1 = out.endswith(".bag")
    new = make_bag.Ros1 if ros1 else make_bag.Cdr
    args = argparse.Namespace(no_chunks=False, no_summary=False)
    bag = make_bag.Ros1Bag(out, args, "ros1", "none") if ros1 else make_bag.Mcap(out, args, "cdr", "zstd")
    middle = "" if ros1 else "msg/"

    def write(topic, package, type_, utime, data):
        bag.write(topic, f"{package}/{middle}{type_}", utime * NS, data)

    packets = list(recorded(pcap))
    lens = {"width": 320, "height": 240, "fx": 300.0, "fy": 300.0, "cx": 160.0, "cy": 120.0, "d": [0.0] * 5}
    with tempfile.TemporaryDirectory() as scratch:
        png = os.path.join(scratch, "grey.png")
        grey_png(png, lens["width"], lens["height"])
        for i, (utime, payload) in enumerate(packets):
            m = new()
            m.blob(payload)
            for lidar in lidars:
                write(f"/{lidar}/lidar_packets", "ouster_ros" if ros1 else "ouster_sensor_msgs", "PacketMsg",
                      utime, m.done())
            if i % 8 == 0:
                write("/cam/image_raw", "sensor_msgs", "Image", utime,
                      make_bag.image(new, utime * NS, "cam", png, False))
                write("/cam/camera_info", "sensor_msgs", "CameraInfo", utime,
                      make_bag.camera_info(new, utime * NS, "cam", lens))
    m = new()
    m.text(open(metadata, encoding="utf-8").read())
    write(f"/{lidars[0]}/metadata", "std_msgs", "String", packets[-1][0], m.done())
    bag.close()


main()
