"""Makes a fused cloud (PLY) of what is hard to compress without loss: places as far as LAS holds and
in one place, times that jump, stand still and run backwards, any float as a temperature.
Usage: make_cloud.py OUT POINTS wild|same"""
import math
import random
import struct
import sys

path, count, kind = sys.argv[1], int(sys.argv[2]), sys.argv[3]
FIELDS = {"x": "f", "y": "f", "z": "f", "intensity": "f", "utime": "d", "red": "B", "green": "B", "blue": "B",
          "temperature": "f", "temperature_sigma": "f"}
NAMES = {"f": "float", "d": "double", "B": "uchar"}
MOST = 214_000.0
rng = random.Random(7)


def a_float():
    value, = struct.unpack("<f", struct.pack("<I", rng.getrandbits(32)))
    return value if math.isfinite(value) else math.nan


def place():
    size = rng.randrange(6)
    if size == 0:
        return [rng.choice((-MOST, MOST)) for _ in range(3)]
    most = MOST if size == 1 else 10.0**size
    return [rng.uniform(-most, most) for _ in range(3)]


utime = 1_700_000_000_000_000
rows = []
for i in range(count):
    if kind == "same":
        rows.append((1, 2, 3, 0.5, utime, 200, 100, 50, 300, 0.1))
        continue
    how = rng.randrange(10)
    if how < 4:
        utime += 100
    elif how < 6:
        utime += rng.randrange(-50, 50) * rng.choice((1, 100, 10_000))
    elif how == 6:
        utime = rng.choice((1_650_000_000_000_000, 1_750_000_000_000_000)) + rng.randrange(1000)
    grey = rng.randrange(256)
    colour = [grey] * 3 if how % 3 == 0 else [rng.randrange(256) for _ in range(3)]
    rows.append((*place(), rng.choice((0, 1, 0.5, rng.random())), utime, *colour, a_float(), a_float()))

head = ["ply", "format binary_little_endian 1.0", f"element vertex {count}"]
head += [f"property {NAMES[code]} {name}" for name, code in FIELDS.items()] + ["end_header", ""]
with open(path, "wb") as f:
    f.write("\n".join(head).encode())
    for row in rows:
        f.write(struct.pack("<" + "".join(FIELDS.values()), *row))
