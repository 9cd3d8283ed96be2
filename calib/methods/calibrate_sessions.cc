#include "calib/methods/calibrate_sessions.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "calib/methods/internal/lidar_parts.h"
#include "calib/methods/internal/report_parts.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "calib/solve/by_boards.h"

namespace rgbdt {
namespace {

// The comparison of two sessions, begun where there is none yet.
CalibrationComparison* Between(const Report& a, const std::string& a_name, const Report& b,
                               const std::string& b_name,
                               std::vector<CalibrationComparison>* comparisons) {
  const auto found = std::find_if(comparisons->begin(), comparisons->end(), [&](const auto& both) {
    return both.a == a_name && both.b == b_name;
  });
  if (found != comparisons->end()) return &*found;
  CalibrationComparison& begun = comparisons->emplace_back();
  begun.a = a_name;
  begun.b = b_name;
  begun.utime_a = a.utime;
  begun.utime_b = b.utime;
  return &begun;
}

std::string MovedText(const PoseComparison& camera, const CalibrationComparison& sessions) {
  return Format(
      "The sessions contradict each other: %s puts this camera %.2f deg and %.1f mm from where %s "
      "does (chi-square %.0f where 6 is expected). If the mount was touched in between, "
      "--mounts-moved gives each session poses of its own.",
      sessions.b.c_str(), camera.difference.rotation_deg, camera.difference.translation_mm,
      sessions.a.c_str(), *camera.chi2);
}

}  // namespace

CalibratedSessions CalibrateSessions(const Rig& rig, const std::vector<SessionViews>& sessions,
                                     const CalibrateOptions& options) {
  options.Check();
  if (options.method != kAutoMethod) {
    throw InputError("method \"" + options.method +
                     "\" cannot solve sessions that differ in their poses; expected \"auto\"");
  }
  std::vector<CameraViews> cameras;
  for (const SessionViews& session : sessions) {
    std::vector<CameraViews> own = ViewsOfCameras(rig, session.detections);
    std::move(own.begin(), own.end(), std::back_inserter(cameras));
  }
  for (const LidarSpec& lidar : rig.further_lidars) {
    SayNotCalibrated(lidar.name, "mounts that may have moved are solved for cameras alone",
                     &cameras);
  }
  CalibratedCameras calibrated =
      CalibrateByBoards(rig.target, WithRig(options, rig), std::move(cameras));
  CalibratedSessions out;
  const std::size_t count = rig.cameras.size();
  for (std::size_t s = 0; s < sessions.size(); ++s) {
    Report& report =
        out.reports.emplace_back(BlankReport(rig, options.method, sessions[s].detections));
    for (std::size_t c = 0; c < count; ++c) {
      AddCamera(std::move(calibrated.cameras[s * count + c]), &report);
    }
  }
  for (MountChange& change : calibrated.changes) {
    const std::size_t a = change.from / count;
    const std::size_t b = change.to / count;
    Between(out.reports[a], sessions[a].name, out.reports[b], sessions[b].name, &out.comparisons)
        ->cameras.push_back(std::move(change.moved));
  }
  return out;
}

Report WithChanges(Report report, const std::vector<CalibrationComparison>& comparisons) {
  std::size_t count = 0;
  for (const CalibrationComparison& sessions : comparisons) count += sessions.cameras.size();
  // Of many comparisons some are unlikely.
  const auto certain = [&](const PoseComparison& moved) {
    return moved.chi2 && ChanceOfChi2(*moved.chi2) * static_cast<double>(count) < kMovedChance;
  };
  for (CameraReport& camera : report.cameras) {
    for (const CalibrationComparison& sessions : comparisons) {
      for (const PoseComparison& moved : sessions.cameras) {
        if (moved.camera != camera.calibration.camera || !certain(moved)) continue;
        if (!camera.contradiction.empty()) camera.contradiction += " ";
        camera.contradiction += MovedText(moved, sessions);
      }
    }
  }
  return report;
}

}  // namespace rgbdt
