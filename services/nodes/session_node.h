#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "calib/files/session_script.h"
#include "calib/model/rig.h"
#include "services/nodes/node.h"
#include "services/nodes/view_collector.h"

namespace rgbdt {

/// How far a session is, for a person.
struct SessionProgress {
  int step = 0;  ///< 1 to steps
  int steps = 0;
  std::string text;
  double fraction = 0;  ///< of this step
};

/// Runs a scripted session: sends commands, waits for the answering events, writes the session
/// directory (the one node that writes files). STATUS, SESSION_EVENT, CLOUD, <CAMERA>_IMAGE,
/// CORNER_SELECTION, REPORT -> RIG, SESSION_COMMAND.
/// It begins when assembler, detector, solver, fuser and the processes of the devices that the rig
/// file names say that they are ready. next_pose and
/// sweep end with anybody's done, capture with the detector's and the view on disk, solve and
/// evaluate with the solver's. Save writes the report, and the calibration
/// of the cameras that were solved. A failed event, no answer in the step's time, a camera that
/// could not be solved, or a file that cannot be written ends the session with the reason. The wall
/// clock is handed in, it serves time-outs only.
class SessionNode : public Node {
 public:
  using OnProgress = std::function<void(const SessionProgress&)>;

  /// Throws InputError where the script makes no sense, and where `directory` holds views already:
  /// two sessions' views must not mix.
  SessionNode(SessionScript script, Rig rig, std::filesystem::path directory, OnProgress progress);

  std::string name() const override { return "session"; }
  std::vector<std::string> Subscriptions() const override {
    return {"STATUS", "SESSION_EVENT", "CLOUD", ".*_IMAGE", "CORNER_SELECTION", "REPORT"};
  }
  Messages Handle(const Message& message) override;
  Messages Republish() override;
  Status GetStatus() const override;

  /// Goes on as far as possible; `wall_s` [s] only grows.
  Messages Advance(double wall_s);

  /// The board is to be carried to its next place; PoseIsSet() says that it stands there, where
  /// nobody on the bus does.
  bool WaitsForPose() const;
  void PoseIsSet();

  bool finished() const { return finished_; }
  const std::string& failure() const { return failure_; }  ///< empty: none so far

 private:
  const SessionStep& step() const { return script_.steps[index_]; }
  Messages Begin();
  Messages BeginCapture();
  Messages Send(SessionVerb verb);
  bool StepDone();
  void Take(const Message& message);
  void OnEvent(const SessionEvent& event);
  void SaveView();
  void Save();
  void Fail(const std::string& why);
  void Say(const std::string& text, double fraction);
  std::vector<std::string> Needed() const;
  std::string WhoIsNotReady() const;
  std::string WhatIsMissing() const;

  SessionScript script_;
  Rig rig_;
  std::filesystem::path directory_;
  OnProgress progress_;

  std::map<std::string, Status> statuses_;
  Utime newest_utime_ = 0;
  double now_s_ = 0;  // wall clock, newest handed in
  double step_began_s_ = 0;
  bool started_ = false;  // everybody was ready
  bool waiting_ = false;  // the step at hand was begun
  std::size_t index_ = 0;
  std::int64_t command_ = 0;
  bool answered_ = false;
  int view_number_ = 0;
  std::string view_;
  Utime sweep_utime_ = 0;
  ViewCollector collector_;
  bool view_saved_ = false;
  std::optional<ReportText> report_;
  bool finished_ = false;
  std::string failure_;
};

}  // namespace rgbdt
