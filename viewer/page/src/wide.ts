// Whether two panels fit beside each other.
import { signal } from "@preact/signals";

const query = matchMedia("(min-width: 1200px)");
export const wide = signal(query.matches);
query.addEventListener("change", () => { wide.value = query.matches; });
