#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/nodes/session_node.h"
#include "services/nodes/solver_node.h"
#include "tests/nodes/bus_process.h"
#include "tests/nodes/session_world.h"
#include "tests/unit/solve/board_world.h"

namespace rgbdt::test {

inline constexpr int kViews = 6;

inline const BoardWorld& Boards() {
  static const BoardWorld world = MakeBoardWorld(kViews);
  return world;
}

inline const Rig& OneCamera() {
  static const Rig rig = [] {
    Rig one = simulate::Simulator(TinyOptions()).rig();
    CameraSpec camera = Boards().spec;
    camera.camera_from_lidar_guess = GuessOff(Boards().camera_from_lidar, 0.02, 0.03, 5);
    camera.format = one.cameras[0].format;
    one.cameras = {camera};
    return ParseRig(PrintRig(one), "test rig");
  }();
  return rig;
}

inline CalibrateOptions ByPaper() {
  CalibrateOptions options;
  options.method = kPaperMethod;
  return options;
}

inline SessionScript ManyViews() {
  SessionScript script;
  for (int i = 0; i < kViews; ++i) {
    for (const SessionStep::Kind kind :
         {SessionStep::Kind::kNextPose, SessionStep::Kind::kSweep, SessionStep::Kind::kCapture}) {
      script.steps.push_back(Step(kind));
    }
    script.steps.back().heldout = Boards().views.at(static_cast<std::size_t>(i)).heldout;
  }
  for (const SessionStep::Kind kind :
       {SessionStep::Kind::kSolve, SessionStep::Kind::kEvaluate, SessionStep::Kind::kSave}) {
    script.steps.push_back(Step(kind));
  }
  return script;
}

using Solver = Process<SolverNode>;

/// Session and solver on the in-memory bus, simulator, assembler, detector and fuser made up: of
/// the boards' views. What the sensors give is a function of the view alone. Each can be killed at
/// any command and comes back some seconds later, having forgotten all.
class RestartWorld {
 public:
  using OnCommand = std::function<void(const SessionCommand&, RestartWorld*)>;

  RestartWorld(std::filesystem::path directory, OnCommand on_command)
      : directory_(std::move(directory)), on_command_(std::move(on_command)) {
    StartSession();
    StartSolver();
    bus_.Subscribe("CLOUD",
                   [this](const std::string& channel, const std::uint8_t* data, std::size_t size) {
                     OnChunk(std::get<CloudChunk>(Decode(channel, data, size)));
                   });
    bus_.Subscribe("SESSION_COMMAND",
                   [this](const std::string& channel, const std::uint8_t* data, std::size_t size) {
                     Answer(std::get<SessionCommand>(Decode(channel, data, size)));
                   });
  }

  /// Until the session ends, or a minute is over.
  void Run() {
    for (; turn_ < 600 && !(session_ && session_->node.finished()); ++turn_) {
      const Utime now = turn_ * kMicrosecondsPerSecond / 10;
      if (turn_ == starts_solver_at_) StartSolver();
      if (turn_ == starts_session_at_) StartSession();
      for (auto& [process, others] : others_) {
        if (turn_ < others.back_at) {
          others.statuses += others.goes_on ? 1 : 0;
          continue;
        }
        Status status = Ready(process);
        status.seq = others.statuses++;
        Send(status);
      }
      if (session_) session_->runner.Advance(now);
      if (solver_) solver_->runner.Advance(now);
      bus_.Run();
    }
  }

  void KillSolver() { solver_.reset(); }
  void StartSolver() { solver_ = std::make_unique<Solver>(&bus_, ByPaper()); }
  void StartSolverInSeconds(int seconds) { starts_solver_at_ = turn_ + 10 * seconds; }
  /// What it wrote stays. Between two messages, so not from within one that it handles.
  void KillSession(int seconds) {
    session_.reset();
    starts_session_at_ = turn_ + 10 * seconds;
  }
  void StartSession() {
    session_ = std::make_unique<Process<SessionNode>>(
        &bus_, ManyViews(), OneCamera(), directory_, SessionNode::OnProgress(),
        SessionNode::BoardStands(), SessionIdentity{++sessions_, "", 0});
    session_->runner.SetProblemHandler(
        [this](const std::string& problem) { problems_.push_back(problem); });
  }
  /// simulator, assembler, detector or fuser.
  void Kill(const std::string& process, int seconds) {
    others_[process] = {turn_ + 10 * seconds, 0, false};
    if (process == "detector") detector_ = {};
  }
  /// Its machine: it hears nobody and is not heard, and goes on.
  void CutOff(const std::string& process, int seconds) {
    others_[process] = {turn_ + 10 * seconds, others_[process].statuses, true};
    if (process == "detector") detector_ = {};
  }
  void Send(const Message& message) { bus_.Publish(ChannelOf(message), Encode(message)); }
  void LeaveOut(const std::string& view) {
    LeftOutViews left_out;
    left_out.views = {view};
    Send(left_out);
  }

