// Points of many sweeps, one a voxel: that of the newest sweep, unless fewer cameras saw it. When
// they are too many the voxels double.
import { kWords, type Part, type Points } from "./points";

const kLeast = 1 << 16;

function bits(mask: number): number {
  let count = 0;
  for (let left = mask; left; left &= left - 1) ++count;
  return count;
}

export class VoxelMap implements Points {
  words!: Uint32Array;
  floats!: Float32Array;
  /// Record indices in random order: any first part of them is an even sample.
  order!: Uint32Array;
  count = 0;
  cameras: string[] = [];
  frame: "map" | "lidar" = "lidar";
  voxel_m: number;
  /// Records changed since `takeDirty`.
  private dirty: [number, number] = [Infinity, 0];
  private utimes!: Float64Array;
  private sweeps!: Float64Array;
  private table!: Int32Array; // open addressing: record index + 1, 0 empty
  private readonly point = new Float32Array(3);

  /// `most`: points; `start_m`: side of a voxel [m].
  constructor(private most: number, private start_m: number) {
    this.voxel_m = start_m;
    this.clear();
  }

  clear(): void {
    this.count = 0;
    this.voxel_m = this.start_m;
    this.frame = "lidar";
    this.reserve(Math.min(kLeast, this.most));
  }

  reset(most: number, start_m: number): void {
    [this.most, this.start_m] = [most, start_m];
    this.clear();
  }

  utimeOf(index: number): number { return this.utimes[index]; }
  sweepOf(index: number): number { return this.sweeps[index]; }

  takeDirty(): [number, number] {
    const range = this.dirty;
    this.dirty = [Infinity, 0];
    return range;
  }

  add(part: Part): void {
    const pose = part.header.map_from_lidar;
    if (!pose && this.frame === "map") return; // it cannot be placed
    if (pose && this.frame === "lidar") {
      this.clear();
      this.frame = "map";
    }
    this.cameras = part.cameras;
    for (let i = 0; i < part.count; ++i) {
      this.place(part.floats, i * kWords, pose);
      if (this.point.every(Number.isFinite)) this.insert(part, i);
    }
  }

  private place(floats: Float32Array, at: number, pose: number[] | null): void {
    const [x, y, z] = [floats[at], floats[at + 1], floats[at + 2]];
    for (let row = 0; row < 3; ++row) {
      const p = pose ? 4 * row : 0;
      this.point[row] = pose ? pose[p] * x + pose[p + 1] * y + pose[p + 2] * z + pose[p + 3] : floats[at + row];
    }
  }

  private insert(part: Part, index: number): void {
    let slot = this.slotOf(this.point, 0);
    if (this.table[slot] === 0 && this.count === this.utimes.length) {
      if (!this.makeRoom()) return;
      slot = this.slotOf(this.point, 0);
    }
    const from = index * kWords;
    const known = this.table[slot] - 1;
    if (known >= 0 && bits(part.words[from + 6] >>> 16) < bits(this.words[known * kWords + 6] >>> 16)) return;
    const record = known >= 0 ? known : this.append(slot);
    const to = record * kWords;
    for (let axis = 0; axis < 3; ++axis) this.floats[to + axis] = this.point[axis];
    for (let word = 3; word < kWords; ++word) this.words[to + word] = part.words[from + word];
    this.utimes[record] = part.utimeOf(index);
    this.sweeps[record] = part.header.sweep_utime;
    if (record < this.dirty[0]) this.dirty[0] = record;
    if (record >= this.dirty[1]) this.dirty[1] = record + 1;
  }

  /// Fisher and Yates' shuffle, inside out.
  private append(slot: number): number {
    const record = this.count++;
    this.table[slot] = record + 1;
    const other = Math.floor(Math.random() * this.count);
    this.order[record] = this.order[other];
    this.order[other] = record;
    return record;
  }

  /// The slot of the voxel that a position is in, or the empty one where it would be.
  private slotOf(floats: Float32Array, at: number): number {
    const side = this.voxel_m;
    const [x, y, z] = [Math.floor(floats[at] / side), Math.floor(floats[at + 1] / side), Math.floor(floats[at + 2] / side)];
    const mask = this.table.length - 1;
    let slot = Math.imul(Math.imul(x, 73856093) ^ Math.imul(y, 19349663) ^ Math.imul(z, 83492791), 0x9e3779b1);
    slot = (slot ^ (slot >>> 15)) & mask;
    for (; this.table[slot] !== 0; slot = (slot + 1) & mask) {
      const known = (this.table[slot] - 1) * kWords;
      if (Math.floor(this.floats[known] / side) === x && Math.floor(this.floats[known + 1] / side) === y
        && Math.floor(this.floats[known + 2] / side) === z) break;
    }
    return slot;
  }

  /// False where not even larger voxels make room.
  private makeRoom(): boolean {
    if (this.count < this.most) {
      this.reserve(Math.min(2 * this.utimes.length, this.most));
      return true;
    }
    for (let tries = 0; tries < 20 && this.count === this.most; ++tries) {
      this.voxel_m *= 2;
      this.reserve(this.utimes.length);
    }
    return this.count < this.most;
  }

  /// Room for `capacity` records; those that are known are inserted anew.
  private reserve(capacity: number): void {
    const old = { count: this.count, words: this.words, floats: this.floats, utimes: this.utimes, sweeps: this.sweeps };
    this.words = new Uint32Array(capacity * kWords);
    this.floats = new Float32Array(this.words.buffer);
    this.order = new Uint32Array(capacity);
    this.utimes = new Float64Array(capacity);
    this.sweeps = new Float64Array(capacity);
    this.table = new Int32Array(2 ** Math.ceil(Math.log2(2 * capacity)));
    this.count = 0;
    for (let i = 0; i < old.count; ++i) {
      const slot = this.slotOf(old.floats, i * kWords);
      if (this.table[slot] !== 0) continue;
      const record = this.append(slot);
      for (let word = 0; word < kWords; ++word) this.words[record * kWords + word] = old.words[i * kWords + word];
      [this.utimes[record], this.sweeps[record]] = [old.utimes[i], old.sweeps[i]];
    }
    this.dirty = [0, this.count];
  }
}
