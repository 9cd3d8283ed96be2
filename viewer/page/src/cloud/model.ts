// Cloud frames in, the scene out. It outlives the panel: what came while another tab was shown is
// there when this one is.
import { effect } from "@preact/signals";
import { Matrix4 } from "three";
import type { CloudFrame, Frame, SessionFrame, RigFrame, Vec3 } from "../protocol";
import { shownView } from "../chosen_view";
import { ack, connection, onCloud, rig, session, watched } from "../store";
import { kZeroCelsius } from "../format";
import { liveBudget } from "./budget";
import { coloursOf } from "./color_maps";
import { limitsOf } from "./crop";
import { withPoint } from "./measure";
import { partOf, valuesOf, type Part, type PointValues } from "./points";
import { percentiles } from "./range";
import { CloudScene } from "./scene";
import {
  blend, colour, crop, cutaway, dark, ends, extents, lighting, mode, picked, pointSize, rangedBy, ranges, section, setRange, showCameras, showGrid,
  stats, voxel,
} from "./settings";
import type { Frustum } from "./surroundings";
import { Sweeps } from "./sweeps";
import { VoxelMap } from "./voxel_map";

const kDefaultBudget = 100_000; // until it is known what draws
const kMostViews = 4; // whose clouds are kept where a bridge can be asked for them again

const sweeps = new Sweeps();
const map = new VoxelMap(kDefaultBudget, voxel.peek());
const ofViews = new Map<string, Part>(); // the clouds of a session's views
let ofView: Part | null = null; // the one that is shown; null: what comes live
let undrawn: Frame[] = [];
let visible = false;
let pose: number[] | null = null; // of the newest frame: map from LIDAR
let cameras: string[] = [];
let scene: CloudScene | null = null;

function ackAll(): void {
  undrawn.forEach(ack);
  undrawn = [];
}

function take(header: CloudFrame, frame: Frame): void {
  const part = partOf(header, frame);
  if (header.view !== "") {
    keepView(header.view, part);
    if (header.ack) undrawn.push(frame);
    if (header.view !== shownView.peek()) return ackAll();
    ofView = part;
  } else {
    sweeps.add(part);
    if (mode.peek() === "map") map.add(part);
    [pose, cameras] = [header.map_from_lidar, header.cameras];
    if (header.ack) undrawn.push(frame);
  }
  if (!visible || !scene || document.hidden) ackAll();
  else show();
}

function keepView(view: string, part: Part): void {
  ofViews.delete(view);
  ofViews.set(view, part);
  if (connection.peek() === "open" && ofViews.size > kMostViews) ofViews.delete(ofViews.keys().next().value!);
}

/// Of the view that is shown or, without one, of what came live.
const shownParts = (): Part[] => (ofView ? [ofView] : sweeps.shown());

/// The view that it is of; "": of none.
export const shownCloud = (): string => ofView?.header.view ?? "";

/// Until a view's cloud is there, the one before stays.
function showView(view: string): void {
  const next = view === "" ? null : ofViews.get(view) ?? ofView;
  if (next === ofView) return;
  ofView = next;
  picked.value = null;
  ends.value = [];
  show();
}

function tell(): void {
  const frame = mode.peek() === "map" ? map.frame : "lidar" as const;
  const now = { ...stats.peek(), points: scene?.points ?? 0, voxel_m: map.voxel_m, frame, cameras: ofView?.cameras ?? cameras };
  if (JSON.stringify(now) !== JSON.stringify(stats.peek())) stats.value = now;
}

/// The legend's ends in the scene's units.
function sceneRange(): [number, number] {
  const which = rangedBy(colour.peek());
  if (!which) return [0, 1];
  const { low, high } = ranges.peek()[which];
  const zero = which === "temperature" ? kZeroCelsius : 0;
  return [low + zero, high + zero];
}

function autoRange(): void {
  const which = rangedBy(colour.peek());
  if (!which || !ranges.peek()[which].auto) return;
  const inMap = mode.peek() === "map";
  const lidar: Vec3 = inMap && map.frame === "map" && pose ? [pose[3], pose[7], pose[11]] : [0, 0, 0];
  const ends = percentiles(inMap ? [map] : shownParts(), which, lidar);
  const { low, high } = ranges.peek()[which];
  if (ends && (ends[0] !== low || ends[1] !== high)) setRange(which, { low: ends[0], high: ends[1] });
}

