// Words over the canvas, at places of the cloud.
import type { Label } from "./surroundings";

interface Screen { x: number; y: number; inFront: boolean } // [px of the window]

export class Labels {
  private spans: HTMLSpanElement[] = [];
  constructor(private readonly layer: HTMLElement) {}

  place(labels: Label[], project: (at: Label["at"]) => Screen): void {
    while (this.spans.length < labels.length) this.spans.push(this.layer.appendChild(document.createElement("span")));
    const box = this.layer.getBoundingClientRect();
    for (const [i, span] of this.spans.entries()) {
      const label = labels[i];
      const at = label && project(label.at);
      span.hidden = !at?.inFront;
      if (!label || !at?.inFront) continue;
      if (span.textContent !== label.text) span.textContent = label.text;
      span.className = `cloud-label ${label.kind}`;
      span.style.color = label.color ?? "";
      span.style.transform = `translate(${Math.round(at.x - box.left)}px, ${Math.round(at.y - box.top)}px)`;
    }
  }
}
