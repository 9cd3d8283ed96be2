import { useEffect } from "preact/hooks";
import type { NoticeFrame } from "./protocol";
import { notices } from "./store";

type Notice = NoticeFrame & { at: number };
const kShownMs = { info: 6000, error: 20000 };

function drop(notice: Notice): void {
  notices.value = notices.value.filter((other) => other !== notice);
}

function Toast({ notice }: { notice: Notice }) {
  useEffect(() => {
    const timer = setTimeout(() => drop(notice), kShownMs[notice.level]);
    return () => clearTimeout(timer);
  }, [notice]);
  return (
    <div class={`toast ${notice.level}`} data-testid="toast">
      <span>{notice.text}</span>
      <button aria-label="Dismiss" onClick={() => drop(notice)}>✕</button>
    </div>
  );
}

export function Toasts() {
  return (
    <div class="toasts" role="status" aria-live="polite">
      {notices.value.map((notice) => <Toast key={`${notice.at} ${notice.text}`} notice={notice} />)}
    </div>
  );
}
