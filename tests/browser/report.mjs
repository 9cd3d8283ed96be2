// node report.mjs REPORT_HTML URL: the same session, as a file that asks for nothing and by a bridge.
import { pathToFileURL } from "node:url";
import { byId, kPhone, numberOf, openBrowser, openTab, require, run, shot, until } from "./browser.mjs";

const [report, url] = process.argv.slice(2);
const kCameras = ["rgb", "thermal"], kViews = 6, kHeldout = "0003", kHeldoutPx = 1.5;

/// What it shows of the session, in words and numbers. `all`: points that are to come.
async function look(page, name, all = null) {
  // While parts of the cloud come, not all of it is drawn.
  const drawn = () => page.evaluate(() => ({ points: window.rgbdt.cloud.points(), total: window.rgbdt.cloud.total() }));
  await until("the cloud", drawn, ({ points, total }) => points > 10_000 && points === total && (all ?? total) === total);
  const { points } = await drawn();
  await openTab(page, "session");
  const verdict = await byId(page, "verdict").innerText();
  const states = [];
  for (let view = 1; view <= kViews; ++view) {
    const card = byId(page, `card-${String(view).padStart(4, "0")}`);
    states.push(...await card.locator("li").evaluateAll((all) => all.map((each) => each.dataset.state)));
    await until("thumbs", () => card.locator(".thumb img").evaluateAll((all) => all.filter((each) => each.naturalWidth > 0).length),
      (count) => count === kCameras.length + 1);
  }
  await shot(page, `${name}-session`);
  await openTab(page, "cameras");
  await byId(page, `view-${kHeldout}`).click();
  const edges = [];
  for (const camera of kCameras) edges.push(numberOf(await byId(page, `picture-${camera}`).getByTestId("edge-rms").innerText()));
  await shot(page, `${name}-cameras`);
  return { points, verdict, states, edges };
}

run(async () => {
  const offline = await openBrowser(), online = await openBrowser();
  await offline.context.setOffline(true);
  await offline.page.goto(pathToFileURL(report).href);
  require(await byId(offline.page, "connection").innerText() === "report", "it does not say that it is a report");
  const figures = await look(offline.page, "file");
  console.log(`${figures.points} points; held-out view: ${figures.edges.join(" and ")} px; ${figures.states.join(" ")}`);
  require(figures.states.length === kViews * kCameras.length && figures.states.every((state) => state === "accepted"), "a view was rejected");
  require(figures.edges.every((px) => px < kHeldoutPx), "the cloud's edge does not lie on the board's");
  const asked = offline.requests.filter((request) => !/^(file|blob|data):/.test(request));
  require(asked.length === 0, `the report asked for ${asked}`);

  await online.page.goto(url);
  const served = await look(online.page, "served", figures.points);
  require(await byId(online.page, "connection").innerText() === "finished session", "it does not say that the session is finished");
  require(await byId(online.page, "tab-bus").count() === 0, "a finished session has a tab for the bus");
  require(JSON.stringify(served) === JSON.stringify(figures), `by the bridge it is ${JSON.stringify(served)}`);
  await openTab(online.page, "session");
  const buttons = byId(online.page, "panel-session").locator("[data-testid^=request-]:enabled");
  require(await buttons.count() === 0, "a finished session can be commanded");
  await offline.page.setViewportSize(kPhone);
  await shot(offline.page, "phone");
});
