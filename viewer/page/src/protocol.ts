// What the bridge and the page say to each other. The C++ side is calib/present/frames (what the
// bridge says), viewer/server (how it gets here) and viewer/live (what the page asks for). Frames: LIDAR x forward, y left, z up; camera x right, y down,
// z forward; metres, kelvin, pixels with centres at integers, microseconds UTC.
//
// Bridge -> page: binary frames, little-endian.
//   uint32 id       counts a connection's frames from 1; 0 in a report's embedded frames
//   uint32 size     bytes of the header
//   header          JSON (UTF-8), padded with spaces so that 8 + size is a multiple of 8
//   payload         the header's `arrays` in order, each beginning at a multiple of 8
// A payload may end early, at a whole record of its last array: it was thinned for this browser. Its
// records come shuffled, so that any first part of them is an even sample.
// Page -> bridge: JSON text, see ToBridge. Every frame with `ack` in its header is answered by
// {type: "ack", id} once it has been drawn; the bridge sends no more than a few ahead of that.

export type Grade = "good" | "usable" | "doubtful" | "bad" | "none";
export type Vec2 = [number, number];
export type Vec3 = [number, number, number];

export interface ArrayInfo {
  name: string;
  type: "u8" | "u16" | "i32" | "u32" | "f32";
  length: number; // elements
}

/// First frame of a connection, and of a report.
export interface Hello {
  type: "hello";
  source: "live" | "session"; // a bus, or a finished session
  title: string; // bus URL or session directory
  version: string;
  may_command: boolean; // this browser may command the rig
  why_not: string; // where it may not: what to do
}

export interface CameraInfo {
  name: string;
  kind: "color" | "thermal";
  width: number; // [px]
  height: number;
  corners: Vec3[]; // where the image's four corners look, going round, camera axes; empty: no lens is known
}

/// The rig, as far as the page needs it.
export interface RigFrame {
  type: "rig";
  hash: string;
  cameras: CameraInfo[];
  target: { squares_x: number; squares_y: number; square_m: number; width_m: number; height_m: number };
}

/// A camera's image as a JPEG (array "jpeg"): the newest one, or that of a view. Thermal ones are
/// grey, from min_k (black) to max_k (white).
export interface ImageFrame {
  type: "image";
  camera: string;
  view: string; // "" for the newest, live; in a finished session also "sigma", the reprojection
                // uncertainty, and "lidar", the LIDAR's own errors
  utime: number;
  width: number; // of the camera's image [px]; the JPEG may be smaller
  height: number;
  min_k: number | null; // thermal with radiometry [K]
  max_k: number | null;
  ack?: boolean;
  arrays: ArrayInfo[];
}

/// What to draw on an image, in that image's pixels (full size). Arrays (f32):
///   "corners"  x y         the inner corners found
///   "outline"  x y         the board's outline as found, a closed chain
///   "edge"     x y r       the cloud's board edge laid on the image by the calibration, and its
///                          distance r [px] from the outline; NaN: no outline to compare with
///   "cloud"    x y d       the cloud laid on the image by the calibration, d metres away
export interface OverlayFrame {
  type: "overlay";
  camera: string;
  view: string; // "" for the newest, live
  utime: number; // of the image that it belongs to
  calibrated: boolean; // edge and cloud could be laid
  text: string; // what a person should know: "board found", or why not
  ack?: boolean;
  arrays: ArrayInfo[];
}

/// A small JPEG (array "jpeg") of a view: of a camera's image, or of the board in the cloud.
export interface ThumbFrame {
  type: "thumb";
  view: string;
  camera: string; // "" for the board in the cloud
  width: number;
  height: number;
  arrays: ArrayInfo[];
}

/// Fused points, LIDAR frame: a chunk of the sweep that is being made, or a part of a whole one,
/// which takes the place of its chunks; or the whole cloud of a session's view. The last array is "points": `count` records of
/// kPointBytes, see PointView.
export interface CloudFrame {
  type: "cloud";
  view: string; // "" for the newest, live
  sweep_utime: number; // the sweep's name
  whole: boolean;
  part: number; // of a whole sweep, from 0; a chunk's number
  sweep_end: boolean; // the last of its sweep
  utime: number; // that the points' offsets count from
  cameras: string[]; // bit i of `valid`
  calibrated: boolean[]; // by camera
  map_from_lidar: number[] | null; // 4x4 row by row, where there is a pose
  count: number; // points before thinning
  ack?: boolean;
  arrays: ArrayInfo[];
}

