// Leaving views out of the result and taking them back.
import type { Hello, LeftOut, SessionFrame } from "../../protocol";
import type { Connection } from "../../store";
import { degrees, millimetres, sigmas } from "../words";
import { whyNotCommand } from "./permission";

/// Why no view can be left out here, and what to do; "": it can.
export function whyNotLeaveOut(session: SessionFrame, connection: Connection, hello: Hello | null): string {
  if (connection === "embedded") {
    return `To leave views out and see the result change, run: rgbdt-viewer --session ${hello?.title || "DIR"}`;
  }
  return whyNotCommand(connection, hello) || session.left_out.why_not;
}

/// The views that are to be left out once `view` has changed sides.
export function toggled({ views }: LeftOut, view: string): string[] {
  return views.includes(view) ? views.filter((each) => each !== view) : [...views, view].sort();
}

/// Of a result without some views: whether it stands on disk, and the command that puts it there.
export function howToKeep({ left_out }: SessionFrame, connection: Connection, hello: Hello | null): string {
  if (connection === "embedded") return "This report and its calibration.textproto were made without.";
  if (hello?.source !== "session") return "Nothing is saved.";
  const options = left_out.views.map((view) => `--without ${view}`).join(" ");
  return `Nothing is saved yet. To keep it, run: rgbdt calibrate ${hello.title} ${options}`;
}

/// "rgb: 0.012°, 1.3 mm (0.80 sigmas)"
export function movedWords({ camera, rotation_deg, centre_mm, sigmas: many }: LeftOut["moved"][number]): string {
  const rated = many === null ? "" : ` (${sigmas(many)})`;
  return `${camera}: ${degrees(rotation_deg)}, ${millimetres(centre_mm, 1)}${rated}`;
}
