import type { Signal } from "@preact/signals";
import { coloursOf, kColours, type Colour } from "../../cloud/color_maps";
import { kViews } from "../../cloud/viewpoint";
import { clearMap, sceneNow } from "../../cloud/model";
import {
  colour, crop, cutaway, dark, lighting, measuring, mode, pointSize, section, showCameras, showGrid, stats, voxel, type Mode,
} from "../../cloud/settings";
import { fixed, grouped } from "../../format";
import { chooseView, hasLive, shownView } from "../../chosen_view";
import { hello, rig, session } from "../../store";
import { CropPanel, MeasurePanel, SectionPanel, toggleCrop, toggleMeasure, toggleSection } from "./tools";

const kModes: { id: Mode; name: string }[] = [{ id: "sweep", name: "Sweep" }, { id: "map", name: "Map" }];

/// A finished session has a sweep a view, of which there is no map to be made.
function ModeButtons() {
  if (hello.value?.source === "session") return null;
  return (
    <div class="row" role="group" aria-label="What is shown">
      {kModes.map(({ id, name }) => (
        <button key={id} aria-pressed={mode.value === id} data-testid={`cloud-mode-${id}`}
          onClick={() => { mode.value = id; }}>{name}</button>
      ))}
    </div>
  );
}

/// Whose cloud is shown, of a session's views.
function ViewChoice() {
  const views = session.value?.views ?? [];
  if (hasLive.value || views.length < 2) return null;
  return (
    <select aria-label="View" data-testid="cloud-view" value={shownView.value} onChange={(event) => chooseView(event.currentTarget.value)}>
      {views.map(({ name }) => <option key={name} value={name}>view {name}</option>)}
    </select>
  );
}

function ColourChoice() {
  const offered = coloursOf(rig.value?.cameras ?? null);
  return (
    <select aria-label="Colour by" data-testid="cloud-colour" value={colour.value}
      onChange={(event) => { colour.value = event.currentTarget.value as Colour; }}>
      {offered.map((id) => <option key={id} value={id}>{kColours.find((each) => each.id === id)!.name}</option>)}
    </select>
  );
}

interface ToolProps { name: string; on?: boolean; testid: string; title: string; act(): void }

function Tool({ name, on, testid, title, act }: ToolProps) {
  return <button aria-pressed={on} data-testid={testid} title={title} onClick={act}>{name}</button>;
}

function Tools() {
  return (
    <>
      <Tool name="Fit" testid="cloud-fit" title="All of the cloud on the screen (double click)" act={() => sceneNow()?.fit()} />
      <Tool name="Measure" on={measuring.value} testid="cloud-measure" title="The distance between two points" act={toggleMeasure} />
      <Tool name="Crop" on={crop.value !== null} testid="cloud-crop" title="Only what is in a box" act={toggleCrop} />
      <Tool name="Section" on={section.value !== null} testid="cloud-section" title="Only a slice across an axis" act={toggleSection} />
    </>
  );
}

function ViewButtons() {
  return (
    <div class="row" role="group" aria-label="View">
      {kViews.map(({ id, name }) => (
        <button key={id} data-testid={`cloud-view-${id}`} onClick={() => sceneNow()?.look(id)}>{name}</button>
      ))}
    </div>
  );
}

function MapSettings() {
  return (
    <div class="row cloud-tool">
      <label class="check">voxel
        <input type="number" min={0.5} max={100} step={0.5} value={voxel.value * 100} data-testid="cloud-voxel" aria-label="Voxel size, cm"
          onChange={(event) => { voxel.value = Math.min(1, Math.max(0.005, Number(event.currentTarget.value) / 100 || 0.05)); }} />
        cm
      </label>
      {stats.value.voxel_m > voxel.value && <span class="caution">{fixed(100 * stats.value.voxel_m, 0, "cm")} now: too many points</span>}
      <button data-testid="cloud-clear" onClick={clearMap}>Clear</button>
    </div>
  );
}

function Switch({ name, of, testid, title }: { name: string; of: Signal<boolean>; testid: string; title?: string }) {
  return (
    <label class="check" title={title}>
      <input type="checkbox" checked={of.value} data-testid={testid} onChange={(event) => { of.value = event.currentTarget.checked; }} />
      {name}
    </label>
  );
}

function Appearance() {
  return (
    <>
      <label class="check">point size
        <input type="range" min={0.5} max={3} step={0.25} value={pointSize.value} aria-label="Point size, times the spacing"
          onInput={(event) => { pointSize.value = Number(event.currentTarget.value); }} />
        {fixed(pointSize.value, 2, "×")}
      </label>
      <div class="cloud-switches">
        <Switch name="Grid" of={showGrid} testid="cloud-grid" title="On the ground, metres" />
        <Switch name="Cameras" of={showCameras} testid="cloud-cameras" title="Where they are and what they see" />
        <Switch name="Cutaway" of={cutaway} testid="cloud-cutaway" title="Leaves out what stands in front of the LIDAR and no camera saw" />
        <Switch name="Eye-dome lighting" of={lighting} testid="cloud-lighting" title="Edges in depth are darkened" />
        <Switch name="Dark background" of={dark} testid="cloud-dark" />
      </div>
    </>
  );
}

function More() {
  return (
    <details class="cloud-more">
      <summary>View</summary>
      <div class="cloud-more-body">
        <ViewButtons />
        <Appearance />
        <p class="muted">Drag: turn. Right button or two fingers: move. Wheel or pinch: zoom. Double click: fit. Arrow keys:
          move, with Shift: turn; + and −: zoom. Tap a point for its values.</p>
      </div>
    </details>
  );
}

export function Controls() {
  return (
    <div class="cloud-controls" data-testid="cloud-controls">
      <div class="row">
        <ModeButtons />
        <ViewChoice />
        <ColourChoice />
        <Tools />
        <More />
      </div>
      {mode.value === "map" && <MapSettings />}
      <MeasurePanel />
      <CropPanel />
      <SectionPanel />
    </div>
  );
}

export function Status() {
  return <div class="cloud-status muted" data-testid="cloud-status">{grouped(stats.value.points)} points</div>;
}
