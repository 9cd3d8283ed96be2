// Reads an MCAP by @mcap/core, decodes each message by the schema in the file, and prints what is
// inside, a line a topic: name, schema, messages, those decoded, and of the last one some values.
// Checked besides: the checksums, that each message is found by the index in the order of its time,
// and that statistics and messages agree. Usage: node read_mcap.mjs FILE NODE_MODULES

import { open, readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { decoderMaker, describe } from "./foxglove_decoder.mjs";

const [file, modules] = process.argv.slice(2);
const require = createRequire(`${modules}/`);
const typeOf = decoderMaker(modules);
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { decompress } = require("fzstd");

const zstd = (packed, size) => {
  const bytes = decompress(packed);
  if (BigInt(bytes.byteLength) !== size) throw new Error(`${bytes.byteLength} bytes of ${size}`);
  return bytes;
};
const decompressHandlers = { zstd };

function decoderOf(schema) {
  if (schema.encoding !== "protobuf") throw new Error(`${schema.name}: ${schema.encoding}`);
  return typeOf(schema.data, schema.name);
}

// Nothing where it is no message of the schema.
function valueOf(type, data) {
  try {
    const value = type.decode(data);
    return type.verify(value) === null ? value : undefined;
  } catch {
    return undefined;
  }
}

const handle = await open(file);
const { size } = await handle.stat();
const readable = {
  size: async () => BigInt(size),
  read: async (offset, length) => {
    const bytes = new Uint8Array(Number(length));
    const { bytesRead } = await handle.read(bytes, 0, bytes.length, Number(offset));
    if (bytesRead !== bytes.length) throw new Error("the file ends too early");
    return bytes;
  },
};
const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });

const topics = new Map();
let before = 0n;
let decoded = 0;
for await (const message of reader.readMessages({ validateCrcs: true })) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  if (message.logTime < before) throw new Error(`${channel.topic}: time goes back`);
  before = message.logTime;
  let topic = topics.get(channel.topic);
  if (!topic) {
    topic = { schema: schema.name, type: decoderOf(schema), messages: 0, decoded: 0 };
    topics.set(channel.topic, topic);
  }
  if (message.sequence !== topic.messages) throw new Error(`${channel.topic}: a number is missing`);
  ++topic.messages;
  const value = valueOf(topic.type, message.data);
  if (!value) continue;
  ++topic.decoded;
  ++decoded;
  topic.last = value;
}

// Front to back, as who cannot seek: the checksums of chunks, data and summary.
const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
stream.append(await readFile(file));
let streamed = 0;
for (let record; (record = stream.nextRecord()); ) if (record.type === "Message") ++streamed;
if (!stream.done()) throw new Error("the file does not end");

const { messageCount } = reader.statistics;
if (messageCount !== BigInt(streamed)) throw new Error(`${streamed} messages of ${messageCount}`);

for (const [name, topic] of [...topics].sort()) {
  const last = topic.last ? describe(topic.schema, topic.last) : "";
  console.log(`${name}  ${topic.schema}  ${topic.messages} ${topic.decoded}  ${last}`);
}
console.log(`decoded ${decoded} of ${messageCount}`);
if (BigInt(decoded) !== messageCount) process.exit(1);
