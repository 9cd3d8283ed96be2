// node session.mjs SEED TRUTH: six views, three tabs, nine points, and the calibration is saved.
import { byId, helper, kDesk, kPhone, lossesOf, numberOf, openBrowser, openTab, require, run, shot, until } from "./browser.mjs";

const [seed, truth] = process.argv.slice(2);
const kViews = 6, kReloadAfter = 3, kHeldoutPx = 1.5;
const kPointsOf = 5; // the view whose points are clicked: near, so that squares are large
const kCameras = ["rgb", "thermal"];
const nameOf = (view) => String(view).padStart(4, "0");

async function click(page, request) {
  const button = byId(page, `request-${request}`);
  await until(`${request} to be possible`, () => button.isEnabled());
  await button.click();
}

async function takeView(page, number) {
  const view = nameOf(number);
  await click(page, "next_pose");
  await until("the board to stand", () => byId(page, "request-capture").isDisabled());
  await until("the board to stand", () => byId(page, "request-capture").isEnabled());
  const preset = await byId(page, "heldout").isChecked();
  require(preset === (number % 3 === 0), `view ${view}: the page presets held-out as ${preset}`);
  await click(page, "capture");
  for (const camera of kCameras) {
    const line = byId(page, `view-state-${view}-${camera}`);
    await until(`view ${view} of ${camera}`, () => line.getAttribute("data-state", { timeout: 120_000 }), (state) => state !== "waiting");
    require(await line.getAttribute("data-state") === "accepted", `view ${view}: ${await line.innerText()}`);
  }
  // The solve that follows is done when another view may be asked for.
  await until(`view ${view} to be solved`, () => byId(page, "request-next_pose").isEnabled());
  const badge = byId(page, `card-${view}`).locator(".badge");
  require(await badge.innerText() === (number % 3 === 0 ? "held out" : "used"), `view ${view} is ${await badge.innerText()}`);
}

async function thumbsShown(page, views) {
  for (let view = 1; view <= views; ++view) {
    const images = byId(page, `card-${nameOf(view)}`).locator(".thumb img, .thumb canvas[data-points]");
    await until(`thumbs of view ${view}`, () => images.evaluateAll((all) => all.filter((image) => image.naturalWidth !== 0).length),
      (count) => count === kCameras.length + 1);
  }
}

const cloudPoints = (page) => page.evaluate(() => window.rgbdt.cloud.points());

async function reload(page) {
  await page.reload();
  await until("the connection", () => byId(page, "connection").innerText(), (text) => text === "live");
  await openTab(page, "session");
  await thumbsShown(page, kReloadAfter);
  await until("the cloud after a reload", () => cloudPoints(page), (points) => points > 10_000);
}

async function checkOverlays(page) {
  await openTab(page, "cameras");
  await byId(page, "view-0003").click();
  for (const camera of kCameras) {
    const rms = byId(page, `picture-${camera}`).getByTestId("edge-rms");
    const px = numberOf(await rms.innerText());
    console.log(`edge of the held-out view 0003 in ${camera}: ${px} px RMS`);
    require(px < kHeldoutPx, `the cloud's edge lies ${px} px off the board in ${camera}`);
  }
  await shot(page, "cameras");
}

/// A real click on the canvas where a point of the LIDAR's frame is drawn; what the card then says.
async function clickPoint(page, place) {
  const at = await page.evaluate(([x, y, z]) => window.rgbdt.cloud.project(x, y, z), place);
  require(at?.inFront, `${place} is not on the screen`);
  await page.keyboard.press("Escape");
  await page.mouse.click(at.x, at.y);
  const card = byId(page, "point-card");
  await card.waitFor();
  const read = async (name) => numberOf(await byId(page, `point-${name}`).innerText());
  const temperature = await byId(page, "point-temperature").innerText();
  const sigma = /± *([\d.]+)/.exec(temperature);
  require(sigma, `no temperature at ${place}: "${temperature}"`);
  return {
    place: [await read("x"), await read("y"), await read("z")],
    kelvin: numberOf(temperature) + 273.15, sigma_k: Number(sigma[1]),
  };
}

const distance = (a, b) => Math.hypot(...a.map((value, i) => value - b[i]));

