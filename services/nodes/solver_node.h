#pragma once

#include <map>
#include <optional>
#include <string>

#include "calib/methods/calibrate.h"
#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "services/runtime/node.h"

namespace rgbdt {

/// DETECTION -> CALIBRATION and REPORT. Solves again after each view, always from the first guess
/// and from all views so far, so the order in which they came does not matter; a detection of a
/// view seen before replaces it. SESSION_COMMAND: solve and evaluate are answered with an event and
/// the report, reset forgets all. The calibration is repeated at 1 Hz. A camera that was not solved
/// yet has no calibration on the bus.
class SolverNode : public Node {
 public:
  explicit SolverNode(CalibrateOptions options = {});

  std::string name() const override { return "solver"; }
  std::vector<std::string> Subscriptions() const override {
    return {"RIG", "DETECTION", "SESSION_COMMAND"};
  }
  Messages Handle(const Message& message) override;
  Messages Republish() override;
  Status GetStatus() const override;

  /// The newest report; none before the first view.
  const std::optional<Report>& report() const { return report_; }

 private:
  void Solve(bool for_report);  // for a report: with a second start, folds, the next view
  Messages Calibrations() const;
  Messages OnCommand(const SessionCommand& command);

  CalibrateOptions options_;
  std::optional<Rig> rig_;
  std::map<std::string, ViewDetection> detections_;  // by view
  std::optional<Report> report_;
};

}  // namespace rgbdt
