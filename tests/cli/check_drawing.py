"""Looks at what scripts/target drew as a printer and a laser cutter would. Exit code 1: wrong."""

import argparse
import sys
import xml.etree.ElementTree as ElementTree

parser = argparse.ArgumentParser()
parser.add_argument("dir")
parser.add_argument("--board", nargs=2, type=float)
parser.add_argument("--squares", nargs=2, type=int)
parser.add_argument("--corners", type=int)
parser.add_argument("--black-mm2", type=float)
parser.add_argument("--first-corner", nargs=2, type=float)
args = parser.parse_args()


def expect(what, found, wanted):
    if isinstance(wanted, float):
        good = abs(found - wanted) < 1e-3
    else:
        good = found == wanted
    if not good:
        sys.exit(f"{what}: {found}, expected {wanted}")


def black_area(root):
    """Of what is seen in the end, by painting: rectangles split the plane into cells."""
    rects = []
    for r in root.iter("{http://www.w3.org/2000/svg}rect"):
        x, y, w, h = (float(r.get(key)) for key in ("x", "y", "width", "height"))
        rects.append((x, y, x + w, y + h, r.get("fill")))
    xs = sorted({round(x, 4) for r in rects for x in (r[0], r[2])})
    ys = sorted({round(y, 4) for r in rects for y in (r[1], r[3])})
    area = 0.0
    for x0, x1 in zip(xs, xs[1:]):
        for y0, y1 in zip(ys, ys[1:]):
            x, y, colour = (x0 + x1) / 2, (y0 + y1) / 2, None
            for left, top, right, bottom, fill in rects:
                if left < x < right and top < y < bottom:
                    colour = fill
            area += (x1 - x0) * (y1 - y0) if colour == "black" else 0
    return area


def polylines(path):
    """(layer, closed, [(x, y)]) of each polyline of an R12 file."""
    with open(path, encoding="ascii") as file:
        lines = file.read().splitlines()
    expect("DXF: lines come in pairs; their number modulo 2", len(lines) % 2, 0)
    found, kind = [], None
    for code, value in zip((int(line) for line in lines[::2]), lines[1::2]):
        if code == 0:
            kind = value
            if kind == "POLYLINE":
                found.append([None, False, []])
        elif kind == "POLYLINE" and code == 8:
            found[-1][0] = value
        elif kind == "POLYLINE" and code == 70:
            found[-1][1] = int(value) & 1 == 1
        elif kind == "VERTEX" and code == 10:
            found[-1][2].append([float(value)])
        elif kind == "VERTEX" and code == 20:
            found[-1][2][-1].append(float(value))
    expect("DXF: last entity", kind, "EOF")
    return found


svg = ElementTree.parse(args.dir + "/target.svg").getroot()
expect("SVG: width", svg.get("width"), f"{args.board[0]:g}mm")
expect("SVG: height", svg.get("height"), f"{args.board[1]:g}mm")
expect("SVG: view box", svg.get("viewBox"), f"0 0 {args.board[0]:g} {args.board[1]:g}")
expect("SVG: black area", black_area(svg), args.black_mm2)

lines = polylines(args.dir + "/target.dxf")
for layer, closed, points in lines:
    expect(f"DXF: a line of {layer} is closed", closed, True)
    expect(f"DXF: corners of a line of {layer}", len(points), 4)
by_layer = lambda name: [points for layer, _, points in lines if layer == name]
squares = args.squares[0] * args.squares[1]
expect("DXF: boards", len(by_layer("CUT")), 1)
expect("DXF: frames", len(by_layer("FRAME")), 1)
expect("DXF: black squares", len(by_layer("BLACK")), (squares + 1) // 2)
expect("DXF: white squares", len(by_layer("WHITE")), squares // 2)
expect("DXF: width", max(x for x, y in by_layer("CUT")[0]), args.board[0])
expect("DXF: height", max(y for x, y in by_layer("CUT")[0]), args.board[1])

# An inner corner is where two black squares meet; y points up in DXF.
met = {}
for points in by_layer("BLACK"):
    for x, y in points:
        at = (round(x, 3), round(args.board[1] - y, 3))
        met[at] = met.get(at, 0) + 1
corners = sorted((y, x) for (x, y), count in met.items() if count == 2)
expect("DXF: inner corners", len(corners), args.corners)
expect("DXF: first corner's x", corners[0][1], args.first_corner[0])
expect("DXF: first corner's y", corners[0][0], args.first_corner[1])