async function lookFrom(page, view) {
  const more = byId(page, "cloud-controls").locator("summary");
  await more.click();
  await byId(page, `cloud-view-${view}`).click();
  await more.click();
}

async function checkPoints(page) {
  const { squares, centre } = helper(["squares", seed, truth, nameOf(kPointsOf)]);
  await openTab(page, "cloud");
  await lookFrom(page, "lidar");
  // What was cut for a browser that was behind comes once the rig is at rest.
  await until("all of the sweep", () => cloudPoints(page), (points) => points > 70_000);
  const picks = [];
  for (const square of squares) picks.push(await clickPoint(page, square));
  await byId(page, "cloud-colour").selectOption("temperature");
  await shot(page, "cloud");
  await page.keyboard.press("Escape");
  await byId(page, "cloud-colour").selectOption("rgb");
  await lookFrom(page, "behind");
  await openTab(page, "session");
  await shot(page, "beside");
  const there = helper(["truth", seed, truth, nameOf(kPointsOf)], picks.map(({ place }) => place.join(" ")).join("\n"));
  const wrong = picks.filter(({ place, kelvin, sigma_k }, i) => {
    const { what, distance_m, low_k, high_k } = there[i];
    const off = Math.max(low_k - kelvin, kelvin - high_k, 0);
    console.log(`point ${i + 1}: ${distance(place, squares[i]).toFixed(3)} m from the click, ${distance_m.toFixed(3)} m off the ${what}, ` +
      `${(kelvin - 273.15).toFixed(2)} °C ± ${sigma_k}, truly ${(low_k - 273.15).toFixed(2)} to ${(high_k - 273.15).toFixed(2)}`);
    // Range noise is 10 mm; points lie 10 mm apart, and of those under the pointer the nearest to the eye is taken.
    return what !== "board" || distance_m > 0.04 || distance(place, squares[i]) > 0.06 || off > 3 * sigma_k + 0.05;
  });
  require(wrong.length === 0, `${wrong.length} of ${picks.length} points are not what they truly are`);
  // A comparison with anything between black and white would say little.
  const sharp = there.filter(({ low_k, high_k }) => high_k - low_k < 1).length;
  require(sharp >= 6, `only ${sharp} of ${picks.length} points lie within a square`);
  const board = (await byId(page, `card-${nameOf(kPointsOf)}`).innerText()).match(/([\d.]+)\s*m away/);
  const truly = Math.hypot(...centre);
  require(board && Math.abs(Number(board[1]) - truly) < 0.02, `the board is ${truly} m away, the page says ${board?.[1]}`);
}

async function lookRound(page) {
  for (const tab of ["pick", "bus", "session"]) {
    await openTab(page, tab);
    await shot(page, tab);
  }
  const losses = await lossesOf(page);
  require(losses.every((line) => / 0$/.test(line)), `lost on the bus: ${losses}`);
  await openTab(page, "session");
  await page.setViewportSize(kPhone);
  await shot(page, "phone");
  await openTab(page, "cloud");
  await until("the cloud on a phone", () => cloudPoints(page), (points) => points > 10_000);
  await shot(page, "phone-cloud");
  await page.setViewportSize(kDesk);
  await openTab(page, "session");
}

run(async () => {
  const { page } = await openBrowser();
  await page.goto(process.env.RGBDT_URL);
  await openTab(page, "session");
  const verdict = byId(page, "verdict");
  await until("the first verdict", () => verdict.innerText(), (words) => /no calibration/i.test(words));
  for (let view = 1; view <= kViews; ++view) {
    await takeView(page, view);
    if (view === kReloadAfter) await reload(page);
    if (view === kPointsOf) await checkPoints(page);
  }
  await thumbsShown(page, kViews);
  const words = await verdict.innerText();
  console.log(`verdict: ${words.replace(/\s+/g, " ")}`);
  require(!/no calibration/i.test(words) && await verdict.getAttribute("data-grade") !== "none", "the verdict did not change");
  await checkOverlays(page);
  await lookRound(page);
  await click(page, "finish");
  await byId(page, "finish-confirm").click();
  await until("the session to end", () => byId(page, "progress").innerText(), (text) => /saved to/.test(text));
  await shot(page, "finished");
});
