// The page while a board is waved: what to do, how the sigma falls, what came of it.
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { byId, kPhone, numberOf, openBrowser, openTab, require, run, shot, until } from "./browser.mjs";

const out = process.argv[2];
run(async () => {
  const { page } = await openBrowser(kPhone);
  await page.goto(process.env.RGBDT_URL);
  await openTab(page, "session");
  const phaseIs = (phase) => page.locator(`[data-testid=wave][data-phase=${phase}]`).waitFor();
  /// "time offset −12.34 ± 0.18 ms (1 sigma)"
  const clock = async () => {
    const text = await byId(page, "wave-rgb").innerText();
    const found = /offset ([-−]?[\d.]+) ± ([\d.]+)/.exec(text);
    return found ? { offset: Number(found[1].replace("−", "-")), sigma: Number(found[2]) } : null;
  };

  writeFileSync(join(process.env.RGBDT_SCRATCH, "page_open"), "");
  await phaseIs("waiting");
  require((await byId(page, "wave-text").innerText()).includes("aiting for a sweep"), "it does not say what it waits for");
  writeFileSync(join(process.env.RGBDT_SCRATCH, "page_waits"), "");
  await phaseIs("recording");
  const left = numberOf(await byId(page, "wave-left").innerText());
  require(left > 0 && left <= 22, `${left} s left of 22`);
  await byId(page, "wave-rgb").waitFor();
  const first = await until("an offset", clock);
  await shot(page, "first");
  await byId(page, "chart-wave").waitFor();
  await until("a smaller sigma", clock, (now) => now && now.sigma < first.sigma);
  await shot(page, "waving");

  await phaseIs("done");
  const text = await byId(page, "wave-text").innerText();
  require(text.includes("calibration.textproto") && text.includes(out), `it does not say what was written: ${text}`);
  const written = /time_offset_s *\{ *value: *(\S+) *sigma: *([^\s}]+)/.exec(
    readFileSync(join(out, "calibration.textproto"), "utf8").replaceAll("\n", " "));
  require(written, "no offset in the calibration");
  const [offset, sigma] = [1e3 * Number(written[1]), 1e3 * Number(written[2])];
  const shown = await clock();
  require(Math.abs(shown.offset - offset) < 0.006 && Math.abs(shown.sigma - sigma) < 0.006,
    `the page says ${shown.offset} ± ${shown.sigma} ms, the calibration ${offset} ± ${sigma}`);
  require(await byId(page, "wave-left").count() === 0, "it still counts down");
  await shot(page, "done");
});
