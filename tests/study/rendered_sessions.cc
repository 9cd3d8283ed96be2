#include "tests/study/rendered_sessions.h"

#include <string>

#include "calib/methods/detect_view.h"
#include "calib/simulate/imperfections.h"
#include "calib/simulate/internal/noise.h"
#include "calib/simulate/simulator.h"
#include "services/simulator/simulated_sweep.h"
#include "services/simulator/simulator_node.h"
#include "tests/study/sampled_sessions.h"

namespace rgbdt::study {
namespace {

using simulate::Simulator;

simulate::Options OptionsOf(const RenderedOptions& rendered, std::uint64_t seed) {
  simulate::Options options;
  options.seed = seed;
  options.scene = static_cast<simulate::Scene>(seed % 3);
  options.threads = 1;  // the study runs one program on each core
  simulate::UseLidar(rendered.rings, &options);
  if (rendered.board) options.board = *rendered.board;
  if (rendered.random_physics) DrawPhysics(RandomPhysics(), seed, &options);
  return options;
}

View TakeView(const Simulator& simulator, bool spinning, const std::string& name, Utime* now) {
  View view;
  view.name = name;
  if (spinning) {
    view.cloud = simulator.Revolution(*now);
    *now += kMicrosecondsPerSecond;
  } else {
    view.cloud = TakeSweep(simulator, *now);
    *now += simulator.sweep_lines() * simulator.line_period() + kMicrosecondsPerSecond;
  }
  for (const CameraSpec& camera : simulator.rig().cameras) {
    view.images.push_back(simulator.TakeImage(camera.name, *now));
  }
  *now += kMicrosecondsPerSecond;
  return view;
}

BeamModel ModelOf(const simulate::Options& options) {
  const simulate::BeamOptions* beam = &options.scanner;
  BeamModel model;
  if (options.spinning) {
    beam = &*options.spinning;
    model.beams_meet_m = options.spinning->beams_meet_m;
  }
  model.range_offset_m = -beam->range_offset_m;
  model.dark_range_m = beam->dark_range_m;
  return model;
}

}  // namespace

void DrawPhysics(const RandomPhysics& ranges, std::uint64_t seed, simulate::Options* options) {
  const simulate::Noise noise(seed, 0, "physics");
  std::uint64_t next = 0;
  const auto draw = [&](const RandomPhysics::Range& range) {
    return noise.Uniform(next++, range.low, range.high);
  };
  simulate::BoardOptions& board = options->board;
  board.black_reflectivity = draw(ranges.black_reflectivity);
  board.white_reflectivity = draw(ranges.white_reflectivity);
  board.black_minus_white_k = draw(ranges.black_minus_white_k);
  board.thickness_m = draw(ranges.thickness_m);
  const RandomPhysics::Board& size = ranges.boards[noise.Bits(next++) % ranges.boards.size()];
  board.squares_x = size.squares_x;
  board.squares_y = size.squares_y;
  board.square_m = size.square_m;
  board.width_m = size.width_m;
  board.height_m = size.height_m;
  for (simulate::CameraOptions& camera : options->cameras) {
    camera.blur_px *= draw(ranges.blur_times);
    const double focal = draw(ranges.focal_times);
    camera.lens.fx *= focal;
    camera.lens.fy *= focal;
    const double distortion = draw(ranges.distortion_times);
    for (double& k : camera.lens.distortion) k *= distortion;
  }
  MakeImperfect(options);
}

RenderedSession RenderSession(const RenderedOptions& rendered, std::uint64_t seed) {
  const simulate::Options options = OptionsOf(rendered, seed);
  Simulator simulator(options);
  RenderedSession session;
  session.rig = simulator.rig();
  Utime now = SimulatorNode::kEpoch;
  for (int i = 0; i < rendered.views + rendered.heldout; ++i) {
    const std::string name = ViewName(i);
    simulator.ShowView(i, name);
    View view = TakeView(simulator, options.spinning.has_value(), name, &now);
    view.heldout = IsHeldOut(i, rendered.views, rendered.heldout);
    session.detections.push_back(DetectView(session.rig, view));
  }
  session.truth = simulator.truth();
  session.model = ModelOf(options);
  return session;
}

}  // namespace rgbdt::study
