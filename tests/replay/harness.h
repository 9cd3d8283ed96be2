#pragma once

// A whole session in one process: the simulator's node, the services' nodes and the session's on
// the in-memory bus, each behind its own NodeRunner, as the processes are on LCM.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "calib/files/schema/session_script.h"
#include "services/bus/bus.h"
#include "services/nodes/assembler_node.h"
#include "services/nodes/detector_node.h"
#include "services/nodes/fuser_node.h"
#include "services/nodes/session_node.h"
#include "services/nodes/solver_node.h"
#include "services/replay/replay.h"
#include "services/runtime/node_runner.h"
#include "services/simulator/simulator_node.h"

namespace rgbdt::test {

/// A message as it crossed the bus.
struct Recorded {
  std::string channel;
  Bytes bytes;
};
using Recording = std::vector<Recorded>;

/// Assembler, detector, solver, fuser on a bus.
struct Services {
  explicit Services(Bus* bus);

  AssemblerNode assembler;
  DetectorNode detector;
  SolverNode solver;
  FuserNode fuser;
  NodeRunner assembler_runner, detector_runner, solver_runner, fuser_runner;

  std::vector<NodeRunner*> runners();
  std::int64_t gaps() const;
  std::int64_t dropped() const;
};

/// calibration.textproto of what the solver has.
std::string CalibrationOf(const SolverNode& solver);

/// `views` views, the third and every third after it held out, thermal corners picked by a person.
SessionScript MakeScript(int views);

struct SessionRun {
  Recording recording;
  std::string failure;
  std::string calibration;  ///< calibration.textproto of what the solver had
  Rig rig;
  Truth truth;
  std::int64_t gaps = 0, dropped = 0;
};

/// Runs a session into `directory`.
SessionRun RunSession(const simulate::Options& options, const SessionScript& script,
                      const std::filesystem::path& directory);

/// All of a recording, in order.
void Feed(const Recording& recording, Replay* replay);

}  // namespace rgbdt::test
