#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>

#include "calib/methods/calibrate.h"
#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "services/runtime/node.h"
#include "services/runtime/periodic.h"

namespace rgbdt {

/// OBSERVATION -> CALIBRATION and REPORT. Solves again after each observation, always from the
/// rig's guess and from all observations so far, so the order in which they came does not matter;
/// an observation of a view and camera seen before replaces it. SESSION_COMMAND: solve and evaluate
/// are answered with an event and the report, reset forgets all. The calibration is repeated once a
/// second. A camera that was not solved yet has no calibration on the bus.
class SolverNode : public Node {
 public:
  explicit SolverNode(CalibrateOptions options = {});

  std::string name() const override { return "solver"; }
  std::vector<std::string> Subscriptions() const override {
    return {"RIG", "OBSERVATION", "SESSION_COMMAND"};
  }
  Messages Handle(const Message& message) override;
  Messages Advance(Utime now) override;
  Status GetStatus() const override;

  /// The newest report; none before the first observation.
  const std::optional<Report>& report() const { return report_; }

 private:
  using Observations = std::map<std::pair<std::string, std::string>, Observation>;  // view, camera

  // For a report: with a second start, folds, the next view.
  Report Solve(const Observations& observations, bool for_report) const;
  Messages Calibrations() const;
  Messages OnCommand(const SessionCommand& command);

  CalibrateOptions options_;
  std::optional<Rig> rig_;
  Observations observations_;
  std::optional<Report> report_;
  Periodic repeat_{kMicrosecondsPerSecond};
};

}  // namespace rgbdt
