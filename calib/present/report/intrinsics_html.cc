#include "calib/present/report/intrinsics_html.h"

#include <algorithm>
#include <cmath>

#include "calib/model/text.h"
#include "calib/present/report/html.h"
#include "calib/present/report/words.h"

namespace rgbdt {
namespace {

Verdict VerdictOf(const IntrinsicsResult& result) {
  Verdict verdict{Grade::kGood, "Converged", {}};
  if (!result.converged) verdict = {Grade::kBad, "Not converged", {result.detail}};
  verdict.reasons.push_back(
      std::to_string(result.ViewsUsed()) + " views, " + std::to_string(result.corners_used) +
      " corners, RMS " + Number(result.rms_px, 3) + " px; " +
      Number(100 * result.coverage.fraction, 0) + "% of the image held corners.");
  const auto parts = result.coverage.EmptyParts();
  if (!parts.empty()) {
    verdict.reasons.push_back("Few corners at the image's " + Joined(parts) +
                              ": the lens is extrapolated there.");
  }
  return verdict;
}

Table ParametersTable(const IntrinsicsResult& result) {
  Table table{"Lens", {}, {"Parameter", "Value", "1 sigma", "Unit"}, {}};
  for (std::size_t i = 0; i < result.values.size(); ++i) {
    const int digits = i < 4 ? 3 : 6;
    table.rows.push_back({{result.names[i]},
                          {Number(result.values[i], digits)},
                          {Number(result.Sigma(static_cast<int>(i)), digits)},
                          {i < 4 ? "px" : ""}});
  }
  if (const auto& board = result.board) {
    const auto add = [&](const char* name, const Estimate& of, double scale, const char* unit) {
      table.rows.push_back(
          {{name}, {Number(scale * of.value, 2)}, {Number(scale * of.sigma, 2)}, {unit}});
    };
    add("printed squares' height over their width", board->aspect, 100, "%");
    add("board's bulge towards the camera, along its width", board->bow_x, 1e3, "mm");
    add("board's bulge towards the camera, along its height", board->bow_y, 1e3, "mm");
    add("board's twist", board->twist, 1e3, "mm");
  }
  return table;
}

std::string Coordinates(const char* x, const char* y, const Eigen::Vector2d& at) {
  return std::string(" ") + x + "=\"" + Number(at.x(), 1) + "\" " + y + "=\"" + Number(at.y(), 1) +
         "\"";
}

// How much longer residuals are drawn than they are: a typical one a fiftieth of the image's width.
double Magnification(const CameraIntrinsics& camera) {
  const double wanted = 0.02 * camera.before.width / std::max(0.01, camera.result.rms_px);
  const double decade = std::pow(10, std::floor(std::log10(wanted)));
  return decade * (wanted >= 5 * decade ? 5 : wanted >= 2 * decade ? 2 : 1);
}

std::string CornersSvg(const CameraIntrinsics& camera) {
  const double scale = Magnification(camera);
  const double stroke = camera.before.width / 800.0;
  std::string out = "<figure>\n<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " +
                    std::to_string(camera.before.width) + " " +
                    std::to_string(camera.before.height) +
                    "\" width=\"100%\" role=\"img\" aria-label=\"corners and residuals\">\n"
                    "<rect width=\"100%\" height=\"100%\" fill=\"none\" stroke=\"currentColor\" "
                    "stroke-width=\"" +
                    Number(2 * stroke, 1) + "\"/>\n<g stroke=\"currentColor\" stroke-width=\"" +
                    Number(stroke, 1) + "\">\n";
  for (std::size_t v = 0; v < camera.result.views.size(); ++v) {
    const IntrinsicsViewFit& view = camera.result.views[v];
    if (!view.rejected.empty()) continue;
    for (std::size_t i = 0; i < view.used.size(); ++i) {
      const Eigen::Vector2d corner = camera.corners.views[v].corners[i];
      const Eigen::Vector2d end = corner + scale * view.residuals_px[i];
      if (view.used[i]) {
        out += "<line" + Coordinates("x1", "y1", corner) + Coordinates("x2", "y2", end) + "/>\n";
      } else {
        out += "<circle" + Coordinates("cx", "cy", corner) + " r=\"" + Number(6 * stroke, 1) +
               "\" fill=\"none\"/>\n";
      }
    }
  }
  return out + "</g>\n</svg>\n<figcaption>Every corner and its residual (measured - predicted), " +
         Number(scale, 0) +
         " times as long as it is; a circle: a wrong corner, left out. Lines that point the same "
         "way in one part of the image mean a lens model that does not fit there.</figcaption>\n"
         "</figure>\n";
}

Table LensViewsTable(const IntrinsicsResult& result) {
  Table table{"Views", {}, {"View", "RMS", "Worst corner", "Corners left out", "Why rejected"}, {}};
  for (const IntrinsicsViewFit& view : result.views) {
    if (!view.rejected.empty()) {
      table.rows.push_back({{view.name}, {"–"}, {"–"}, {"all"}, {view.rejected}});
      continue;
    }
    table.rows.push_back({{view.name},
                          {WithUnit(view.rms_px, 3, "px")},
                          {WithUnit(view.worst_px, 2, "px")},
                          {std::to_string(view.corners_left_out)},
                          {}});
  }
  return table;
}

std::string CameraHtml(const CameraIntrinsics& camera) {
  std::string out = "<section>\n" + html::Heading(2, "Camera " + camera.before.name) +
                    html::VerdictBox(VerdictOf(camera.result));
  if (camera.result.converged) {
    out += html::TableBox(ParametersTable(camera.result)) + html::Heading(3, "Corners") +
           CornersSvg(camera);
  }
  return out + html::TableBox(LensViewsTable(camera.result)) + "</section>\n";
}

}  // namespace

std::string IntrinsicsHtml(const std::vector<CameraIntrinsics>& cameras) {
  std::string body = "<h1>Intrinsic calibration of the cameras</h1>\n";
  for (const CameraIntrinsics& camera : cameras) body += CameraHtml(camera);
  return html::Page("rgbdt intrinsics", ValidUtf8(body));
}

}  // namespace rgbdt
