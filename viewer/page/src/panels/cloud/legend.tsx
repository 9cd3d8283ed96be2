// What the colours mean, and where the colour table begins and ends.
import { useState } from "preact/hooks";
import { cameraColor, gradient, kColours } from "../../cloud/color_maps";
import { blend, colour, rangedBy, ranges, setRange, stats, type Ranged } from "../../cloud/settings";

/// All combinations of few cameras; of many each alone.
function combinations(cameras: string[]): { valid: number; name: string }[] {
  const masks = cameras.length <= 3
    ? Array.from({ length: 2 ** cameras.length - 1 }, (_, i) => i + 1) : cameras.map((_, bit) => 1 << bit);
  return masks.map((valid) => ({ valid, name: cameras.filter((_, bit) => valid & (1 << bit)).join(" + ") }));
}

function CamerasLegend() {
  return (
    <ul class="cloud-swatches" data-testid="cloud-legend">
      {combinations(stats.value.cameras).map(({ valid, name }) => (
        <li key={valid}><i style={{ background: cameraColor(valid) }} />{name}</li>
      ))}
      <li><i class="cloud-unknown" />none</li>
    </ul>
  );
}

/// What is being typed stands, though "auto" goes on moving the end.
function End({ which, end, unit }: { which: Ranged; end: "low" | "high"; unit: string }) {
  const digits = which === "intensity" ? 0 : 1;
  const [draft, setDraft] = useState<string | null>(null);
  const change = (text: string) => {
    const value = Number(text);
    if (text !== "" && Number.isFinite(value)) setRange(which, { auto: false, [end]: value });
    setDraft(null);
  };
  return (
    <label class="cloud-end">
      <input type="number" step={digits ? 0.5 : 1} value={draft ?? ranges.value[which][end].toFixed(digits)} data-testid={`cloud-${end}`}
        aria-label={`${end === "low" ? "Lower" : "Upper"} end of the colours${unit && `, ${unit}`}`}
        onInput={(event) => setDraft(event.currentTarget.value)} onBlur={() => setDraft(null)}
        onChange={(event) => change(event.currentTarget.value)} />
      {unit}
    </label>
  );
}

function RangeLegend({ which }: { which: Ranged }) {
  const { name, unit } = kColours.find(({ id }) => id === which)!;
  return (
    <div class="cloud-range" data-testid="cloud-legend" role="group" aria-label={name}>
      <End which={which} end="low" unit={unit} />
      <span class="cloud-bar" style={{ background: gradient(which) }} />
      <End which={which} end="high" unit={unit} />
      <label class="check" title="From the 1st to the 99th percentile of what is shown">
        <input type="checkbox" checked={ranges.value[which].auto} data-testid="cloud-auto"
          onChange={(event) => setRange(which, { auto: event.currentTarget.checked })} />
        auto
      </label>
    </div>
  );
}

function BlendSlide() {
  return (
    <label class="cloud-blend">Colour
      <input type="range" min={0} max={1} step={0.05} value={blend.value} data-testid="cloud-blend" aria-label="From colour to temperature"
        onInput={(event) => { blend.value = Number(event.currentTarget.value); }} />
      Temperature
    </label>
  );
}

export function Legend() {
  const which = colour.value, ranged = rangedBy(which);
  if (which === "cameras") return <CamerasLegend />;
  return (
    <>
      {which === "blend" && <BlendSlide />}
      {ranged && <RangeLegend which={ranged} />}
    </>
  );
}
