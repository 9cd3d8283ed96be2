// What is on the bus, who is well, and who watches.
import type { ComponentChildren } from "preact";
import { bytes, fixed, grouped } from "../format";
import type { BusFrame } from "../protocol";
import { bus } from "../store";
import { rates } from "./bus/history";
import { Sparkline } from "./bus/sparkline";
import "./bus/bus.css";

const kLateS = 3; // a STATUS comes every second

function Heads({ names }: { names: [string, boolean?][] }) {
  return <thead><tr>{names.map(([name, number]) => <th key={name} class={number ? "number" : ""} scope="col">{name}</th>)}</tr></thead>;
}

function Card({ title, children }: { title: string; children: ComponentChildren }) {
  return <section class="card"><h2>{title}</h2>{children}</section>;
}

function Channels({ channels }: Pick<BusFrame, "channels">) {
  return (
    <Card title="Channels">
      <div class="scroll-x"><table data-testid="bus-channels">
        <Heads names={[["Name"], ["Rate", true], ["Trend"], ["Latency", true], ["Lost", true], ["Size", true], ["Data rate", true]]} />
        <tbody>{channels.map((one) => (
          <tr key={one.name} data-testid={`channel-${one.name}`}>
            <th scope="row" class="mono">{one.name}</th>
            <td class="number">{fixed(one.rate_hz, 1, "Hz")}</td>
            <td><Sparkline values={rates.get(one.name) ?? []} label={`rate of ${one.name}`} /></td>
            <td class="number">{fixed(one.latency_ms, 1, "ms")}</td>
            <td class={`number ${one.lost > 0 ? "bad" : ""}`}>{grouped(one.lost)}</td>
            <td class="number">{bytes(one.size_bytes)}</td>
            <td class="number">{bytes(one.bytes_per_s)}</td>
          </tr>
        ))}</tbody>
      </table></div>
    </Card>
  );
}

type Process = BusFrame["processes"][number];
function light({ ready, age_s }: Process): [grade: string, word: string] {
  if (age_s > kLateS) return ["bad", `no status for ${fixed(age_s, 0, "s")}`];
  return ready ? ["good", "ready"] : ["doubtful", "not ready"];
}

function ProcessRow({ process }: { process: Process }) {
  const [grade, word] = light(process);
  return (
    <li data-testid={`process-${process.process}`}>
      <div class="row">
        <strong class="mono">{process.process}</strong>
        <span class={`badge ${grade}`}>{word}</span>
        <span>{process.text}</span>
      </div>
      {process.last_problem && <p class="caution">Last problem: {process.last_problem}</p>}
      {process.counters.length > 0 && (
        <details>
          <summary>Counters ({process.counters.length})</summary>
          <dl>{process.counters.map(({ name, value }) => (
            <div key={name}><dt class="mono">{name}</dt><dd class="number">{grouped(value)}</dd></div>
          ))}</dl>
        </details>
      )}
    </li>
  );
}

function Browsers({ browsers, screen_ms }: Pick<BusFrame, "browsers" | "screen_ms">) {
  return (
    <Card title="Browsers">
      {screen_ms && (
        <p data-testid="screen-ms">Delay from bus to screen: <strong>{fixed(screen_ms.p50, 0, "ms")}</strong> (median),{" "}
          <strong>{fixed(screen_ms.p95, 0, "ms")}</strong> (95 %), last {screen_ms.count} frames.</p>
      )}
      <div class="scroll-x"><table data-testid="bus-browsers">
        <Heads names={[["Address"], ["Queued", true], ["Reduced", true], ["Points", true]]} />
        <tbody>{browsers.map((one) => (
          <tr key={one.address}>
            <th scope="row" class="mono">{one.address}</th>
            <td class="number">{grouped(one.waiting)}</td>
            <td class="number">{grouped(one.thinned)}</td>
            <td class="number">{fixed(100 * one.share, 0, "%")}</td>
          </tr>
        ))}</tbody>
      </table></div>
    </Card>
  );
}

export function BusPanel() {
  const now = bus.value;
  if (!now) return <p class="empty">No bus data yet.</p>;
  return (
    <div class="panel bus">
      <Channels channels={now.channels} />
      <Card title="Processes">
        <ul class="bus-processes">{now.processes.map((one) => <ProcessRow key={one.process} process={one} />)}</ul>
        {now.processes.length === 0 && <p class="muted">No process has reported its status.</p>}
      </Card>
      <Browsers browsers={now.browsers} screen_ms={now.screen_ms} />
    </div>
  );
}
