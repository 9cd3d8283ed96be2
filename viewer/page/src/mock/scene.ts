// A yard with a checkerboard, a warm wall and a person who walks; LIDAR frame [m], [K].
import type { CameraInfo, RigFrame, Vec3 } from "../protocol";

const kFocal = 0.95; // times the width

function cornersOf(width: number, height: number): Vec3[] {
  const [u, v] = [0.5 / kFocal, (0.5 * height) / width / kFocal];
  return [[-u, -v, 1], [u, -v, 1], [u, v, 1], [-u, v, 1]];
}

export const kCameras: CameraInfo[] = [
  { name: "rgb", kind: "color", width: 1936, height: 1456, corners: cornersOf(1936, 1456) },
  { name: "thermal", kind: "thermal", width: 640, height: 512, corners: cornersOf(640, 512) },
];
export const kTarget: RigFrame["target"] = { squares_x: 8, squares_y: 6, square_m: 0.1, width_m: 1.0, height_m: 0.8 };

export interface Board { centre: Vec3; yaw: number; roll: number } // faces the LIDAR; [rad]

/// A board's pose for a view, or for a time [s] where it is carried about.
export const boardOfView = (index: number): Board => ({
  centre: [3 + 0.4 * (index % 4), 1.1 * Math.sin(index * 2.1), 0.2 * Math.cos(index * 1.3)],
  yaw: 0.5 * Math.sin(index * 1.7),
  roll: 0.3 * Math.cos(index * 2.9),
});
export const boardAt = (seconds: number): Board => boardOfView(seconds / 6);

/// u to the right and v down on the board, as the LIDAR sees it [m].
export function onBoard({ centre, yaw, roll }: Board, u: number, v: number): Vec3 {
  const right = u * Math.cos(roll) - v * Math.sin(roll);
  const down = u * Math.sin(roll) + v * Math.cos(roll);
  return [centre[0] + right * Math.sin(yaw), centre[1] - right * Math.cos(yaw), centre[2] - down];
}

export const camera_from_lidar = (camera: CameraInfo): number[] =>
  [0, -1, 0, camera.kind === "color" ? 0.12 : -0.12, 0, 0, -1, -0.1, 1, 0, 0, 0.03, 0, 0, 0, 1];

/// Pixel and depth [m]; null behind the camera.
export function project(camera: CameraInfo, [x, y, z]: Vec3): Vec3 | null {
  const m = camera_from_lidar(camera);
  const [cx, cy, cz] = [0, 4, 8].map((row) => m[row] * x + m[row + 1] * y + m[row + 2] * z + m[row + 3]);
  if (cz < 0.1) return null;
  const focal = kFocal * camera.width;
  return [camera.width / 2 + (focal * cx) / cz, camera.height / 2 + (focal * cy) / cz, cz];
}

export interface Sample { at: Vec3; color: Vec3; kelvin: number; intensity: number }

function onGround(a: number, b: number): Sample {
  const range = 1.5 + 14 * b * b;
  const at: Vec3 = [range * Math.cos(a), range * Math.sin(a), -1.4 + 0.05 * Math.sin(range)];
  const green = 90 + 50 * Math.sin(at[0] * 1.3) * Math.cos(at[1]);
  return { at, color: [80, green, 60], kelvin: 291 + 3 * Math.sin(at[0] / 3), intensity: 60 };
}

function onWall(a: number, b: number): Sample {
  const side = Math.floor(4 * a);
  const along = (4 * a - side - 0.5) * 18;
  const z = -1.4 + 4 * b;
  const at: Vec3 = side === 0 ? [9, along, z] : side === 1 ? [along, 9, z] : side === 2 ? [-9, along, z] : [along, -9, z];
  const warm = side === 0 && z > -0.4 && z < 1.2 && Math.abs(along % 3) < 1;
  const brick = 110 + 20 * (Math.floor(z * 4) & 1);
  return { at, color: warm ? [200, 210, 220] : [150, brick, 90], kelvin: warm ? 298 : 288, intensity: 120 };
}

function onPerson(a: number, b: number, seconds: number): Sample {
  const z = -1.4 + 1.8 * b;
  const radius = z > 0.1 ? 0.13 : 0.25;
  const around = 2 * Math.PI * a;
  const [x, y] = [5 * Math.cos(seconds / 5), 5 * Math.sin(seconds / 5)];
  const at: Vec3 = [x + radius * Math.cos(around), y + radius * Math.sin(around), z];
  return { at, color: [40, 60, 170], kelvin: z > 0.1 ? 308 : 303, intensity: 30 };
}

function onTarget(board: Board, a: number, b: number): Sample {
  const u = (a - 0.5) * kTarget.width_m;
  const v = (b - 0.5) * kTarget.height_m;
  const black = (Math.floor(u / kTarget.square_m + 100) + Math.floor(v / kTarget.square_m + 100)) & 1;
  const at = onBoard(board, u, v);
  return black ? { at, color: [20, 20, 20], kelvin: 305, intensity: 15 } : { at, color: [235, 235, 235], kelvin: 296, intensity: 230 };
}

/// A random point of what is seen at a time [s].
export function sample(seconds: number, board: Board): Sample {
  const [which, a, b] = [Math.random(), Math.random(), Math.random()];
  if (which < 0.5) return onGround(2 * Math.PI * a, b);
  if (which < 0.88) return onWall(a, b);
  return which < 0.94 ? onPerson(a, b, seconds) : onTarget(board, a, b);
}
