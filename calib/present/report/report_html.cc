#include "calib/present/report/report_html.h"

#include <algorithm>
#include <cstdio>
#include <ctime>

#include "calib/files/image_files.h"
#include "calib/files/schema/text_proto.h"
#include "calib/files/session/session_dir.h"
#include "calib/present/report/html.h"
#include "calib/present/report/internal/sureness_html.h"
#include "calib/present/report/internal/verdict.h"

namespace rgbdt {
namespace {

using html::Escape;
using html::Number;
using html::PoseErrorText;

using Row = std::vector<std::string>;
using Rows = std::vector<Row>;

std::string Heading(int level, const std::string& text) {
  const std::string tag = "h" + std::to_string(level);
  return "<" + tag + ">" + Escape(text) + "</" + tag + ">\n";
}

std::string VerdictHtml(const Verdict& verdict) {
  const char* const grade = verdict.grade == Verdict::Grade::kGood      ? "good"
                            : verdict.grade == Verdict::Grade::kCaution ? "caution"
                                                                        : "bad";
  std::string out = std::string("<div class=\"verdict ") + grade + "\">\n<p><strong>" +
                    Escape(verdict.headline) + "</strong></p>\n";
  for (const std::string& reason : verdict.reasons) out += "<p>" + Escape(reason) + "</p>\n";
  return out + "</div>\n";
}

std::string Optional(const std::optional<double>& value, int decimals) {
  return value ? Number(*value, decimals) : "–";
}

std::string FiguresHtml(const CameraReport& camera) {
  const auto row = [](const char* name, const TrainHeldout& figure) {
    return Row{name, Optional(figure.train, 2) + " px", Optional(figure.heldout, 2) + " px"};
  };
  std::string out =
      html::Table({"figure", "views used (" + std::to_string(camera.used.size()) + ")",
                   "views held out (" + std::to_string(camera.heldout.size()) + ")"},
                  {row("RMS distance of the LIDAR's board edge to the outline in the image",
                       camera.edge_rms_px),
                   row("mean distance-transform value (the 2015 paper's quality)",
                       camera.distance_transform_px)});
  Rows rows;
  if (camera.truth_error) {
    rows.push_back({"result against truth", PoseErrorText(*camera.truth_error)});
  }
  if (camera.first_guess_error) {
    rows.push_back({"first guess against truth", PoseErrorText(*camera.first_guess_error)});
  }
  if (camera.first_guess) {
    rows.push_back(
        {"result against first guess",
         PoseErrorText(ErrorOf(camera.calibration.camera_from_lidar, *camera.first_guess))});
  }
  // SurenessHtml says it better.
  if (camera.calibration.covariance && !camera.sigma) {
    const Vector6d sigma = camera.calibration.covariance->diagonal().cwiseMax(0).cwiseSqrt();
    rows.push_back({"1 sigma about and along the camera's x, y, z",
                    Number(sigma[0] * 180 / M_PI, 3) + ", " + Number(sigma[1] * 180 / M_PI, 3) +
                        ", " + Number(sigma[2] * 180 / M_PI, 3) + "° and " +
                        Number(sigma[3] * 1000, 1) + ", " + Number(sigma[4] * 1000, 1) + ", " +
                        Number(sigma[5] * 1000, 1) + " mm"});
  }
  return out + html::Table({"pose", "rotation and camera centre"}, rows);
}

std::string MatrixText(const Rigid3& pose) {
  const Eigen::Matrix3d rotation = pose.rotation.normalized().toRotationMatrix();
  std::string text;
  char line[120];
  for (int r = 0; r < 3; ++r) {
    std::snprintf(line, sizeof line, "%12.8f %12.8f %12.8f %12.6f\n", rotation(r, 0),
                  rotation(r, 1), rotation(r, 2), pose.translation[r]);
    text += line;
  }
  return text + "  0            0            0            1\n";
}

std::string PoseHtml(const CameraReport& camera) {
  const Rigid3& camera_from_lidar = camera.calibration.camera_from_lidar;
  const Rigid3 lidar_from_camera = camera_from_lidar.Inverse();
  const std::string name = Escape(camera.calibration.camera);
  const auto centre = [&](int i) { return Number(lidar_from_camera.translation[i], 4); };
  return Heading(3, "Which way the transform goes") +
         "<p><b>camera_from_lidar</b> takes a point of the LIDAR frame (x forward, y left, z up) "
         "into the frame of camera " +
         name +
         " (x right, y down, z forward); metres. point_in_camera = camera_from_lidar · "
         "point_in_lidar</p>\n<pre>" +
         MatrixText(camera_from_lidar) +
         "</pre>\n<p><b>lidar_from_camera</b> is its inverse, the camera's pose in the LIDAR frame "
         "(what ROS wants): the camera sits at x " +
         centre(0) + ", y " + centre(1) + ", z " + centre(2) + " m.</p>\n<pre>" +
         MatrixText(lidar_from_camera) + "</pre>\n";
}

std::string EdgeRmsText(const ViewQuality& quality) {
  const std::string px = Number(quality.edge_rms_px, 2);
  if (!quality.edge_rms_whitened) return px;
  return px + " (" + Number(*quality.edge_rms_whitened, 2) + " sigmas)";
}

// Every view once: its figures where there are some, else why not.
std::string ViewsHtml(const CameraReport& camera) {
  struct Line {
    std::string view;
    Row cells;
  };
  std::vector<Line> lines;
  const auto add = [&](const std::vector<std::string>& views, const char* role) {
    for (const std::string& view : views) {
      const auto quality = std::find_if(camera.views.begin(), camera.views.end(),
                                        [&](const ViewQuality& q) { return q.view == view; });
      const bool known = quality != camera.views.end();
      lines.push_back({view,
                       {Escape(view), role, known ? EdgeRmsText(*quality) : "–",
                        known ? Number(quality->distance_transform_px, 2) : "–", ""}});
    }
  };
  add(camera.used, "used");
  add(camera.heldout, "held out");
  for (const RejectedView& view : camera.rejected) {
    lines.push_back({view.view, {Escape(view.view), "rejected", "–", "–", Escape(view.why)}});
  }
  std::stable_sort(lines.begin(), lines.end(),
                   [](const Line& a, const Line& b) { return NaturalLess(a.view, b.view); });
  Rows rows;
  for (const Line& line : lines) rows.push_back(line.cells);
  std::string warnings;
  for (const std::string& warning : camera.warnings) {
    warnings += "<p>" + Escape(warning) + "</p>\n";
  }
  return Heading(3, "Views") + warnings +
         html::Table({"view", "role", "edge RMS [px]", "distance transform [px]", "why rejected"},
                     rows);
}

std::string StartsHtml(const CameraReport& camera) {
  if (camera.other_starts.empty()) return {};
  Rows rows;
  for (const StartResult& start : camera.other_starts) {
    rows.push_back(
        {Escape(start.start),
         start.calibration.converged() ? "yes" : "no: " + Escape(start.calibration.StatusText()),
         Optional(start.distance_transform_px, 2), PoseErrorText(start.from_result),
         start.truth_error ? PoseErrorText(*start.truth_error) : "–"});
  }
  return Heading(3, "The same solve from other starts") +
         html::Table({"start", "converged", "distance transform [px]", "away from the result",
                      "away from truth"},
                     rows);
}

std::string SecondsHtml(const CameraReport& camera) {
  return Heading(3, "Computing time, all views") +
         html::Table({"edges in the images", "edges in the clouds", "solve"},
                     {{Number(camera.detect_image_s, 2) + " s",
                       Number(camera.detect_cloud_s, 2) + " s", Number(camera.solve_s, 2) + " s"}});
}

std::string PictureHtml(const ReportPicture& picture) {
  std::string out = "<figure>\n" + Heading(3, picture.title);
  if (!picture.bgr.empty()) {
    out += "<img alt=\"" + Escape(picture.title) + "\" width=\"" +
           std::to_string(picture.bgr.cols) + "\" height=\"" + std::to_string(picture.bgr.rows) +
           "\" src=\"data:image/png;base64," + html::Base64(EncodePng(picture.bgr, 6)) + "\">\n";
  }
  return out + "<figcaption>" + Escape(picture.caption) + "</figcaption>\n</figure>\n";
}

std::string TimeText(Utime utime) {
  const std::time_t seconds = static_cast<std::time_t>(utime / kMicrosecondsPerSecond);
  std::tm utc{};
  char text[64] = "";
  if (gmtime_r(&seconds, &utc) != nullptr) {
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S UTC", &utc);
  }
  return text;
}

std::string IntroHtml(const Report& report) {
  std::string out =
      "<h1>Calibration of the cameras against the LIDAR</h1>\n<p>Method: " + Escape(report.method) +
      ". Rig: " + Escape(report.rig_hash) + ".";
  if (report.utime != 0) out += " Newest image: " + TimeText(report.utime) + ".";
  return out + "</p>\n";
}

std::string CameraHtml(const CameraReport& camera, const std::optional<NextView>& next_view) {
  return "<section>\n" + Heading(2, "Camera " + camera.calibration.camera) +
         VerdictHtml(Judge(camera, next_view)) + Heading(3, "Figures") + FiguresHtml(camera) +
         SurenessHtml(camera) + PoseHtml(camera) + ViewsHtml(camera) + StartsHtml(camera) +
         SecondsHtml(camera) + "</section>\n";
}

}  // namespace

std::string ReportHtml(const Report& report, const std::vector<ReportPicture>& pictures) {
  std::string body = IntroHtml(report);
  for (const CameraReport& camera : report.cameras) body += CameraHtml(camera, report.next_view);
  if (report.cameras.empty()) body += "<p>No camera could be calibrated.</p>\n";
  body += ClosureHtml(report) + NextViewHtml(report);
  if (!pictures.empty()) body += Heading(2, "Pictures");
  for (const ReportPicture& picture : pictures) body += PictureHtml(picture);
  return html::Page("rgbdt calibration report", text::ValidUtf8(body));
}

}  // namespace rgbdt
