#include "calib/present/report/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "calib/model/method.h"
#include "calib/model/pose_sigma.h"
#include "calib/present/report/internal/lidar_tables.h"
#include "calib/present/report/said_once.h"
#include "calib/present/report/verdict.h"

namespace rgbdt {
namespace {

constexpr int kLabel = 44;
constexpr int kColumn = 22;
constexpr double kShownDistancesM[] = {2, 5, 10};  // of points, for the projection uncertainty

std::string Number(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "-";
}

std::string Error(const std::optional<PoseError>& error) {
  return error ? fmt::format("{:.3f} deg {:.1f} mm", error->rotation_deg, error->translation_mm)
               : "-";
}

RangeErrors RangeErrorsOf(const CameraReport& camera) {
  return camera.calibration.range_errors.value_or(RangeErrors{});
}

// The same of all points.
std::string Common(const RangeErrors& errors) {
  return errors.offset_m.sigma > 0 ? fmt::format("{:.1f} +- {:.1f}", 1e3 * errors.offset_m.value,
                                                 1e3 * errors.offset_m.sigma)
                                   : "-";
}

// From the least to the most of offsets of rings or intensities.
template <typename Offsets>
std::string Spread(const Offsets& offsets) {
  if (offsets.empty()) return "-";
  const auto [least, most] = std::minmax_element(
      offsets.begin(), offsets.end(),
      [](const auto& a, const auto& b) { return a.offset_m.value < b.offset_m.value; });
  return fmt::format("{:+.0f} to {:+.0f}", 1e3 * least->offset_m.value, 1e3 * most->offset_m.value);
}

// At each of the distances, where it is worst in the image.
std::string ProjectionSigma(const CameraReport& camera) {
  if (!camera.sigma) return "-";
  std::string text;
  for (const double distance_m : kShownDistancesM) {
    const auto& all = camera.sigma->colouring;
    const auto at = std::find_if(all.begin(), all.end(), [&](const ColouringSigma& s) {
      return std::abs(s.distance_m - distance_m) < 1e-6;
    });
    if (!text.empty()) text += " / ";
    text += at == all.end() ? "-" : fmt::format("{:.2f}", at->worst_px);
  }
  return text;
}

// The verdict, and what speaks most against the result. Where to hold the board next, a line of its
// own says.
std::string VerdictLines(const CameraReport& camera, const std::vector<std::string>& told) {
  Verdict verdict = Judge(camera);
  const auto is_told = [&](const std::string& reason) {
    return std::any_of(told.begin(), told.end(), [&](const std::string& why) {
      return reason.find(why) != std::string::npos;
    });
  };
  auto& reasons = verdict.reasons;
  reasons.erase(std::remove_if(reasons.begin(), reasons.end(), is_told), reasons.end());
  std::string lines = fmt::format("{}: {}", camera.calibration.camera, verdict.headline);
  if (verdict.grade == Grade::kGood || reasons.empty()) return lines + "\n";
  lines += " " + reasons.front() + "\n";
  // Without a pose the reasons are those of the rejected views, which are told below.
  const bool below = camera.calibration.status == SolveStatus::kNotSolved;
  if (below || verdict.grade < Grade::kDoubtful || reasons.size() < 2) return lines;
  return lines + "  " + reasons[1] + "\n";
}

// By camera.
using VerdictTexts = std::vector<std::pair<std::string, std::string>>;

// Whether the verdict on each whom a line "NAME, NAME: TEXT" is about has the text.
bool IsSaid(const std::string& line, const VerdictTexts& verdicts) {
  const std::size_t colon = line.find(": ");
  if (colon == std::string::npos) return false;
  const std::string names = ", " + line.substr(0, colon) + ",";
  auto left = std::count(names.begin(), names.end(), ',') - 1;
  for (const auto& [name, text] : verdicts) {
    const bool named = names.find(", " + name + ",") != std::string::npos;
    if (named && text.find(line.substr(colon + 2)) != std::string::npos) --left;
  }
  return left == 0;
}

// What the cameras' columns have no room for, and no verdict has said.
std::string Warnings(const Report& report, const std::vector<std::string>& told,
                     const VerdictTexts& verdicts) {
  std::vector<Said> statuses, rejected, warnings;
  for (const CameraReport& camera : report.cameras) {
    const std::string& name = camera.calibration.camera;
    const std::string& detail = camera.calibration.detail;
    if (camera.calibration.status != SolveStatus::kConverged &&
        (detail.empty() || !IsSaid(name + ": " + detail, verdicts))) {
      statuses.push_back({name, "", camera.calibration.StatusText()});
    }
    for (const RejectedView& view : camera.rejected) {
      if (std::find(told.begin(), told.end(), view.why) != told.end()) continue;
      rejected.push_back({name, view.view, view.why});
    }
    for (const std::string& warning : camera.warnings) warnings.push_back({name, "", warning});
  }
  for (const LidarReport& lidar : report.lidars) {
    const std::string& name = lidar.calibration.lidar;
    for (const RejectedView& view : lidar.rejected) rejected.push_back({name, view.view, view.why});
    for (const std::string& warning : lidar.warnings) warnings.push_back({name, "", warning});
  }
  std::string text;
  for (const auto& [said, what] :
       {std::pair{statuses, ""}, {rejected, "rejected"}, {warnings, ""}}) {
    for (const std::string& line : SaidOnce(said, what)) {
      if (!IsSaid(line, verdicts)) text += line + "\n";
    }
  }
  return text;
}

}  // namespace

bool Summary::converged() const {
  return std::all_of(report_.cameras.begin(), report_.cameras.end(),
                     [](const CameraReport& c) { return c.calibration.converged(); }) &&
         std::all_of(report_.lidars.begin(), report_.lidars.end(),
                     [](const LidarReport& l) { return l.calibration.converged(); });
}

std::string Summary::BriefReport() const {
  std::string text;
  for (const CameraReport& camera : report_.cameras) {
    text += (text.empty() ? "" : "; ") + camera.calibration.camera + ": " +
            camera.calibration.StatusText();
    if (report_.method == kPaperMethod) {
      const TrainHeldout& distance = camera.distance_transform_px;
      if (distance.train) text += fmt::format(", {:.2f} px", *distance.train);
      if (distance.heldout) text += fmt::format(", {:.2f} px on held-out views", *distance.heldout);
    } else if (const ColouringSigma* at = JudgedColouring(camera)) {
      text += fmt::format(", {:.2f} px at {:.0f} m (1 sigma)", at->worst_px, at->distance_m);
    }
  }
  return text;
}

std::string Summary::FullReport(const std::vector<std::string>& told) const {
  std::string text;
  VerdictTexts verdicts;
  for (const CameraReport& camera : report_.cameras) {
    verdicts.emplace_back(camera.calibration.camera, VerdictLines(camera, told));
    text += verdicts.back().second;
  }
  const auto row = [&](const std::string& label,
                       const std::function<std::string(const CameraReport&)>& cell) {
    text += fmt::format("{:<{}}", label, kLabel);
    for (const CameraReport& camera : report_.cameras) {
      text += fmt::format("{:>{}}", cell(camera), kColumn);
    }
    text += "\n";
  };
  row("method " + report_.method, [](const CameraReport& c) { return c.calibration.camera; });
  row("status", [](const CameraReport& c) -> std::string {
    if (c.calibration.status == SolveStatus::kContradicted) return "NOT TO BE USED";
    return c.calibration.converged() ? "converged" : "NOT CONVERGED";
  });
  row("views used / held out / rejected", [](const CameraReport& c) {
    return fmt::format("{} / {} / {}", c.used.size(), c.heldout.size(), c.rejected.size());
  });
  const auto any = [&](auto has) {
    return std::any_of(report_.cameras.begin(), report_.cameras.end(), has);
  };
  if (any([](const CameraReport& c) { return c.calibration.covariance.has_value(); })) {
    row("1 sigma, worst axis",
        [](const CameraReport& c) { return Error(WorstAxisSigma(c.calibration)); });
  }
  if (any([](const CameraReport& c) { return c.sigma.has_value(); })) {
    row("worst projection at 2/5/10 m, 1 sigma [px]", ProjectionSigma);
  }
  if (any([](const CameraReport& c) { return c.edge_rms_whitened.heldout.has_value(); })) {
    row("outline error, held out [sigma, expected 1]",
        [](const CameraReport& c) { return Number(c.edge_rms_whitened.heldout, 2); });
  }
  if (any([](const CameraReport& c) { return c.halves.has_value(); })) {
    row("halves of the views differ by", [](const CameraReport& c) {
      return c.halves ? Error(c.halves->difference) : std::string("-");
    });
  }
  if (report_.method == kPaperMethod) {
    row("distance transform, views used [px]",
        [](const CameraReport& c) { return Number(c.distance_transform_px.train, 2); });
    row("distance transform, held out [px]",
        [](const CameraReport& c) { return Number(c.distance_transform_px.heldout, 2); });
  }
  row("outline error, views used, RMS [px]",
      [](const CameraReport& c) { return Number(c.edge_rms_px.train, 2); });
  row("outline error, held out, RMS [px]",
      [](const CameraReport& c) { return Number(c.edge_rms_px.heldout, 2); });
  if (any([](const CameraReport& c) { return c.truth_error.has_value(); })) {
    row("first guess against truth",
        [](const CameraReport& c) { return Error(c.first_guess_error); });
    row("result against truth", [](const CameraReport& c) { return Error(c.truth_error); });
  }
  if (any([](const CameraReport& c) { return RangeErrorsOf(c).offset_m.sigma > 0; })) {
    row("range offset, all points [mm]",
        [](const CameraReport& c) { return Common(RangeErrorsOf(c)); });
  }
  if (any([](const CameraReport& c) { return !RangeErrorsOf(c).rings.empty(); })) {
    row("range offset, by ring [mm]",
        [](const CameraReport& c) { return Spread(RangeErrorsOf(c).rings); });
  }
  if (any([](const CameraReport& c) { return !RangeErrorsOf(c).intensities.empty(); })) {
    row("range offset, by intensity [mm]",
        [](const CameraReport& c) { return Spread(RangeErrorsOf(c).intensities); });
  }
  if (any([](const CameraReport& c) { return c.calibration.timing.has_value(); })) {
    const auto cell = [](const CameraReport& c, Estimate CameraTiming::*time) {
      if (!c.calibration.timing) return std::string("-");
      const Estimate& estimate = (*c.calibration.timing).*time;
      return fmt::format("{:.3f} +- {:.3f}", 1e3 * estimate.value, 1e3 * estimate.sigma);
    };
    row("time offset, by rgbdt sync [ms]",
        [&](const CameraReport& c) { return cell(c, &CameraTiming::time_offset_s); });
    row("read-out, by rgbdt sync [ms]",
        [&](const CameraReport& c) { return cell(c, &CameraTiming::rolling_s); });
  }
  if (any([](const CameraReport& c) { return !c.other_starts.empty(); })) {
    row("result from a far start differs by", [](const CameraReport& c) {
      return c.other_starts.empty() ? std::string("-") : Error(c.other_starts[0].from_result);
    });
  }
  row("seconds: image / cloud / solve", [](const CameraReport& c) {
    return fmt::format("{:.1f} / {:.1f} / {:.2f}", c.detect_image_s, c.detect_cloud_s, c.solve_s);
  });
  text += FurtherLidarLines(report_) + Warnings(report_, told, verdicts);
  if (const NextView* next = NextViewOf(report_)) text += "next view: " + next->words + "\n";
  return text;
}

}  // namespace rgbdt
