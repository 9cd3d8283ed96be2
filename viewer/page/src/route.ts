// Which tab is shown: "#/cameras" in the address. Other hashes (the token's) are left alone.
import { computed, signal } from "@preact/signals";
import { connection, hello } from "./store";

const kTabs = [
  { id: "cloud", name: "Cloud" },
  { id: "cameras", name: "Cameras" },
  { id: "session", name: "Session" },
  { id: "pick", name: "Pick corners" },
  { id: "bus", name: "Bus" },
] as const;
export type Tab = (typeof kTabs)[number]["id"];

/// A session that is finished: a report, or a directory.
const over = computed(() => connection.value === "embedded" || hello.value?.source === "session");

/// A finished session has no bus, and corners picked in it would change nothing.
export const tabs = computed(() => kTabs.filter(({ id }) => !over.value || (id !== "pick" && id !== "bus")));

const wanted = signal<Tab | null>(null); // null: nobody has asked for one yet
/// Of a finished session the result comes first; live, what the sensors see.
export const tab = computed<Tab>(() => tabs.value.find(({ id }) => id === wanted.value)?.id ?? (over.value ? "session" : "cloud"));

function readAddress(): void {
  const named = kTabs.find(({ id }) => location.hash.split("?")[0] === `#/${id}`);
  if (named) wanted.value = named.id;
}

export function goTo(next: Tab): void {
  if (location.hash !== `#/${next}`) history.pushState(null, "", `#/${next}`);
  wanted.value = next;
}

export function startRoute(): void {
  readAddress();
  addEventListener("hashchange", readAddress);
  addEventListener("popstate", readAddress);
}
