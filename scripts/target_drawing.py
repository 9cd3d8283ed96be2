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

    def rectangles(self):
        """(x, y, width, height, black) over the pattern's white ground, in the order to paint."""
        for x, y in self.squares(True):
            yield x, y, self.side, self.side, True

    def circles(self):
        """(x, y, radius) of each hole."""
        return ()

    def fields(self):
        """Of the rig file's target, but for the board's size and the pattern's offset."""
        return [f"  squares_x: {self.nx} squares_y: {self.ny} square_m: {metres(self.side)}"]

    def title(self):
        return f"{self.nx}x{self.ny} squares of {text(self.side)} mm"


def markers_of(family, border):
    """Marker number -> its white cells (column, row), and how many cells a side has."""
    try:
        import cv2
    except ImportError:
        die("markers need Python's OpenCV: apt-get install python3-opencv")
    number = getattr(cv2.aruco, "DICT_" + family, None)
    if number is None:
        die(f"no markers are called '{family}'; expected OpenCV's names, such as 5X5_100")
    known = cv2.aruco.getPredefinedDictionary(number)
    cells = known.markerSize + 2 * border

    def white(marker):
        if marker >= len(known.bytesList):
            die(f"{family} has {len(known.bytesList)} markers, too few for this board")
        image = cv2.aruco.drawMarker(known, marker, cells, borderBits=border)
        return [(x, y) for y in range(cells) for x in range(cells) if image[y][x] > 127]

    return white, cells


class Charuco(Board):
    """A marker in each white square: black, with white cells."""

    def __init__(self, squares, square_mm, board_mm, offset_mm, border, charuco):
        super().__init__(squares, square_mm, board_mm, offset_mm, border)
        match = re.fullmatch(r"([0-9A-Za-z_]+)," + NUMBER, charuco)
        if not match:
            die(f"--charuco is '{charuco}'; expected something like 5X5_100,75")
        self.family, self.marker = match.group(1), float(match.group(2))
        if not 0 < self.marker < self.side:
            die(f"--charuco: a marker of {self.marker:g} mm is not smaller than its square")
        self.white, self.cells = markers_of(self.family, 1)

    def rectangles(self):
        """(x, y, width, height, black) over the pattern's white ground, in the order to paint."""
        for x, y in self.squares(True):
            yield x, y, self.side, self.side, True
        margin = 0.5 * (self.side - self.marker)
        cell = self.marker / self.cells
        for number, (x, y) in enumerate(self.squares(False)):
            yield x + margin, y + margin, self.marker, self.marker, True
            for column, row in self.white(number):
                yield x + margin + column * cell, y + margin + row * cell, cell, cell, False

    def fields(self):
        return [
            f"  charuco {{ squares_x: {self.nx} squares_y: {self.ny} square_m: {metres(self.side)}",
            f'            marker_m: {metres(self.marker)} dictionary: "{self.family}" }}',
        ]

    def title(self):
        return f"ChArUco, {self.nx}x{self.ny} squares of {text(self.side)} mm"


