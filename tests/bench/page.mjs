// node page.mjs DIR: how quickly the page draws a cloud that is turned, by software and, where there is
// one, on a graphics card. Writes table.txt, page.csv, page-N.png and summary.json. See page.sh.
import { createRequire } from "node:module";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { tmpdir } from "node:os";
import { pathToFileURL } from "node:url";

const { RGBDT_CHROMIUM, RGBDT_PACKAGES, RGBDT_PAGE } = process.env;
const { chromium } = createRequire(RGBDT_PACKAGES)("playwright-core");
const [out] = process.argv.slice(2);
const kCases = [
  { name: "software", points: 500_000, args: ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] },
  { name: "card", points: 2_000_000, args: ["--use-gl=angle", "--use-angle=gl", "--ignore-gpu-blocklist"] },
];
const kTurnMs = 6000, kSettleMs = 2000, kView = { width: 1300, height: 900 };
const kRecord = 32; // bytes, see protocol.ts

function random(seed) {
  let state = seed;
  return () => (state = (Math.imul(state, 1664525) + 1013904223) >>> 0) / 2 ** 32;
}

/// A room of 18 x 16 x 5.5 m as a dense scanner sees its front half, 1 cm of noise; records shuffled.
function room(points) {
  const draw = random(1), rows = Math.round(Math.sqrt(points / 3)), columns = Math.floor(points / rows);
  const order = Uint32Array.from({ length: rows * columns }, (_, i) => i);
  for (let i = order.length - 1; i > 0; --i) {
    const j = Math.floor(draw() * (i + 1));
    [order[i], order[j]] = [order[j], order[i]];
  }
  const bytes = Buffer.alloc(kRecord * order.length);
  order.forEach((beam, i) => {
    const azimuth = Math.PI * ((beam % columns) / columns - 0.5), elevation = -0.9 + (1.4 * Math.floor(beam / columns)) / rows;
    const towards = [Math.cos(elevation) * Math.cos(azimuth), Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation)];
    const walls = [[10, 0], [8, 1], [-8, 1], [-1.5, 2], [4, 2]].map(([at, axis]) => at / towards[axis]).filter((range) => range > 0);
    const place = towards.map((part) => part * (Math.min(...walls) + 0.02 * (draw() - 0.5)));
    place.forEach((value, axis) => bytes.writeFloatLE(value, kRecord * i + 4 * axis));
    const light = place.reduce((sum, value) => sum + Math.floor(2 * value), 0) & 1 ? 180 : 70;
    bytes.set([light, 0.8 * light, 90, 100], kRecord * i + 12);
    bytes.writeFloatLE(290 + 5 * Math.sin(5 * azimuth), kRecord * i + 16);
    bytes.writeUInt16LE(150, kRecord * i + 24);
    bytes.writeUInt16LE(3, kRecord * i + 26);
  });
  return bytes;
}

function frame(header, payload = Buffer.alloc(0)) {
  const json = Buffer.from(JSON.stringify(header)), size = ((8 + json.length + 7) & ~7) - 8;
  const bytes = Buffer.alloc(8 + size + payload.length, " ");
  bytes.writeUInt32LE(0, 0);
  bytes.writeUInt32LE(size, 4);
  json.copy(bytes, 8);
  payload.copy(bytes, 8 + size);
  return `<script type="application/x-rgbdt-frames">${bytes.toString("base64")}</script>`;
}

function writeReport(path, points) {
  const records = room(points), count = records.length / kRecord;
  const frames = [
    frame({ type: "hello", source: "session", title: "bench", version: "", may_command: false, why_not: "" }),
    frame({
      type: "cloud", view: "", sweep_utime: 1e15, whole: true, part: 0, sweep_end: true, utime: 1e15, cameras: ["rgb", "thermal"],
      calibrated: [true, true], map_from_lidar: null, count, arrays: [{ name: "points", type: "u8", length: records.length }],
    }, records),
  ];
  writeFileSync(path, readFileSync(RGBDT_PAGE, "utf8").replace("<!--rgbdt-frames-->", () => frames.join("\n")));
  return count;
}

const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1] ?? NaN;
const look = (page) => page.evaluate(() => ({
  drawn: window.rgbdt.cloud.drawn(), points: window.rgbdt.cloud.points(), cost: window.rgbdt.cloud.cost(), renderer: window.rgbdt.cloud.renderer(),
}));

/// Turned by a mouse that is dragged to and fro.
async function turn(page, ms) {
  const box = await page.getByTestId("cloud-canvas").boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  const looks = [], begin = performance.now();
  for (let i = 0; performance.now() - begin < ms; ++i) {
    await page.mouse.move(x + 250 * Math.sin(i / 12), y + 60 * Math.sin(i / 19));
    looks.push(await look(page));
  }
  const seconds = (performance.now() - begin) / 1000;
  await page.mouse.up();
  return { fps: (looks[looks.length - 1].drawn - looks[0].drawn) / seconds, points: median(looks.map(({ points }) => points)) };
}

async function measure({ name, points, args }) {
  const scratch = mkdtempSync(join(tmpdir(), "rgbdt-page-"));
  const browser = await chromium.launch({ executablePath: RGBDT_CHROMIUM, headless: true, args: ["--no-sandbox", ...args] });
  try {
    const report = join(scratch, "report.html"), all = writeReport(report, points);
    const page = await browser.newPage({ viewport: kView });
    await page.goto(pathToFileURL(report).href);
    const { renderer } = await look(page);
    if (name === "card" && (renderer === "" || /swiftshader|llvmpipe|software/i.test(renderer))) return null;
    await page.waitForFunction((most) => window.rgbdt.cloud.points() > 0.9 * most, all, { timeout: 60_000 });
    await turn(page, kSettleMs); // until it knows how much it can draw
    const { fps, points: moving } = await turn(page, kTurnMs);
    await page.waitForFunction((most) => window.rgbdt.cloud.points() > 0.9 * most, all, { timeout: 60_000 });
    const { cost } = await look(page);
    await page.screenshot({ path: join(out, `page-${name}.png`) });
    return { name, points: all, fps, moving, cost, renderer };
  } finally {
    await browser.close();
    rmSync(scratch, { recursive: true });
  }
}

const rows = [];
for (const one of kCases) {
  const row = await measure(one);
  if (row) rows.push(row);
  else console.log(`${one.name}: not measured, this machine has no graphics card`);
}
const lines = rows.map(({ name, points, fps, moving, cost, renderer }) =>
  `${name.padEnd(9)} ${points} points: ${fps.toFixed(1)} frames/s while turned (${moving} points drawn), ${cost.toFixed(0)} ms for all of them at rest; ${renderer}`);
console.log(lines.join("\n"));
writeFileSync(join(out, "table.txt"), lines.join("\n") + "\n");
writeFileSync(join(out, "page.csv"), ["name,points,frames_per_s,points_moving,rest_ms",
  ...rows.map((row) => [row.name, row.points, row.fps.toFixed(2), row.moving, row.cost.toFixed(1)].join())].join("\n") + "\n");
writeFileSync(join(out, "summary.json"), JSON.stringify({ figures: rows.flatMap(({ name, fps, moving, cost }) => [
  { name: `page_${name}_frames`, value: fps, unit: "1/s" }, { name: `page_${name}_points_moving`, value: moving, unit: "" },
  { name: `page_${name}_rest`, value: cost, unit: "ms" },
]) }, null, 2) + "\n");
