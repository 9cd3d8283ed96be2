// The cloud on a canvas. It is drawn when there is something new or the viewpoint moves, and only then.
import * as THREE from "three";
import type { Vec3 } from "../protocol";
import { isSoftware, pointBudget, rendererName } from "./budget";
import type { Colour } from "./color_maps";
import { Viewpoint, type ViewName } from "./viewpoint";
import { makeMaterial, setColour } from "./material";
import { Pace } from "./pace";
import { pick, type Picked } from "./picking";
import type { Points } from "./points";
import { PointObjects } from "./point_objects";
import type { VoxelMap } from "./voxel_map";

export class CloudScene {
  readonly renderer: string; // what draws
  readonly budget: number; // points
  readonly pace = new Pace();
  points = 0; // in the frame drawn last
  /// Called after each frame that was really drawn.
  onDrawn: () => void = () => undefined;

  private readonly gl: THREE.WebGLRenderer;
  private readonly scene = new THREE.Scene();
  private readonly material = makeMaterial();
  private readonly objects = new PointObjects(this.material);
  private readonly axes = new THREE.AxesHelper(0.5); // the LIDAR's
  private readonly viewpoint: Viewpoint;
  private readonly pixel = new Uint8Array(4);
  private asked = false;

  /// Throws where the browser has no WebGL 2.
  constructor(private readonly canvas: HTMLCanvasElement) {
    this.gl = new THREE.WebGLRenderer({ canvas, antialias: false, powerPreference: "high-performance" });
    this.renderer = rendererName(this.gl.getContext() as WebGL2RenderingContext);
    this.budget = pointBudget(this.renderer);
    this.gl.setPixelRatio(isSoftware(this.renderer) ? 1 : Math.min(devicePixelRatio, 2));
    this.scene.add(this.objects.group, this.axes);
    this.viewpoint = new Viewpoint(canvas, () => this.draw());
    canvas.addEventListener("webglcontextrestored", () => this.draw());
  }

  resize(width: number, height: number): void {
    if (width === 0 || height === 0) return;
    this.gl.setSize(width, height, false);
    this.viewpoint.camera.aspect = width / height;
    this.viewpoint.camera.updateProjectionMatrix();
    this.draw();
  }

  showParts(parts: Points[]): void { this.objects.showParts(parts); this.draw(); }
  showMap(map: VoxelMap): void { this.objects.showMap(map); this.draw(); }

  /// Where the LIDAR is in the frame that is shown: 4x4 row by row; null: it is that frame.
  setLidar(pose: number[] | null): void {
    this.axes.matrixAutoUpdate = false;
    if (pose) this.axes.matrix.set(...(pose as Parameters<THREE.Matrix4["set"]>));
    else this.axes.matrix.identity();
    (this.material.uniforms.origin.value as THREE.Vector3).setFromMatrixPosition(this.axes.matrix);
  }

  /// `range`: the legend's ends [K, m, intensity].
  setColour(colour: Colour, range: [number, number]): void { setColour(this.material, colour, range); this.draw(); }

  setPointSize(size_px: number): void {
    this.material.uniforms.size.value = size_px * this.gl.getPixelRatio();
    this.draw();
  }

  setGround(dark: boolean): void {
    this.gl.setClearColor(dark ? 0x0e1115 : 0xf1f4f7);
    (this.material.uniforms.unknown.value as THREE.Vector3).setScalar(dark ? 0.32 : 0.68);
    this.draw();
  }

  look(view: ViewName): void {
    this.viewpoint.look(view, this.material.uniforms.origin.value as THREE.Vector3);
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

  /// The point at a pixel of the window.
  pickAt(x: number, y: number): Picked | null {
    const box = this.canvas.getBoundingClientRect();
    return pick(this.objects.drawn(), this.clipFromPoints(), box, x - box.left, y - box.top);
  }

  private clipFromPoints(): THREE.Matrix4 {
    const { camera } = this.viewpoint;
    camera.updateMatrixWorld();
    return new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
  }

  private drawNow(): void {
    const { moving, camera } = this.viewpoint;
    const start = performance.now();
    this.points = this.objects.thin(moving ? this.pace.share : 1, this.budget);
    this.gl.render(this.scene, camera);
    // Reading a pixel waits until it is there, which finish() need not.
    const context = this.gl.getContext();
    context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, this.pixel);
    const end = performance.now();
    this.pace.drew(end, end - start, moving);
    this.onDrawn();
  }
}