function show(): void {
  if (!scene) return;
  const inMap = mode.peek() === "map";
  scene.setLidar(inMap && map.frame === "map" ? pose : null);
  if (inMap) scene.showMap(map);
  else scene.showParts(shownParts(), ofView !== null || sweeps.isWhole());
  autoRange();
  if (scene.extents !== extents.peek()) extents.value = scene.extents;
}

const kKindColours = { color: "#7cc4ff", thermal: "#ffa94d" };

/// Cameras that are calibrated, where they are.
function frustaOf(cameras: RigFrame["cameras"], states: SessionFrame["cameras"]): Frustum[] {
  return states.flatMap(({ camera: name, camera_from_lidar: pose }) => {
    const info = cameras.find((each) => each.name === name);
    if (!info || !pose) return [];
    const lidar_from_camera = new Matrix4().set(...(pose as Parameters<Matrix4["set"]>)).invert();
    return [{ name, color: kKindColours[info.kind], lidar_from_camera, corners: info.corners }];
  });
}

/// Begins the map with what is known now.
function restartMap(): void {
  map.reset(scene?.budget ?? kDefaultBudget, voxel.peek());
  sweeps.shown().forEach((part) => map.add(part));
}

export function clearMap(): void {
  map.clear();
  picked.value = null;
  show();
}

/// The scene on a canvas, once; throws where the browser has no WebGL 2. `onDrawn` follows each frame.
export function startScene(canvas: HTMLCanvasElement, words: HTMLElement, onDrawn: () => void): CloudScene {
  const made = new CloudScene(canvas, words);
  scene = made;
  stats.value = { ...stats.peek(), budget: made.budget, renderer: made.renderer };
  watched.value = { ...watched.peek(), points: liveBudget(made.renderer) };
  made.onDrawn = () => { ackAll(); tell(); onDrawn(); };
  effect(() => made.setGround(dark.value));
  effect(() => made.setLighting(lighting.value));
  effect(() => made.setPointSize(pointSize.value));
  effect(() => made.setBlend(blend.value));
  effect(() => made.setCutaway(cutaway.value));
  effect(() => made.setGrid(showGrid.value));
  effect(() => {
    made.surroundings.setBox(crop.value);
    made.setLimits(limitsOf(crop.value, section.value));
  });
  effect(() => { made.surroundings.setEnds(ends.value); made.draw(); });
  effect(() => {
    made.surroundings.setFrusta(showCameras.value ? frustaOf(rig.value?.cameras ?? [], session.value?.cameras ?? []) : []);
    made.draw();
  });
  effect(() => { void ranges.value; made.setColour(colour.value, sceneRange()); });
  effect(() => { void colour.value; autoRange(); });
  effect(() => {
    void voxel.value;
    picked.value = null;
    ends.value = [];
    if (mode.value === "map") restartMap();
    show();
  });
  return made;
}

export const sceneNow = (): CloudScene | null => scene;

export function setVisible(now: boolean): void {
  visible = now;
  watched.value = { ...watched.peek(), cloud: now };
  if (now) show();
  else ackAll();
}

/// The point at a pixel of the window becomes the picked one.
export function pickAt(x: number, y: number): PointValues | null {
  const found = scene?.pickAt(x, y);
  picked.value = found ? valuesOf(found.points, found.index) : null;
  return picked.value;
}

/// The point at a pixel of the window becomes an end of what is measured.
export function measureAt(x: number, y: number): void {
  const found = scene?.pickAt(x, y);
  if (found) ends.value = withPoint(ends.peek(), valuesOf(found.points, found.index).position);
}

onCloud(take);
effect(() => showView(shownView.value));
// What there is to be shown depends on the rig.
effect(() => {
  const offered = coloursOf(rig.value?.cameras ?? null);
  if (!offered.includes(colour.peek())) colour.value = offered[0];
});
document.addEventListener("visibilitychange", () => { if (document.hidden) ackAll(); });
