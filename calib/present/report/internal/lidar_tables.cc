#include "calib/present/report/internal/lidar_tables.h"

#include "calib/model/pose_sigma.h"
#include "calib/model/text.h"
#include "calib/present/report/words.h"

namespace rgbdt {
namespace {

std::string Translation(const LidarCalibration& lidar) {
  const Eigen::Vector3d& t = lidar.reference_from_lidar.translation;
  return Format("%.4f, %.4f, %.4f m", t.x(), t.y(), t.z());
}

std::string Quaternion(const LidarCalibration& lidar) {
  const Eigen::Quaterniond& q = lidar.reference_from_lidar.rotation;
  return Format("%.7f, %.7f, %.7f, %.7f", q.w(), q.x(), q.y(), q.z());
}

template <typename Axes>
std::string ThreeOf(const Axes& axes, int decimals, const std::string& unit) {
  return Number(axes[0], decimals) + ", " + Number(axes[1], decimals) + ", " +
         WithUnit(axes[2], decimals, unit);
}

Row RowOf(const LidarReport& lidar, bool with_truth) {
  const LidarCalibration& calibration = lidar.calibration;
  const bool solved = calibration.solved();
  const bool known = lidar.sigma.has_value();
  Row row = {{calibration.lidar},
             {calibration.StatusText(), calibration.converged() ? Grade::kGood : Grade::kDoubtful},
             {std::to_string(lidar.used.size()) + " / " + std::to_string(lidar.rejected.size())},
             {solved ? Translation(calibration) : "–"},
             {solved ? Quaternion(calibration) : "–"},
             {known ? ThreeOf(lidar.sigma->rotation_deg, 4, "°") : "–"},
             {known ? ThreeOf(lidar.sigma->translation_mm, 2, "mm") : "–"}};
  if (with_truth) {
    row.push_back({lidar.truth_error && solved ? PoseErrorText(*lidar.truth_error) : "–"});
  }
  return row;
}

// Why views have no say, and what else there is to know.
void AddNotes(const LidarReport& lidar, Table* table) {
  const std::string name = lidar.calibration.lidar + ": ";
  for (const RejectedView& view : lidar.rejected) {
    table->notes.push_back(name + "view " + view.view + " is not used: " + view.why + ".");
  }
  for (const std::string& warning : lidar.warnings) table->notes.push_back(name + warning + ".");
}

}  // namespace

Table FurtherLidarsTable(const Report& report) {
  if (report.lidars.empty()) return {};
  bool with_truth = false;
  for (const LidarReport& lidar : report.lidars) with_truth |= lidar.truth_error.has_value();
  Table table{
      "LIDARs beside the reference: reference_from_lidar",
      {"Takes a point of the LIDAR's frame into that of the reference, the rig's first LIDAR; "
       "metres. point_in_reference = reference_from_lidar · point_in_lidar. 1 sigma: "
       "about the reference's axes, and of the LIDAR's origin along them."},
      {"LIDAR", "Status", "Views used / not used", "Translation x, y, z", "Quaternion w, x, y, z",
       "Rotation, 1 sigma", "Origin, 1 sigma"},
      {}};
  if (with_truth) table.head.emplace_back("Against truth");
  for (const LidarReport& lidar : report.lidars) {
    table.rows.push_back(RowOf(lidar, with_truth));
    AddNotes(lidar, &table);
  }
  return table;
}

Table FurtherNuisanceTable(const Report& report) {
  Table table{"What was solved for of those LIDARs besides their poses",
              {},
              {"LIDAR", "Unknown", "Value", "1 sigma"},
              {}};
  for (const LidarReport& lidar : report.lidars) {
    for (const Nuisance& unknown : lidar.nuisance) {
      table.rows.push_back({{lidar.calibration.lidar},
                            {unknown.name},
                            {WithUnit(unknown.estimate.value, 3, unknown.unit)},
                            {WithUnit(unknown.estimate.sigma, 3, unknown.unit)}});
    }
  }
  return table;
}

std::string FurtherLidarLines(const Report& report) {
  std::string lines;
  for (const LidarReport& lidar : report.lidars) {
    const LidarCalibration& calibration = lidar.calibration;
    lines += "LIDAR " + calibration.lidar + ": " + calibration.StatusText() +
             Format("; %d views used, %d not", static_cast<int>(lidar.used.size()),
                    static_cast<int>(lidar.rejected.size()));
    if (calibration.solved()) {
      lines += "; in the reference's frame at " + Translation(calibration);
    }
    const auto worst = WorstAxisSigma(calibration);
    if (calibration.solved() && worst) {
      lines += Format("; 1 sigma, worst axis: %.4f deg %.2f mm", worst->rotation_deg,
                      worst->translation_mm);
    }
    if (lidar.truth_error && calibration.solved()) {
      lines += Format("; against truth: %.4f deg %.2f mm", lidar.truth_error->rotation_deg,
                      lidar.truth_error->translation_mm);
    }
    lines += "\n";
  }
  return lines;
}

}  // namespace rgbdt
