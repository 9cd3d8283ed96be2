// The page is read in sunlight: words have a contrast of 7:1 or more on each ground (WCAG 2, 1.4.6).
import { readFileSync } from "node:fs";
import { describe, expect, test } from "vitest";

const css = readFileSync(new URL("../src/style.css", import.meta.url), "utf8");

function variables(theme: string): Map<string, string> {
  const block = css.split(`:root[data-theme="${theme}"] {`)[1].split("}")[0];
  return new Map([...block.matchAll(/--([\w-]+): (#[0-9a-f]{6})/g)].map((match) => [match[1], match[2]]));
}

function luminance(color: string): number {
  const [r, g, b] = [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16) / 255)
    .map((value) => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

function contrast(a: string, b: string): number {
  const [dark, light] = [luminance(a), luminance(b)].sort((x, y) => x - y);
  return (light + 0.05) / (dark + 0.05);
}

describe.each(["dark", "light"])("%s", (theme) => {
  const colors = variables(theme);
  const grounds = ["bg", "surface", "raised"];
  const words = ["text", "muted", "accent", "good", "caution", "bad"];
  test.each(grounds.flatMap((ground) => words.map((word) => [word, ground])))("%s on %s", (word, ground) => {
    expect(contrast(colors.get(word)!, colors.get(ground)!)).toBeGreaterThanOrEqual(7);
  });
  test("on a pressed button", () => {
    expect(contrast(colors.get("on-accent")!, colors.get("accent")!)).toBeGreaterThanOrEqual(7);
  });
});
