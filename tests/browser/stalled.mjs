// node stalled.mjs VIEWER_PID MOST_GROWTH_KB: one page hangs for some seconds, another one watches.
import { readFileSync } from "node:fs";
import { lossesOf, numberOf, openBrowser, openTab, require, run, shot, until } from "./browser.mjs";

const [viewerPid, mostGrowthKb] = process.argv.slice(2);
const kStallMs = 10_000; // at least
// The bridge holds the newest sweeps for a capture that may come: some 60 of these, at 2 Hz 30 s,
// then no more. By the sweeps' own stamps, as a page on a busy machine is sent only some of them.
const kWarmUtime = 35_000_000;
const kLeast = 3; // sweeps and images that show that the other goes on, however slow the machine

const rssKb = () => numberOf(/VmRSS:\s*(\d+)/.exec(readFileSync(`/proc/${viewerPid}/status`, "utf8"))[1]);

/// From here on counts the frames that come, by type; of clouds the newest sweep's name.
async function countFrames(page) {
  await page.addInitScript(() => {
    window.frames_ = { cloud: 0, image: 0, sweeps: new Set(), oldest: Infinity, newest: 0 };
    const Real = window.WebSocket;
    window.WebSocket = class extends Real {
      constructor(...all) {
        super(...all);
        this.addEventListener("message", ({ data }) => {
          const size = new DataView(data).getUint32(4, true);
          const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 8, size)));
          if (header.type in window.frames_) ++window.frames_[header.type];
          if (header.type !== "cloud" || !header.whole) return;
          window.frames_.sweeps.add(header.sweep_utime);
          window.frames_.oldest = Math.min(window.frames_.oldest, header.sweep_utime);
          window.frames_.newest = Math.max(window.frames_.newest, header.sweep_utime);
        });
      }
    };
  });
}

const framesOf = (page) => page.evaluate(() => ({ ...window.frames_, sweeps: window.frames_.sweeps.size }));

/// The page runs no more of its scripts until what this returns is called.
async function hang(page) {
  const debug = await page.context().newCDPSession(page);
  await debug.send("Debugger.enable");
  const paused = new Promise((done) => { debug.once("Debugger.paused", done); });
  await debug.send("Debugger.pause");
  await paused;
  return async () => {
    await debug.send("Debugger.resume");
    await debug.detach();
  };
}

async function openPage() {
  const { page } = await openBrowser();
  await countFrames(page);
  await page.goto(process.env.RGBDT_URL);
  await openTab(page, "cameras");
  await until("clouds and images", () => framesOf(page), ({ sweeps, image }) => sweeps > 3 && image > 3);
  await until("the cloud to be drawn", () => page.evaluate(() => window.rgbdt.cloud.points()), (points) => points > 1000);
  return page;
}

run(async () => {
  const stalled = await openPage(), other = await openPage();
  await until("the bridge to hold what it holds", () => framesOf(other), ({ oldest, newest }) => newest - oldest > kWarmUtime);
  const before = { frames: await framesOf(other), rss: rssKb(), stalled: await framesOf(stalled) };
  const release = await hang(stalled);
  const hungAt = performance.now();
  let most = before.rss;
  let waited = 0;
  // Until the other page has shown that it goes on, however slow the machine.
  await until("the other page to go on", async () => {
    most = Math.max(most, rssKb());
    waited = performance.now() - hungAt;
    const { sweeps, image } = await framesOf(other);
    return waited >= kStallMs && sweeps - before.frames.sweeps >= kLeast && image - before.frames.image >= kLeast;
  });
  const after = { frames: await framesOf(other), rss: rssKb() };
  await release();
  const came = {
    sweeps: after.frames.sweeps - before.frames.sweeps, cloud: after.frames.cloud - before.frames.cloud,
    image: after.frames.image - before.frames.image,
  };
  console.log(`while one page hung for ${Math.round(waited / 1000)} s the other got ${came.sweeps} sweeps, ${came.cloud} clouds, ${came.image} images; ` +
    `the bridge: ${before.rss} kB, at most ${most} kB, then ${after.rss} kB`);
  require(most - before.rss < mostGrowthKb, `the bridge grew by ${most - before.rss} kB`);
  // What comes after the other page's newest sweep of now is new for the one that hung.
  const newest = after.frames.newest;
  await until("the page that hung to catch up", () => framesOf(stalled), (frames) => frames.newest > newest);
  const drawn = await stalled.evaluate(() => window.rgbdt.cloud.drawn());
  await until("the page that hung to draw", () => stalled.evaluate(() => window.rgbdt.cloud.drawn()), (now) => now > drawn);
  const losses = await lossesOf(other);
  await shot(other, "bus");
  console.log(losses.join(", "));
  require(losses.every((line) => / 0$/.test(line)), `lost on the bus: ${losses}`);
});
