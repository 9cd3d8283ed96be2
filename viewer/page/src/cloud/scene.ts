// The cloud on a canvas. It is drawn when there is something new or the viewpoint moves, and only then.
import * as THREE from "three";
import type { Vec2, Vec3 } from "../protocol";
import { isSoftware, pointBudget, rendererName } from "./budget";
import type { Colour } from "./color_maps";
import { kEverything, type Box } from "./crop";
import { extentsOf, sampleOf, subjectOf } from "./fit";
import { gridOf, groundHeight } from "./ground";
import { Labels } from "./labels";
import { Lighting, projectionOf } from "./lighting";
import { Materials } from "./material";
import { Pace } from "./pace";
import { pick, type Picked } from "./picking";
import type { Points } from "./points";
import { PointObjects } from "./point_objects";
import { Surroundings } from "./surroundings";
import { Viewpoint, type ViewName } from "./viewpoint";
import type { VoxelMap } from "./voxel_map";

const kSizes = { least: 1.25, most: 32 }; // of a point [CSS px]
const kQuick = { ratio: 0.5, grow: 0.75, most: 10 }; // what a frame in a hurry has of pixels, and of a point
const kVoxelRadius = 0.62; // of its side
const kSurveyMs = 2000;
const kBeside_m = 0.5; // from the LIDAR: there its axes and cameras would only stand in the way
const kMostGrowth = 2; // of points that stand for those left out
const kGrounds = {
  dark: { above: 0.063, below: 0.188, unknown: 0.3 },
  light: { above: 0.96, below: 0.9, unknown: 0.66 },
};

export class CloudScene {
  readonly renderer: string; // what draws
  readonly budget: number; // points
  readonly pace = new Pace();
  readonly surroundings = new Surroundings();
  extents = kEverything; // about where points are
  grid = true;
  points = 0; // in the frame drawn last
  /// Called after each frame that was really drawn.
  onDrawn: () => void = () => undefined;

  private readonly gl: THREE.WebGLRenderer;
  private readonly cloud = new THREE.Scene();
  private readonly lines = new THREE.Scene(); // among the points
  private readonly materials = new Materials();
  private readonly objects = new PointObjects(this.materials.now(true));
  private readonly lighting = new Lighting();
  private readonly labels: Labels;
  private limits = kEverything;
  private cutaway = true;
  private seen = false; // by cameras, some of the points
  private surveyed = -Infinity; // when [ms]
  private readonly viewpoint: Viewpoint;
  private readonly pixel = new Uint8Array(4);
  private readonly ratio: number; // pixels of the screen in a CSS px
  private size = { width: 1, height: 1 }; // [CSS px]
  private pointSize = 1;
  private asked = false;
  private fitted: "nothing" | "part" | "sweep" = "nothing"; // what the first view was fitted to

  /// Throws where the browser has no WebGL 2.
  constructor(private readonly canvas: HTMLCanvasElement, words: HTMLElement) {
    this.labels = new Labels(words);
    this.gl = new THREE.WebGLRenderer({ canvas, antialias: false, powerPreference: "high-performance" });
    this.gl.autoClear = false;
    this.renderer = rendererName(this.gl.getContext() as WebGL2RenderingContext);
    this.budget = pointBudget(this.renderer);
    this.ratio = isSoftware(this.renderer) ? 1 : Math.min(devicePixelRatio, 2);
    this.cloud.add(this.objects.group);
    this.lines.add(this.surroundings.group);
    this.viewpoint = new Viewpoint(canvas, () => this.draw());
    canvas.addEventListener("webglcontextrestored", () => this.draw());
  }

  resize(width: number, height: number): void {
    if (width === 0 || height === 0) return;
    const { camera } = this.viewpoint;
    this.size = { width, height };
    this.setPixels(this.ratio);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    this.materials.uniforms.projection.value = projectionOf(camera);
    if (!this.viewpoint.touched) this.fitted = "nothing";
    this.fitFirst(true);
    this.draw();
  }

