#include "calib/present/report/internal/sureness_html.h"

#include <cmath>
#include <vector>

#include "calib/present/report/html.h"
#include "calib/present/report/internal/verdict.h"

namespace rgbdt {
namespace {

using html::Escape;
using html::Number;

using Rows = std::vector<std::vector<std::string>>;

std::string Heading(const std::string& text) { return "<h3>" + Escape(text) + "</h3>\n"; }

std::string Paragraph(const std::string& text) { return "<p>" + Escape(text) + "</p>\n"; }

std::string Joined(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

std::vector<std::string> AxesRow(const std::string& name, const std::array<double, 3>& axes,
                                 int decimals, const std::string& unit) {
  std::vector<std::string> row = {name};
  for (const double value : axes) row.push_back(Number(value, decimals) + unit);
  return row;
}

std::string Agreement(double chi2) {
  if (std::isnan(chi2)) return "–";
  return chi2 > kUnlikelyChi2 ? "they contradict each other" : "they agree";
}

std::string PoseSigmaHtml(const PoseSigma& sigma) {
  return html::Table({"1 sigma of the pose", "x", "y", "z"},
                     {AxesRow("rotation about the camera's axes (x right, y down, z forward)",
                              sigma.rotation_deg, 4, "°"),
                      AxesRow("camera's centre along the LIDAR's axes (x forward, y left, z up)",
                              sigma.centre_mm, 2, " mm")});
}

std::string ColouringHtml(const PoseSigma& sigma) {
  if (sigma.colouring.empty()) return {};
  Rows rows;
  for (const ColouringSigma& at : sigma.colouring) {
    rows.push_back({Number(at.distance_m, 0) + " m", Number(at.centre_px, 2) + " px",
                    Number(at.worst_px, 2) + " px"});
  }
  return Paragraph(
             "What that does to the colours: how far off in the image a point's colour is "
             "taken from, 1 sigma.") +
         html::Table({"point this far from the camera", "in the image's middle",
                      "where it is "
                      "worst in the image"},
                     rows);
}

std::string WhitenedHtml(const TrainHeldout& rms) {
  if (!rms.train && !rms.heldout) return {};
  std::string text = "Where the beams cross the board's edge, they miss it by ";
  if (rms.train) text += Number(*rms.train, 2) + " of their sigmas on the views used";
  if (rms.train && rms.heldout) text += ", and by ";
  if (rms.heldout) text += Number(*rms.heldout, 2) + " of them on the views held out";
  return Paragraph(text +
                   " (RMS): 1 means that the data are as exact as stated; above 1 they are worse, "
                   "and the sigmas too small.");
}

std::string FoldsHtml(const std::vector<Fold>& folds) {
  if (folds.empty()) return {};
  Rows rows;
  for (const Fold& fold : folds) {
    rows.push_back({Escape(Joined(fold.heldout)), Number(fold.edge_rms_whitened, 2),
                    Number(fold.misfit, 2), Number(fold.first_guess_misfit, 2),
                    html::PoseErrorText(fold.from_result)});
  }
  return Heading("Each part of the views left out once") +
         Paragraph(
             "Solved without these views, then judged on them. Misfit: their chi-square; the solve "
             "should "
             "fit them no worse than the first guess from the same views does.") +
         html::Table({"views left out", "edge RMS [sigmas]", "misfit", "misfit of the first guess",
                      "away from the result"},
                     rows);
}

std::string HalvesHtml(const std::optional<Halves>& halves) {
  if (!halves) return {};
  return Heading("Two halves of the views, each solved by itself") +
         Paragraph("They differ by " + html::PoseErrorText(halves->difference) + ": chi-square " +
                   Number(halves->chi2, 1) + " with 6 degrees of freedom. By chance it is above " +
                   Number(kUnlikelyChi2, 1) + " once in a thousand times.");
}

std::string NuisanceHtml(const std::vector<Nuisance>& unknowns) {
  if (unknowns.empty()) return {};
  Rows rows;
  for (const Nuisance& unknown : unknowns) {
    rows.push_back({Escape(unknown.name), Number(unknown.estimate.value, 3),
                    Number(unknown.estimate.sigma, 3), Escape(unknown.unit)});
  }
  return Heading("What was solved for besides the pose") +
         html::Table({"unknown", "value", "1 sigma", "unit"}, rows);
}

}  // namespace

std::string SurenessHtml(const CameraReport& camera) {
  std::string sigma;
  if (camera.sigma) sigma = PoseSigmaHtml(*camera.sigma) + ColouringHtml(*camera.sigma);
  sigma += WhitenedHtml(camera.edge_rms_whitened);
  return (sigma.empty() ? "" : Heading("How sure it is") + sigma) + HalvesHtml(camera.halves) +
         FoldsHtml(camera.folds) + NuisanceHtml(camera.nuisance);
}

std::string ClosureHtml(const Report& report) {
  if (report.closure.empty()) return {};
  Rows rows;
  for (const Closure& closure : report.closure) {
    rows.push_back({Escape(closure.from + " to " + closure.to),
                    html::PoseErrorText(closure.difference), html::PoseErrorText(closure.sigma),
                    Number(closure.chi2, 1), Agreement(closure.chi2)});
  }
  return "<section>\n<h2>Camera against camera</h2>\n" +
         Paragraph(
             "How two cameras sit to each other, found twice: by way of the LIDAR, and from "
             "the images alone of views that both see. Chi-square with 6 degrees of freedom: "
             "by chance it is above " +
             Number(kUnlikelyChi2, 1) + " once in a thousand times.") +
         html::Table({"cameras", "difference", "1 sigma to be expected", "chi-square", "so"},
                     rows) +
         "</section>\n";
}

std::string NextViewHtml(const Report& report) {
  if (!report.next_view) return {};
  const NextView& next = *report.next_view;
  const Eigen::Vector3d& centre = next.lidar_from_target.translation;
  return "<section>\n<h2>Where to hold the board next</h2>\n<p><strong>" + Escape(next.words) +
         "</strong></p>\n" +
         Paragraph("The board's centre is then at x " + Number(centre.x(), 1) + ", y " +
                   Number(centre.y(), 1) + ", z " + Number(centre.z(), 1) +
                   " m in the LIDAR's frame. Where camera " + next.camera +
                   " is worst, 1 sigma of a colour is to go from " +
                   Number(next.sigma_before_px, 2) + " to " + Number(next.sigma_after_px, 2) +
                   " px.") +
         "</section>\n";
}

}  // namespace rgbdt
