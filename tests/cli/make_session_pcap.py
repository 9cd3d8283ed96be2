"""Makes what somebody with an Ouster and a camera records: its packets (monday.pcap) with its metadata
(os.json), and a folder of images named by their times, with the camera's lens as camera_info.
Usage: make_session_pcap.py SESSION OUT_DIR
SESSION is of `rgbdt simulate --lidar 128`. Each view is a sweep of 0.1 s, two seconds apart; its image
is of the sweep's middle."""

import os
import shutil
import struct
import sys

from make_bag import read_pcd, read_session

EPOCH_NS = 1_700_000_000_000_000_000
APART_NS, TURN_NS = 2_000_000_000, 100_000_000
IN_PACKET = 8
CAMERA = "rgb"


def beams(path):
    """Rows, columns, and of each beam, row by row from the lowest ring, range [mm] and reflectivity."""
    fields, columns, rows, data = read_pcd(path)
    record = struct.Struct("<" + "".join(
        {("F", 4): "f", ("F", 8): "d", ("U", 2): "H", ("I", 4): "i", ("U", 4): "I"}[kind, size]
        for _, kind, size in fields))
    found = []
    for x, y, z, intensity, *_ in record.iter_unpack(data):
        distance = (x * x + y * y + z * z) ** 0.5
        found.append((round(1000 * distance), round(255 * min(intensity, 1))) if distance > 0 else (0, 0))
    return rows, columns, found


def packets(rows, columns, found, start_ns, frame):
    """LEGACY profile: a turn begins at the seam, x backwards, and goes clockwise; highest ring first."""
    for first in range(0, columns, IN_PACKET):
        data = b""
        for measurement in range(first, first + IN_PACKET):
            time_ns = start_ns + measurement * TURN_NS // columns
            data += struct.pack("<QHHI", time_ns, measurement, frame, 0)
            column = (columns - measurement) % columns
            for row in range(rows - 1, -1, -1):
                distance, reflectivity = found[row * columns + column]
                data += struct.pack("<IBBHHH", distance, reflectivity, 0, 0, 0, 0)
            data += b"\xff\xff\xff\xff"
        yield time_ns, data


def write_packet(file, time_ns, number, data):
    udp = struct.pack(">HHHH", 7502, 7502, 8 + len(data), 0) + data
    ip = struct.pack(">BBHHHBBH4s4s", 0x45, 0, 20 + len(udp), number & 0xFFFF, 0, 64, 17, 0, b"\n\0\0\1",
                     b"\n\0\0\2")
    file.write(struct.pack("<IIII", time_ns // 10**9, time_ns % 10**9 // 1000, len(ip + udp), len(ip + udp)))
    file.write(ip + udp)


def write_metadata(path, rows, columns):
    numbers = lambda values: "[" + ", ".join(f"{v:.6f}" for v in values) + "]"
    low, high = -25, 15  # degrees, of `--lidar 128`
    altitudes = [high - (high - low) * row / (rows - 1) for row in range(rows)]
    with open(path, "w", encoding="ascii") as file:
        file.write(f"""{{"prod_line": "OS-1-128", "lidar_origin_to_beam_origin_mm": 0,
"data_format": {{"columns_per_frame": {columns}, "columns_per_packet": {IN_PACKET},
  "pixels_per_column": {rows}, "pixel_shift_by_row": {[0] * rows}}},
"beam_altitude_angles": {numbers(altitudes)},
"beam_azimuth_angles": {numbers([0] * rows)},
"lidar_to_sensor_transform": [-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}}
""")


def write_lens(path, lens):
    k = [lens["fx"], 0, lens["cx"], 0, lens["fy"], lens["cy"], 0, 0, 1]
    with open(path, "w", encoding="ascii") as file:
        file.write(f"""image_width: {lens["width"]}
image_height: {lens["height"]}
distortion_model: plumb_bob
camera_matrix: {{rows: 3, cols: 3, data: {k}}}
distortion_coefficients: {{rows: 1, cols: {len(lens["d"])}, data: {lens["d"]}}}
""")


def main():
    session, out = sys.argv[1:]
    lenses, views = read_session(session)
    os.makedirs(os.path.join(out, "images"))
    write_lens(os.path.join(out, "camera_info.yaml"), lenses[CAMERA])
    with open(os.path.join(out, "monday.pcap"), "wb") as file:
        file.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 101))
        number = 0
        for i, view in enumerate(views):
            rows, columns, found = beams(os.path.join(view, "cloud.pcd"))
            start_ns = EPOCH_NS + i * APART_NS
            for time_ns, data in packets(rows, columns, found, start_ns, i):
                write_packet(file, time_ns, number, data)
                number += 1
            at = start_ns + TURN_NS // 2
            shutil.copy(os.path.join(view, CAMERA + ".png"),
                        os.path.join(out, "images", f"{at // 10**9}.{at % 10**9 // 10**6:03}.png"))
    write_metadata(os.path.join(out, "os.json"), rows, columns)


main()
