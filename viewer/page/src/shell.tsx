// The frame round the panels: title, connection, verdict, tabs, notices.
import type { ComponentChildren } from "preact";
import { useEffect } from "preact/hooks";
import { BusPanel } from "./panels/bus";
import { CamerasPanel } from "./panels/cameras";
import { CloudPanel } from "./panels/cloud";
import { PickPanel } from "./panels/pick";
import { SessionPanel } from "./panels/session";
import { goTo, tab, tabs, type Tab } from "./route";
import { MountLamps } from "./panels/session/mounts";
import { connection, hello, mounts, session, type Connection } from "./store";
import { switchTheme, theme } from "./theme";
import { Toasts } from "./toasts";
import { wide } from "./wide";
import "./style.css";
import "./shell.css";

const kConnectionWords: Record<Connection, { text: string; grade: string }> = {
  connecting: { text: "connecting", grade: "doubtful" },
  open: { text: "live", grade: "good" },
  lost: { text: "disconnected", grade: "bad" },
  embedded: { text: "report", grade: "muted" },
};
const kGradeWords = { good: "good", usable: "usable", doubtful: "doubtful", bad: "do not use", none: "not assessed" } as const;

/// A bridge to a finished session is no live one.
function connectionWords(): { text: string; grade: string } {
  if (connection.value === "open" && hello.value?.source === "session") return { text: "finished session", grade: "muted" };
  return kConnectionWords[connection.value];
}

/// A session by its directory's name, a bus by its address: so that it is whole on a phone, too.
function shortTitle(): string {
  const { source, title } = hello.value ?? { source: "", title: "" };
  if (source === "live") return title.replace(/^udpm:\/\//, "").replace(/\?\S*/, "");
  return source === "session" ? title.replace(/\/+$/, "").split("/").pop() || title : title;
}

function Head() {
  const { text, grade } = connectionWords();
  const verdict = session.value?.verdict;
  const other = theme.value === "dark" ? "light" : "dark";
  return (
    <header class="shell-head">
      <h1>rgbdt</h1>
      <span class="shell-title" data-testid="title" title={hello.value?.title}>{shortTitle()}</span>
      {verdict && (
        <span class={`badge ${verdict.grade === "none" ? "muted" : verdict.grade}`} data-testid="verdict-badge" title={verdict.headline}>
          {kGradeWords[verdict.grade]}
        </span>
      )}
      {mounts.value && <MountLamps frame={mounts.value} />}
      <span class={`badge ${grade}`} data-testid="connection">{text}</span>
      <button aria-label={`Use ${other} colours`} title={`Use ${other} colours`} data-testid="theme" onClick={switchTheme}>
        {theme.value === "dark" ? "☀" : "☾"}
      </button>
    </header>
  );
}

/// Left and right go round the tabs, Home and End to the first and last (WAI-ARIA's tabs).
function tabFor(key: string, from: number): number | null {
  const last = tabs.value.length - 1;
  if (key === "ArrowRight") return from === last ? 0 : from + 1;
  if (key === "ArrowLeft") return from === 0 ? last : from - 1;
  if (key === "Home") return 0;
  return key === "End" ? last : null;
}

function Tabs() {
  const onKey = (event: KeyboardEvent, index: number) => {
    const next = tabs.value[tabFor(event.key, index) ?? -1];
    if (!next) return;
    event.preventDefault();
    goTo(next.id);
    document.getElementById(`tab-${next.id}`)?.focus();
  };
  return (
    <div class="shell-tabs" role="tablist" aria-label="Panels">
      {tabs.value.map(({ id, name }, index) => (
        <button key={id} id={`tab-${id}`} role="tab" data-testid={`tab-${id}`} aria-selected={tab.value === id}
          aria-controls={`panel-${id}`} tabIndex={tab.value === id ? 0 : -1} title={`${name} (${index + 1})`}
          onClick={() => goTo(id)} onKeyDown={(event) => onKey(event, index)}>
          {name}
        </button>
      ))}
    </div>
  );
}

function Panel({ id, shown, children }: { id: Tab; shown: boolean; children: ComponentChildren }) {
  return (
    <section id={`panel-${id}`} class="shell-panel" role="tabpanel" aria-labelledby={`tab-${id}`} hidden={!shown}
      data-testid={`panel-${id}`}>
      {children}
    </section>
  );
}

const kPanels: Record<Exclude<Tab, "cloud">, () => ComponentChildren> = {
  cameras: () => <CamerasPanel />,
  session: () => <SessionPanel />,
  pick: () => <PickPanel />,
  bus: () => <BusPanel />,
};

/// 1 to 5, except where a person is typing.
function onDigit(event: KeyboardEvent): void {
  const target = event.target as HTMLElement;
  if (event.ctrlKey || event.metaKey || event.altKey || target.closest("input, select, textarea")) return;
  const chosen = /^[1-5]$/.test(event.key) ? tabs.value[Number(event.key) - 1] : undefined;
  if (chosen) goTo(chosen.id);
}

export function Shell() {
  useEffect(() => {
    addEventListener("keydown", onDigit);
    return () => removeEventListener("keydown", onDigit);
  }, []);
  const now = tab.value;
  return (
    <div class="shell">
      <Head />
      <Tabs />
      {connection.value === "lost" && (
        <div class="shell-gone" role="alert" data-testid="gone">Connection lost; reconnecting</div>
      )}
      <main class={`shell-main ${now === "cloud" ? "" : "beside"}`}>
        <CloudPlace alone={now === "cloud"} />
        {now !== "cloud" && <Panel key={now} id={now} shown>{kPanels[now]()}</Panel>}
      </main>
      <Toasts />
    </div>
  );
}

/// The cloud keeps its WebGL context while another tab is shown, and on a wide screen its place.
function CloudPlace({ alone }: { alone: boolean }) {
  return (
    <Panel id="cloud" shown={alone || wide.value}>
      <CloudPanel visible={alone || wide.value} />
    </Panel>
  );
}
