// Measuring, the crop box and the section.
import { padded, withEnd, type Box, type Section } from "../../cloud/crop";
import { measured } from "../../cloud/measure";
import { sceneNow } from "../../cloud/model";
import { crop, ends, extents, measuring, section } from "../../cloud/settings";
import { fixed, metres } from "../../format";

const kAxes = ["x", "y", "z"] as const;
const kThickness = { least: 0.05, most: 3, first: 0.5 }; // [m]

export function toggleMeasure(): void {
  measuring.value = !measuring.value;
  ends.value = [];
}

export function toggleCrop(): void {
  crop.value = crop.value ? null : padded(extents.peek());
}

export function toggleSection(): void {
  const { low, high } = extents.peek();
  section.value = section.value ? null : { axis: 2, middle: (low[2] + high[2]) / 2, thickness: kThickness.first };
}

const kMeasureWords = ["Tap the first point.", "Tap the second point."];

export function MeasurePanel() {
  if (!measuring.value) return null;
  const [from, to] = ends.value;
  const between = to && measured(from, to);
  return (
    <div class="cloud-tool" role="status" data-testid="cloud-measured">
      {between ? (
        <>
          <strong data-testid="measured-distance">{metres(between.distance)}</strong>
          {between.difference.map((value, i) => (
            <span key={i} data-testid={`measured-d${kAxes[i]}`}>d{kAxes[i]} {metres(value)}</span>
          ))}
        </>
      ) : kMeasureWords[ends.value.length]}
    </div>
  );
}

interface SlideProps { label: string; min: number; max: number; value: number; testid: string; set(value: number): void }

function Slide({ label, min, max, value, testid, set }: SlideProps) {
  return (
    <input type="range" min={min} max={max} step={0.05} value={value} aria-label={label} data-testid={testid}
      onInput={(event) => set(Number(event.currentTarget.value))} />
  );
}

function CropRow({ axis, box, reach }: { axis: number; box: Box; reach: Box }) {
  const name = kAxes[axis];
  const end = (which: "low" | "high", words: string) => (
    <Slide label={`${words} end of the box in ${name}, m`} min={reach.low[axis]} max={reach.high[axis]} value={box[which][axis]}
      testid={`crop-${name}-${which}`} set={(to) => { crop.value = withEnd(box, which, axis, to); }} />
  );
  return (
    <div class="cloud-slides">
      <span>{name}</span>
      {end("low", "Lower")}
      {end("high", "Upper")}
      <span class="number">{fixed(box.low[axis], 1)} to {fixed(box.high[axis], 1, "m")}</span>
    </div>
  );
}

export function CropPanel() {
  const box = crop.value;
  if (!box) return null;
  const reach = padded(extents.value);
  return (
    <div class="cloud-tool column" role="group" aria-label="Crop box" data-testid="cloud-crop-box">
      {[0, 1, 2].map((axis) => <CropRow key={axis} axis={axis} box={box} reach={reach} />)}
    </div>
  );
}

function AxisButtons({ now }: { now: Section }) {
  const { low, high } = extents.value;
  return (
    <div class="row" role="group" aria-label="Axis of the section">
      {([0, 1, 2] as const).map((axis) => (
        <button key={axis} aria-pressed={now.axis === axis} data-testid={`section-${kAxes[axis]}`}
          onClick={() => { section.value = { ...now, axis, middle: (low[axis] + high[axis]) / 2 }; }}>{kAxes[axis]}</button>
      ))}
      <button data-testid="section-look" onClick={() => sceneNow()?.lookAlong(now.axis)}>Look along {kAxes[now.axis]}</button>
    </div>
  );
}

export function SectionPanel() {
  const now = section.value;
  if (!now) return null;
  const { low, high } = padded(extents.value);
  return (
    <div class="cloud-tool column" role="group" aria-label="Section" data-testid="cloud-section-panel">
      <AxisButtons now={now} />
      <div class="cloud-slides one">
        <span>at</span>
        <Slide label={`Section's middle in ${kAxes[now.axis]}, m`} min={low[now.axis]} max={high[now.axis]} value={now.middle}
          testid="section-middle" set={(middle) => { section.value = { ...now, middle }; }} />
        <span class="number">{fixed(now.middle, 2, "m")}</span>
        <span>thick</span>
        <Slide label="Section's thickness, m" min={kThickness.least} max={kThickness.most} value={now.thickness}
          testid="section-thickness" set={(thickness) => { section.value = { ...now, thickness }; }} />
        <span class="number">{fixed(now.thickness, 2, "m")}</span>
      </div>
    </div>
  );
}
