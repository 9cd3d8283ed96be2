// Foxglove's messages, decoded by the schema that comes with them, and a few values of each in words.
// By packages of npm, which share no code with ours.
import { createRequire } from "node:module";

/// Of the packages in a folder node_modules: what decodes a FileDescriptorSet's message by its name.
export function decoderMaker(modules) {
  const require = createRequire(`${modules}/`);
  const protobuf = require("protobufjs");
  const { FileDescriptorSet } = require("protobufjs/ext/descriptor");
  return (set, name) => {
    const root = protobuf.Root.fromDescriptor(FileDescriptorSet.decode(set));
    root.resolveAll();
    return root.lookupType(name);
  };
}

const number = (x) => Number(x).toPrecision(6);
const vector = (v) => [v.x, v.y, v.z].map(number).join(" ");

// Of a cloud's point: its values by name.
function pointAt(cloud, index) {
  const view = new DataView(cloud.data.buffer, cloud.data.byteOffset + index * cloud.point_stride);
  const readers = [null, "Uint8", "Int8", "Uint16", "Int16", "Uint32", "Int32", "Float32", "Float64"];
  return cloud.fields.map((f) => `${f.name}=${number(view[`get${readers[f.type]}`](f.offset, true))}`);
}

export function describe(schema, value) {
  switch (schema) {
    case "foxglove.PointCloud":
      return `${value.frame_id} ${value.data.length / value.point_stride} points; ${pointAt(value, 0).join(" ")}`;
    case "foxglove.RawImage":
      return `${value.frame_id} ${value.width}x${value.height} ${value.encoding} ${value.data.length} bytes`;
    case "foxglove.CompressedImage":
      return `${value.frame_id} ${value.format} ${value.data.length} bytes`;
    case "foxglove.CameraCalibration":
      return `${value.frame_id} ${value.distortion_model} fx ${number(value.K[0])} D ${value.D.length}`;
    case "foxglove.FrameTransforms":
      return value.transforms
        .map((t) => `${t.parent_frame_id} > ${t.child_frame_id}: ${vector(t.translation)}`)
        .join(", ");
    case "foxglove.PoseInFrame":
      return `${value.frame_id}: ${vector(value.pose.position)}`;
    default:
      return value.message ?? "";
  }
}
