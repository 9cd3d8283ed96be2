// node report.mjs REPORT_HTML URL: the same session, as a file that asks for nothing and by a bridge.
import { pathToFileURL } from "node:url";
import { byId, kPhone, numberOf, openBrowser, openTab, require, run, shot, until } from "./browser.mjs";

const [report, url] = process.argv.slice(2);
const kCameras = ["rgb", "thermal"], kViews = 6, kHeldout = "0003", kHeldoutPx = 1.5;

/// What it shows of the session, in words and numbers.
async function look(page, name) {
  await until("the result first", () => byId(page, "panel-session").count(), (count) => count === 1);
  await openTab(page, "cloud");
  // While parts of the cloud come, not all of it is drawn.
  const drawn = () => page.evaluate(() => ({ points: window.rgbdt.cloud.points(), total: window.rgbdt.cloud.total() }));
  await until("the cloud", drawn, ({ points, total }) => points > 10_000 && points === total);
  await openTab(page, "session");
  const verdict = await byId(page, "verdict").innerText();
  const states = [];
  for (let view = 1; view <= kViews; ++view) {
    const card = byId(page, `card-${String(view).padStart(4, "0")}`);
    states.push(...await card.locator("li").evaluateAll((all) => all.map((each) => each.dataset.state)));
    await until("the board in the cloud", () => card.locator(".thumb img").evaluateAll((all) => all.filter((each) => each.naturalWidth > 0).length),
      (count) => count === 1);
    // Each image has the cloud on it without being asked for.
    const laid = () => card.locator("canvas").evaluateAll((all) => all.map((each) => Number(each.dataset.points ?? 0)));
    await until("the cloud on the images", laid, (points) => points.length === kCameras.length && points.every((count) => count > 1000));
    require(await card.locator(".residual-bar").count() === kCameras.length, "a view has no bar of its residual");
  }
  // The uncertainty at any distance: at 5 m it is what the line for 5 m says.
  await byId(page, "projection-distance").fill("5");
  const cells = async (row) => (await row.locator("td").allInnerTexts()).join(" ");
  const at5m = await cells(byId(page, "answer-uncertainty").locator("tr", { hasText: "projection at 5 m, up to" }));
  await until("the uncertainty at 5 m", () => cells(byId(page, "projection-chosen")), (shown) => shown === at5m);
  require(/^\d+\.\d+.px/.test(at5m), `the projection uncertainty at 5 m is ${at5m}`);
  await byId(page, "projection-distance").fill("0.7");
  await until("more uncertainty nearby", () => cells(byId(page, "projection-chosen")), (shown) => shown !== at5m);
  await shot(page, `${name}-session`);

  const answers = await byId(page, "answer-uncertainty").innerText();
  console.log(answers.replace(/\s+/g, " "));
  await openTab(page, "cameras");
  await byId(page, `view-${kHeldout}`).click();
  const edges = [];
  for (const camera of kCameras) edges.push(numberOf(await byId(page, `picture-${camera}`).getByTestId("edge-rms").innerText()));
  await shot(page, `${name}-cameras`);
  return { verdict, answers, states, edges };
}

/// Each view has a cloud of its own.
async function checkClouds(page) {
  for (const view of [1, kViews]) {
    const name = String(view).padStart(4, "0");
    await openTab(page, "session");
    await byId(page, `show-cloud-${name}`).click();
    await until(`the cloud of view ${name}`, () => page.evaluate(() => window.rgbdt.cloud.view()), (shown) => shown === name);
    await openTab(page, "cloud");
    require(await byId(page, "cloud-view").inputValue() === name, `the choice does not say ${name}`);
  }
}

/// Without a view the pose is another one, and with it again it is as before.
async function checkLeavingOut(page) {
  await openTab(page, "session");
  const pose = () => byId(page, "pose-rgb-camera_from_lidar").innerText();
  const role = byId(page, "role-0002"), button = byId(page, "leave-out-0002");
  const before = await pose();
  const asked = Date.now();
  await button.click();
  await until("the view to be left out", () => role.innerText(), (words) => words === "left out");
  console.log(`left out after ${Date.now() - asked} ms: ${(await byId(page, "moved-rgb").innerText())}`);
  require(/rgb: \d+\.\d+°, \d+\.\d.mm \(\d+\.\d+.sigmas\)/.test(await byId(page, "moved-rgb").innerText()), "it does not say by how much the pose moved");
  require(await pose() !== before, "the pose is the same without the view");
  require(/rgbdt calibrate \S+ --without 0002/.test(await byId(page, "left-out").innerText()), "it does not say how to keep the result");
  await shot(page, "left-out");
  await button.click();
  await until("the view to be used again", () => role.innerText(), (words) => words === "used");
  require(await pose() === before, "with all views the pose is not what it was");
  require(await byId(page, "left-out").count() === 0, "it still says that a view is left out");
}

run(async () => {
  const offline = await openBrowser(), online = await openBrowser();
  await offline.context.setOffline(true);
  await offline.page.goto(pathToFileURL(report).href);
  require(await byId(offline.page, "connection").innerText() === "report", "it does not say that it is a report");
  const figures = await look(offline.page, "file");
  console.log(`held-out view: ${figures.edges.join(" and ")} px; ${figures.states.join(" ")}`);
  require(figures.states.length === kViews * kCameras.length && figures.states.every((state) => state === "accepted"), "a view was rejected");
  require(figures.edges.every((px) => px < kHeldoutPx), "the cloud's edge does not lie on the board's");
  const asked = offline.requests.filter((request) => !/^(file|blob|data):/.test(request));
  require(asked.length === 0, `the report asked for ${asked}`);

  await online.page.goto(url);
  const served = await look(online.page, "served");
  require(await byId(online.page, "connection").innerText() === "finished session", "it does not say that the session is finished");
  require(await byId(online.page, "tab-bus").count() === 0, "a finished session has a tab for the bus");
  require(JSON.stringify(served) === JSON.stringify(figures), `by the bridge it is ${JSON.stringify(served)}`);
  await openTab(online.page, "session");
  const buttons = byId(online.page, "panel-session").locator("[data-testid^=request-]:enabled");
  require(await buttons.count() === 0, "a finished session can be commanded");
  await checkLeavingOut(online.page);
  await checkClouds(online.page);
  await checkClouds(offline.page);
  await openTab(offline.page, "session");
  require(await byId(offline.page, "leave-out-0002").count() === 0, "a file pretends that it can solve");
  require(await byId(offline.page, "log").count() === 0, "a file has a log without events");
  const cut = await byId(offline.page, "panel-session").locator(".residual-words").evaluateAll((all) => all.filter((each) => each.getBoundingClientRect().right > each.closest(".card").getBoundingClientRect().right).length);
  require(cut === 0, `${cut} views' figures run out of their cards`);
  require(/rgbdt-viewer --session/.test(await byId(offline.page, "why-not-leave-out").innerText()), "it does not say where views can be left out");
  await offline.page.setViewportSize(kPhone);
  await shot(offline.page, "phone");
});
