import type { OverlaySwitches } from "./overlay_drawing";

const kNames: Record<keyof OverlaySwitches, string> = {
  corners: "Detected corners",
  outline: "Board outline",
  edge: "Board edge from the cloud",
  cloud: "Cloud, coloured by depth",
};

interface Props { switches: OverlaySwitches; set(next: OverlaySwitches): void }

export function OverlaySwitchboard({ switches, set }: Props) {
  return (
    <fieldset class="row switches">
      <legend class="muted">Show on the image</legend>
      {(Object.keys(kNames) as (keyof OverlaySwitches)[]).map((name) => (
        <label key={name} class="check">
          <input type="checkbox" checked={switches[name]} data-testid={`overlay-${name}`}
            onChange={(event) => set({ ...switches, [name]: event.currentTarget.checked })} />
          {kNames[name]}
        </label>
      ))}
    </fieldset>
  );
}
