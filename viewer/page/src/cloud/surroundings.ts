// What is drawn among the points: the LIDAR's axes, where cameras are and what they see, a grid on the
// ground, the crop box, what is measured; and the words that belong to them.
import * as THREE from "three";
import type { Vec3 } from "../protocol";
import { edgesOf, type Box } from "./crop";
import { gridLines, type Grid } from "./ground";

export interface Label { kind: "axis" | "camera" | "grid" | "end"; text: string; at: Vec3; color?: string }
/// `corners`: where the image's four corners look, camera axes.
export interface Frustum { name: string; color: string; lidar_from_camera: THREE.Matrix4; corners: Vec3[] }

const kAxis = 0.5; // [m]
export const kAxes = [["x", "#ff6b6b"], ["y", "#69db7c"], ["z", "#74b3ff"]] as const;
const kFrustum = 0.45; // how far its picture is from the camera [m]

function segments(color: THREE.ColorRepresentation, opacity = 1): THREE.LineSegments<THREE.BufferGeometry, THREE.LineBasicMaterial> {
  const lines = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color, opacity, transparent: opacity < 1 }));
  lines.frustumCulled = false;
  return lines;
}

function setPlaces(lines: THREE.LineSegments, places: Vec3[]): void {
  lines.geometry.dispose();
  lines.geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(places.flat(), 3));
  lines.visible = places.length > 0;
}

/// From the camera to the picture's corners, and round it; LIDAR frame.
export function frustumLines({ lidar_from_camera, corners }: Frustum): Vec3[] {
  const place = (direction: Vec3) => new THREE.Vector3(...direction).setLength(kFrustum).applyMatrix4(lidar_from_camera).toArray();
  const eye = new THREE.Vector3().setFromMatrixPosition(lidar_from_camera).toArray();
  const picture = corners.map(place);
  return picture.flatMap((corner, i): Vec3[] => [eye, corner, corner, picture[(i + 1) % picture.length]]);
}

export class Surroundings {
  readonly group = new THREE.Group();
  readonly lidar = new THREE.Group(); // in its frame
  private readonly cameras = new THREE.Group();
  private readonly grid = segments("#9aa7b5", 0.35);
  private readonly box = segments("#ffd166");
  private readonly line = segments("#ffffff");
  private frusta: Frustum[] = [];
  private gridNow: Grid | null = null;
  private ends: Vec3[] = [];

  constructor() {
    this.lidar.matrixAutoUpdate = false;
    for (const [i, [, color]] of kAxes.entries()) {
      const axis = segments(color);
      setPlaces(axis, [[0, 0, 0], [0, 1, 2].map((each) => (each === i ? kAxis : 0)) as Vec3]);
      this.lidar.add(axis);
    }
    (this.line.material as THREE.Material).depthTest = false;
    this.lidar.add(this.cameras);
    this.group.add(this.lidar, this.grid, this.box, this.line);
  }

  setFrusta(frusta: Frustum[]): void {
    this.frusta = frusta.filter(({ corners }) => corners.length === 4);
    (this.cameras.children as THREE.LineSegments[]).forEach((lines) => lines.geometry.dispose());
    this.cameras.clear();
    for (const frustum of this.frusta) {
      const lines = segments(frustum.color);
      setPlaces(lines, frustumLines(frustum));
      this.cameras.add(lines);
    }
  }

  setGrid(grid: Grid | null): void {
    this.gridNow = grid;
    setPlaces(this.grid, grid ? gridLines(grid) : []);
  }

  setBox(box: Box | null): void { setPlaces(this.box, box ? edgesOf(box) : []); }

  setEnds(ends: Vec3[]): void {
    this.ends = ends;
    setPlaces(this.line, ends.length === 2 ? ends : []);
  }

  labels(): Label[] {
    const lidar = this.lidar.visible ? [...this.axisLabels(), ...this.cameraLabels()] : [];
    return [...lidar, ...this.gridLabels(),
      ...this.ends.map((at, i): Label => ({ kind: "end", text: String(i + 1), at }))];
  }

  private inShown(at: THREE.Vector3): Vec3 { return at.applyMatrix4(this.lidar.matrix).toArray(); }

  private axisLabels(): Label[] {
    return kAxes.map(([text, color], i) => ({
      kind: "axis", text, color, at: this.inShown(new THREE.Vector3().setComponent(i, 1.12 * kAxis)),
    }));
  }

  private cameraLabels(): Label[] {
    return this.frusta.map(({ name, color, lidar_from_camera, corners }) => {
      const [a, b] = [new THREE.Vector3(...corners[0]), new THREE.Vector3(...corners[1])];
      return { kind: "camera", text: name, color, at: this.inShown(a.add(b).setLength(kFrustum).applyMatrix4(lidar_from_camera)) };
    });
  }

  /// Along the lines through the frame's origin, or the nearest ones: every second.
  private gridLabels(): Label[] {
    if (!this.gridNow) return [];
    const { xs, ys, z, step } = this.gridNow;
    const near = (values: number[]) => values.reduce((a, b) => (Math.abs(b) < Math.abs(a) ? b : a));
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const text = (value: number) => `${value.toFixed(digits).replace("-", "−")} m`;
    const shown = (values: number[]) => values.filter((value) => value !== 0 && Math.round(value / step) % 2 === 0);
    return [
      ...shown(xs).map((x): Label => ({ kind: "grid", text: text(x), at: [x, near(ys), z] })),
      ...shown(ys).map((y): Label => ({ kind: "grid", text: text(y), at: [near(xs), y, z] })),
    ];
  }
}
