// The cameras' images, live or of a view, with what was found in them and what the calibration
// lays on them.
import { signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import type { CameraInfo } from "../protocol";
import { chooseView, hasLive, shownView } from "../chosen_view";
import { rig, session, watched } from "../store";
import { CameraPicture } from "./image/camera_picture";
import { OverlaySwitchboard } from "./image/overlay_switchboard";
import type { OverlaySwitches } from "./image/overlay_drawing";
import { ViewStrip } from "./image/view_strip";
import { paramsOf } from "./route";
import "./panels.css";

// They outlive the panel: who comes back finds what was left.
const chosen = signal<string[] | null>(null); // cameras; null: nobody chose yet
const switched = signal<Partial<OverlaySwitches>>({}); // what somebody switched

const kWide = 640; // [CSS px] from which more than one image is shown at first

const kKindWords = { color: "colour", thermal: "thermal" };

function shownCameras(cameras: CameraInfo[]): CameraInfo[] {
  const wanted = chosen.value ?? cameras.slice(0, window.innerWidth >= kWide ? 2 : 1).map((each) => each.name);
  const shown = cameras.filter((each) => wanted.includes(each.name));
  return shown.length > 0 ? shown : cameras.slice(0, 1);
}

/// Tells the bridge what is on the screen, and takes it back.
function useWatched(cameras: string[], cloud: boolean): void {
  const key = JSON.stringify(cameras);
  useEffect(() => {
    watched.value = { ...watched.peek(), cameras, overlay_cloud: cloud };
  }, [key, cloud]);
  useEffect(() => () => { watched.value = { ...watched.peek(), cameras: [], overlay_cloud: false }; }, []);
}

/// On live images the cloud costs the bridge a core's time for each of them: only who asks gets it.
function switchesOf(live: boolean): OverlaySwitches {
  return { corners: true, outline: true, edge: true, cloud: !live, ...switched.value };
}

/// Of `next` only what differs from what is shown was switched; the rest keeps following its default.
function switchTo(next: OverlaySwitches, shown: OverlaySwitches): void {
  const keys = Object.keys(next) as (keyof OverlaySwitches)[];
  const changed = keys.filter((key) => next[key] !== shown[key]).map((key) => [key, next[key]]);
  switched.value = { ...switched.value, ...Object.fromEntries(changed) };
}

function CameraButtons({ cameras, shown }: { cameras: CameraInfo[]; shown: string[] }) {
  const toggle = (name: string): void => {
    const next = shown.includes(name) ? shown.filter((each) => each !== name) : [...shown, name];
    if (next.length > 0) chosen.value = next;
  };
  return (
    <div class="row" role="group" aria-label="Cameras shown">
      {cameras.map(({ name, kind }) => (
        <button type="button" key={name} class="toggle" aria-pressed={shown.includes(name)}
          data-testid={`camera-${name}`} onClick={() => toggle(name)}>
          {name}{name !== kind && <span class="muted"> {kKindWords[kind]}</span>}
        </button>
      ))}
    </div>
  );
}

export function CamerasPanel() {
  const params = paramsOf("cameras");
  const wantedView = params.get("view"), wantedCamera = params.get("camera");
  useEffect(() => {
    if (wantedView !== null) chooseView(wantedView);
    if (wantedCamera !== null) chosen.value = [wantedCamera];
  }, [wantedView, wantedCamera]);

  const cameras = shownCameras(rig.value?.cameras ?? []);
  const names = cameras.map((each) => each.name);
  const views = session.value?.views ?? [];
  const view = shownView.value, live = view === "" && hasLive.value;
  const switches = switchesOf(live);
  useWatched(live ? names : [], live && switches.cloud);

  if (!rig.value) return <p class="empty">No rig description received yet.</p>;
  return (
    <section class="panel cameras" aria-label="Cameras">
      <CameraButtons cameras={rig.value.cameras} shown={names} />
      <ViewStrip views={views} chosen={view} hasLive={hasLive.value} camera={names[0] ?? ""} choose={chooseView} />
      <OverlaySwitchboard switches={switches} set={(next) => switchTo(next, switches)} />
      <div class={`pictures ${cameras.length > 1 ? "several" : ""}`}>
        {cameras.map((camera) => (
          <CameraPicture key={camera.name} camera={camera} view={view} switches={switches} />
        ))}
      </div>
    </section>
  );
}
