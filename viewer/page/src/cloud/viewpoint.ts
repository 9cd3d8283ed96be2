// Where the cloud is seen from. LIDAR frame: x forward, y left, z up [m].
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Vec3 } from "../protocol";

export type ViewName = "lidar" | "above" | "behind";
export const kViews: { id: ViewName; name: string; from: Vec3; target: Vec3 }[] = [
  { id: "lidar", name: "From the LIDAR", from: [-0.05, 0, 0.01], target: [3, 0, 0] },
  { id: "above", name: "From above", from: [-0.02, 0, 22], target: [0, 0, 0] },
  { id: "behind", name: "From behind", from: [-3.5, 0, 2], target: [3, 0, 0] },
];
const kZoomStep = 0.85;

export class Viewpoint {
  readonly camera = new THREE.PerspectiveCamera(60, 1, 0.05, 1000);
  readonly controls: OrbitControls;
  moving = false;

  /// `onChange` is called when it moved, and when it came to rest.
  constructor(canvas: HTMLCanvasElement, onChange: () => void) {
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.listenToKeyEvents(canvas);
    this.controls.keyPanSpeed = 30;
    this.controls.addEventListener("change", onChange);
    this.controls.addEventListener("start", () => { this.moving = true; });
    this.controls.addEventListener("end", () => { this.moving = false; onChange(); });
    canvas.addEventListener("keydown", (event) => this.onKey(event));
    this.look("behind", new THREE.Vector3());
  }

  /// `lidar`: where the LIDAR is in the frame that is shown [m].
  look(view: ViewName, lidar: THREE.Vector3): void {
    const { from, target } = kViews.find(({ id }) => id === view)!;
    this.camera.position.set(...from).add(lidar);
    this.controls.target.set(...target).add(lidar);
    this.controls.update();
  }

  private onKey(event: KeyboardEvent): void {
    const factor = event.key === "+" || event.key === "=" ? kZoomStep : event.key === "-" ? 1 / kZoomStep : 0;
    if (factor === 0) return;
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
  }
}
