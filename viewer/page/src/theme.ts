// Dark or light: as the system has it, unless a person chose; the choice is kept where the browser
// lets us (a page from a file, or a private window, may not).
import { effect, signal } from "@preact/signals";

export type Theme = "dark" | "light";
const kKey = "rgbdt-theme";

function kept(): Theme | null {
  try {
    const value = localStorage.getItem(kKey);
    return value === "dark" || value === "light" ? value : null;
  } catch {
    return null;
  }
}

const prefersLight = matchMedia("(prefers-color-scheme: light)");
const systems = (): Theme => (prefersLight.matches ? "light" : "dark");

export const theme = signal<Theme>(kept() ?? systems());

export function switchTheme(): void {
  theme.value = theme.value === "dark" ? "light" : "dark";
  try {
    localStorage.setItem(kKey, theme.value);
  } catch {
    // Then it holds until the page is closed.
  }
}

prefersLight.addEventListener("change", () => { if (!kept()) theme.value = systems(); });
effect(() => { document.documentElement.dataset.theme = theme.value; });
