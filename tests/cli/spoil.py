"""A simulated session with one mistake that people make, as a session of its own.
Usage: spoil.py SESSION OUT MISTAKE
Clouds keep x, y, z, intensity and ring, which is what other people's drivers give."""

import pathlib
import re
import sys

import numpy as np
from PIL import Image

TYPES = {"F4": "<f4", "F8": "<f8", "U1": "u1", "U2": "<u2", "U4": "<u4", "U8": "<u8", "I4": "<i4"}
CLOUDS = {
    "cloud in millimetres": lambda p: 1000 * p,
    "cloud in camera axes": lambda p: np.stack([-p[:, 1], -p[:, 2], p[:, 0]], 1),
    "cloud mirrored": lambda p: p * [1, -1, 1],
}
NUMBERS = r"\[([^]]*)\]"


def read_cloud(path):
    data = path.read_bytes()
    body = data.index(b"\n", data.index(b"DATA binary")) + 1
    head = dict(line.split(" ", 1) for line in data[:body].decode().splitlines() if line[0] != "#")
    kinds = [TYPES[t + s] for t, s in zip(head["TYPE"].split(), head["SIZE"].split())]
    points = np.frombuffer(data[body:], list(zip(head["FIELDS"].split(), kinds)))
    return points[np.isfinite(points["x"])]


def write_cloud(path, points, xyz):
    fields = [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("intensity", "<f4"), ("ring", "<u2")]
    out = np.empty(len(points), fields)
    for axis, name in enumerate("xyz"):
        out[name] = xyz[:, axis]
    for name in ("intensity", "ring"):
        out[name] = points[name]
    path.write_bytes(b"VERSION 0.7\nFIELDS x y z intensity ring\nSIZE 4 4 4 4 2\nTYPE F F F F U\n"
                     b"COUNT 1 1 1 1 1\nWIDTH %d\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS %d\n"
                     b"DATA binary\n" % (len(points), len(points)) + out.tobytes())


def inverted(text):
    """camera_from_lidar_guess as lidar_from_camera."""

    def invert(match):
        w, x, y, z = (float(n) for n in re.search("wxyz: " + NUMBERS, match[0])[1].split(","))
        t = np.array([float(n) for n in re.search("translation_m: " + NUMBERS, match[0])[1].split(",")])
        v = np.array([-x, -y, -z])
        back = -(t + 2 * np.cross(v, np.cross(v, t) + w * t))
        return (f"camera_from_lidar_guess {{\n quaternion_wxyz: [{w}, {-x}, {-y}, {-z}]\n"
                f" translation_m: [{back[0]}, {back[1]}, {back[2]}]\n}}")

    return re.sub(r"camera_from_lidar_guess \{[^}]*\}", invert, text)


def in_millimetres(text):
    return re.sub(r"(square_m|width_m|height_m): ([0-9.]+)",
                  lambda m: f"{m[1]}: {1000 * float(m[2])}", text)


def scaled(text, names, by):
    """The first number of each of these names: the colour camera's, the board's."""
    for name in names:
        text = re.sub(rf"\b{name}: ([0-9.]+)", lambda m: f"{m[0][:-len(m[1])]}{by * float(m[1])}",
                      text, count=1)
    return text


def exchanged(text):
    fx, cx = (re.search(name + r": ([0-9.]+)", text)[1] for name in ("fx", "cx"))
    return text.replace(f"fx: {fx}", f"fx: {cx}", 1).replace(f"cx: {cx}", f"cx: {fx}", 1)


RIGS = {
    "guess inverted": inverted,
    "board in millimetres": in_millimetres,
    "board's sides exchanged": lambda t: re.sub(r"width_m: (\S+)\n(\s*)height_m: (\S+)",
                                                r"width_m: \3\n\2height_m: \1", t),
    "inner corners": lambda t: t.replace("squares_x: 11", "squares_x: 10").replace(
        "squares_y: 8", "squares_y: 7"),
    "fx and cx exchanged": exchanged,
    "focal length 10% too long": lambda t: scaled(t, ("fx", "fy"), 1.1),
    "squares 5% too large": lambda t: scaled(t, ("square_m",), 1.05),
}


def spoil(session, out, mistake):
    views = sorted(p.name for p in (session / "views").iterdir())
    rig = (session / "rig.textproto").read_text()
    out.mkdir(parents=True)
    (out / "rig.textproto").write_text(RIGS.get(mistake, lambda text: text)(rig))
    apart = 1 if mistake == "clouds of the next view" else 0
    for i, name in enumerate(views):
        own, cloud_of = session / "views" / name, session / "views" / views[(i + apart) % len(views)]
        view = out / "views" / name
        view.mkdir(parents=True)
        (view / "view.textproto").write_text((own / "view.textproto").read_text())
        points = read_cloud(cloud_of / "cloud.pcd")
        xyz = np.stack([points[axis] for axis in "xyz"], 1).astype(float)
        write_cloud(view / "cloud.pcd", points, CLOUDS.get(mistake, lambda p: p)(xyz))
        for image in own.glob("*.png"):
            picture = Image.open(image)
            if mistake == "images mirrored":
                picture = picture.transpose(Image.Transpose.FLIP_LEFT_RIGHT)
            picture.save(view / image.name)


if __name__ == "__main__":
    spoil(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3])
