#include "services/simulator/simulated_sweep.h"

#include <utility>
#include <vector>

#include "calib/scan_assembly/encoder_track.h"
#include "calib/scan_assembly/line_to_cloud.h"
#include "calib/scan_assembly/sweep_chunks.h"
#include "services/simulator/simulator_node.h"

namespace rgbdt {

Cloud TakeSweep(const simulate::Simulator& simulator, Utime sweep_utime) {
  const TurnedScanner& scanner = *simulator.rig().lidar.turned_scanner;
  const Utime end = sweep_utime + simulator.sweep_lines() * simulator.line_period();
  EncoderTrack track;
  // One reading after the last beam: between two of them the angle is known.
  for (Utime t = sweep_utime; t < end + SimulatorNode::kEncoderPeriod;
       t += SimulatorNode::kEncoderPeriod) {
    track.Add(simulator.Encoder(t, sweep_utime));
  }
  std::vector<CloudChunk> chunks;
  for (int i = 0; i < simulator.sweep_lines(); ++i) {
    const LineScan line = simulator.Line(sweep_utime, i);
    const auto angles = BeamAngles(scanner, track, line, kMicrosecondsPerSecond);
    CloudChunk chunk;
    chunk.cloud = LineToCloud(scanner, line, angles.value());
    chunk.cloud.first_line = i;
    chunks.push_back(std::move(chunk));
  }
  Cloud cloud = JoinChunks(chunks);
  cloud.sweep_utime = sweep_utime;
  return cloud;
}

}  // namespace rgbdt