  /// `whole`: not only a part of a sweep.
  showParts(parts: Points[], whole: boolean): void {
    if (this.objects.total() > 0) this.viewpoint.stir();
    this.objects.showParts(parts);
    this.materials.uniforms.voxel.value = 0;
    this.fitFirst(whole);
    this.draw();
  }

  showMap(map: VoxelMap): void {
    this.objects.showMap(map);
    this.materials.uniforms.voxel.value = kVoxelRadius * map.voxel_m;
    this.fitFirst(true);
    this.draw();
  }

  /// Where the LIDAR is in the frame that is shown: 4x4 row by row; null: it is that frame.
  setLidar(pose: number[] | null): void {
    const { matrix } = this.surroundings.lidar;
    if (pose) matrix.set(...(pose as Parameters<THREE.Matrix4["set"]>));
    else matrix.identity();
    this.lidar.setFromMatrixPosition(matrix);
  }

  /// `range`: the legend's ends [K, m, intensity].
  setColour(colour: Colour, range: [number, number]): void { this.materials.setColour(colour, range); this.draw(); }

  /// How much of the temperature, of 1, is in the blend.
  setBlend(share: number): void { this.materials.uniforms.blend.value = share; this.draw(); }

  /// Only what is within is shown.
  setLimits(limits: Box): void {
    this.limits = limits;
    const { low, high } = this.materials.uniforms;
    low.value.set(...limits.low);
    high.value.set(...limits.high);
    this.draw();
  }

  /// What stands between the eye and the LIDAR would hide what the LIDAR looks at.
  setCutaway(on: boolean): void { this.cutaway = on; this.draw(); }

  setGrid(on: boolean): void { this.grid = on; this.survey(true); this.draw(); }

  /// `times` as large as closes the gaps.
  setPointSize(times: number): void { this.pointSize = times; this.draw(); }

  setLighting(on: boolean): void { this.lighting.on = on; this.draw(); }

  setGround(dark: boolean): void {
    const { above, below, unknown } = kGrounds[dark ? "dark" : "light"];
    this.lighting.setBackground(above, below);
    this.materials.uniforms.unknown.value.setScalar(unknown);
    this.draw();
  }

  look(view: ViewName): void {
    this.viewpoint.look(view, this.subject(), this.lidar);
    this.draw();
  }

  /// All of it on the canvas, seen along the same direction.
  fit(): void {
    this.viewpoint.touched = true;
    this.viewpoint.lookAlong(null, this.subject());
    this.survey(true);
    this.draw();
  }

  /// All of it on the canvas, seen along an axis.
  lookAlong(axis: 0 | 1 | 2): void {
    this.viewpoint.touched = true;
    this.viewpoint.lookAlong(new THREE.Vector3().setComponent(axis, axis === 2 ? -1 : 1), this.subject());
    this.draw();
  }

