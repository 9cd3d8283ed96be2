// Images and overlays of the scene, drawn on a canvas.
import type { CameraInfo, Vec2, Vec3 } from "../protocol";
import { kTarget, onBoard, project, sample, type Board } from "./scene";

export interface Picture { jpeg: Uint8Array; width: number; height: number }

const grey = (kelvin: number): string => {
  const level = Math.round(Math.min(255, Math.max(0, ((kelvin - kMinK) / (kMaxK - kMinK)) * 255)));
  return `rgb(${level} ${level} ${level})`;
};
export const kMinK = 283;
export const kMaxK = 310;

function pixels(camera: CameraInfo, board: Board, corners: Vec2[]): Vec2[] {
  return corners.map(([u, v]) => project(camera, onBoard(board, u, v))).filter((at) => at !== null)
    .map(([x, y]) => [x, y]);
}

/// The board's four corners in the image, a closed chain without its first again.
export function outlineOf(camera: CameraInfo, board: Board): Vec2[] {
  const [u, v] = [kTarget.width_m / 2, kTarget.height_m / 2];
  return pixels(camera, board, [[-u, -v], [u, -v], [u, v], [-u, v]]);
}

export function innerCorners(camera: CameraInfo, board: Board): Vec2[] {
  const corners: Vec2[] = [];
  for (let row = 1; row < kTarget.squares_y; ++row)
    for (let column = 1; column < kTarget.squares_x; ++column)
      corners.push([(column - kTarget.squares_x / 2) * kTarget.square_m, (row - kTarget.squares_y / 2) * kTarget.square_m]);
  return pixels(camera, board, corners);
}

function fill(context: CanvasRenderingContext2D, chain: Vec2[], style: string): void {
  context.fillStyle = style;
  context.beginPath();
  chain.forEach(([x, y]) => context.lineTo(x + 0.5, y + 0.5));
  context.fill();
}

function drawBoard(context: CanvasRenderingContext2D, camera: CameraInfo, board: Board): void {
  const thermal = camera.kind === "thermal";
  fill(context, outlineOf(camera, board), thermal ? grey(296) : "#ece8e0");
  const { squares_x, squares_y, square_m: side } = kTarget;
  for (let i = 0; i < squares_x * squares_y; ++i) {
    const [column, row] = [i % squares_x, Math.floor(i / squares_x)];
    if ((column + row) & 1) continue;
    const [u, v] = [(column - squares_x / 2) * side, (row - squares_y / 2) * side];
    fill(context, pixels(camera, board, [[u, v], [u + side, v], [u + side, v + side], [u, v + side]]), thermal ? grey(305) : "#161616");
  }
}

export async function picture(camera: CameraInfo, board: Board, width: number): Promise<Picture> {
  const canvas = document.createElement("canvas");
  const scale = width / camera.width;
  [canvas.width, canvas.height] = [width, Math.round(camera.height * scale)];
  const context = canvas.getContext("2d")!;
  context.scale(scale, scale);
  const thermal = camera.kind === "thermal";
  const sky = context.createLinearGradient(0, 0, 0, camera.height);
  sky.addColorStop(0, thermal ? grey(284) : "#7fa6c9");
  sky.addColorStop(0.5, thermal ? grey(288) : "#b08a6a");
  sky.addColorStop(1, thermal ? grey(292) : "#4f7a45");
  context.fillStyle = sky;
  context.fillRect(0, 0, camera.width, camera.height);
  drawBoard(context, camera, board);
  const blob = await new Promise<Blob | null>((done) => canvas.toBlob(done, "image/jpeg", 0.85));
  return { jpeg: new Uint8Array(await blob!.arrayBuffer()), width: camera.width, height: camera.height };
}

/// Arrays of an OverlayFrame.
export function overlayArrays(camera: CameraInfo, board: Board, points: number): Record<string, Float32Array> {
  const outline = outlineOf(camera, board);
  const edge: number[] = [];
  outline.forEach((from, side) => {
    const to = outline[(side + 1) % outline.length];
    for (let i = 0; i < 12; ++i) {
      const off = 1.5 * Math.sin(side * 9 + i * 3);
      edge.push(from[0] + ((to[0] - from[0]) * i) / 12 + off, from[1] + ((to[1] - from[1]) * i) / 12 + off, Math.abs(off));
    }
  });
  const cloud: Vec3[] = [];
  for (let i = 0; i < points * 4 && cloud.length < points; ++i) {
    const at = project(camera, sample(0, board).at);
    if (at && at[0] >= 0 && at[0] < camera.width && at[1] >= 0 && at[1] < camera.height) cloud.push(at);
  }
  return {
    corners: new Float32Array(innerCorners(camera, board).flat()),
    outline: new Float32Array([...outline, ...outline.slice(0, 1)].flat()),
    edge: new Float32Array(edge),
    cloud: new Float32Array(cloud.flat()),
  };
}

/// The board in the cloud, seen along its normal.
export async function boardThumb(): Promise<Picture> {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [240, 180];
  const context = canvas.getContext("2d")!;
  context.fillRect(0, 0, 240, 180);
  for (let i = 0; i < 4000; ++i) {
    const [x, y] = [20 + Math.random() * 200, 10 + Math.random() * 160];
    const level = ((Math.floor(x / 25) + Math.floor(y / 25)) & 1 ? 200 : 60);
    context.fillStyle = `rgb(${level} ${level} ${level})`;
    context.fillRect(x, y, 2, 2);
  }
  const blob = await new Promise<Blob | null>((done) => canvas.toBlob(done, "image/jpeg", 0.85));
  return { jpeg: new Uint8Array(await blob!.arrayBuffer()), width: 240, height: 180 };
}
