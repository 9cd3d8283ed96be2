// Holds a LAZ and a COPC file against the LAS of the same points, decoded by laz-perf and copc, which
// share no code with ours: each byte of each record. The LAZ keeps the order; of the COPC each point is
// in one node, within the node's box, and the whole is found by the chunk table alone, too, as any LAZ.
// Ends with 3 where something differs. Usage: node read_laz.mjs LAS LAZ COPC NODE_MODULES
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const [lasPath, lazPath, copcPath, modules] = process.argv.slice(2);
const require = createRequire(`${modules}/`);
const { createLazPerf } = require("laz-perf");
const { Copc, Las } = require("copc");

function expect(good, what) {
  if (good) return;
  console.error(what);
  process.exit(3);
}

const lazPerf = await createLazPerf();
const las = readFileSync(lasPath);
const head = Las.Header.parse(las);
const { pointCount, pointDataRecordLength: length, pointDataOffset: start } = head;
const point = lazPerf._malloc(length);
const expected = (i) => las.subarray(start + i * length, start + (i + 1) * length);
const decoded = () => Buffer.from(lazPerf.HEAPU8.subarray(point, point + length));

function withBytes(bytes, use) {
  const at = lazPerf._malloc(bytes.length);
  lazPerf.HEAPU8.set(bytes, at);
  const result = use(at);
  lazPerf._free(at);
  return result;
}

// The points of a whole file, by its chunk table.
function* pointsOf(bytes) {
  const file = new lazPerf.LASZip();
  const at = lazPerf._malloc(bytes.length);
  lazPerf.HEAPU8.set(bytes, at);
  file.open(at, bytes.length);
  expect(file.getCount() === pointCount, `${file.getCount()} points, not ${pointCount}`);
  expect(file.getPointFormat() === 7 && file.getPointLength() === length, "another format");
  for (let i = 0; i < pointCount; ++i) {
    file.getPoint(point);
    yield decoded();
  }
  file.delete();
  lazPerf._free(at);
}

function sameHead(bytes, what) {
  const own = Las.Header.parse(bytes);
  for (const key of ["guid", "scale", "offset", "min", "max", "pointCount", "pointCountByReturn", "pointDataRecordLength"]) {
    expect(JSON.stringify(own[key]) === JSON.stringify(head[key]), `${what}: ${key} ${own[key]}, not ${head[key]}`);
  }
}

async function recordOf(bytes, user, id) {
  const get = async (from, to) => bytes.subarray(from, to);
  const records = await Las.Vlr.walk(get, Las.Header.parse(bytes));
  const record = Las.Vlr.find(records, user, id);
  return record && Buffer.from(await Las.Vlr.fetch(get, record));
}

const laz = readFileSync(lazPath);
const copcFile = readFileSync(copcPath);
for (const [bytes, what] of [[laz, "LAZ"], [copcFile, "COPC"]]) {
  sameHead(bytes, what);
  for (const id of [3, 4]) {
    const [own, plain] = [await recordOf(bytes, "LASF_Spec", id), await recordOf(las, "LASF_Spec", id)];
    expect(own && own.equals(plain), `${what}: record ${id}`);
  }
}

let i = 0;
for (const record of pointsOf(laz)) {
  expect(record.equals(expected(i)), `LAZ: point ${i}: ${record.toString("hex")}, not ${expected(i).toString("hex")}`);
  ++i;
}

const left = new Map();
const key = (record) => record.toString("latin1");
const reset = () => {
  left.clear();
  for (let i = 0; i < pointCount; ++i) left.set(key(expected(i)), (left.get(key(expected(i))) ?? 0) + 1);
};
const strike = (record, what) => {
  const count = left.get(key(record)) ?? 0;
  expect(count > 0, `COPC: ${what}: a point that is not in the LAS, or too often: ${record.toString("hex")}`);
  left.set(key(record), count - 1);
};
reset();
for (const record of pointsOf(copcFile)) strike(record, "by the chunk table");
reset();

const get = async (from, to) => copcFile.subarray(from, to);
const copc = await Copc.create(get);
const { nodes, pages } = await Copc.loadHierarchyPage(get, copc.info.rootHierarchyPage);
expect(Object.keys(pages).length === 0, "COPC: more than one page");
const { cube, gpsTimeRange } = copc.info;
const side = cube[3] - cube[0];
expect(Math.abs(copc.info.spacing - side / 128) < 1e-9, `COPC: spacing ${copc.info.spacing} of a cube of ${side} m`);
let count = 0;
let deepest = 0;
const times = [Infinity, -Infinity];
for (const [name, node] of Object.entries(nodes)) {
  const [depth, ...at] = name.split("-").map(Number);
  const parent = [depth - 1, ...at.map((k) => k >> 1)].join("-");
  expect(depth === 0 || parent in nodes, `COPC: node ${name} without a parent`);
  deepest = Math.max(deepest, depth);
  const size = side / 2 ** depth;
  const chunk = await Copc.loadCompressedPointDataBuffer(get, node);
  withBytes(chunk, (bytes) => {
    const decoder = new lazPerf.ChunkDecoder();
    decoder.open(7, length, bytes);
    for (let k = 0; k < node.pointCount; ++k) {
      decoder.getPoint(point);
      const record = decoded();
      strike(record, `node ${name}`);
      for (let axis = 0; axis < 3; ++axis) {
        const along = (record.readInt32LE(4 * axis) * head.scale[axis] - cube[axis]) / size - at[axis];
        expect(along > -1e-9 && along < 1 + 1e-9, `COPC: a point outside of node ${name}`);
      }
      times[0] = Math.min(times[0], record.readDoubleLE(22));
      times[1] = Math.max(times[1], record.readDoubleLE(22));
      ++count;
    }
    decoder.delete();
  });
}
expect(count === pointCount, `COPC: nodes of ${count} points, not ${pointCount}`);
expect(times[0] === gpsTimeRange[0] && times[1] === gpsTimeRange[1], `COPC: times ${gpsTimeRange}, not ${times}`);

// As a viewer has them: by name.
const view = await Copc.loadPointDataView(get, copc, nodes["0-0-0-0"]);
expect("temperature" in view.dimensions && "GpsTime" in view.dimensions, "COPC: no temperature");
console.log(`${pointCount} points; nodes: ${Object.keys(nodes).length}, ${deepest + 1} levels`);
