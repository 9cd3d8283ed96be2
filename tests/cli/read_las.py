"""Reads a LAS file by the LAS 1.4 R15 specification alone and holds it against the PLY that it was
made from, read here, too. Usage: read_las.py LAS PLY"""
import math
import struct
import sys

NUMPY = {"float": "f", "double": "d", "uchar": "B", "uint": "I"}
EXTRA = {5: "I", 9: "f"}  # data types of extra bytes


def expect(good, what):
    if not good:
        sys.exit(what)


def text(field):
    return field.split(b"\0")[0].decode("ascii")


with open(sys.argv[2], "rb") as f:
    ply = f.read()
head, body = ply.split(b"end_header\n", 1)
lines = head.decode().splitlines()
count = next(int(line.split()[2]) for line in lines if line.startswith("element vertex"))
names = [line.split()[2] for line in lines if line.startswith("property")]
layout = "<" + "".join(NUMPY[line.split()[1]] for line in lines if line.startswith("property"))
truth = [dict(zip(names, row, strict=True)) for row in struct.iter_unpack(layout, body)]
expect(len(truth) == count, "the PLY itself")

with open(sys.argv[1], "rb") as f:
    las = f.read()
expect(las[:4] == b"LASF" and las[24:26] == b"\x01\x04", "not LAS 1.4")
encoding, = struct.unpack_from("<H", las, 6)
expect(encoding == 0b10001, f"global encoding {encoding}: not GPS time and WKT")
header_size, start, records, form, length = struct.unpack_from("<HIIBH", las, 94)
expect((header_size, form) == (375, 7), f"header of {header_size}, format {form}")
expect(struct.unpack_from("<6I", las, 107) == (0,) * 6, "counts of LAS 1.2 beside format 7")
scale, offset = struct.unpack_from("<3d", las, 131), struct.unpack_from("<3d", las, 155)
bounds = struct.unpack_from("<6d", las, 179)  # most, least of x, of y, of z
expect(struct.unpack_from("<QQI", las, 227) == (0, 0, 0), "waveforms, or records behind the points")
expect(struct.unpack_from("<16Q", las, 247) == (count, count) + (0,) * 14, "counts of points")

at, dimensions, said = header_size, [], ""
for _ in range(records):
    _, user, number, size, _ = struct.unpack_from("<H16sHH32s", las, at)
    expect(text(user) == "LASF_Spec", "a record of somebody else")
    data = las[at + 54:at + 54 + size]
    at += 54 + size
    if number == 4:
        for i in range(0, size, 192):
            dimensions.append((text(data[i + 4:i + 36]), EXTRA[data[i + 2]], text(data[i + 160:i + 192])))
    elif number == 3:
        said = text(data)
    else:
        sys.exit(f"record {number}: a coordinate system?")
expect(at == start, "records do not end where points begin")
expect("metres" in said and "no coordinate reference system" in said, f"it says {said!r}")
temperature = next(d for d in dimensions if d[0] == "temperature")
expect("[K]" in temperature[2], "temperature without a unit")
point = "<iiiHBBBBhHdHHH" + "".join(d[1] for d in dimensions)
expect(struct.calcsize(point) == length and start + count * length == len(las), "length of points")

seen = 0
least, most = [math.inf] * 3, [-math.inf] * 3
for row, expected in zip(struct.iter_unpack(point, las[start:]), truth, strict=True):
    for axis in range(3):
        metres = row[axis] * scale[axis] + offset[axis]
        least[axis], most[axis] = min(least[axis], metres), max(most[axis], metres)
        # Half a step, and what the double loses.
        expect(abs(metres - expected["xyz"[axis]]) <= 0.5e-4 + 1e-9, f"off: {row} {expected}")
    expect(row[4] == 0x11, "not return 1 of 1")
    if "intensity" in expected and not math.isnan(expected["intensity"]):
        expect(abs(row[3] / 65535 - expected["intensity"]) <= 0.5 / 65535 + 1e-7, "intensity")
    expect([c / 257 for c in row[11:14]] == [expected[c] for c in ("red", "green", "blue")], "colour")
    utc = expected["utime"] if "utime" in expected else expected["last_seen"]
    leaps = 16 if 1341100800e6 <= utc < 1435708800e6 else 18 if utc >= 1483228800e6 else None
    expect(leaps is not None, "times of other years than the test knows")
    gps = (utc - 315964800e6) / 1e6 + leaps - 1e9
    expect(abs(row[10] - gps) < 1e-6, f"gps_time {row[10]}, not {gps}")
    extra = dict(zip((d[0] for d in dimensions), row[14:], strict=True))
    for name, value in extra.items():
        wanted = expected.get(name, expected.get(name + "_k"))
        expect(value == wanted or math.isnan(value) and math.isnan(wanted), f"{name}: {value}")
    seen += not math.isnan(extra["temperature"])
for axis in range(3):
    expect(abs(bounds[2 * axis] - most[axis]) < 1e-9 and abs(bounds[2 * axis + 1] - least[axis]) < 1e-9,
           f"bounds of axis {axis}")
expect(seen > 0, "no point has a temperature")
print(f"{count} points, {seen} with a temperature; {', '.join(d[0] for d in dimensions)}")
