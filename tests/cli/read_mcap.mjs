// Reads an MCAP by @mcap/core, decodes each message by the schema in the file, and prints what is
// inside, a line a topic: name, schema, messages, those decoded, and of the last one some values.
// Checked besides: the checksums, that each message is found by the index in the order of its time,
// and that statistics and messages agree. Usage: node read_mcap.mjs FILE NODE_MODULES

import { open, readFile } from "node:fs/promises";
import { createRequire } from "node:module";

const [file, modules] = process.argv.slice(2);
const require = createRequire(`${modules}/`);
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { decompress } = require("fzstd");
const protobuf = require("protobufjs");
const { FileDescriptorSet } = require("protobufjs/ext/descriptor");

const zstd = (packed, size) => {
  const bytes = decompress(packed);
  if (BigInt(bytes.byteLength) !== size) throw new Error(`${bytes.byteLength} bytes of ${size}`);
  return bytes;
};
const decompressHandlers = { zstd };

function decoderOf(schema) {
  if (schema.encoding !== "protobuf") throw new Error(`${schema.name}: ${schema.encoding}`);
  const root = protobuf.Root.fromDescriptor(FileDescriptorSet.decode(schema.data));
  root.resolveAll();
  return root.lookupType(schema.name);
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
  const value = topic.type.decode(message.data);
  if (topic.type.verify(value) !== null) continue;
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

const number = (x) => Number(x).toPrecision(6);
const vector = (v) => [v.x, v.y, v.z].map(number).join(" ");

// Of a cloud's point: its values by name.
function pointAt(cloud, index) {
  const view = new DataView(cloud.data.buffer, cloud.data.byteOffset + index * cloud.point_stride);
  const readers = [null, "Uint8", "Int8", "Uint16", "Int16", "Uint32", "Int32", "Float32", "Float64"];
  return cloud.fields.map((f) => `${f.name}=${number(view[`get${readers[f.type]}`](f.offset, true))}`);
}

function describe({ schema, last }) {
  switch (schema) {
    case "foxglove.PointCloud":
      return `${last.frame_id} ${last.data.length / last.point_stride} points; ${pointAt(last, 0).join(" ")}`;
    case "foxglove.RawImage":
      return `${last.frame_id} ${last.width}x${last.height} ${last.encoding} ${last.data.length} bytes`;
    case "foxglove.CompressedImage":
      return `${last.frame_id} ${last.format} ${last.data.length} bytes`;
    case "foxglove.CameraCalibration":
      return `${last.frame_id} ${last.distortion_model} fx ${number(last.K[0])} D ${last.D.length}`;
    case "foxglove.FrameTransforms":
      return last.transforms
        .map((t) => `${t.parent_frame_id} > ${t.child_frame_id}: ${vector(t.translation)}`)
        .join(", ");
    case "foxglove.PoseInFrame":
      return `${last.frame_id}: ${vector(last.pose.position)}`;
    default:
      return last.message ?? "";
  }
}

for (const [name, topic] of [...topics].sort()) {
  console.log(`${name}  ${topic.schema}  ${topic.messages} ${topic.decoded}  ${describe(topic)}`);
}
console.log(`decoded ${decoded} of ${messageCount}`);
if (BigInt(decoded) !== messageCount) process.exit(1);
