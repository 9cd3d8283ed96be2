// Where the cloud is seen from. LIDAR frame: x forward, y left, z up [m].
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Vec3 } from "../protocol";
import { firstDirection, fit, turnTowards } from "./fit";

export type ViewName = "lidar" | "above" | "behind";
export const kViews: { id: ViewName; name: string }[] = [
  { id: "lidar", name: "From the LIDAR" }, { id: "above", name: "From above" }, { id: "behind", name: "From behind" },
];
const kDirections: Record<Exclude<ViewName, "lidar">, Vec3> = { above: [0, 0, -1], behind: [1, 0, -0.35] };
const kZoomStep = 0.85;
const kRestMs = 200; // without a change, after which the view is at rest

export class Viewpoint {
  readonly camera = new THREE.PerspectiveCamera(60, 1, 0.05, 1000);
  readonly controls: OrbitControls;
  moving = false;
  touched = false; // a person chose the view
  private held = false;
  private rest = 0;

  /// `onChange` is called when it moved, and when it came to rest.
  constructor(canvas: HTMLCanvasElement, private readonly onChange: () => void) {
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.listenToKeyEvents(canvas);
    this.controls.keyPanSpeed = 30;
    this.controls.addEventListener("change", () => { this.touched ||= this.held; this.moved(); });
    this.controls.addEventListener("start", () => { this.held = true; });
    // A tap moves nothing.
    this.controls.addEventListener("end", () => { this.held = false; if (this.moving) this.moved(); });
    canvas.addEventListener("keydown", (event) => this.onKey(event));
    this.camera.position.set(-3.5, 0, 2);
    this.place(new THREE.Vector3(3, 0, 0));
  }

  /// `lidar`: where the LIDAR is in the frame that is shown [m]; `subject`: what is to be seen.
  look(view: ViewName, subject: Float32Array, lidar: THREE.Vector3): void {
    this.touched = true;
    if (view !== "lidar") return this.lookAlong(new THREE.Vector3(...kDirections[view]), subject);
    this.camera.position.set(-0.05, 0, 0.01).add(lidar);
    this.place(new THREE.Vector3(3, 0, 0).add(lidar));
  }

  /// As nobody chose a view yet.
  lookFirst(subject: Float32Array, lidar: THREE.Vector3): void {
    this.lookAlong(firstDirection(subject, lidar), subject);
  }

  /// All of `subject` on the canvas, from where it is looked at now or along `direction`.
  lookAlong(direction: THREE.Vector3 | null, subject: Float32Array): void {
    const turned = direction ? turnTowards(direction) : this.camera.quaternion;
    const fitted = fit(subject, turned, Math.tan((this.camera.fov * Math.PI) / 360), this.camera.aspect);
    if (!fitted) return;
    this.camera.position.copy(fitted.position);
    this.place(fitted.target);
  }

  private place(target: THREE.Vector3): void {
    this.controls.target.copy(target);
    this.controls.update();
  }

  /// New points came: as if it moved, until none do.
  stir(): void { this.moved(); }

  /// It moves for as long as it is held, or changes again and again, as the wheel makes it.
  private moved(): void {
    this.moving = true;
    clearTimeout(this.rest);
    if (!this.held) this.rest = window.setTimeout(() => { this.moving = false; this.onChange(); }, kRestMs);
    this.onChange();
  }

  private onKey(event: KeyboardEvent): void {
    const factor = event.key === "+" || event.key === "=" ? kZoomStep : event.key === "-" ? 1 / kZoomStep : 0;
    this.touched ||= factor !== 0 || event.key.startsWith("Arrow");
    if (factor === 0) return;
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
  }
}
