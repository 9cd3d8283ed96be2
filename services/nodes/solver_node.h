#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>

#include "calib/methods/calibrate.h"
#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "services/runtime/node.h"
#include "services/runtime/periodic.h"

namespace rgbdt {

/// DETECTION -> CALIBRATION and REPORT. Solves again after each view, always from the first guess
/// and from all views so far, so the order in which they came does not matter; a detection of a
/// view seen before replaces it. LEFT_OUT_VIEWS names views that are left out from then on, until
/// the next one or a reset; it is answered with CALIBRATION and REPORT. SESSION_COMMAND: solve and
/// evaluate are answered with an event and the report, reset forgets all. The calibration is
/// repeated once a second. A camera that was not solved yet has no calibration on the bus.
class SolverNode : public Node {
 public:
  explicit SolverNode(CalibrateOptions options = {});

  std::string name() const override { return "solver"; }
  std::vector<std::string> Subscriptions() const override {
    return {"RIG", "DETECTION", "SESSION_COMMAND", "LEFT_OUT_VIEWS"};
  }
  Messages Handle(const Message& message) override;
  Messages Advance(Utime now) override;
  Status GetStatus() const override;

  /// The newest report; none before the first view.
  const std::optional<Report>& report() const { return report_; }
  /// Its rig; none before it is known.
  const std::optional<Rig>& rig() const { return rig_; }

 private:
  using Detections = std::map<std::string, ViewDetection>;  // by view

  // For a report: with a second start, folds, the next view.
  Report Solve(const Detections& detections, bool for_report) const;
  void Forget();
  Messages OnLeftOut(const LeftOutViews& message);
  ReportText ReportMessage() const;
  Messages Calibrations() const;
  Messages OnCommand(const SessionCommand& command);

  CalibrateOptions options_;
  std::optional<Rig> rig_;
  Detections detections_;
  std::set<std::string> left_out_;
  std::optional<Report> report_;
  Periodic repeat_{kMicrosecondsPerSecond};
};

}  // namespace rgbdt
