import type { ShownOverlay } from "../../store";
import { celsius, count, metres, px } from "../words";
import { gradientOf } from "./colour_tables";
import { depthRange, kOverlayColours } from "./overlay_drawing";
import type { OverlaySwitches } from "./overlay_drawing";
import { kResidualClasses, summaryOf } from "./residuals";
import type { ResidualClass } from "./residuals";

function Mark({ mark, colour }: { mark: ResidualClass["mark"]; colour: string }) {
  return (
    <svg class="mark" viewBox="-6 -6 12 12" aria-hidden="true" stroke-width="2">
      {mark === "dot" && <circle r="4" fill={colour} stroke="#000" stroke-width="1" />}
      {mark === "square" && <rect x="-4" y="-4" width="8" height="8" fill={colour} stroke="#000" stroke-width="1" />}
      {mark === "cross" && <path d="M-4-4 4 4M4-4-4 4" stroke="#000" stroke-width="4" />}
      {mark === "cross" && <path d="M-4-4 4 4M4-4-4 4" stroke={colour} />}
      {mark === "ring" && <circle r="4" fill="none" stroke="#000" stroke-width="4" />}
      {mark === "ring" && <circle r="4" fill="none" stroke={colour} />}
    </svg>
  );
}

function Ramp({ name, low, high, title }: { name: "turbo" | "inferno" | "grey"; low: string; high: string; title: string }) {
  return (
    <div class="ramp">
      <span>{title}</span>
      <span class="ramp-end">{low}</span>
      <span class="ramp-bar" style={{ background: gradientOf(name) }} aria-hidden="true" />
      <span class="ramp-end">{high}</span>
    </div>
  );
}

export function ResidualLegend({ overlay }: { overlay: ShownOverlay }) {
  const { counts, rms } = summaryOf(overlay.edge);
  return (
    <ul class="legend" aria-label="Outline error: distance of the board edge from the outline">
      {kResidualClasses.map((each, i) => (counts[i]! > 0 || each.name !== "unknown") && (
        <li key={each.name}><Mark mark={each.mark} colour={each.colour} /> {each.words}: {counts[i]}</li>
      ))}
      <li><strong data-testid="edge-rms">outline error {px(rms)} RMS</strong></li>
    </ul>
  );
}

function FoundLegend({ overlay, switches }: { overlay: ShownOverlay; switches: OverlaySwitches }) {
  const corners = overlay.corners.length / 2;
  return (
    <ul class="legend">
      {switches.corners && corners > 0 &&
        <li><span class="swatch" style={{ background: kOverlayColours.corners }} /> {count(corners, "corner")} detected</li>}
      {switches.outline && overlay.outline.length > 0 &&
        <li><span class="swatch" style={{ background: kOverlayColours.outline }} /> board outline</li>}
    </ul>
  );
}

export function OverlayLegends({ overlay, switches }: { overlay: ShownOverlay; switches: OverlaySwitches }) {
  const depths = switches.cloud ? depthRange(overlay.cloud) : null;
  return (
    <>
      <FoundLegend overlay={overlay} switches={switches} />
      {switches.edge && overlay.edge.length > 0 && <ResidualLegend overlay={overlay} />}
      {depths && <Ramp name="turbo" title="Depth" low={metres(depths.low, 1)} high={metres(depths.high, 1)} />}
    </>
  );
}

export function TemperatureLegend({ low, high, falseColour }: { low: number; high: number; falseColour: boolean }) {
  return <Ramp name={falseColour ? "inferno" : "grey"} title="Temperature" low={celsius(low)} high={celsius(high)} />;
}
