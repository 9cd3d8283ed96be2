import type { SessionFrame, View, ViewCamera } from "../../protocol";
import { keyOf, thumbs } from "../../store";
import { choose } from "../pick/choice";
import { tabs } from "../../route";
import { linkTo, open } from "../route";
import { degrees, metres, px, sigmas } from "../words";

const kStateWords = {
  accepted: { icon: "✓", words: "accepted", grade: "good" },
  rejected: { icon: "✗", words: "rejected", grade: "bad" },
  waiting: { icon: "…", words: "waiting", grade: "muted" },
} as const;

function Thumb({ view, camera }: { view: string; camera: string }) {
  const url = thumbs.value.get(keyOf(view, camera));
  const name = camera || "board";
  return (
    <figure class="thumb">
      {url ? <img src={url} alt={`View ${view}: ${camera || "the board in the cloud"}`} /> : <span class="thumb-none">no image</span>}
      <figcaption class="muted">{name}</figcaption>
    </figure>
  );
}

function PickButton({ view, camera }: { view: string; camera: string }) {
  const params = { view, camera };
  return (
    <a class="button" href={linkTo("pick", params)} data-testid={`pick-open-${view}-${camera}`}
      onClick={(event) => { event.preventDefault(); choose(params); }}>
      Pick corners
    </a>
  );
}

function CameraLine({ view, own, wanted }: { view: string; own: ViewCamera; wanted: boolean }) {
  const { icon, words, grade } = kStateWords[own.state];
  const rms = own.edge_rms_px === null ? "" : `outline error ${px(own.edge_rms_px)}`;
  const whitened = own.edge_rms_sigmas === null ? "" : sigmas(own.edge_rms_sigmas);
  return (
    <li data-testid={`view-state-${view}-${own.camera}`} data-state={own.state}>
      <span class={grade}><strong><span aria-hidden="true">{icon}</span> {own.camera}</strong> {words}</span>
      {own.picked && ", corners picked by hand"}
      {own.why && <span>: {own.why}</span>}
      {(rms || whitened) && <span class="muted">, {[rms, whitened].filter(Boolean).join(", ")}</span>}
      {wanted && tabs.value.some(({ id }) => id === "pick") && <PickButton view={view} camera={own.camera} />}
    </li>
  );
}

function tiltOf(board: NonNullable<View["board"]>): number {
  const length = Math.hypot(...board.centre_m) * Math.hypot(...board.normal);
  const along = board.centre_m.reduce((sum, value, i) => sum + value * board.normal[i]!, 0);
  return (Math.acos(Math.min(1, Math.abs(along) / length)) * 180) / Math.PI;
}

function BoardLine({ view }: { view: View }) {
  if (!view.board) return <p class="muted">No board detected in the cloud.</p>;
  return <p class="muted">{metres(view.board.distance_m)} away, tilted {degrees(tiltOf(view.board), 0)}</p>;
}

function ViewCard({ view, wanted }: { view: View; wanted: Set<string> }) {
  const show = { view: view.name };
  return (
    <article class="card view" aria-label={`View ${view.name}`} data-testid={`card-${view.name}`}>
      <header class="row">
        <h3>{view.name}</h3>
        <span class="badge muted">{view.heldout ? "held out" : "used"}</span>
      </header>
      <div class="thumbs">
        {view.cameras.map(({ camera }) => <Thumb key={camera} view={view.name} camera={camera} />)}
        <Thumb view={view.name} camera="" />
      </div>
      {view.waits && <p class="caution">Waiting for: {view.waits}</p>}
      <ul class="plain">
        {view.cameras.map((own) => (
          <CameraLine key={own.camera} view={view.name} own={own} wanted={wanted.has(keyOf(view.name, own.camera))} />
        ))}
      </ul>
      <footer class="row">
        <BoardLine view={view} />
        <a class="view-show" href={linkTo("cameras", show)}
          onClick={(event) => { event.preventDefault(); open("cameras", show); }}>Enlarge</a>
      </footer>
    </article>
  );
}

export function ViewCards({ session }: { session: SessionFrame }) {
  const wanted = new Set(session.pick_wanted.map(({ view, camera }) => keyOf(view, camera)));
  if (session.views.length === 0) return <p class="muted">No view yet.</p>;
  // The newest first: it is what a person just made.
  return <div class="views">{[...session.views].reverse().map((view) => <ViewCard key={view.name} view={view} wanted={wanted} />)}</div>;
}
