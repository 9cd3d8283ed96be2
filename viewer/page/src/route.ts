// Which tab is shown: "#/cameras" in the address. Other hashes (the token's) are left alone.
import { signal } from "@preact/signals";

export const kTabs = [
  { id: "cloud", name: "Cloud" },
  { id: "cameras", name: "Cameras" },
  { id: "session", name: "Session" },
  { id: "pick", name: "Pick corners" },
  { id: "bus", name: "Bus" },
] as const;
export type Tab = (typeof kTabs)[number]["id"];

export const tab = signal<Tab>("cloud");

function readAddress(): void {
  const named = kTabs.find(({ id }) => location.hash.split("?")[0] === `#/${id}`);
  if (named) tab.value = named.id;
}

export function goTo(next: Tab): void {
  if (location.hash !== `#/${next}`) history.pushState(null, "", `#/${next}`);
  tab.value = next;
}

export function startRoute(): void {
  readAddress();
  addEventListener("hashchange", readAddress);
  addEventListener("popstate", readAddress);
}
