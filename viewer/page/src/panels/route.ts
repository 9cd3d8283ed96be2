// What stands behind the "?" of the shell's hash route: "#/pick?view=0003&camera=thermal".
import { signal } from "@preact/signals";
import { goTo } from "../route";

type Tab = "cameras" | "session" | "pick";

const changes = signal(0); // of the address, so that who reads it is drawn anew
for (const name of ["hashchange", "popstate"]) addEventListener(name, () => { ++changes.value; });

export function linkTo(tab: Tab, params: Record<string, string>): string {
  return `#/${tab}?${new URLSearchParams(params)}`;
}

export function open(tab: Tab, params: Record<string, string>): void {
  goTo(tab);
  history.replaceState(null, "", linkTo(tab, params));
  ++changes.value;
}

/// Those of this tab's route; empty while the address names another tab.
export function paramsOf(tab: Tab): URLSearchParams {
  void changes.value;
  const [path, query] = location.hash.split("?");
  return new URLSearchParams(path === `#/${tab}` ? query ?? "" : "");
}
