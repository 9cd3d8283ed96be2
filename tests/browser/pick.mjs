// node pick.mjs SEED TRUTH: a view that wants picks gets them by clicks on the image.
import { byId, helper, openBrowser, openTab, require, run, shot, until } from "./browser.mjs";

const [seed, truth] = process.argv.slice(2);
const kOffPx = [[2, -1], [-1.5, 1.5], [1, 2], [-2, -1]]; // as exactly as a person clicks

async function click(page, request) {
  const button = byId(page, `request-${request}`);
  await until(`${request} to be possible`, () => button.isEnabled());
  await button.click();
}

async function clickCorners(page, corners) {
  const canvas = byId(page, "pick-canvas");
  await canvas.scrollIntoViewIfNeeded();
  const box = await canvas.boundingBox();
  const scale = box.width / 640; // the thermal camera's width [px]; a pixel's centre is at an integer
  for (const [i, [u, v]] of corners.entries()) {
    const [du, dv] = kOffPx[i];
    await page.mouse.click(box.x + (u + du + 0.5) * scale, box.y + (v + dv + 0.5) * scale);
    const corner = byId(page, `pick-corner-${i + 1}`);
    await corner.waitFor();
    const at = [Number(await corner.getAttribute("data-x")), Number(await corner.getAttribute("data-y"))];
    // A mouse hits whole pixels of the screen.
    require(Math.hypot(at[0] - u - du, at[1] - v - dv) < 1.5 / scale, `corner ${i + 1} was set at ${at}, clicked at ${[u + du, v + dv]}`);
  }
}

run(async () => {
  const { page } = await openBrowser();
  await page.goto(process.env.RGBDT_URL);
  await openTab(page, "session");
  await click(page, "next_pose");
  await until("the carrying of the board", () => byId(page, "request-capture").isDisabled());
  await click(page, "capture");
  const thermal = byId(page, "view-state-0001-thermal");
  await until("thermal to be rejected", () => thermal.getAttribute("data-state"), (state) => state === "rejected");
  console.log(`before: ${await thermal.innerText()}`);
  require(await byId(page, "view-state-0001-rgb").getAttribute("data-state") === "accepted", "the colour image was rejected");
  await byId(page, "pick-open-0001-thermal").click();
  require(await byId(page, "pick-send").isDisabled(), "nothing was picked, and it can be sent");
  await clickCorners(page, helper(["outline", seed, truth, "0001", "thermal"]));
  await shot(page, "corners");
  await byId(page, "pick-send").click();
  const outcome = byId(page, "pick-outcome");
  const words = await until("the outcome", () => outcome.innerText(), (said) => /Accepted|Rejected|Refused/.test(said));
  console.log(`outcome: ${words}`);
  require(/Accepted/.test(words), "the picks were not taken");
  await openTab(page, "session");
  await until("thermal to be accepted", () => thermal.getAttribute("data-state"), (state) => state === "accepted");
  console.log(`after: ${await thermal.innerText()}`);
  require(/corners picked by hand/.test(await thermal.innerText()), "the card does not say that corners were picked");
  await shot(page, "accepted");
});
