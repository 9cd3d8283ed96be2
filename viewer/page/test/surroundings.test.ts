import { Matrix4 } from "three";
import { expect, test } from "vitest";
import { frustumLines } from "../src/cloud/surroundings";

test("a frustum begins where the camera is and opens where it looks", () => {
  // Camera axes in the LIDAR's: x right is -y, y down is -z, z forward is x; 0.2 m left of the LIDAR.
  const lidar_from_camera = new Matrix4().set(0, 0, 1, 0, -1, 0, 0, 0.2, 0, -1, 0, 0, 0, 0, 0, 1);
  const lines = frustumLines({ name: "rgb", color: "", lidar_from_camera, corners: [[-1, -1, 2], [1, -1, 2], [1, 1, 2], [-1, 1, 2]] });
  expect(lines.length).toBe(16);
  expect(lines[0]).toEqual([0, 0.2, 0]);
  const [x, y, z] = lines[1]; // the image's upper left
  expect(x).toBeGreaterThan(0);
  expect(y).toBeGreaterThan(0.2);
  expect(z).toBeGreaterThan(0);
});
