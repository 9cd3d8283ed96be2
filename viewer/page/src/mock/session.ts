// A session by hand that has six views of ten; requests and picks change it as a real one would.
import type { Board } from "./scene";
import { boardOfView, camera_from_lidar, kCameras } from "./scene";
import { outlineOf } from "./pictures";
import type { CameraState, Cell, RequestName, SessionFrame, Vec3, View, ViewCamera } from "../protocol";

const plain = (text: string): Cell => ({ text, mark: "none" });

const kStart = Date.now() * 1000;

function viewCamera(index: number, board: Board, camera: (typeof kCameras)[number]): ViewCamera {
  const rejected = camera.kind === "thermal" && index % 3 === 2;
  const why = rejected ? "no checkerboard: 31 of 35 corners; the board is too even in temperature" : "";
  return {
    camera: camera.name, image_utime: kStart + index * 60e6, state: rejected ? "rejected" : "accepted",
    why, image_why_not: why,
    picked: camera.kind === "thermal" && index === 1, outline: rejected ? [] : outlineOf(camera, board),
    edge_rms_px: rejected ? null : 0.4 + 0.13 * index, edge_rms_sigmas: rejected ? null : 0.9 + 0.15 * index,
    edge_rms_mm: rejected ? null : 2.1 + 0.4 * index, plane_rms_mm: rejected ? null : 8.3,
  };
}

export const viewName = (index: number): string => String(index + 1).padStart(4, "0");

function view(index: number): View {
  const board = boardOfView(index);
  const normal: Vec3 = [-Math.cos(board.yaw), Math.sin(board.yaw), 0];
  return {
    name: viewName(index), heldout: index % 4 === 3, left_out: false, waits: "",
    board: { centre_m: board.centre, normal, distance_m: Math.hypot(...board.centre) },
    cloud_why_not: "",
    cameras: kCameras.map((camera) => viewCamera(index, board, camera)),
  };
}

function cameraState(views: number, camera: (typeof kCameras)[number]): CameraState {
  const thermal = camera.kind === "thermal";
  return {
    camera: camera.name, calibrated: views > 3, status: views > 3 ? "converged" : "3 views are too few: 4 are needed",
    utime: kStart + views * 60e6, camera_from_lidar: camera_from_lidar(camera),
    poses: [{ name: "camera_from_lidar", sentence: "Takes a point of the LIDAR frame into the camera's.", matrix: camera_from_lidar(camera) }],
    projection: [[0.09, 1.2, 4], [0.16, 0.8, 2]],
    rotation_sigma_deg: 0.2 / views, centre_sigma_mm: (thermal ? 30 : 12) / views,
    verdict: thermal
      ? { grade: "usable", headline: "Usable: rgb and thermal", reasons: ["the upper left of the image has no view", "held-out edge 1.6 sigma"] }
      : { grade: "good", headline: "Good", reasons: [] },
  };
}

export class MockSession {
  private views = Array.from({ length: 6 }, (_, index) => view(index));
  private log: SessionFrame["log"] = [];
  private out: string[] = [];
  private can: RequestName[] = ["capture", "finish"];
  private busy = "";

  constructor() { this.say("session", "done", "6 views read"); }

  say(source: string, kind: "progress" | "done" | "failed", text: string): void {
    this.log = [...this.log.slice(-50), { utime: Date.now() * 1000, source, kind, text }];
  }

  get viewCount(): number { return this.views.length; }

  frame(): SessionFrame {
    const wanted = this.views.flatMap(({ name, cameras }) => cameras.filter(({ state }) => state === "rejected")
      .map(({ camera, image_utime, why }) => ({ view: name, camera, image_utime, why })));
    const cameras = kCameras.map((camera) => cameraState(this.views.length, camera));
    return {
      type: "session", mode: "by_hand", can: this.busy ? [] : this.can, busy: this.busy, fraction: this.busy ? 0.4 : 0,
      step: 0, steps: 0, failure: "", log: this.log, views: this.views, left_out: this.leftOut(), pick_wanted: wanted,
      sigma: Array.from({ length: Math.max(0, this.views.length - 3) }, (_, step) => ({
        views: step + 4,
        cameras: cameras.map(({ camera }, i) => ({ camera, rotation_deg: 0.2 / (step + 4), centre_mm: (i ? 30 : 12) / (step + 4) })),
      })),
      cameras,
      verdict: { grade: "usable", headline: "Usable: thermal", reasons: ["thermal: the upper left of the image has no view"] },
      heldout: {
        title: "Held-out views", notes: ["RMS distance on views that the solver never saw."], head: ["Camera", "Distance", "In sigmas", "Verdict"],
        rows: [
          [plain("rgb"), plain("0.70 px"), plain("1.05 sigma"), { text: "as expected", mark: "good" }],
          [plain("thermal"), plain("1.10 px"), plain("1.60 sigma"), { text: "less exact than stated", mark: "doubtful" }],
        ],
      },
      next_view: {
        words: "Board 4 m away, left and high in the thermal image, turned 30° to the right",
        gain: "Where camera thermal is worst, the projection uncertainty (1 sigma) is expected to improve from 1.10 to 0.80 px.",
      },
      report: null,
    };
  }

  leaveOut(views: string[]): void {
    this.out = views;
    this.views = this.views.map((one) => ({ ...one, left_out: views.includes(one.name) }));
  }

  private leftOut(): SessionFrame["left_out"] {
    const moved = this.out.length === 0 ? [] : kCameras.map(({ name: camera }) =>
      ({ camera, rotation_deg: 0.01 * this.out.length, centre_mm: this.out.length, sigmas: 0.5 * this.out.length }));
    return { views: this.out, moved, why_not: "" };
  }

  /// Begins what was asked for; `done` when it would be.
  begin(request: RequestName): void {
    this.busy = request === "capture" ? "taking a whole sweep" : request;
    this.say("session", "progress", this.busy);
  }

  end(request: RequestName): void {
    this.busy = "";
    if (request === "capture") this.views = [...this.views, view(this.views.length)];
    this.say("session", "done", request === "capture" ? `view ${viewName(this.views.length - 1)} taken` : request);
  }

  pick(camera: string, image_utime: number): void {
    this.views = this.views.map((one) => ({ ...one, cameras: one.cameras.map((state) =>
      state.camera === camera && state.image_utime === image_utime
        ? { ...state, state: "accepted", why: "", image_why_not: "", picked: true, edge_rms_px: 0.8, edge_rms_sigmas: 1.2 } : state) }));
    this.say("detector", "done", `${camera}: corners picked`);
  }
}
