#include "calib/present/report/internal/fit_tables.h"

#include <algorithm>

#include "calib/model/text.h"
#include "calib/present/report/words.h"

namespace rgbdt {
namespace {

constexpr char kNone[] = "–";

std::string PoseErrorText(const std::optional<PoseError>& error) {
  return error ? rgbdt::PoseErrorText(*error) : kNone;
}

struct ViewRow {
  std::string view;
  Row cells;
};

ViewRow RowOf(const CameraReport& camera, const std::string& view, const char* role) {
  const auto found = std::find_if(camera.views.begin(), camera.views.end(),
                                  [&](const ViewQuality& q) { return q.view == view; });
  if (found == camera.views.end()) return {view, {{view}, {role}, {kNone}, {kNone}, {kNone}}};
  return {view,
          {{view},
           {role},
           {WithUnit(found->edge_rms_px, 2, "px")},
           {WithUnit(found->edge_rms_whitened, 2, "sigma")},
           {WithUnit(found->distance_transform_px, 2, "px")}}};
}

std::vector<ViewRow> RowsOfViews(const CameraReport& camera) {
  std::vector<ViewRow> rows;
  for (const std::string& view : camera.used) rows.push_back(RowOf(camera, view, "used"));
  for (const std::string& view : camera.heldout) rows.push_back(RowOf(camera, view, "held out"));
  for (const RejectedView& rejected : camera.rejected) {
    rows.push_back(RowOf(camera, rejected.view, "rejected"));
    rows.back().cells.push_back({rejected.why});
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](const ViewRow& a, const ViewRow& b) { return NaturalLess(a.view, b.view); });
  return rows;
}

}  // namespace

Table FitTable(const CameraReport& camera) {
  Table table{"How well it fits",
              {},
              {"", "Views used (" + std::to_string(camera.used.size()) + ")",
               "Views held out (" + std::to_string(camera.heldout.size()) + ")"},
              {}};
  const auto add = [&](const char* name, const TrainHeldout& figure, const char* unit) {
    if (!figure.train && !figure.heldout) return;
    table.rows.push_back(
        {{name}, {WithUnit(figure.train, 2, unit)}, {WithUnit(figure.heldout, 2, unit)}});
  };
  add("RMS distance of the LIDAR's board edge from the outline in the image", camera.edge_rms_px,
      "px");
  add("The same in sigmas (1 is expected; above 1 the stated sigmas are too small)",
      camera.edge_rms_whitened, "sigma");
  add("Mean distance-transform value (the 2015 paper's quality)", camera.distance_transform_px,
      "px");
  return table;
}

Table ViewsTable(const CameraReport& camera) {
  Table table{"Views",
              camera.warnings,
              {"View", "Role", "Edge RMS", "In sigmas", "Distance transform"},
              {}};
  if (!camera.rejected.empty()) table.head.emplace_back("Why rejected");
  for (ViewRow& row : RowsOfViews(camera)) {
    row.cells.resize(table.head.size());
    table.rows.push_back(std::move(row.cells));
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

Table StartsTable(const CameraReport& camera) {
  Table table{"The same solve from other starts",
              {},
              {"Start", "Ended", "Distance transform", "Away from the result"},
              {}};
  const bool truth =
      std::any_of(camera.other_starts.begin(), camera.other_starts.end(),
                  [](const StartResult& start) { return start.truth_error.has_value(); });
  if (truth) table.head.emplace_back("Away from the truth");
  for (const StartResult& start : camera.other_starts) {
    Row& row = table.rows.emplace_back(Row{{start.start},
                                           {start.calibration.StatusText()},
                                           {WithUnit(start.distance_transform_px, 2, "px")},
                                           {rgbdt::PoseErrorText(start.from_result)}});
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
  if (camera.range_offset) {
    add("LIDAR's range offset", WithUnit(1000 * camera.range_offset->value, 1, "mm") + " ± " +
                                    WithUnit(1000 * camera.range_offset->sigma, 1, "mm"));
  }
  add("Computing time, all views", "images " + WithUnit(camera.detect_image_s, 2, "s") +
                                       ", clouds " + WithUnit(camera.detect_cloud_s, 2, "s") +
                                       ", solve " + WithUnit(camera.solve_s, 3, "s"));
  return table;
}

}  // namespace rgbdt
