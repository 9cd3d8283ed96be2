// rgbdt-viewer's channels, by the client that Foxglove publishes (@foxglove/ws-protocol), each message
// decoded by the schema that was advertised.
// node foxglove.mjs collect URL NODE_MODULES OUT: subscribes to all, into OUT until stdin ends
// node foxglove.mjs compare OUT MCAP NODE_MODULES: what came is what the file has, byte by byte
import { createHash } from "node:crypto";
import { open, readFile, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { decoderMaker, describe } from "../cli/foxglove_decoder.mjs";

function fail(why) {
  console.error(why);
  process.exit(1);
}

const digestOf = (bytes) => createHash("sha256").update(bytes).digest("hex");

/// Of its own time alone, where the message is of its moment; else what it says, without the time.
const isExact = (topic) => /points$|image_raw|^\/tf$|^\/pose$/.test(topic);

function told(topic, schema, type, bytes) {
  const value = type.decode(bytes);
  if (type.verify(value) !== null) fail(`${topic}: ${type.verify(value)}`);
  return { topic, schema, digest: digestOf(bytes), says: describe(schema, value) };
}

/// How many points have a colour, and a temperature that a room may have, with its sigma.
function fullPoints(cloud) {
  const view = new DataView(cloud.data.buffer, cloud.data.byteOffset, cloud.data.byteLength);
  const at = Object.fromEntries(cloud.fields.map((field) => [field.name, field.offset]));
  let full = 0;
  for (let begin = 0; begin < cloud.data.length; begin += cloud.point_stride) {
    const kelvin = view.getFloat32(begin + at.temperature, true);
    const sigma = view.getFloat32(begin + at.temperature_sigma, true);
    if (view.getUint8(begin + at.alpha) === 255 && kelvin > 250 && kelvin < 400 && sigma > 0) ++full;
  }
  return full;
}

async function collect(url, modules, out) {
  const require = createRequire(`${modules}/`);
  const { FoxgloveClient } = require("@foxglove/ws-protocol");
  const { WebSocket } = require("ws");
  const typeOf = decoderMaker(modules);
  const client = new FoxgloveClient({ ws: new WebSocket(url, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
  const channels = new Map(), messages = [];
  let full = 0;
  client.on("error", (error) => fail(`${url}: ${error.message}`));
  client.on("close", () => fail("the viewer closed the connection"));
  client.on("status", ({ message }) => fail(`the viewer warns: ${message}`));
  client.on("serverInfo", ({ name, capabilities }) => {
    if (name !== "rgbdt" || capabilities.length > 0) fail(`${name} offers ${capabilities}`);
  });
  client.on("advertise", (added) => {
    for (const channel of added) {
      if (channel.encoding !== "protobuf") fail(`${channel.topic}: ${channel.encoding}`);
      const type = typeOf(Buffer.from(channel.schema, "base64"), channel.schemaName);
      channels.set(client.subscribe(channel.id), { ...channel, type });
    }
  });
  client.on("message", ({ subscriptionId, timestamp, data }) => {
    const { topic, schemaName, type } = channels.get(subscriptionId);
    const bytes = new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
    const late = Date.now() - Number(timestamp / 1_000_000n);
    if (Math.abs(late) > 60_000) fail(`${topic}: received ${late} ms ago`);
    messages.push(told(topic, schemaName, type, bytes));
    if (topic === "/fused/points") full += fullPoints(type.decode(bytes));
  });
  for await (const _ of process.stdin);
  await writeFile(out, JSON.stringify({ full, messages }));
  process.exit(0);
}

async function readMcap(file, modules) {
  const require = createRequire(`${modules}/`);
  const { McapIndexedReader } = require("@mcap/core");
  const { decompress } = require("fzstd");
  const typeOf = decoderMaker(modules);
  const handle = await open(file);
  const { size } = await handle.stat();
  const readable = {
    size: async () => BigInt(size),
    read: async (offset, length) => (await handle.read(new Uint8Array(Number(length)), 0, Number(length), Number(offset))).buffer,
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers: { zstd: (packed) => decompress(packed) } });
  const types = new Map(), messages = [];
  for await (const { channelId, data } of reader.readMessages()) {
    const { topic, schemaId } = reader.channelsById.get(channelId);
    const { name, data: set } = reader.schemasById.get(schemaId);
    if (!types.has(name)) types.set(name, typeOf(set, name));
    messages.push(told(topic, name, types.get(name), data));
  }
  return messages;
}

async function compare(collected, mcap, modules) {
  const { full, messages } = JSON.parse(await readFile(collected, "utf8"));
  const written = new Set();
  const keyOf = ({ topic, schema, digest, says }) => `${topic} ${schema} ${isExact(topic) ? digest : says}`;
  for (const message of await readMcap(mcap, modules)) written.add(keyOf(message));
  const counts = {};
  for (const message of messages) {
    // The first fused sweep may be one of RGBDT_CLOUD: nobody knew that RGBDT_SWEEP comes, too.
    const first = message.topic === "/fused/points" && counts[message.topic] === undefined;
    if (!first && !written.has(keyOf(message))) fail(`not in the file: ${message.topic} ${message.says}`);
    counts[message.topic] = (counts[message.topic] ?? 0) + 1;
  }
  for (const [topic, count] of Object.entries(counts).sort()) console.log(`${topic}  ${count}`);
  console.log(`points with colour, temperature and sigma: ${full}`);
}

const [verb, ...rest] = process.argv.slice(2);
await { collect, compare }[verb](...rest);
