// A calibration that came and is not shown, as it is another rig's or not to be used: said where the
// result would stand.
import type { BusFrame, SessionFrame } from "../../protocol";
import { bus } from "../../store";
import { VerdictCard } from "./verdict";

const kChannel = "CALIBRATION: "; // a process's last problem begins with the channel it came on

/// Each in a sentence; none once every camera has a calibration, as problems are told for ever.
export function refusalsOf(processes: BusFrame["processes"], cameras: SessionFrame["cameras"]): string[] {
  if (cameras.every(({ calibrated }) => calibrated)) return [];
  const refused = processes.filter(({ last_problem }) => last_problem.startsWith(kChannel));
  return [...new Set(refused.map(({ process, last_problem }) => `${process}: ${last_problem.slice(kChannel.length)}`))];
}

export function RefusedNote({ session }: { session: SessionFrame }) {
  const refusals = refusalsOf(bus.value?.processes ?? [], session.cameras);
  if (refusals.length === 0) return null;
  return <VerdictCard verdict={{ grade: "bad", headline: "A calibration on the bus was refused", reasons: refusals }} testid="refused-calibration" />;
}
