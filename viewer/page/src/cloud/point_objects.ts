// What of the cloud is on the graphics card: one object a part, made and disposed as parts come and go.
import * as THREE from "three";
import { sweepGeometry, voxelGeometry } from "./material";
import { kWords, type Points } from "./points";
import type { VoxelMap } from "./voxel_map";

interface Shown { points: Points; object: THREE.Points; drawn: number }

export class PointObjects {
  readonly group = new THREE.Group();
  private shown: Shown[] = [];
  private map: { object: THREE.Points; words: Uint32Array } | null = null;

  constructor(private material: THREE.Material) {}

  use(material: THREE.Material): void {
    if (material === this.material) return;
    this.material = material;
    this.shown.forEach(({ object }) => { object.material = material; });
  }

  /// Parts in place of what was shown; those that stay are not uploaded again.
  showParts(parts: Points[]): void {
    this.dropMap();
    const wanted = new Set(parts);
    this.shown.filter(({ points }) => !wanted.has(points)).forEach((one) => this.remove(one.object));
    const known = new Map(this.shown.map((one) => [one.points, one]));
    this.shown = parts.map((points) => known.get(points) ?? { points, object: this.add(sweepGeometry(points)), drawn: 0 });
  }

  showMap(map: VoxelMap): void {
    if (this.map?.words !== map.words) this.remakeMap(map);
    const { geometry } = this.map!.object;
    const [first, end] = map.takeDirty();
    if (end <= first) return;
    const records = (geometry.getAttribute("head") as THREE.InterleavedBufferAttribute).data;
    records.addUpdateRange(first * kWords, (end - first) * kWords);
    records.needsUpdate = true;
    geometry.index!.addUpdateRange(0, map.count);
    geometry.index!.needsUpdate = true;
  }

  total(): number { return this.shown.reduce((sum, { points }) => sum + points.count, 0); }

  /// Draws `share` of the points, `most` at most; says how many.
  thin(share: number, most: number): number {
    const total = this.total();
    const part = Math.min(share, total > 0 ? most / total : 1);
    for (const one of this.shown) {
      one.drawn = Math.floor(one.points.count * part);
      one.object.geometry.setDrawRange(0, one.drawn);
    }
    return this.shown.reduce((sum, { drawn }) => sum + drawn, 0);
  }

  drawn(): { points: Points; drawn: number }[] { return this.shown; }

  private remakeMap(map: VoxelMap): void {
    this.showParts([]);
    const geometry = voxelGeometry(map.words);
    geometry.setIndex(new THREE.BufferAttribute(map.order, 1));
    this.map = { object: this.add(geometry), words: map.words };
    this.shown = [{ points: map, object: this.map.object, drawn: 0 }];
  }

  private dropMap(): void {
    if (!this.map) return;
    this.remove(this.map.object);
    this.map = null;
    this.shown = [];
  }

  private add(geometry: THREE.BufferGeometry): THREE.Points {
    const object = new THREE.Points(geometry, this.material);
    object.frustumCulled = false; // three does not know where the records' positions are
    this.group.add(object);
    return object;
  }

  private remove(object: THREE.Points): void {
    this.group.remove(object);
    object.geometry.dispose();
  }
}
