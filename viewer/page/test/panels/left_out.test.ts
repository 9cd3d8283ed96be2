import { describe, expect, test } from "vitest";
import type { Hello, LeftOut, SessionFrame, View, ViewCamera } from "../../src/protocol";
import { howToKeep, movedWords, toggled, whyNotLeaveOut } from "../../src/panels/session/leave_out";
import { barLength, expectedPx } from "../../src/panels/session/residual_bar";
import { stampOf } from "../../src/chosen_view";

const leftOut = (views: string[], why_not = ""): LeftOut => ({ views, moved: [], why_not });
const hello = { may_command: true, why_not: "", title: "out/monday" } as Hello;
const session = (left_out: LeftOut) => ({ mode: "finished", left_out, cameras: [], views: [] }) as unknown as SessionFrame;

describe("leaving a view out", () => {
  test("names all views that are to be left out, and takes one back", () => {
    expect(toggled(leftOut(["0004"]), "0002")).toEqual(["0002", "0004"]);
    expect(toggled(leftOut(["0002", "0004"]), "0002")).toEqual(["0004"]);
  });

  test("is possible where a bridge can solve, and says why not elsewhere", () => {
    expect(whyNotLeaveOut(session(leftOut([])), "open", hello)).toBe("");
    expect(whyNotLeaveOut(session(leftOut([], "by paper")), "open", hello)).toBe("by paper");
    expect(whyNotLeaveOut(session(leftOut([])), "open", { ...hello, may_command: false, why_not: "no token" })).toBe("no token");
    expect(whyNotLeaveOut(session(leftOut([])), "embedded", hello)).toContain("rgbdt-viewer --session out/monday");
  });

  test("is kept by a command, and a report says that it was made so", () => {
    const without = session(leftOut(["0002", "0004"]));
    expect(howToKeep(without, "open", { ...hello, source: "session" })).toContain("rgbdt calibrate out/monday --without 0002 --without 0004");
    expect(howToKeep(without, "open", { ...hello, source: "live" })).toBe("Nothing is saved.");
    expect(howToKeep(without, "embedded", hello)).toContain("made without");
  });

  test("is told in degrees, millimetres and sigmas", () => {
    expect(movedWords({ camera: "rgb", rotation_deg: 0.0123, centre_mm: 1.26, sigmas: 0.8 })).toBe("rgb: 0.012°, 1.3\u202fmm (0.80\u202fsigmas)");
    expect(movedWords({ camera: "rgb", rotation_deg: 0.0123, centre_mm: 1.26, sigmas: null })).not.toContain("(");
  });

  test("makes the pictures of views be asked for again", () => {
    expect(stampOf(session(leftOut([])), "0001")).not.toBe(stampOf(session(leftOut(["0003"])), "0001"));
  });
});

describe("the bar of a residual", () => {
  const own = (edge_rms_px: number | null, edge_rms_sigmas: number | null) => ({ camera: "rgb", edge_rms_px, edge_rms_sigmas }) as ViewCamera;

  test("has a mark where 1 sigma is", () => {
    expect(expectedPx(own(0.6, 1.5))).toBeCloseTo(0.4, 9);
    expect(expectedPx(own(0.6, null))).toBeNull();
    expect(expectedPx(own(null, null))).toBeNull();
  });

  test("is as long as the worst of a camera's views", () => {
    const views = [own(0.6, 1.5), own(3, 1), own(null, null)].map((camera) => ({ cameras: [camera, { ...own(9, 1), camera: "thermal" }] }) as View);
    expect(barLength(views, "rgb")).toBe(3);
    expect(barLength([], "rgb")).toBe(1);
  });
});