  draw(): void {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => { this.asked = false; this.drawNow(); });
  }

  /// Pixels of the window, and whether it is in front of the camera.
  project([x, y, z]: Vec3): { x: number; y: number; inFront: boolean } {
    const at = new THREE.Vector4(x, y, z, 1).applyMatrix4(this.clipFromPoints());
    const box = this.canvas.getBoundingClientRect();
    return {
      x: box.left + ((at.x / at.w + 1) / 2) * box.width,
      y: box.top + ((1 - at.y / at.w) / 2) * box.height,
      inFront: at.w > 0,
    };
  }

  /// Each axis of the frame as it points on the screen: x right, y down, at most 1 long.
  axesOnScreen(): Vec2[] {
    const { camera } = this.viewpoint;
    camera.updateMatrixWorld();
    return [0, 1, 2].map((axis) => {
      const towards = new THREE.Vector3().setComponent(axis, 1).transformDirection(camera.matrixWorldInverse);
      return [towards.x, -towards.y];
    });
  }

  /// The point at a pixel of the window.
  pickAt(x: number, y: number): Picked | null {
    const box = this.canvas.getBoundingClientRect();
    this.objects.thin(1, this.budget); // also those that are left out while it moves
    return pick(this.objects.drawn(), this.clipFromPoints(), box, x - box.left, y - box.top,
      { limits: this.limits, before: this.materials.uniforms.before.value });
  }

  /// Points that are shown: while the view moves, fewer are drawn.
  get total(): number { return this.objects.total(); }

  private get lidar(): THREE.Vector3 { return this.materials.uniforms.origin.value; }

  private subject(): Float32Array { return subjectOf(this.objects.drawn().map(({ points }) => points), this.limits); }

  /// Where points are, and the grid below them; from time to time, as they come.
  private survey(now: boolean): void {
    if (this.objects.total() === 0 || (!now && performance.now() < this.surveyed + kSurveyMs)) return;
    this.surveyed = performance.now();
    const points = sampleOf(this.objects.drawn().map(({ points: each }) => each));
    this.seen = subjectOf(this.objects.drawn().map(({ points: each }) => each)).length < points.length;
    const found = extentsOf(points);
    if (found) this.extents = found;
    this.surroundings.setGrid(found && this.grid ? gridOf(found, groundHeight(points)) : null);
  }

  /// The first view, and once more when there is a whole sweep, unless a person chose one.
  private fitFirst(whole: boolean): void {
    this.survey(false);
    const now = whole ? "sweep" : "part";
    const sized = this.canvas.clientWidth > 0;
    if (this.viewpoint.touched || !sized || this.fitted === now || this.fitted === "sweep" || this.objects.total() === 0) return;
    this.fitted = now;
    this.viewpoint.lookFirst(this.subject(), this.lidar);
  }

  private clipFromPoints(): THREE.Matrix4 {
    const { camera } = this.viewpoint;
    camera.updateMatrixWorld();
    return new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
  }

  /// So many pixels a CSS px.
  private setPixels(ratio: number): void {
    const { width, height } = this.size;
    this.gl.setPixelRatio(ratio);
    this.gl.setSize(width, height, false);
    this.lighting.resize(this.canvas.width, this.canvas.height, ratio);
    this.materials.uniforms.focal.value = this.canvas.height / 2 / Math.tan((this.viewpoint.camera.fov * Math.PI) / 360);
  }

  /// `quick`: fewer pixels, and squares for discs.
  private setQuality(quick: boolean): void {
    const ratio = quick ? kQuick.ratio * this.ratio : this.ratio;
    if (ratio !== this.gl.getPixelRatio()) this.setPixels(ratio);
    const { grow, sizes } = this.materials.uniforms;
    const thinned = Math.min(kMostGrowth, Math.sqrt(this.objects.total() / Math.max(this.points, 1)));
    grow.value = this.pointSize * thinned * (quick ? kQuick.grow : 1);
    sizes.value.set(Math.max(1, kSizes.least * ratio), (quick ? kQuick.most : kSizes.most) * ratio);
    this.objects.use(this.materials.now(!quick));
  }

  private drawNow(): void {
    const { moving, camera } = this.viewpoint;
    const start = performance.now();
    this.points = this.objects.thin(moving ? this.pace.share : 1, this.budget);
    const lidar = this.lidar.clone().applyMatrix4(camera.matrixWorldInverse);
    this.materials.uniforms.before.value = this.cutaway && this.seen ? Math.max(0, -lidar.z) : 0;
    const quick = moving && this.pace.hurry;
    this.setQuality(quick);
    this.lighting.draw(this.gl, this.cloud, camera);
    this.surroundings.lidar.visible = camera.position.distanceTo(this.lidar) > kBeside_m;
    this.gl.render(this.lines, camera);
    // Words cost software more than lines: they come back at rest.
    this.labels.place(quick ? [] : this.surroundings.labels(), (at) => this.project(at));
    // Reading a pixel waits until it is there, which finish() need not.
    const context = this.gl.getContext();
    context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, this.pixel);
    const end = performance.now();
    this.pace.drew(end, end - start, moving);
    this.onDrawn();
  }
}
