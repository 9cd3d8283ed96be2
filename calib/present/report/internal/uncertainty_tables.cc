#include "calib/present/report/internal/uncertainty_tables.h"

#include <array>
#include <cmath>

#include "calib/model/pose_sigma.h"
#include "calib/present/report/internal/degrees.h"
#include "calib/present/report/words.h"

namespace rgbdt {
namespace {

template <typename Axes>
Row AxesRow(const std::string& name, const Axes& axes, int decimals, const std::string& unit) {
  Row row = {{name}};
  for (const double value : axes) row.push_back({WithUnit(value, decimals, unit)});
  return row;
}

Cell Agreement(double chi2) {
  if (std::isnan(chi2)) return {"–"};
  if (chi2 > kUnlikelyChi2) return {"more than the sigmas allow", Grade::kDoubtful};
  return {"no more than the sigmas allow", Grade::kGood};
}

std::string Chi2Note() {
  return "Chi-square has 6 degrees of freedom: by chance it is above " + Number(kUnlikelyChi2, 1) +
         " once in a thousand times.";
}

// Where the report has a covariance only, e.g. of the 2015 paper's method.
std::vector<Row> CovarianceRows(const Matrix6d& covariance) {
  const Vector6d sigma = covariance.diagonal().cwiseMax(0).cwiseSqrt();
  const std::array<double, 3> rotation = {sigma[0], sigma[1], sigma[2]};
  const std::array<double, 3> translation = {sigma[3] * 1000, sigma[4] * 1000, sigma[5] * 1000};
  Row turned = {{"Rotation about the camera's axes (x right, y down, z forward)"}};
  for (const double value : rotation)
    turned.push_back({WithUnit(value * kDegreesPerRadian, 3, "°")});
  return {turned, AxesRow("Translation along the camera's axes", translation, 1, "mm")};
}

// The figures that the terminal and the viewer's charts have, beside the three axes.
void AddWorstAxis(const CameraCalibration& calibration, Table* table) {
  const auto worst = WorstAxisSigma(calibration);
  if (!worst || table->rows.size() != 2) return;
  table->head.emplace_back("worst axis");
  table->rows[0].push_back({WithUnit(worst->rotation_deg, 4, "°")});
  table->rows[1].push_back({WithUnit(worst->translation_mm, 2, "mm")});
}

}  // namespace

Table PoseSigmaTable(const CameraReport& camera) {
  Table table{"Uncertainty of the pose (1 sigma)", {}, {"", "x", "y", "z"}, {}};
  if (camera.sigma) {
    table.rows = {AxesRow("Rotation about the camera's axes (x right, y down, z forward)",
                          camera.sigma->rotation_deg, 4, "°"),
                  AxesRow("Camera's centre along the LIDAR's axes (x forward, y left, z up)",
                          camera.sigma->centre_mm, 2, "mm")};
  } else if (camera.calibration.covariance) {
    table.rows = CovarianceRows(*camera.calibration.covariance);
  }
  AddWorstAxis(camera.calibration, &table);
  return table;
}

Table ProjectionTable(const CameraReport& camera) {
  if (!camera.sigma || camera.sigma->colouring.empty()) return {};
  Table table{
      "Projection uncertainty (1 sigma)",
      {"1 sigma of the position at which a point is projected into the image."},
      {"Distance of the point from the camera", "In the image's centre", "Where it is worst"},
      {}};
  for (const ColouringSigma& at : camera.sigma->colouring) {
    table.rows.push_back({{WithUnit(at.distance_m, 0, "m")},
                          {WithUnit(at.centre_px, 2, "px")},
                          {WithUnit(at.worst_px, 2, "px")}});
  }
  return table;
}

Table PartsTable(const CameraReport& camera) {
  Table table{"Parts of the data, each solved separately",
              {Chi2Note()},
              {"", "They differ by", "Chi-square", "Verdict"},
              {}};
  const auto add = [&](const char* name, const std::optional<Halves>& apart) {
    if (!apart) return;
    table.rows.push_back({{name},
                          {PoseErrorText(apart->difference)},
                          {Number(apart->chi2, 1)},
                          Agreement(apart->chi2)});
  };
  add("Two halves of the views", camera.halves);
  add("Edges of the boards against their planes", camera.edges_planes);
  if (table.rows.empty()) return {};
  return table;
}

Table FoldsTable(const CameraReport& camera) {
  if (camera.folds.empty()) return {};
  Table table{
      "Cross-validation: each part of the views left out once",
      {"Solved without these views, then judged on them. Misfit: their chi-square. The solve "
       "should fit them no worse than the first guess from the same views does."},
      {"Views left out", "Outline error", "Misfit", "Misfit of the first guess",
       "Away from the result"},
      {}};
  for (const Fold& fold : camera.folds) {
    table.rows.push_back({{Joined(fold.heldout)},
                          {WithUnit(fold.edge_rms_whitened, 2, "σ")},
                          {Number(fold.misfit, 2)},
                          {Number(fold.first_guess_misfit, 2)},
                          {PoseErrorText(fold.from_result)}});
  }
  return table;
}

Table NuisanceTable(const CameraReport& camera) {
  Table table{"What was solved for besides the pose", {}, {"Unknown", "Value", "1 sigma"}, {}};
  for (const Nuisance& unknown : camera.nuisance) {
    table.rows.push_back({{unknown.name},
                          {WithUnit(unknown.estimate.value, 3, unknown.unit)},
                          {WithUnit(unknown.estimate.sigma, 3, unknown.unit)}});
  }
  return table;
}

Table ClosureTable(const Report& report) {
  if (report.closure.empty()) return {};
  Table table{
      "Camera against camera",
      {"The pose of two cameras relative to each other, found twice: by way of the LIDAR, and "
       "from the images alone of views that both see.",
       Chi2Note()},
      {"Cameras", "Difference", "Expected (1 sigma)", "Chi-square", "Verdict"},
      {}};
  for (const Closure& closure : report.closure) {
    table.rows.push_back({{closure.from + " to " + closure.to},
                          {PoseErrorText(closure.difference)},
                          {PoseErrorText(closure.sigma)},
                          {Number(closure.chi2, 1)},
                          Agreement(closure.chi2)});
  }
  return table;
}

}  // namespace rgbdt
