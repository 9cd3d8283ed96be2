#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "calib/model/session.h"
#include "calib/present/frames/session_state.h"

namespace rgbdt::viewer {

/// What the session does, what may be asked of it, and how all processes are: from STATUS and
/// SESSION_EVENT. Times [s] are of a steady clock.
class SessionWatch {
 public:
  static constexpr double kGone = 5;  ///< s without a STATUS: the process is gone

  void Add(const Status& status, double now_s);

  /// Sets what an event tells: busy, fraction, failure, log.
  void Add(const SessionEvent& event, SessionState* state);

  /// Sets what is so by now: mode, can, step, steps, busy. Returns whether any of it changed.
  bool Update(double now_s, SessionState* state) const;

  bool Running(const std::string& process, double now_s) const;

  /// The processes of a BusFrame.
  nlohmann::json Processes(double now_s) const;

 private:
  struct Process {
    Status status;
    double received_s;
  };
  std::map<std::string, Process> processes_;
  std::string doing_;  // what the session itself is at
};

}  // namespace rgbdt::viewer
