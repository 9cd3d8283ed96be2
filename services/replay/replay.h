#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "services/bus/bus.h"
#include "services/nodes/assembler_node.h"
#include "services/nodes/detector_node.h"
#include "services/nodes/fuser_node.h"
#include "services/nodes/solver_node.h"
#include "services/runtime/node_runner.h"

namespace rgbdt {

/// The nodes of the live processes on the in-memory bus, fed with what a log holds of sensors,
/// people and the session. Their time is the newest in a message, so the same log gives the same
/// bytes at any speed.
class Replay {
 public:
  /// Throws InputError for an unknown method. `use`: which calibrations are fused by.
  explicit Replay(const std::string& method, Use use = Use::kIfSound);

  /// A message of the log, in the log's order; true: it was of use. All that nodes made live is
  /// left out: they make it again. So is CLOUD in a log with lines, CALIBRATION in a log of a
  /// session, and what was said again for a process that had been started anew: here none was.
  bool Take(const std::string& channel, const Bytes& bytes);
  /// After the last one: what waits for others is done without them.
  void Finish();

  const SolverNode& solver() const { return solver_; }
  const FuserNode& fuser() const { return fuser_; }
  /// Assembler, detector, solver, fuser.
  const std::array<NodeRunner*, 4>& runners() const { return runners_; }
  /// For who subscribes to what the nodes publish.
  MemoryBus& bus() { return bus_; }
  bool took_calibration() const { return took_calibration_; }

 private:
  bool IsOfUse(const std::string& channel);

  MemoryBus bus_;
  AssemblerNode assembler_;
  DetectorNode detector_;
  SolverNode solver_;
  FuserNode fuser_;
  NodeRunner assembler_runner_, detector_runner_, solver_runner_, fuser_runner_;
  std::array<NodeRunner*, 4> runners_;
  bool has_lines_ = false, has_session_ = false, took_calibration_ = false;
};

}  // namespace rgbdt