export const kPointBytes = 32;
/// Layout of a point: f32 x y z [m]; u8 red green blue (all 0: no colour camera saw it), u8
/// intensity (0 to 254, 255 unknown); f32 temperature [K] (NaN unknown); f32 thermal counts (NaN);
/// u16 temperature's sigma [mK] (65535 unknown); u16 valid; u32 offset of its time [us].
export const kPointOffsets = {
  position: 0, color: 12, intensity: 15, temperature: 16, counts: 20, sigma: 24, valid: 26, time: 28,
} as const;

export interface ViewCamera {
  camera: string;
  image_utime: number; // 0: none yet
  state: "accepted" | "rejected" | "waiting";
  why: string; // where rejected
  image_why_not: string; // what is wrong with the image alone; "": nothing
  picked: boolean; // a person's corners
  outline: Vec2[]; // the four corners found [px]; empty: none
  edge_rms_px: number | null; // cloud's edge against the outline
  edge_rms_sigmas: number | null;
  edge_rms_mm: number | null; // on the board
  plane_rms_mm: number | null; // of the board's points from its plane
}

export interface View {
  name: string;
  heldout: boolean; // kept to judge the result
  left_out: boolean; // by a person
  waits: string; // what is still missing; "": complete
  board: { centre_m: Vec3; normal: Vec3; distance_m: number } | null; // in the cloud
  cloud_why_not: string; // why there is none; "": there is one, or nobody looked yet
  cameras: ViewCamera[];
}

export interface CameraState {
  camera: string;
  calibrated: boolean;
  status: string; // how the solve ended, in words
  utime: number; // of the calibration; it changes with each new one
  camera_from_lidar: number[] | null; // 4x4 row by row
  poses: Pose[]; // camera_from_lidar and its inverse; empty: not calibrated
  rotation_sigma_deg: number | null; // 1 sigma along the axis that is known least
  centre_sigma_mm: number | null; // of the camera's centre, likewise
  projection: ProjectionVariance[]; // of the image's worst pixels; empty: not known
  verdict: Verdict;
}

/// How uncertain it is where a point is projected, in one pixel: its variance [px^2] is
/// v[0] + v[1] / d + v[2] / d^2, d the point's distance from the camera [m].
export type ProjectionVariance = [number, number, number];

/// Views that a person left out of the result, and what that did.
export interface LeftOut {
  views: string[];
  moved: { camera: string; rotation_deg: number; centre_mm: number; sigmas: number | null }[]; // from the result with all views
  why_not: string; // why no view can be left out; "": it can
}

export interface Verdict {
  grade: Grade;
  headline: string;
  reasons: string[];
}

export interface Cell {
  text: string;
  mark: Grade; // what it says of the result; "none": nothing
}

export interface Table {
  title: string;
  notes: string[]; // sentences between title and table
  head: string[]; // the first column names the rows
  rows: Cell[][];
}

/// A transform with the sentences that say which way it goes.
export interface Pose {
  name: string; // "camera_from_lidar"
  sentence: string;
  matrix: number[]; // 4x4 row by row
}

export interface CameraReport {
  camera: string;
  tables: Table[];
}

/// A report's words and tables, as the plain HTML report has them, too (calib/present/report).
export interface Report {
  intro: string;
  cameras: CameraReport[];
  tables: Table[]; // of all cameras together
}

/// What a person may ask for.
export type RequestName = "next_pose" | "pose_is_set" | "capture" | "finish";

/// All that the Session panel shows. A whole new one whenever something in it changed.
export interface SessionFrame {
  type: "session";
  mode: "none" | "script" | "by_hand" | "finished"; // no session process; a script; the page leads; a directory
  can: RequestName[]; // what may be asked for now
  busy: string; // what is being done; "": nothing
  fraction: number; // of that, 0 to 1
  step: number; // of a script; 0: none
  steps: number;
  failure: string; // why the session, or its last step, failed
  log: { utime: number; source: string; kind: "progress" | "done" | "failed"; text: string }[]; // newest last
  views: View[];
  left_out: LeftOut;
  pick_wanted: { view: string; camera: string; image_utime: number; why: string }[]; // likeliest first
  sigma: { views: number; cameras: { camera: string; rotation_deg: number; centre_mm: number }[] }[];
  cameras: CameraState[];
  verdict: Verdict; // of all cameras
  heldout: Table; // how well each camera's calibration fits the held-out views
  next_view: { words: string; gain: string } | null;
  report: Report | null;
}

/// Who sees the board just now.
export interface TargetStatusFrame {
  type: "target_status";
  sensors: { sensor: string; kind: "color" | "thermal" | "lidar"; seen: boolean; text: string; utime: number; age_s: number }[];
}

