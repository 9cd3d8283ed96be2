#include "calib/present/report/report_html.h"

#include "calib/files/image_files.h"
#include "calib/model/text.h"
#include "calib/present/report/html.h"

namespace rgbdt {
namespace {

using html::Escape;
using html::Heading;
using html::Paragraph;

std::string MatrixText(const Rigid3& pose) {
  const Eigen::Matrix3d rotation = pose.rotation.normalized().toRotationMatrix();
  std::string text;
  for (int r = 0; r < 3; ++r) {
    text += Format("%12.8f %12.8f %12.8f %12.6f\n", rotation(r, 0), rotation(r, 1), rotation(r, 2),
                   pose.translation[r]);
  }
  return text + "  0            0            0            1\n";
}

std::string PoseHtml(const NamedPose& pose) {
  return Heading(3, pose.name) + Paragraph(pose.sentence) + "<pre>" + MatrixText(pose.pose) +
         "</pre>\n";
}

std::string TablesHtml(const std::vector<Table>& tables) {
  std::string out;
  for (const Table& table : tables) out += html::TableBox(table);
  return out;
}

std::string CameraHtml(const CameraContent& camera) {
  std::string out =
      "<section>\n" + Heading(2, "Camera " + camera.camera) + html::VerdictBox(camera.verdict);
  for (const NamedPose& pose : camera.poses) out += PoseHtml(pose);
  return out + TablesHtml(camera.tables) + "</section>\n";
}

std::string NextViewHtml(const NextViewWords& next) {
  return "<section>\n" + Heading(2, "Where to hold the board next") + "<p><strong>" +
         Escape(next.words) + "</strong></p>\n" + Paragraph(next.gain) + "</section>\n";
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

}  // namespace

std::string ReportHtml(const ReportContent& content, const std::vector<ReportPicture>& pictures) {
  std::string body =
      Heading(1, "Calibration of the cameras against the LIDAR") + Paragraph(content.intro);
  for (const CameraContent& camera : content.cameras) body += CameraHtml(camera);
  if (content.cameras.empty()) body += Paragraph("No camera could be calibrated.");
  if (!content.tables.empty()) {
    body += "<section>\n" + Heading(2, "All cameras together") + TablesHtml(content.tables) +
            "</section>\n";
  }
  if (content.next_view) body += NextViewHtml(*content.next_view);
  if (!pictures.empty()) body += Heading(2, "Pictures");
  for (const ReportPicture& picture : pictures) body += PictureHtml(picture);
  return html::Page("rgbdt calibration report", body);
}

}  // namespace rgbdt
