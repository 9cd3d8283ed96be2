import { describe, expect, test } from "vitest";
import { fitted, panned, toImage, toScreen, zoomed } from "../../src/panels/image/viewport";

const kImage = { width: 640, height: 480 };
const kScreen = { width: 320, height: 400 };

describe("an image on the screen", () => {
  test("fits whole, in the middle", () => {
    expect(fitted(kScreen, kImage)).toEqual({ scale: 0.5, x: 0, y: 80 });
  });

  test("has pixel (0, 0)'s centre half a pixel from its corner", () => {
    const at = { scale: 4, x: 10, y: 20 };
    expect(toScreen(at, [0, 0])).toEqual([12, 22]);
    expect(toImage(at, [10, 20])).toEqual([-0.5, -0.5]);
  });

  test("comes back from the screen as it went there", () => {
    const at = { scale: 3.7, x: -51, y: 8.25 };
    const [x, y] = toImage(at, toScreen(at, [123.25, 45.5]));
    expect(x).toBeCloseTo(123.25, 9);
    expect(y).toBeCloseTo(45.5, 9);
  });

  test("keeps what is under the pointer when it is zoomed", () => {
    const near = zoomed(fitted(kScreen, kImage), 6, [160, 200], kScreen, kImage);
    const nearer = zoomed(near, 1.5, [100, 300], kScreen, kImage);
    expect(nearer.scale).toBeCloseTo(4.5);
    expect(toImage(nearer, [100, 300])[0]).toBeCloseTo(toImage(near, [100, 300])[0], 9);
    expect(toImage(nearer, [100, 300])[1]).toBeCloseTo(toImage(near, [100, 300])[1], 9);
  });

  test("does not get smaller than whole", () => {
    expect(zoomed(fitted(kScreen, kImage), 0.1, [0, 0], kScreen, kImage)).toEqual(fitted(kScreen, kImage));
  });

  test("cannot be dragged off the screen", () => {
    const at = panned({ scale: 1, x: 0, y: 0 }, 5000, -5000, kScreen, kImage);
    expect(at).toEqual({ scale: 1, x: 0, y: kScreen.height - kImage.height });
  });
});
