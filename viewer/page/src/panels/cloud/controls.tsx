import { kColours, type Colour } from "../../cloud/color_maps";
import { kViews } from "../../cloud/viewpoint";
import { clearMap, sceneNow } from "../../cloud/model";
import { colour, mode, pointSize, stats, voxel, type Mode } from "../../cloud/settings";
import { fixed, grouped } from "../../format";

const kModes: { id: Mode; name: string }[] = [{ id: "sweep", name: "Sweep" }, { id: "map", name: "Map" }];

function ModeButtons() {
  return (
    <div class="row" role="group" aria-label="What is shown">
      {kModes.map(({ id, name }) => (
        <button key={id} aria-pressed={mode.value === id} data-testid={`cloud-mode-${id}`}
          onClick={() => { mode.value = id; }}>{name}</button>
      ))}
    </div>
  );
}

function ColourChoice() {
  return (
    <select aria-label="Colour by" data-testid="cloud-colour" value={colour.value}
      onChange={(event) => { colour.value = event.currentTarget.value as Colour; }}>
      {kColours.map(({ id, name }) => <option key={id} value={id}>{name}</option>)}
    </select>
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
    <div class="row cloud-map">
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

export function Controls() {
  return (
    <div class="cloud-controls" data-testid="cloud-controls">
      <div class="row">
        <ModeButtons />
        <ColourChoice />
      </div>
      {mode.value === "map" && <MapSettings />}
      <details class="cloud-more">
        <summary>View</summary>
        <ViewButtons />
        <label class="check">point size
          <input type="range" min={1} max={6} step={0.5} value={pointSize.value} aria-label="Point size, px"
            onInput={(event) => { pointSize.value = Number(event.currentTarget.value); }} />
          {fixed(pointSize.value, 1, "px")}
        </label>
        <p class="muted">Drag: turn. Right button or two fingers: shift. Wheel or pinch: nearer. Arrow keys: shift, with
          Shift: turn; + and −: nearer. Tap a point for its values.</p>
      </details>
    </div>
  );
}

export function Status() {
  return <div class="cloud-status muted" data-testid="cloud-status">{grouped(stats.value.points)} points</div>;
}
