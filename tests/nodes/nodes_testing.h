#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "calib/files/schema/rig_file.h"
#include "calib/model/said_again.h"
#include "calib/simulate/simulator.h"
#include "services/messages/codec.h"
#include "services/messages/status_counters.h"
#include "services/runtime/node.h"

namespace rgbdt::test {

/// The simulator's rig, with half the colour camera's resolution: good enough to calibrate.
inline simulate::Options HalfSizeOptions() {
  simulate::Options options;
  simulate::CameraOptions& rgb = options.cameras.front();
  rgb.width /= 2;
  rgb.height /= 2;
  rgb.lens.fx /= 2;
  rgb.lens.fy /= 2;
  rgb.lens.cx = (rgb.lens.cx + 0.5) / 2 - 0.5;
  rgb.lens.cy = (rgb.lens.cy + 0.5) / 2 - 0.5;
  return options;
}

/// Small and fast, for what does not look for the board: 25 lines of 40 beams in one second,
/// images of 96x72 and 64x48.
inline simulate::Options TinyOptions() {
  simulate::Options options;
  options.scanner.beams = 40;
  options.scanner.angle_step_rad = 2 * simulate::kDegree;
  options.scanner.beam_period_s = 1e-3;
  options.scanner.motor_speed_rad_s = 60 * simulate::kDegree;
  options.supersampling = 1;
  for (simulate::CameraOptions& camera : options.cameras) {
    const double scale = (camera.kind == CameraKind::kColor ? 96.0 : 64.0) / camera.width;
    camera.width = camera.kind == CameraKind::kColor ? 96 : 64;
    camera.height = camera.width * 3 / 4;
    camera.lens.fx *= scale;
    camera.lens.fy *= scale;
    camera.lens.cx *= scale;
    camera.lens.cy *= scale;
  }
  return options;
}

/// The rig as everybody reads it from the bus.
inline Rig RigOf(const simulate::Simulator& simulator) {
  return ParseRig(PrintRig(simulator.rig()), "synthetic rig");
}

inline const simulate::Simulator& TinySimulator() {
  static const simulate::Simulator simulator(TinyOptions());
  return simulator;
}

inline const Rig& TinyRig() {
  static const Rig rig = RigOf(TinySimulator());
  return rig;
}

/// A whole sweep of two points.
inline CloudChunk SweepOfTwo(Utime sweep) {
  CloudChunk chunk;
  chunk.cloud.sweep_utime = sweep;
  chunk.cloud.lines = 1;
  chunk.cloud.beams = 2;
  chunk.cloud.points = {{3, 0, 0}, {3, 1, 0}};
  chunk.cloud.utime = {sweep, sweep + 1};
  chunk.sweep_end = true;
  chunk.sweep_lines = 1;
  return chunk;
}

inline RigText TextOf(const Rig& rig) { return {0, rig.hash, rig.text}; }

/// The messages of one type among many.
template <typename T>
std::vector<T> Only(const Messages& messages) {
  std::vector<T> found;
  for (const Message& message : messages) {
    if (const T* one = std::get_if<T>(&message)) found.push_back(*one);
  }
  return found;
}

/// Hands messages over one after the other; what comes back.
inline Messages HandleAll(Node* node, const Messages& messages) {
  Messages out;
  for (const Message& message : messages) {
    for (Message& answer : node->Handle(message)) out.push_back(std::move(answer));
  }
  return out;
}

/// Messages as bytes: equal exactly when they are the same, bit for bit, NaN included.
inline std::vector<Bytes> BytesOf(const Messages& messages) {
  std::vector<Bytes> bytes;
  for (const Message& message : messages) bytes.push_back(Encode(message));
  return bytes;
}

/// A counter of a status; -1 where there is none of that name.
inline std::int64_t Counter(const Status& status, const std::string& name) {
  return CounterOf(status, name, -1);
}

}  // namespace rgbdt::test
