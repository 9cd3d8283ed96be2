#pragma once

#include <string>

#include "calib/model/rig.h"
#include "calib/model/view_detection.h"
#include "calib/scan_assembly/line_to_cloud.h"
#include "calib/scan_assembly/sweep_chunks.h"
#include "calib/simulate/simulator.h"

namespace rgbdt {

/// A rendered view of the synthetic rig with everything that is known of it.
struct SyntheticView {
  Rig rig;
  Truth truth;
  View view;
  CornerSelection thermal_picks;
};

/// The default rig's view `index`, assembled from scan lines as on the bus.
inline SyntheticView MakeView(int index, std::uint64_t seed = 1) {
  simulate::Options options;
  options.seed = seed;
  simulate::Simulator simulator(options);
  simulator.ShowView(index, "0001");
  SyntheticView made;
  made.rig = simulator.rig();
  made.truth = simulator.truth();
  made.view.name = "0001";
  const Utime start = 1'433'160'000'000'000;
  std::vector<CloudChunk> chunks;
  for (int i = 0; i < simulator.sweep_lines(); ++i) {
    const LineScan line = simulator.Line(start, i);
    std::vector<double> angles;
    for (std::size_t beam = 0; beam < line.range.size(); ++beam) {
      const Utime at = line.utime + FromSeconds(static_cast<double>(beam) * line.beam_period_s);
      const TurnedScanner& scanner = *made.rig.lidar.turned_scanner;
      angles.push_back(
          (static_cast<double>(simulator.Encoder(at, start).ticks) - scanner.zero_ticks) /
          scanner.ticks_per_rad);
    }
    CloudChunk chunk;
    chunk.cloud = LineToCloud(*made.rig.lidar.turned_scanner, line, angles);
    chunk.cloud.first_line = i;
    chunks.push_back(std::move(chunk));
  }
  made.view.cloud = JoinChunks(chunks);
  made.view.cloud.sweep_utime = start;
  for (const CameraSpec& camera : made.rig.cameras) {
    made.view.images.push_back(simulator.TakeImage(camera.name, start + 13'000'000));
  }
  made.thermal_picks = simulator.PickCorners("thermal", start + 13'000'000);
  return made;
}

}  // namespace rgbdt
