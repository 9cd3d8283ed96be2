// How large a point is to be drawn so that a surface has no gaps: as an angle, as the LIDAR sees it.
// calib/present/pictures/internal/point_radius.h has the same rule for pictures.
import { kWords, type Points } from "./points";

export const kAngleUnit = 2e-6; // of the stored radii [rad]
const kDefault = 0.003; // beams' spacing where it cannot be told [rad]
const kLeast = 0.8; // times the beams' spacing: half the diagonal of a square and some more
const kMost = 3; // so that lines on ground that is seen at a grazing angle stay lines
const kStep = 8; // a gap that is so many times larger is a step from one surface to another
const kMostForGaps = 400_000; // of more points the gaps are not looked for: it would take a second
const kComparisons = 4e6;
const kGrowth = { covered: 0.35, most: 2.2 }; // sparse clouds: the share of their field that points fill

type Positions = Pick<Points, "floats" | "count">;

/// Directions of the points from the LIDAR, and their distances; points that are not finite have NaN.
function directionsOf({ floats, count }: Positions): { units: Float32Array; distances: Float32Array } {
  const units = new Float32Array(3 * count), distances = new Float32Array(count);
  for (let i = 0; i < count; ++i) {
    const at = i * kWords;
    const distance = Math.hypot(floats[at], floats[at + 1], floats[at + 2]);
    distances[i] = distance > 0 ? distance : NaN;
    for (let axis = 0; axis < 3; ++axis) units[3 * i + axis] = floats[at + axis] / distances[i];
  }
  return { units, distances };
}

/// Angle between neighbouring beams [rad], the median over some of them.
function spacingOf(units: Float32Array, count: number): number {
  const samples = Math.min(count, Math.max(15, Math.min(101, Math.floor(kComparisons / count))));
  const found: number[] = [];
  for (let sample = 0; sample < samples; ++sample) {
    const at = 3 * Math.floor(((sample + 0.5) * count) / samples);
    const [x, y, z] = [units[at], units[at + 1], units[at + 2]];
    let nearest = Infinity;
    for (let other = 0; other < 3 * count; other += 3) {
      const dx = units[other] - x, dy = units[other + 1] - y, dz = units[other + 2] - z;
      const squared = dx * dx + dy * dy + dz * dz;
      if (squared < nearest && squared > 1e-9) nearest = squared; // not itself, not its double
    }
    if (Number.isFinite(nearest)) found.push(Math.sqrt(nearest));
  }
  if (found.length === 0) return kDefault;
  found.sort((a, b) => a - b);
  return Math.min(0.03, Math.max(0.0005, found[found.length >> 1]));
}

/// Points by direction, in cells as large as the beams' spacing.
class Cells {
  private readonly heads: Int32Array;
  private readonly next: Int32Array;
  private readonly keys: Int32Array; // column and row, 16 bits each
  constructor(private readonly floats: Float32Array, units: Float32Array, count: number, spacing: number) {
    const size = 2 ** Math.ceil(Math.log2(2 * count + 1));
    this.heads = new Int32Array(size).fill(-1);
    this.next = new Int32Array(count).fill(-1);
    this.keys = new Int32Array(count);
    for (let i = 0; i < count; ++i) {
      const [x, y, z] = [units[3 * i], units[3 * i + 1], units[3 * i + 2]];
      if (!(z <= 1 && z >= -1)) continue;
      const column = Math.floor((Math.atan2(y, x) + Math.PI) / spacing), row = Math.floor((Math.asin(z) + Math.PI / 2) / spacing);
      this.keys[i] = (column << 16) | row;
      const slot = this.slotOf(this.keys[i]);
      this.next[i] = this.heads[slot];
      this.heads[slot] = i;
    }
  }

  /// Squared distance [m^2] to the nearest point towards one side: straight on, or one cell beside.
  towards(i: number, column: number, row: number): number {
    for (let step = 1; step <= 2; ++step) {
      let nearest = Infinity;
      for (let aside = -1; aside <= 1; ++aside)
        nearest = Math.min(nearest, this.nearest(i, column !== 0 ? column * step : aside, row !== 0 ? row * step : aside));
      if (nearest < Infinity) return nearest;
    }
    return Infinity;
  }

  private slotOf(key: number): number {
    const mixed = Math.imul(key, 0x9e3779b1);
    return (mixed ^ (mixed >>> 15)) & (this.heads.length - 1);
  }

  private nearest(i: number, columns: number, rows: number): number {
    const key = this.keys[i] + (columns << 16) + rows | 0;
    const { floats } = this;
    const at = i * kWords;
    let nearest = Infinity;
    for (let other = this.heads[this.slotOf(key)]; other >= 0; other = this.next[other]) {
      if (this.keys[other] !== key) continue;
      const to = other * kWords;
      const dx = floats[to] - floats[at], dy = floats[to + 1] - floats[at + 1], dz = floats[to + 2] - floats[at + 2];
      nearest = Math.min(nearest, dx * dx + dy * dy + dz * dz);
    }
    return nearest;
  }
}

/// Half of what closes the gap to a point's neighbours, in units of the beams' spacing.
function radiusOf(cells: Cells, i: number, base_m: number): number {
  // Per direction the nearer side: at an edge the other one is another surface.
  const across = Math.min(cells.towards(i, 1, 0), cells.towards(i, -1, 0));
  const along = Math.min(cells.towards(i, 0, 1), cells.towards(i, 0, -1));
  const gap = Math.sqrt(Math.max(across, along)) / base_m;
  return gap < kStep ? Math.min(kMost, Math.max(kLeast, 0.6 * gap)) : kLeast;
}

/// A LIDAR of few rings leaves most of its field empty: its points are drawn larger, so that their
/// colours can be seen at all. Of the solid angles that are looked at and covered [sr].
function growthOf(units: Float32Array, count: number, covered: number): number {
  const step = Math.max(1, Math.floor(count / 2000));
  const azimuths: number[] = [], heights: number[] = [];
  for (let i = 0; i < count; i += step) {
    if (!Number.isFinite(units[3 * i])) continue;
    azimuths.push(Math.atan2(units[3 * i + 1], units[3 * i]));
    heights.push(units[3 * i + 2]);
  }
  const extent = (values: number[]) => {
    values.sort((a, b) => a - b);
    return values.length > 1 ? values[Math.floor(0.98 * (values.length - 1))] - values[Math.floor(0.02 * (values.length - 1))] : 0;
  };
  const field = extent(azimuths) * extent(heights);
  return Math.min(kGrowth.most, Math.max(1, Math.sqrt((kGrowth.covered * field) / Math.max(covered, 1e-9))));
}

/// Each point's radius as an angle at the LIDAR, in kAngleUnit; times its distance it closes the gap
/// to its neighbours. At least what the beams' spacing asks for; 0 for points that are not finite.
export function angularRadii(points: Positions): Uint16Array {
  const { floats, count } = points;
  const { units, distances } = directionsOf(points);
  const spacing = spacingOf(units, count);
  const cells = count <= kMostForGaps ? new Cells(floats, units, count, spacing) : null;
  const radii = new Float32Array(count);
  let covered = 0;
  for (let i = 0; i < count; ++i) {
    if (!(distances[i] > 0)) continue;
    radii[i] = spacing * (cells ? radiusOf(cells, i, spacing * distances[i]) : kLeast);
    covered += Math.PI * radii[i] * radii[i];
  }
  const growth = growthOf(units, count, covered);
  return Uint16Array.from(radii, (radius) => Math.min(65535, Math.round((growth * radius) / kAngleUnit)));
}
