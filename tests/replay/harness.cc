#include "tests/replay/harness.h"

#include <stdexcept>

#include "calib/files/schema/calibration_file.h"
#include "calib/present/report/verdict.h"
#include "tests/nodes/nodes_testing.h"

namespace rgbdt::test {

Services::Services(Bus* bus)
    : assembler_runner(&assembler, bus),
      detector_runner(&detector, bus),
      solver_runner(&solver, bus),
      fuser_runner(&fuser, bus) {}

std::vector<NodeRunner*> Services::runners() {
  return {&assembler_runner, &detector_runner, &solver_runner, &fuser_runner};
}

std::int64_t Services::gaps() const {
  return assembler_runner.gaps() + detector_runner.gaps() + solver_runner.gaps() +
         fuser_runner.gaps();
}

std::int64_t Services::dropped() const {
  return assembler_runner.dropped() + detector_runner.dropped() + solver_runner.dropped() +
         fuser_runner.dropped();
}

std::string CalibrationOf(const SolverNode& solver) {
  if (!solver.report()) return "";
  return PrintCalibration(JudgedCalibration(*solver.report(), *solver.rig()));
}

SessionScript MakeScript(int views) {
  SessionScript script;
  const auto add = [&](SessionStep::Kind kind) {
    script.steps.emplace_back();
    script.steps.back().kind = kind;
    return &script.steps.back();
  };
  for (int view = 0; view < views; ++view) {
    add(SessionStep::Kind::kNextPose);
    add(SessionStep::Kind::kSweep);
    SessionStep* capture = add(SessionStep::Kind::kCapture);
    capture->heldout = view % 3 == 2;
    capture->picked_cameras = {"thermal"};
  }
  add(SessionStep::Kind::kSolve);
  add(SessionStep::Kind::kEvaluate);
  add(SessionStep::Kind::kSave);
  return script;
}

SessionRun RunSession(const simulate::Options& options, const SessionScript& script,
                      const std::filesystem::path& directory) {
  SessionRun run;
  MemoryBus bus;
  bus.Subscribe(".*", [&](const std::string& channel, const std::uint8_t* data, std::size_t size) {
    run.recording.push_back({channel, Bytes(data, data + size)});
  });
  SimulatorNode simulator(options);
  run.rig = RigOf(simulator.simulator());
  SessionNode session(script, run.rig, directory, {});
  Services services(&bus);
  NodeRunner simulator_runner(&simulator, &bus);
  NodeRunner session_runner(&session, &bus);
  std::vector<NodeRunner*> runners = services.runners();
  runners.push_back(&session_runner);
  runners.push_back(&simulator_runner);
  constexpr Utime kTurn = 10'000;
  constexpr Utime kLongest = 3600 * kMicrosecondsPerSecond;
  for (Utime now = 0; now < kLongest && !session.finished(); now += kTurn) {
    for (NodeRunner* runner : runners) runner->Advance(now);
    bus.Run();
  }
  if (!session.finished()) throw std::runtime_error("the session did not end");
  run.failure = session.failure();
  run.calibration = CalibrationOf(services.solver);
  run.truth = simulator.simulator().truth();
  run.gaps = services.gaps() + session_runner.gaps() + simulator_runner.gaps();
  run.dropped = services.dropped() + session_runner.dropped() + simulator_runner.dropped();
  return run;
}

void Feed(const Recording& recording, Replay* replay) {
  for (const Recorded& message : recording) replay->Take(message.channel, message.bytes);
}

}  // namespace rgbdt::test
