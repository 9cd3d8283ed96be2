// Chromium with the page, for the tests: what it complains about, screenshots, waiting for events.
import { execFileSync } from "node:child_process";
import { createRequire } from "node:module";
import { mkdtempSync } from "node:fs";
import { join } from "node:path";

const { RGBDT_CHROMIUM, RGBDT_HELPER, RGBDT_PACKAGES, RGBDT_SCRATCH, RGBDT_SCREENSHOTS, RGBDT_TEST } = process.env;
const { chromium } = createRequire(RGBDT_PACKAGES)("playwright-core");

export const kDesk = { width: 1280, height: 800 }, kPhone = { width: 390, height: 844 };
export const kPatienceMs = 60_000;

const kArgs = [
  "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-background-networking",
  "--disable-component-update", "--disable-sync", "--disable-quic", "--no-first-run",
];

const opened = [];

/// A browser of its own with one page; what goes wrong in the page is collected in `problems`.
export async function openBrowser(viewport = kDesk) {
  const profile = mkdtempSync(join(RGBDT_SCRATCH, "profile-"));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: RGBDT_CHROMIUM, headless: true, viewport, args: kArgs, colorScheme: "dark",
  });
  context.setDefaultTimeout(kPatienceMs);
  const page = context.pages()[0] ?? await context.newPage();
  const problems = [], requests = [];
  // A broken rule of the content security policy is an error on the console, too.
  page.on("console", (message) => { if (message.type() === "error") problems.push(`console: ${message.text()}`); });
  page.on("pageerror", (error) => problems.push(`exception: ${error}`));
  page.on("request", (request) => requests.push(request.url()));
  page.on("requestfailed", (request) => problems.push(`request failed: ${request.url()} ${request.failure()?.errorText}`));
  page.on("response", (response) => { if (response.status() >= 400) problems.push(`${response.status()}: ${response.url()}`); });
  const browser = { context, page, problems, requests };
  opened.push(browser);
  return browser;
}

export async function shot(page, what) {
  await page.screenshot({ path: join(RGBDT_SCREENSHOTS, `${RGBDT_TEST}-${what}.png`) });
}

export function require(condition, what) {
  if (!condition) throw new Error(what);
}

/// Asks again and again until the answer is good; the last answer is in the failure.
export async function until(what, ask, good = Boolean, patience_ms = kPatienceMs) {
  const end = Date.now() + patience_ms;
  for (;;) {
    const answer = await ask();
    if (good(answer)) return answer;
    if (Date.now() > end) throw new Error(`waited ${patience_ms / 1000} s for ${what}; last: ${JSON.stringify(answer)?.slice(0, 300)}`);
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
}

export const byId = (page, id) => page.getByTestId(id);

export async function openTab(page, tab) {
  await byId(page, `tab-${tab}`).click();
  await byId(page, `panel-${tab}`).waitFor();
}

/// What the bus lost, by the Bus panel: "CLOUD 0", ...
export async function lossesOf(page) {
  await openTab(page, "bus");
  const rows = byId(page, "bus-channels").locator("tbody tr");
  await until("the channels", () => rows.count(), (count) => count >= 8);
  const names = await rows.locator("th").allInnerTexts();
  const lost = await rows.locator("td:nth-child(5)").allInnerTexts();
  return names.map((name, i) => `${name} ${lost[i]}`);
}

/// "−1.234 m" as a number.
export function numberOf(text) {
  const found = /[-−]?\d[\d\u202f ]*\.?\d*/.exec(text);
  require(found, `no number in "${text}"`);
  return Number(found[0].replace("−", "-").replace(/[\u202f ]/g, ""));
}

export function helper(arguments_, input = "") {
  return JSON.parse(execFileSync(RGBDT_HELPER, arguments_, { input, encoding: "utf8" }));
}

/// Runs a test; on failure every page is photographed. Complaints of a page are failures.
export async function run(test) {
  let failure = null;
  try {
    await test();
  } catch (error) {
    failure = error;
  }
  const problems = opened.flatMap((browser) => browser.problems);
  if (!failure && problems.length > 0) failure = new Error("the page complained");
  if (failure) {
    console.error(failure.stack, ...problems.map((problem) => `\n  ${problem}`));
    for (const [i, { page }] of opened.entries()) await shot(page, `failed-${i}`).catch(() => undefined);
  }
  for (const { context } of opened) await context.close().catch(() => undefined);
  process.exit(failure ? 1 : 0);
}
