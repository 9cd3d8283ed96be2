// Whether a person may ask for something now, and if not, why.
import type { Hello, RequestName, SessionFrame } from "../../protocol";
import type { Connection } from "../../store";

const kModeWords: Record<SessionFrame["mode"], string> = {
  none: "No session is running: start rgbdt-session.",
  script: "A script runs this session; it asks when input is needed.",
  by_hand: "Not available now.",
  finished: "This session is finished.",
};

/// Why this browser may not command the rig; "": it may.
export function whyNotCommand(connection: Connection, hello: Hello | null): string {
  if (connection === "embedded") return "This is a report: there is nothing to control.";
  if (connection !== "open" || !hello) return "Not connected to the bridge.";
  return hello.may_command ? "" : hello.why_not || "This browser is not allowed to control the rig.";
}

/// "": it may be asked for.
export function whyNot(
  request: RequestName, session: SessionFrame, connection: Connection, hello: Hello | null,
): string {
  const command = whyNotCommand(connection, hello);
  if (command !== "" || session.can.includes(request)) return command;
  return session.busy ? `Busy: ${session.busy}.` : kModeWords[session.mode];
}

/// Every third view is held out, as long as nobody says otherwise.
export function heldoutByDefault(views: number): boolean {
  return (views + 1) % 3 === 0;
}
