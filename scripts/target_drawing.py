"""What scripts/target draws. Millimetres, from the board's top left corner, x right, y down."""

import os
import re
import sys

NUMBER = r"([0-9]+(?:\.[0-9]+)?)"


def die(message):
    sys.exit("target: " + message)


def parse(name, text, pattern, example):
    match = re.fullmatch(pattern, text)
    if not match:
        die(f"{name} is '{text}'; expected something like {example}")
    return [float(group) for group in match.groups()]


class Board:
    def __init__(self, squares, square_mm, board_mm, offset_mm, border):
        self.nx, self.ny = (int(n) for n in parse("--squares", squares, r"(\d+)x(\d+)", "11x8"))
        (self.side,) = parse("--square-mm", square_mm, NUMBER, "100")
        self.width, self.height = parse("--board-mm", board_mm, NUMBER + "x" + NUMBER, "1219.2x914.4")
        signed = r"(-?[0-9]+(?:\.[0-9]+)?)"
        self.offset = parse("--offset-mm", offset_mm, signed + "," + signed, "0,0")
        self.black_border = border == "black"
        self.check(border)
        self.left = 0.5 * (self.width - self.nx * self.side) + self.offset[0]
        self.top = 0.5 * (self.height - self.ny * self.side) + self.offset[1]

    def check(self, border):
        if border not in ("black", "white"):
            die(f"--border is '{border}'; expected black or white")
        if not (3 <= self.nx <= 100 and 3 <= self.ny <= 100):
            die(f"--squares is {self.nx}x{self.ny}; expected 3 to 100 each way")
        if self.side <= 0:
            die("--square-mm is 0; expected more")
        for name, board, count, offset in (
            ("width", self.width, self.nx, self.offset[0]),
            ("height", self.height, self.ny, self.offset[1]),
        ):
            needed = count * self.side + 2 * abs(offset)
            if needed > board + 1e-9:
                die(f"--board-mm: the {name} is {board:g} mm, the pattern needs {needed:g} mm")

    def squares(self, black):
        """(x, y) of the top left corner of each square of one colour; the top left one is black."""
        for row in range(self.ny):
            for column in range(self.nx):
                if ((row + column) % 2 == 0) == black:
                    yield self.left + column * self.side, self.top + row * self.side

    def pattern(self):
        return self.left, self.top, self.nx * self.side, self.ny * self.side


def text(value):
    return f"{value:.4f}".rstrip("0").rstrip(".")


def svg(board):
    def rect(x, y, width, height, fill):
        return (
            f'<rect x="{text(x)}" y="{text(y)}" width="{text(width)}" height="{text(height)}" '
            f'fill="{fill}"/>'
        )

    size = f'width="{text(board.width)}mm" height="{text(board.height)}mm"'
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} '
        f'viewBox="0 0 {text(board.width)} {text(board.height)}">',
        f"<title>{board.nx}x{board.ny} squares of {text(board.side)} mm on "
        f"{text(board.width)}x{text(board.height)} mm</title>",
        rect(0, 0, board.width, board.height, "black" if board.black_border else "white"),
        rect(*board.pattern(), "white"),
    ]
    lines += [rect(x, y, board.side, board.side, "black") for x, y in board.squares(True)]
    return "\n".join(lines + ["</svg>", ""])


LAYERS = {"CUT": 1, "FRAME": 3, "BLACK": 7, "WHITE": 5}  # and their colours


def dxf(board):
    """R12 ASCII: what every laser cutter's software reads. DXF's y points up."""

    def polyline(layer, x, y, width, height):
        yield from (0, "POLYLINE", 8, layer, 66, 1, 10, 0, 20, 0, 30, 0, 70, 1)  # 70: closed
        for u, v in ((x, y), (x + width, y), (x + width, y + height), (x, y + height)):
            yield from (0, "VERTEX", 8, layer, 10, text(u), 20, text(board.height - v), 30, 0)
        yield from (0, "SEQEND", 8, layer)

    codes = [0, "SECTION", 2, "HEADER", 9, "$ACADVER", 1, "AC1009"]
    codes += [9, "$EXTMIN", 10, 0, 20, 0, 30, 0]
    codes += [9, "$EXTMAX", 10, text(board.width), 20, text(board.height), 30, 0, 0, "ENDSEC"]
    codes += [0, "SECTION", 2, "TABLES", 0, "TABLE", 2, "LAYER", 70, len(LAYERS)]
    for layer, colour in LAYERS.items():
        codes += [0, "LAYER", 2, layer, 70, 0, 62, colour, 6, "CONTINUOUS"]
    codes += [0, "ENDTAB", 0, "ENDSEC", 0, "SECTION", 2, "ENTITIES"]
    codes += polyline("CUT", 0, 0, board.width, board.height)
    codes += polyline("FRAME", *board.pattern())
    for layer, black in (("BLACK", True), ("WHITE", False)):
        for x, y in board.squares(black):
            codes += polyline(layer, x, y, board.side, board.side)
    codes += [0, "ENDSEC", 0, "EOF"]
    return "\n".join(str(code) for code in codes) + "\n"


def textproto(board):
    metres = lambda mm: f"{mm / 1000:.7f}".rstrip("0").rstrip(".")
    lines = [
        "# As drawn. Measure the finished board to 1 mm and write here what it is.",
        "target {",
        f"  squares_x: {board.nx} squares_y: {board.ny} square_m: {metres(board.side)}",
        f"  width_m: {metres(board.width)} height_m: {metres(board.height)}",
    ]
    if any(board.offset):
        lines.append(f"  pattern_offset_m: [{metres(board.offset[0])}, {metres(board.offset[1])}]")
    return "\n".join(lines + ["}", ""])


def write(path, content):
    """All or nothing."""
    with open(path + ".tmp", "w", encoding="ascii") as file:
        file.write(content)
    os.replace(path + ".tmp", path)


def main():
    board = Board(*sys.argv[1:6])
    out = sys.argv[6]
    try:
        os.makedirs(out, exist_ok=True)
        for name, content in (("svg", svg), ("dxf", dxf), ("textproto", textproto)):
            write(os.path.join(out, "target." + name), content(board))
    except OSError as error:
        die(f"cannot write to {out}: {error.strerror}")
    print(textproto(board), end="")


main()