/// What rgbdt-monitor says of each camera's mount: whether its calibration still holds.
export interface MountsFrame {
  type: "mounts";
  cameras: {
    camera: string;
    state: "cannot_tell" | "holds" | "moved" | "lost";
    holds: number | null; // probability; null: nothing is told
    text: string;
    utime: number;
    where: number[]; // of the edges that told, the share in each part of the image, 3 rows of 4
    steps: { utime: number; rotation_deg: number }[]; // moved by; newest last
  }[];
}

/// What `rgbdt sync live` is at, and how well it knows each camera's time offset so far.
export interface WaveFrame {
  type: "wave";
  phase: "waiting" | "recording" | "solving" | "done" | "failed";
  left_s: number; // of the recording
  text: string; // what to do now, what was written, or why it failed
  cameras: {
    camera: string;
    offset_ms: number | null; // null: not told
    sigma_ms: number | null; // 1 sigma
    text: string; // why nothing is told, or what is to be known beside it
  }[];
  steps: { seconds: number; cameras: { camera: string; sigma_ms: number }[] }[]; // since the wave began
}

export interface BusFrame {
  type: "bus";
  channels: {
    name: string;
    count: number;
    rate_hz: number;
    bytes_per_s: number;
    size_bytes: number; // of the newest message
    latency_ms: number | null; // from its utime until it came; null: it has no time of this clock
    lost: number;
  }[];
  processes: {
    process: string;
    ready: boolean;
    text: string;
    last_problem: string;
    age_s: number; // since its last STATUS
    counters: { name: string; value: number }[];
  }[];
  browsers: { address: string; waiting: number; thinned: number; share: number }[]; // share: of the points
  screen_ms: { p50: number; p95: number; count: number } | null; // from the bus to drawn, newest 200
}

/// An answer to a person.
export interface NoticeFrame {
  type: "notice";
  level: "info" | "error";
  text: string;
}

export type Header =
  | Hello | RigFrame | ImageFrame | OverlayFrame | ThumbFrame | CloudFrame | SessionFrame
  | TargetStatusFrame | MountsFrame | WaveFrame | BusFrame | NoticeFrame;

export type ToBridge =
  | { type: "hello"; token: string } // first of all
  // What is on the screen; replaces what was said before. points: most drawn at once.
  | { type: "watch"; cloud: boolean; cameras: string[]; overlay_cloud: boolean; points: number }
  | { type: "ack"; id: number }
  | { type: "view"; view: string } // send that view's images, overlays and cloud
  // Commands; with a token where the bridge listens beyond loopback.
  | { type: "request"; request: RequestName; heldout: boolean }
  | { type: "leave_out"; views: string[] } // all that are to be left out
  | { type: "pick"; camera: string; image_utime: number; corners: [Vec2, Vec2, Vec2, Vec2] };

export interface Frame {
  id: number;
  header: Header;
  bytes: ArrayBuffer;
  arrays: Map<string, { type: ArrayInfo["type"]; offset: number; length: number }>;
}

const kElementBytes = { u8: 1, u16: 2, i32: 4, u32: 4, f32: 4 } as const;

/// Throws where the bytes are no frame.
export function decodeFrame(bytes: ArrayBuffer): Frame {
  const view = new DataView(bytes);
  if (bytes.byteLength < 8) throw new Error(`a frame of ${bytes.byteLength} bytes`);
  const size = view.getUint32(4, true);
  if (8 + size > bytes.byteLength) throw new Error(`a header of ${size} bytes in a frame of ${bytes.byteLength}`);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 8, size))) as Header;
  const arrays: Frame["arrays"] = new Map();
  let offset = 8 + size;
  for (const info of "arrays" in header ? header.arrays : []) {
    offset = (offset + 7) & ~7;
    const left = Math.max(0, Math.floor((bytes.byteLength - offset) / kElementBytes[info.type]));
    arrays.set(info.name, { type: info.type, offset, length: Math.min(info.length, left) });
    offset += info.length * kElementBytes[info.type];
  }
  return { id: view.getUint32(0, true), header, bytes, arrays };
}

export function floats(frame: Frame, name: string): Float32Array<ArrayBuffer> {
  const at = frame.arrays.get(name);
  return at ? new Float32Array(frame.bytes, at.offset, at.length) : new Float32Array();
}

export function octets(frame: Frame, name: string): Uint8Array<ArrayBuffer> {
  const at = frame.arrays.get(name);
  return at ? new Uint8Array(frame.bytes, at.offset, at.length) : new Uint8Array();
}
