// The browser's part of `scripts/study viewer`, called by viewer.sh:
//   node viewer.mjs screen NAME SECONDS CSV        from bus to screen, as the Bus panel says it
//   node viewer.mjs orbit STREAM_PID SECONDS CSV   frames a second while the eye goes round
//   node viewer.mjs stall                          a page that hangs until SIGTERM
import { writeFileSync } from "node:fs";
import { byId, numberOf, openBrowser, openTab, require, run, until } from "../browser/browser.mjs";

const [verb, ...rest] = process.argv.slice(2);
const kPoints = 100_000;
const kFilled = 200; // frames that the bridge's figures are over

const pointsOf = (page) => page.evaluate(() => window.rgbdt.cloud.points());
const seconds = (count) => new Promise((resolve) => setTimeout(resolve, 1000 * count));

async function openPage() {
  const browser = await openBrowser();
  await browser.page.goto(process.env.RGBDT_URL);
  return browser;
}

async function screenNow(page) {
  const text = await byId(page, "screen-ms").innerText();
  const [p50, p95] = (await byId(page, "screen-ms").locator("strong").allInnerTexts()).map(numberOf);
  return { p50, p95, count: numberOf(/newest (\d+)/.exec(text)[1]) };
}

// The page as it is used: cloud beside a panel.
async function measureScreen(name, duration, csv) {
  const { page } = await openPage();
  await until("the cloud", () => pointsOf(page), (points) => points > 1000);
  await openTab(page, "bus");
  await byId(page, "screen-ms").waitFor();
  await until("as many frames as are counted", () => screenNow(page), ({ count }) => count >= kFilled);
  const lines = ["traffic,second,p50_ms,p95_ms,points"];
  for (let second = 1; second <= duration; ++second) {
    await seconds(1);
    const { p50, p95 } = await screenNow(page);
    lines.push([name, second, p50, p95, await pointsOf(page)].join(","));
  }
  writeFileSync(csv, `${lines.join("\n")}\n`);
}

// Nothing comes meanwhile: what is drawn is drawn for the eye alone.
async function measureOrbit(stream, duration, csv) {
  const { page } = await openPage();
  await until("a whole sweep", () => pointsOf(page), (points) => points >= 0.9 * kPoints);
  process.kill(Number(stream), "SIGSTOP");
  const renderer = await page.evaluate(() => window.rgbdt.cloud.renderer());
  await until("all of the sweep", () => pointsOf(page), (points) => points >= 0.9 * kPoints);
  await page.mouse.move(500, 400);
  await page.mouse.down();
  const lines = ["second,frames,points,renderer"];
  let drawn = await page.evaluate(() => window.rgbdt.cloud.drawn());
  let began = performance.now();
  for (let second = 1; second <= duration; ++second) {
    for (let step = 0; performance.now() - began < 1000; ++step) await page.mouse.move(500 + 8 * (step % 60), 400);
    const now = await page.evaluate(() => window.rgbdt.cloud.drawn());
    const passed = (performance.now() - began) / 1000;
    began = performance.now();
    lines.push([second, (now - drawn) / passed, await pointsOf(page), `"${renderer}"`].join(","));
    drawn = now;
  }
  await page.mouse.up();
  writeFileSync(csv, `${lines.join("\n")}\n`);
}

// By the debugger, so that the page costs no time of the processor while it hangs.
async function stall() {
  const { page, context } = await openPage();
  await until("the connection", () => byId(page, "connection").innerText(), (text) => text === "live");
  const debug = await context.newCDPSession(page);
  const paused = new Promise((resolve) => debug.once("Debugger.paused", resolve));
  await debug.send("Debugger.enable");
  await debug.send("Debugger.pause");
  void page.evaluate(() => 1).catch(() => undefined); // something to stop at
  await paused;
  console.log("stalled");
  await new Promise((resolve) => process.once("SIGTERM", resolve));
  process.exit(0);
}

run(async () => {
  if (verb === "screen") return measureScreen(rest[0], Number(rest[1]), rest[2]);
  if (verb === "orbit") return measureOrbit(rest[0], Number(rest[1]), rest[2]);
  require(verb === "stall", `unknown verb ${verb}`);
  return stall();
});
