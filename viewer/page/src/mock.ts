// A bridge that is none: plausible frames of every type, for `npm run dev` without the C++ side.
import type { Header, ToBridge } from "./protocol";
import { decodeFrame } from "./protocol";
import { busFrame, mountsFrame, targetStatusFrame, waveFrame } from "./mock/bus";
import { chunk, wholeSweep } from "./mock/clouds";
import { encodeFrame } from "./mock/encode";
import { boardThumb, kMaxK, kMinK, overlayArrays, picture } from "./mock/pictures";
import { boardAt, boardOfView, kCameras, kTarget, type Board } from "./mock/scene";
import { MockSession, viewName } from "./mock/session";
import { connection, setSender, take, watched } from "./store";

const kSweepPoints = 100_000;
const session = new MockSession();
const seconds = (): number => performance.now() / 1000;
let id = 0;

function post(header: Parameters<typeof encodeFrame>[1], arrays?: Record<string, Uint8Array | Float32Array>): void {
  take(decodeFrame(encodeFrame(++id, header, arrays)));
}

const limits = (kind: string) => (kind === "thermal" ? { min_k: kMinK, max_k: kMaxK } : { min_k: null, max_k: null });

async function postImage(camera: (typeof kCameras)[number], view: string, board: Board): Promise<void> {
  const utime = Date.now() * 1000;
  const { jpeg, width, height } = await picture(camera, board, 640);
  post({ type: "image", camera: camera.name, view, utime, width, height, ...limits(camera.kind), ack: view === "" }, { jpeg });
  post({ type: "overlay", camera: camera.name, view, utime, calibrated: true, text: "board found", ack: view === "" },
    overlayArrays(camera, board, 3000));
}

async function postThumbs(index: number): Promise<void> {
  for (const camera of kCameras) {
    const { jpeg, width, height } = await picture(camera, boardOfView(index), 240);
    post({ type: "thumb", view: viewName(index), camera: camera.name, width, height }, { jpeg });
  }
  const { jpeg, width, height } = await boardThumb();
  post({ type: "thumb", view: viewName(index), camera: "", width, height }, { jpeg });
}

function request(message: Extract<ToBridge, { type: "request" }>): void {
  session.begin(message.request);
  post(session.frame());
  setTimeout(() => {
    session.end(message.request);
    post(session.frame());
    post({ type: "notice", level: "info", text: `${message.request}: done` });
    if (message.request === "capture") void postThumbs(session.viewCount - 1);
  }, 1500);
}

function answer(message: ToBridge): void {
  if (message.type === "view")
    kCameras.forEach((camera) => void postImage(camera, message.view, boardOfView(Number(message.view) - 1)));
  if (message.type === "request") request(message);
  if (message.type === "leave_out") {
    session.leaveOut(message.views);
    post(session.frame());
  }
  if (message.type === "pick") {
    session.pick(message.camera, message.image_utime);
    post(session.frame());
    post({ type: "notice", level: "info", text: `${message.camera}: four corners sent` });
  }
}

/// A sweep of 4 s: a chunk every half second, then the whole.
function postClouds(): void {
  let sweep = Date.now() * 1000;
  let part = 0;
  const send = (one: { header: Parameters<typeof encodeFrame>[1]; points: Uint8Array }) => post(one.header, { points: one.points });
  wholeSweep(sweep - 1, kSweepPoints, seconds()).forEach(send);
  setInterval(() => {
    if (!watched.value.cloud) return;
    if (part < 8) return send(chunk(sweep, part++, kSweepPoints / 8, seconds()));
    wholeSweep(sweep, kSweepPoints, seconds()).forEach(send);
    [sweep, part] = [Date.now() * 1000, 0];
  }, 500);
}

const kFirst: Header[] = [
  { type: "hello", source: "live", title: "udpm://239.255.76.67:7667 (mock)", version: "0.1.0", may_command: true, why_not: "" },
  { type: "rig", hash: "0a1b2c3d", cameras: kCameras, target: kTarget },
];

export function startMock(): void {
  setSender(answer);
  connection.value = "open";
  kFirst.forEach((header) => take(decodeFrame(encodeFrame(++id, header as Parameters<typeof encodeFrame>[1]))));
  post(session.frame());
  postClouds();
  void (async () => { for (let index = 0; index < session.viewCount; ++index) await postThumbs(index); })();
  setInterval(() => { post(busFrame(seconds())); post(targetStatusFrame(seconds())); post(mountsFrame(seconds())); post(waveFrame(seconds())); }, 1000);
  setInterval(() => kCameras.filter(({ name }) => watched.value.cameras.includes(name))
    .forEach((camera) => void postImage(camera, "", boardAt(seconds()))), 500);
}
