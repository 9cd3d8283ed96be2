// node cloud.mjs REPORT_HTML: what a person does with the cloud, in a report.
import { pathToFileURL } from "node:url";
import { byId, kPhone, numberOf, openBrowser, require, run, shot, until } from "./browser.mjs";

const [report] = process.argv.slice(2);
const kTouch = 44; // least side of what a finger hits [px]
const distance = (a, b) => Math.hypot(...a.map((value, i) => value - b[i]));

const cloud = (page, ask, ...values) => page.evaluate(([name, given]) => window.rgbdt.cloud[name](...given), [ask, values]);

/// It draws on demand: nothing changes any more.
async function atRest(page) {
  const frames = () => page.evaluate(async () => {
    const before = window.rgbdt.cloud.drawn();
    for (let i = 0; i < 30; ++i) await new Promise(requestAnimationFrame);
    return window.rgbdt.cloud.drawn() - before;
  });
  await until("the cloud to rest", frames, (drawn) => drawn === 0);
}

/// The points under an even grid of the canvas; null where there is none.
async function pointsSeen(page) {
  await atRest(page);
  const { x, y, width, height } = await byId(page, "cloud-canvas").boundingBox();
  const seen = await page.evaluate(([left, top, w, h]) => Array.from({ length: 400 }, (_, i) => {
    const at = [left + ((i % 20 + 0.5) * w) / 20, top + ((Math.floor(i / 20) + 0.5) * h) / 20];
    return { at, place: window.rgbdt.cloud.pickAt(...at)?.position ?? null };
  }), [x, y, width, height]);
  await page.keyboard.press("Escape");
  return seen;
}
const shareOf = (seen) => seen.filter(({ place }) => place).length / seen.length;
const placesOf = (seen) => seen.flatMap(({ place }) => (place ? [place] : []));

async function slide(page, id, value) {
  await byId(page, id).evaluate((input, to) => {
    input.value = String(to);
    input.dispatchEvent(new Event("input", { bubbles: true }));
  }, value);
}

async function checkFit(page) {
  const first = shareOf(await pointsSeen(page));
  await byId(page, "cloud-canvas").focus();
  for (let i = 0; i < 12; ++i) await page.keyboard.press("-");
  const far = shareOf(await pointsSeen(page));
  await byId(page, "cloud-fit").click();
  const fitted = shareOf(await pointsSeen(page));
  console.log(`the cloud covers ${first} of the canvas at first, ${far} from afar, ${fitted} after "Fit"`);
  require(first > 0.35 && far < 0.5 * first && fitted > 0.9 * first, "the cloud does not fill its canvas");
}

async function checkMeasure(page) {
  const seen = (await pointsSeen(page)).filter(({ place, at: [, y] }) => place && y > 300);
  const [from, to] = [seen[0], seen[seen.length - 1]];
  await byId(page, "cloud-measure").click();
  for (const { at } of [from, to]) await page.mouse.click(...at);
  const told = numberOf(await byId(page, "measured-distance").innerText());
  const parts = await Promise.all(["x", "y", "z"].map(async (axis) =>
    numberOf((await byId(page, `measured-d${axis}`).innerText()).replace(`d${axis}`, ""))));
  console.log(`measured ${told} m, ${parts}`);
  require(Math.abs(told - distance(from.place, to.place)) < 0.001, `${told} m between ${from.place} and ${to.place}`);
  require(distance(parts, to.place.map((value, i) => value - from.place[i])) < 0.002, `its parts are ${parts}`);
  await shot(page, "measured");
  await byId(page, "cloud-measure").click();
}

async function checkCuts(page) {
  const xs = placesOf(await pointsSeen(page)).map(([x]) => x).sort((a, b) => a - b);
  const middle = xs[xs.length >> 1];
  await byId(page, "cloud-crop").click();
  await slide(page, "crop-x-high", middle);
  const cropped = placesOf(await pointsSeen(page));
  require(cropped.length > 0 && cropped.every(([x]) => x <= middle + 0.06), `points beyond x = ${middle} after cropping`);
  await shot(page, "cropped");
  await byId(page, "cloud-crop").click();
  await byId(page, "cloud-section").click();
  await byId(page, "section-x").click();
  await slide(page, "section-middle", middle);
  await slide(page, "section-thickness", 1);
  await byId(page, "section-look").click();
  const slice = placesOf(await pointsSeen(page));
  require(slice.length > 0 && slice.every(([x]) => Math.abs(x - middle) <= 0.56), `points outside the section at x = ${middle}`);
  await shot(page, "section");
  await byId(page, "cloud-section").click();
}

async function checkColours(page) {
  require(await byId(page, "cloud-blend").count() === 0, "there is a slide without a blend");
  await byId(page, "cloud-colour").selectOption("blend");
  await slide(page, "cloud-blend", 0.6);
  await atRest(page);
  await shot(page, "blend");
  const names = await byId(page, "cloud-labels").locator("span:not([hidden])").allInnerTexts();
  require(["rgb", "thermal", "x", "y", "z"].every((name) => names.includes(name)), `labels are ${names}`);
  require(names.some((name) => /^−?\d+ m$/.test(name)), `no label of the grid in ${names}`);
}

/// What is too small for a finger, or not on the screen; a label is what a finger hits of its checkbox.
async function outOfReach(page) {
  const boxes = await byId(page, "cloud-controls").locator("button, select, summary, label, input[type=range]").evaluateAll((all) =>
    all.filter((each) => each.checkVisibility()).map((each) => {
      const { left, right, height } = each.getBoundingClientRect();
      return { what: each.dataset.testid ?? each.textContent, left, right, height };
    }));
  return boxes.filter(({ left, right, height }) => height < kTouch - 2 || left < 0 || right > kPhone.width);
}

async function checkPhone(page) {
  await page.setViewportSize(kPhone);
  // The result stands first, and a phone has room for one tab alone.
  await page.getByRole("tab", { name: "Cloud" }).click();
  await byId(page, "cloud-crop").click();
  let wrong = await outOfReach(page);
  require(wrong.length === 0, `on a phone: ${JSON.stringify(wrong)}`);
  await atRest(page);
  await shot(page, "phone");
  await byId(page, "cloud-crop").click();
  await byId(page, "cloud-controls").locator("summary").click();
  wrong = await outOfReach(page);
  require(wrong.length === 0, `in the menu on a phone: ${JSON.stringify(wrong)}`);
  await shot(page, "phone-menu");
}

run(async () => {
  const { page } = await openBrowser();
  await page.goto(pathToFileURL(report).href);
  await until("the cloud", () => cloud(page, "points"), (points) => points > 10_000);
  const tabs = await page.getByRole("tab").allInnerTexts();
  require(tabs.join() === "Cloud,Cameras,Session", `a report has the tabs ${tabs}`);
  require(await byId(page, "cloud-mode-map").count() === 0, "a report offers a map of its one sweep");
  await checkFit(page);
  await checkMeasure(page);
  await checkCuts(page);
  await page.evaluate(() => window.rgbdt.cloud.look("behind"));
  await checkColours(page);
  await checkPhone(page);
});
