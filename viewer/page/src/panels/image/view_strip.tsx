import type { View } from "../../protocol";
import { keyOf, thumbs } from "../../store";

interface Props {
  views: View[];
  chosen: string; // "": live
  hasLive: boolean;
  camera: string; // whose thumbs are shown
  choose(view: string): void;
}

/// "Live" and the session's views as a strip of thumbs.
export function ViewStrip({ views, chosen, hasLive, camera, choose }: Props) {
  if (views.length === 0) return null;
  return (
    <div class="strip" role="group" aria-label="Live or a view of the session">
      {hasLive && (
        <button type="button" class="strip-item" aria-pressed={chosen === ""} data-testid="view-live" onClick={() => choose("")}>
          <span class="strip-live" aria-hidden="true">●</span>Live
        </button>
      )}
      {views.map(({ name, heldout }) => {
        const url = thumbs.value.get(keyOf(name, camera));
        return (
          <button type="button" key={name} class="strip-item" aria-pressed={chosen === name}
            data-testid={`view-${name}`} onClick={() => choose(name)}>
            {url ? <img src={url} alt="" /> : <span class="strip-none" aria-hidden="true">no image</span>}
            {name}{heldout ? " (held out)" : ""}
          </button>
        );
      })}
    </div>
  );
}
