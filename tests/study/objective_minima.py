"""Local minima of sampled curves and surfaces, for slices.py and surfaces.py."""

SHARE = 0.01  # of the range: a dent that is less deep does not stop a solver that may step uphill


def of_curve(values, least):
    """How many times a curve falls by `least` and then rises by as much; ends are no minima."""
    count, falling, high, low = 0, False, values[0], values[0]
    for value in values:
        if falling:
            low = min(low, value)
            if value >= low + least:
                count, falling, high = count + 1, False, value
        else:
            high = max(high, value)
            if value <= high - least:
                falling, low = True, value
    return count


def neighbours(i, j, rows, columns):
    for di in (-1, 0, 1):
        for dj in (-1, 0, 1):
            if (di or dj) and 0 <= i + di < rows and 0 <= j + dj < columns:
                yield i + di, j + dj


def hollows_of(values, least):
    """Cells of a grid, each deeper by `least` than the lowest way out of it; none on the border.

    Cells are flooded from the lowest up; where two pools meet, the shallower one ends."""
    rows, columns = values.shape
    pool, bottoms = {}, []

    def root(cell):
        while pool[cell] != cell:
            pool[cell] = pool[pool[cell]]
            cell = pool[cell]
        return cell

    order = sorted(((values[i, j], i, j) for i in range(rows) for j in range(columns)))
    for value, i, j in order:
        pool[i, j] = (i, j)
        for cell in neighbours(i, j, rows, columns):
            if cell not in pool:
                continue
            # Each pool is known by its lowest cell.
            low, high = sorted((root(cell), root((i, j))), key=lambda c: values[c])
            if low == high:
                continue
            pool[high] = low
            if value - values[high] >= least:
                bottoms.append(high)
    bottoms.append(root(order[0][1:]))
    return [(i, j) for i, j in bottoms if 0 < i < rows - 1 and 0 < j < columns - 1]
