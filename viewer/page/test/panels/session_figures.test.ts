import { describe, expect, test } from "vitest";
import type { Hello, SessionFrame } from "../../src/protocol";
import { summaryOf } from "../../src/panels/image/residuals";
import { rowsOf as rowsOnStrip, stripOf } from "../../src/panels/session/depth_strip";
import { logMarks } from "../../src/panels/session/log_scale";
import { heldoutByDefault, whyNot } from "../../src/panels/session/permission";
import { textOf } from "../../src/panels/session/pose_card";

describe("residuals", () => {
  test("are counted by class, and their RMS is over the known ones", () => {
    const edge = new Float32Array([0, 0, 1, 0, 0, -3, 0, 0, 8, 0, 0, NaN]);
    const { counts, rms } = summaryOf(edge);
    expect(counts).toEqual([1, 1, 1, 1]);
    expect(rms).toBeCloseTo(Math.sqrt((1 + 9 + 64) / 3), 6);
  });

  test("have no RMS where none is known", () => {
    expect(summaryOf(new Float32Array([0, 0, NaN])).rms).toBeNull();
  });
});

describe("marks of a logarithmic axis", () => {
  test.each([[[0.033, 0.05]], [[0.02]], [[1, 10]], [[0.0123, 4.7, 900]]])("enclose %j", (values) => {
    const marks = logMarks(values);
    expect(marks[0]!).toBeLessThan(Math.min(...values));
    expect(marks[marks.length - 1]!).toBeGreaterThan(Math.max(...values));
    expect(marks.length).toBeGreaterThanOrEqual(3);
    expect([...marks].sort((x, y) => x - y)).toEqual(marks);
  });

  test("are none without a value above zero", () => {
    expect(logMarks([0, -1, NaN])).toEqual([]);
  });
});

describe("the strip of distances", () => {
  test("puts labels that would lie on each other into rows", () => {
    expect(rowsOnStrip([0.5, 0.52, 0.9, 0.54], 0.08)).toEqual([0, 1, 0, 2]);
  });

  test("is as long as the farthest board, in round parts", () => {
    expect(stripOf(4.2)).toEqual({ length: 5, parts: 5 });
    expect(stripOf(130)).toEqual({ length: 200, parts: 4 });
  });
});

describe("a pose on the clipboard", () => {
  test("is JSON, with all digits", () => {
    const matrix = [0, -1, 0, 1 / 3, 1, 0, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1];
    expect(JSON.parse(textOf(matrix)).flat()).toEqual(matrix);
  });
});

describe("what a person may ask for", () => {
  const session = { mode: "by_hand", can: ["capture"], busy: "" } as unknown as SessionFrame;
  const hello = { may_command: true, why_not: "" } as Hello;

  test("is what the session can do", () => {
    expect(whyNot("capture", session, "open", hello)).toBe("");
    expect(whyNot("finish", session, "open", hello)).not.toBe("");
    expect(whyNot("finish", { ...session, busy: "solving" }, "open", hello)).toBe("Busy: solving.");
  });

  test("is nothing without permission or bridge", () => {
    expect(whyNot("capture", session, "open", { ...hello, may_command: false, why_not: "no token" })).toBe("no token");
    expect(whyNot("capture", session, "lost", hello)).not.toBe("");
    expect(whyNot("capture", session, "embedded", hello)).not.toBe("");
  });

  test("holds out every third view", () => {
    expect([0, 1, 2, 3, 4, 5].map(heldoutByDefault)).toEqual([false, false, true, false, false, true]);
  });
});
