"""A made-up Ouster's packets as a recording, and its metadata. Usage: make_pcap.py OUT.pcap OUT.json TURNS"""

import json
import struct
import sys

ROWS, COLUMNS, IN_PACKET = 16, 512, 16


def packet(turn, number):
    data = b""
    for column in range(number * IN_PACKET, (number + 1) * IN_PACKET):
        time_ns = (turn * COLUMNS + column) * 195_312
        data += struct.pack("<QHHI", time_ns, column, turn, 0)
        for row in range(ROWS):
            data += struct.pack("<IBBHHH", 0 if column < 8 else 3000 + row, 100, 0, 0, 0, 0)
        data += b"\xff\xff\xff\xff"
    return data


def main():
    pcap, metadata, turns = sys.argv[1], sys.argv[2], int(sys.argv[3])
    with open(pcap, "wb") as file:
        file.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 101))
        for i in range(turns * COLUMNS // IN_PACKET):
            data = packet(*divmod(i, COLUMNS // IN_PACKET))
            udp = struct.pack(">HHHH", 7502, 7502, 8 + len(data), 0) + data
            ip = struct.pack(">BBHHHBBH4s4s", 0x45, 0, 20 + len(udp), i, 0, 64, 17, 0, b"\n\0\0\1", b"\n\0\0\2")
            microseconds = i * 3125
            file.write(struct.pack("<IIII", 1_700_000_000 + microseconds // 10**6, microseconds % 10**6,
                                   len(ip + udp), len(ip + udp)) + ip + udp)
    with open(metadata, "w", encoding="utf-8") as file:
        json.dump({
            "prod_line": "OS-1-16",
            "data_format": {"columns_per_frame": COLUMNS, "columns_per_packet": IN_PACKET,
                            "pixels_per_column": ROWS, "pixel_shift_by_row": [0] * ROWS},
            "beam_altitude_angles": [15 - 2 * row for row in range(ROWS)],
            "beam_azimuth_angles": [0] * ROWS,
            "lidar_origin_to_beam_origin_mm": 15.8,
            "lidar_to_sensor_transform": [-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 36, 0, 0, 0, 1],
        }, file)


main()
