import type { SessionFrame, View, ViewCamera } from "../../protocol";
import { chooseView, hasLive, shownView } from "../../chosen_view";
import { connection, images, keyOf, overlays, thumbs } from "../../store";
import { wide } from "../../wide";
import { ViewPicture } from "../image/view_picture";
import { choose } from "../pick/choice";
import { goTo, tabs } from "../../route";
import { linkTo, open } from "../route";
import { degrees, metres } from "../words";
import { LeaveOutButton, WhyNotLeaveOut } from "./left_out";
import { barLength, ResidualBar } from "./residual_bar";

const kStateWords = {
  accepted: { icon: "✓", words: "accepted", grade: "good" },
  rejected: { icon: "✗", words: "rejected", grade: "bad" },
  waiting: { icon: "…", words: "waiting", grade: "muted" },
} as const;

/// The image with the cloud on it or, while that is not here, a small image.
function Picture({ view, camera }: { view: string; camera: string }) {
  const key = keyOf(view, camera);
  const image = images.value.get(key);
  if (!image) return <Thumb view={view} camera={camera} />;
  return (
    <figure class="thumb">
      <ViewPicture image={image} overlay={overlays.value.get(key)} label={`View ${view}: ${camera}, with the cloud on it`}
        testid={`view-picture-${view}-${camera}`} />
      <figcaption class="muted">{camera}</figcaption>
    </figure>
  );
}

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

function CameraLine({ view, own, length, wanted }: { view: string; own: ViewCamera; length: number; wanted: boolean }) {
  const { icon, words, grade } = kStateWords[own.state];
  return (
    <li data-testid={`view-state-${view}-${own.camera}`} data-state={own.state}>
      <span class={grade}><strong><span aria-hidden="true">{icon}</span> {own.camera}</strong> {words}</span>
      {own.picked && ", corners picked by hand"}
      {own.why && <span>: {own.why}</span>}
      <ResidualBar own={own} length={length} testid={`residual-${view}-${own.camera}`} />
      {wanted && tabs.value.some(({ id }) => id === "pick") && <PickButton view={view} camera={own.camera} />}
    </li>
  );
}

/// Beside the session where there is room for it, else in its own tab.
function showCloud(view: string): void {
  chooseView(view);
  if (!wide.peek()) goTo("cloud");
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

const roleOf = (view: View): string => (view.left_out ? "left out" : view.heldout ? "held out" : "used");

interface CardProps { session: SessionFrame; view: View; lengths: Map<string, number>; wanted: Set<string> }

function ViewCard({ session, view, lengths, wanted }: CardProps) {
  const show = { view: view.name };
  const shown = shownView.value === view.name;
  return (
    <article class={`card view ${view.left_out ? "out" : ""}`} aria-label={`View ${view.name}`} data-testid={`card-${view.name}`}>
      <header class="row">
        <h3>{view.name}</h3>
        <span class="badge muted" data-testid={`role-${view.name}`}>{roleOf(view)}</span>
        {connection.value !== "embedded" && <LeaveOutButton session={session} view={view} />}
      </header>
      <div class="thumbs">
        {view.cameras.map(({ camera }) => <Picture key={camera} view={view.name} camera={camera} />)}
        <Thumb view={view.name} camera="" />
      </div>
      {view.waits && <p class="caution">Waiting for: {view.waits}</p>}
      <ul class="plain">
        {view.cameras.map((own) => (
          <CameraLine key={own.camera} view={view.name} own={own} length={lengths.get(own.camera) ?? 1} wanted={wanted.has(keyOf(view.name, own.camera))} />
        ))}
      </ul>
      <footer class="row">
        <BoardLine view={view} />
        {!hasLive.value && (
          <button type="button" aria-pressed={shown} data-testid={`show-cloud-${view.name}`} onClick={() => showCloud(view.name)}>Show cloud</button>
        )}
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
  const lengths = new Map(session.cameras.map(({ camera }) => [camera, barLength(session.views, camera)]));
  return (
    <>
      <p class="muted">Bar: RMS distance of the board edge in the cloud from the outline in the image. Mark: 1 sigma, what is expected.</p>
      <WhyNotLeaveOut session={session} />
      <div class="views">
        {[...session.views].reverse().map((view) => (
          <ViewCard key={view.name} session={session} view={view} lengths={lengths} wanted={wanted} />
        ))}
      </div>
    </>
  );
}
