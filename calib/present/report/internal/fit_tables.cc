#include "calib/present/report/internal/fit_tables.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/model/text.h"
#include "calib/present/report/words.h"

namespace rgbdt {
namespace {

constexpr char kNone[] = "–";
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

std::string PoseErrorText(const std::optional<PoseError>& error) {
  return error ? rgbdt::PoseErrorText(*error) : kNone;
}

// One view of the table of views; `why`: where it was rejected.
struct ViewLine {
  std::string view;
  const char* role;
  std::string why;
};

std::vector<ViewLine> LinesOf(const CameraReport& camera) {
  std::vector<ViewLine> lines;
  for (const std::string& view : camera.used) lines.push_back({view, "used", ""});
  for (const std::string& view : camera.heldout) lines.push_back({view, "held out", ""});
  for (const RejectedView& view : camera.rejected) {
    lines.push_back({view.view, view.copy ? "copy" : "rejected", view.why});
  }
  std::stable_sort(lines.begin(), lines.end(), [](const ViewLine& a, const ViewLine& b) {
    return NaturalLess(a.view, b.view);
  });
  return lines;
}

ViewQuality QualityOf(const CameraReport& camera, const std::string& view) {
  const auto found = std::find_if(camera.views.begin(), camera.views.end(),
                                  [&](const ViewQuality& q) { return q.view == view; });
  return found == camera.views.end() ? ViewQuality{view, false, kUnknown, kUnknown, {}} : *found;
}

}  // namespace

Table FitTable(const CameraReport& camera, FitFigure figure) {
  Table table{"How well it fits",
              {"Outline error: distance of the board's edge in the cloud from its outline in the "
               "image. In sigmas 1 is expected; above 1 the stated sigmas are too small. In "
               "millimetres it is measured on the board, from halfway between the last beam on it "
               "and the first beyond. Distance from the plane: of the board's points from where "
               "the image puts the board."},
              {"", "Views used (" + std::to_string(camera.used.size()) + ")",
               "Views held out (" + std::to_string(camera.heldout.size()) + ")"},
              {}};
  const auto add = [&](const char* name, const TrainHeldout& value, const char* unit) {
    if (!value.train && !value.heldout) return;
    table.rows.push_back(
        {{name}, {WithUnit(value.train, 2, unit)}, {WithUnit(value.heldout, 2, unit)}});
  };
  add("Outline error, RMS", camera.edge_rms_px, "px");
  add("Outline error in sigmas, RMS", camera.edge_rms_whitened, "σ");
  add("Outline error on the board, RMS", camera.edge_rms_mm, "mm");
  add("Distance of points from the board's plane, RMS", camera.plane_rms_mm, "mm");
  if (figure == FitFigure::kDistanceTransform) {
    add("Mean distance-transform value (the 2015 paper's quality)", camera.distance_transform_px,
        "px");
  }
  return table;
}

Table ViewsTable(const CameraReport& camera, FitFigure figure) {
  const bool transform = figure == FitFigure::kDistanceTransform;
  Table table{"Views", camera.warnings, {"View", "Role", "Outline error"}, {}};
  if (transform) table.head.emplace_back("Distance transform");
  const bool sigmas =
      std::any_of(camera.views.begin(), camera.views.end(),
                  [](const ViewQuality& view) { return view.edge_rms_whitened.has_value(); });
  if (sigmas) {
    table.head.emplace_back("Outline error in sigmas");
    table.head.emplace_back("On the board");
    table.head.emplace_back("Points from its plane");
  }
  if (!camera.rejected.empty()) table.head.emplace_back("Why rejected");
  for (const ViewLine& line : LinesOf(camera)) {
    const ViewQuality quality = QualityOf(camera, line.view);
    Row& row = table.rows.emplace_back(
        Row{{line.view}, {line.role}, {WithUnit(quality.edge_rms_px, 2, "px")}});
    if (transform) row.push_back({WithUnit(quality.distance_transform_px, 2, "px")});
    if (sigmas) {
      row.push_back({WithUnit(quality.edge_rms_whitened, 2, "σ")});
      row.push_back({WithUnit(quality.edge_rms_mm, 1, "mm")});
      row.push_back({WithUnit(quality.plane_rms_mm, 1, "mm")});
    }
    if (!camera.rejected.empty()) row.push_back({line.why});
  }
  return table;
}

Table DetectionTable(const Report& report) {
  Table table{"What was found in each view", {}, {"View"}, {}};
  if (report.detections.empty()) return table;
  for (const DetectedView::InImage& image : report.detections.front().images) {
    table.head.push_back("Image of " + image.camera);
  }
  table.head.emplace_back("Cloud");
  for (const DetectedView& view : report.detections) {
    Row& row = table.rows.emplace_back(Row{{view.view + (view.heldout ? " (held out)" : "")}});
    for (const DetectedView::InImage& image : view.images) {
      row.push_back({image.why_not.empty() ? "board found" : image.why_not});
    }
    row.resize(table.head.size() - 1);
    row.push_back({view.cloud_why_not.empty() ? "board found" : view.cloud_why_not});
  }
  return table;
}

Table StartsTable(const CameraReport& camera, FitFigure figure) {
  const bool transform = figure == FitFigure::kDistanceTransform;
  Table table{"The same solve from other starts", {}, {"Start", "Ended"}, {}};
  if (transform) table.head.emplace_back("Distance transform");
  table.head.emplace_back("Away from the result");
  const bool truth =
      std::any_of(camera.other_starts.begin(), camera.other_starts.end(),
                  [](const StartResult& start) { return start.truth_error.has_value(); });
  if (truth) table.head.emplace_back("Away from the truth");
  for (const StartResult& start : camera.other_starts) {
    Row& row = table.rows.emplace_back(Row{{start.start}, {start.calibration.StatusText()}});
    if (transform) row.push_back({WithUnit(start.distance_transform_px, 2, "px")});
    row.push_back({rgbdt::PoseErrorText(start.from_result)});
    if (truth) row.push_back({PoseErrorText(start.truth_error)});
  }
  return table;
}

Table SolveTable(const CameraReport& camera) {
  Table table{"The solve", {}, {"", ""}, {}};
  const auto add = [&](const char* name, const std::string& value) {
    if (value != kNone) table.rows.push_back({{name}, {value}});
  };
  add("Status", camera.calibration.StatusText());
  add("Views", std::to_string(camera.used.size()) + " used, " +
                   std::to_string(camera.heldout.size()) + " held out, " +
                   std::to_string(camera.rejected.size()) + " rejected");
  if (camera.first_guess) {
    add("Result away from the first guess",
        rgbdt::PoseErrorText(ErrorOf(camera.calibration.camera_from_lidar, *camera.first_guess)));
  }
  add("First guess away from the truth", PoseErrorText(camera.first_guess_error));
  add("Result away from the truth", PoseErrorText(camera.truth_error));
  add("Computing time, all views", "images " + WithUnit(camera.detect_image_s, 2, "s") +
                                       ", clouds " + WithUnit(camera.detect_cloud_s, 2, "s") +
                                       ", solve " + WithUnit(camera.solve_s, 3, "s"));
  return table;
}

Table LidarTable(const CameraReport& camera) {
  if (!camera.calibration.range_errors) return {};
  const RangeErrors& errors = *camera.calibration.range_errors;
  Table table{
      "The LIDAR's own errors",
      {"True range less measured range; what stands below adds up. The calibration file has "
       "them, too: rgbdt fuse --correct-ranges applies them."},
      {"", "offset", "1 sigma"},
      {}};
  const auto add = [&](const std::string& name, const Estimate& estimate) {
    table.rows.push_back({{name},
                          {WithUnit(1000 * estimate.value, 1, "mm")},
                          {WithUnit(1000 * estimate.sigma, 1, "mm")}});
  };
  if (errors.offset_m.sigma > 0) add("all ranges", errors.offset_m);
  for (const auto& [ring, offset_m] : errors.rings) add("ring " + std::to_string(ring), offset_m);
  for (const auto& [log2_intensity, offset_m] : errors.intensities) {
    add("intensity " + Number(std::exp2(log2_intensity), 3), offset_m);
  }
  if (errors.beams_meet_m.sigma > 0) {
    add("beams meet at a radius of (beams start at z = -radius tan(elevation))",
        errors.beams_meet_m);
  }
  return table;
}

}  // namespace rgbdt