  const SessionNode& session() const { return session_->node; }
  const Solver& solver() const { return *solver_; }
  const std::vector<std::string>& problems() const { return problems_; }
  const std::vector<SessionCommand>& commands() const { return world_.commands; }
  double seconds() const { return turn_ / 10.0; }

 private:
  struct Other {
    int back_at = 0;  // turn
    std::int64_t statuses = 0;
    bool goes_on = false;  // while it is away
  };

  bool Lives(const std::string& process) const { return turn_ >= others_.at(process).back_at; }

  // What the session says again; images came before.
  void OnChunk(const CloudChunk& chunk) {
    if (chunk.seq != kSaidAgain || !Lives("detector")) return;
    detector_.has_sweep = true;
    if (detector_.capture) Detect(*detector_.capture);
  }

  void SayView() {
    if (!Lives("detector") || !detector_.detected || !detector_.has_sweep) return;
    Image image = Blank(OneCamera().cameras[0], world_.now);
    CloudChunk chunk = detector_.chunk;
    image.seq = chunk.seq = kSaidAgain;
    Send(image);
    Send(chunk);
    Detect(*detector_.detected);
  }

  void Answer(const SessionCommand& command) {
    const bool of_view =
        command.verb == SessionVerb::kSweep || command.verb == SessionVerb::kCapture;
    if (of_view) {
      world_.now = kStart + std::stoi(command.view) * 20 * kMicrosecondsPerSecond +
                   (command.verb == SessionVerb::kCapture ? 2 * kMicrosecondsPerSecond : 0);
    }
    const Messages answer = of_view ? world_.Answer(command) : Messages();
    if (!of_view) world_.commands.push_back(command);
    on_command_(command, this);
    if (command.verb == SessionVerb::kSayView) SayView();
    if (command.verb == SessionVerb::kNextPose && Lives("simulator")) {
      Send(world_.Event(command, "simulator"));
    }
    if (command.verb == SessionVerb::kSweep) {
      const bool whole = Lives("simulator") && Lives("assembler");
      for (const Message& message : answer) {
        const auto* chunk = std::get_if<CloudChunk>(&message);
        if (chunk != nullptr) detector_.chunk = *chunk;
        if (chunk != nullptr ? whole : Lives("simulator")) Send(message);
      }
      detector_.has_sweep = whole && Lives("detector");
    }
    if (command.verb != SessionVerb::kCapture || !Lives("simulator")) return;
    Send(Blank(OneCamera().cameras[0], world_.now));
    if (!Lives("detector")) return;
    detector_.capture = command;
    if (detector_.has_sweep) Detect(command);
  }

  void Detect(const SessionCommand& command) {
    ViewDetection detection =
        Boards().views.at(static_cast<std::size_t>(std::stoi(command.view) - 1));
    detection.view = command.view;
    detection.sweep_utime = command.sweep_utime;
    detection.seq = detections_++;
    detection.images[0].utime = world_.now;
    detection.cloud.candidates[0].normal = {-1, 0, 0};
    detector_.detected = command;
    detector_.capture.reset();
    Send(detection);
    Send(world_.Event(command, "detector"));
  }

  std::filesystem::path directory_;
  OnCommand on_command_;
  MemoryBus bus_;
  World world_;
  std::unique_ptr<Process<SessionNode>> session_;
  std::unique_ptr<Solver> solver_;
  std::map<std::string, Other> others_ = {
      {"assembler", {}}, {"detector", {}}, {"fuser", {}}, {"simulator", {}}};
  struct Detector {
    bool has_sweep = false;
    CloudChunk chunk;
    std::optional<SessionCommand> capture, detected;  // asked for; done
  };
  Detector detector_;
  std::vector<std::string> problems_;
  std::int64_t sessions_ = 0, detections_ = 0;
  int turn_ = 0, starts_solver_at_ = -1, starts_session_at_ = -1;
};

}  // namespace rgbdt::test