class AprilGrid(Board):
    """Black tags with white cells, and a black square where four gaps meet."""

    KALIBR_BORDER = 2  # cells

    def __init__(self, grid, board_mm, offset_mm):
        match = re.fullmatch(r"(\d+)x(\d+)," + NUMBER + "," + NUMBER + r"(?:,(\w+))?", grid)
        if not match:
            die(f"--aprilgrid is '{grid}'; expected something like 7x5,130,0.25")
        self.tags_x, self.tags_y = int(match.group(1)), int(match.group(2))
        self.tag, self.spacing = float(match.group(3)), float(match.group(4))
        self.family = match.group(5) or "36h11"
        if self.tags_x < 2 or self.tags_y < 2 or self.tag <= 0 or not 0 < self.spacing < 2:
            die("--aprilgrid: expected 2 tags or more each way, a size, a spacing of 0 to 2")
        self.gap = self.spacing * self.tag
        # Rows and columns are in turn a gap and a tag wide.
        self.nx, self.ny = 2 * self.tags_x + 1, 2 * self.tags_y + 1
        self.side = 0.5 * (self.tag + self.gap)
        self.width, self.height = parse("--board-mm", board_mm, NUMBER + "x" + NUMBER, "1219.2x914.4")
        signed = r"(-?[0-9]+(?:\.[0-9]+)?)"
        self.offset = parse("--offset-mm", offset_mm, signed + "," + signed, "0,0")
        self.black_border = False
        self.across = self.tags_x * self.tag + (self.tags_x + 1) * self.gap
        self.down = self.tags_y * self.tag + (self.tags_y + 1) * self.gap
        for name, size, needed in (("width", self.width, self.across + 2 * abs(self.offset[0])),
                                   ("height", self.height, self.down + 2 * abs(self.offset[1]))):
            if needed > size + 1e-9:
                die(f"--board-mm: the {name} is {size:g} mm, the pattern needs {needed:g} mm")
        self.left = 0.5 * (self.width - self.across) + self.offset[0]
        self.top = 0.5 * (self.height - self.down) + self.offset[1]
        self.white, self.cells = markers_of("APRILTAG_" + self.family, self.KALIBR_BORDER)

    def pattern(self):
        return self.left, self.top, self.across, self.down

    def rectangles(self):
        pitch = self.tag + self.gap
        for row in range(self.tags_y + 1):
            for column in range(self.tags_x + 1):
                yield self.left + column * pitch, self.top + row * pitch, self.gap, self.gap, True
        cell = self.tag / self.cells
        for number in range(self.tags_x * self.tags_y):
            x = self.left + self.gap + (number % self.tags_x) * pitch
            y = self.top + self.gap + (self.tags_y - 1 - number // self.tags_x) * pitch
            yield x, y, self.tag, self.tag, True
            for column, row in self.white(number):
                yield x + column * cell, y + row * cell, cell, cell, False

    def fields(self):
        return [
            f"  aprilgrid {{ tags_x: {self.tags_x} tags_y: {self.tags_y} tag_m: {metres(self.tag)}",
            f'              spacing: {self.spacing:g} family: "{self.family}" }}',
        ]

    def title(self):
        return f"{self.tags_x}x{self.tags_y} AprilTags ({self.family}) of {text(self.tag)} mm"


class BoardWithHoles(Board):
    """velo2cam's and FAST-Calib's: four round holes, and a marker towards each corner."""

    FAMILY = "6X6_250"
    FIRST = 1  # along the rows from the top
    HOLES = 500, 400  # from centre to centre
    MARKERS = 1100, 700
    SIZE = "1400x1000"

    def __init__(self, marker_mm, board_mm):
        (self.marker,) = parse("--holes", marker_mm, NUMBER, "160")
        if self.marker > 300:
            die(f"--holes: markers of {self.marker:g} mm would touch the holes; 300 mm at most")
        self.radius = 120
        self.width, self.height = parse("--board-mm", board_mm, NUMBER + "x" + NUMBER, self.SIZE)
        self.offset = 0, 0
        self.black_border = False
        for name, size, apart in (("width", self.width, self.MARKERS[0]),
                                  ("height", self.height, self.MARKERS[1])):
            if self.marker <= 0 or apart + self.marker > size + 1e-9:
                die(f"--holes: markers of {self.marker:g} mm need {apart + self.marker:g} mm of the "
                    f"board's {name}, which is {size:g} mm")
        self.white, self.cells = markers_of(self.FAMILY, 1)

    def centres(self, apart):
        for y in (-0.5, 0.5):
            for x in (-0.5, 0.5):
                yield 0.5 * self.width + x * apart[0], 0.5 * self.height + y * apart[1]

    def pattern(self):
        across, down = (apart + self.marker for apart in self.MARKERS)
        return 0.5 * (self.width - across), 0.5 * (self.height - down), across, down

    def rectangles(self):
        cell = self.marker / self.cells
        for number, (middle_x, middle_y) in enumerate(self.centres(self.MARKERS), self.FIRST):
            x, y = middle_x - 0.5 * self.marker, middle_y - 0.5 * self.marker
            yield x, y, self.marker, self.marker, True
            for column, row in self.white(number):
                yield x + column * cell, y + row * cell, cell, cell, False

    def circles(self):
        for x, y in self.centres(self.HOLES):
            yield x, y, self.radius

    def fields(self):
        return [f"  holes {{ marker_m: {metres(self.marker)} }}"]

    def title(self):
        return f"Four holes of {2 * self.radius} mm, {self.FAMILY} markers of {text(self.marker)} mm"


def metres(mm):
    return f"{mm / 1000:.7f}".rstrip("0").rstrip(".")


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
        f"<title>{board.title()} on {text(board.width)}x{text(board.height)} mm</title>",
        rect(0, 0, board.width, board.height, "black" if board.black_border else "white"),
        rect(*board.pattern(), "white"),
    ]
    for x, y, width, height, black in board.rectangles():
        lines.append(rect(x, y, width, height, "black" if black else "white"))
    for x, y, radius in board.circles():  # to be cut out
        lines.append(f'<circle cx="{text(x)}" cy="{text(y)}" r="{text(radius)}" fill="white" '
                     'stroke="black" stroke-width="0.2"/>')
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
    for x, y, radius in board.circles():
        codes += [0, "CIRCLE", 8, "CUT", 10, text(x), 20, text(board.height - y), 30, 0]
        codes += [40, text(radius)]
    codes += polyline("FRAME", *board.pattern())
    if type(board) is Board:
        for layer, black in (("BLACK", True), ("WHITE", False)):
            for x, y in board.squares(black):
                codes += polyline(layer, x, y, board.side, board.side)
    else:
        for x, y, width, height, black in board.rectangles():
            codes += polyline("BLACK" if black else "WHITE", x, y, width, height)
    codes += [0, "ENDSEC", 0, "EOF"]
    return "\n".join(str(code) for code in codes) + "\n"


def textproto(board):
    lines = [
        "# As drawn. Measure the finished board to 1 mm and write here what it is.",
        "target {",
        *board.fields(),
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
    charuco, aprilgrid, holes, out = sys.argv[6:10]
    if sum(map(bool, (charuco, aprilgrid, holes))) > 1:
        die("--charuco, --aprilgrid and --holes are different boards; expected one")
    size = sys.argv[3] or "1219.2x914.4"
    if holes:
        board = BoardWithHoles(holes, sys.argv[3] or BoardWithHoles.SIZE)
    elif aprilgrid:
        board = AprilGrid(aprilgrid, size, sys.argv[4])
    elif charuco:
        board = Charuco(*sys.argv[1:3], size, *sys.argv[4:6], charuco)
    else:
        board = Board(*sys.argv[1:3], size, *sys.argv[4:6])
    try:
        os.makedirs(out, exist_ok=True)
        for name, content in (("svg", svg), ("dxf", dxf), ("textproto", textproto)):
            write(os.path.join(out, "target." + name), content(board))
    except OSError as error:
        die(f"cannot write to {out}: {error.strerror}")
    print(textproto(board), end="")


main()
