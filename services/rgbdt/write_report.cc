#include "services/rgbdt/write_report.h"

#include <algorithm>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "calib/camera/camera.h"
#include "calib/camera/pixels.h"
#include "calib/files/atomic_file.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/report_file.h"
#include "calib/model/version.h"
#include "calib/present/frames/image_frame.h"
#include "calib/present/frames/page.h"
#include "calib/present/pictures/colouring_picture.h"
#include "calib/present/report/report_html.h"
#include "calib/present/report/report_table.h"
#include "calib/solve/evaluate.h"
#include "calib/solve/first_guess.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

// The boundary points on the image: green within 1 px of the outline, then yellow, red beyond 4 px.
cv::Scalar ColourOf(double distance) {
  if (distance <= 1) return {80, 220, 60};
  if (distance <= 4) return {40, 210, 250};
  return {60, 60, 250};
}

cv::Mat Overlay(const Session& session, const CameraView& shown, const CameraCalibration& found) {
  const View view = ReadView(session, shown.view);
  const auto image = std::find_if(view.images.begin(), view.images.end(),
                                  [&](const Image& i) { return i.camera == found.camera; });
  const Camera camera(session.rig.Camera(found.camera));
  cv::Mat picture = ToBgr(*image).clone();
  const double size = std::max(1.0, picture.cols / 640.0);
  for (const Eigen::Vector3d& point : shown.cloud->boundary) {
    const auto pixel = camera.Project(found.camera_from_lidar * point);
    if (!pixel || !camera.Contains(*pixel)) continue;
    cv::circle(
        picture,
        {static_cast<int>(std::lround(pixel->x())), static_cast<int>(std::lround(pixel->y()))},
        static_cast<int>(1.6 * size), ColourOf(DistanceToOutline(*pixel, shown.image->outline)),
        cv::FILLED, cv::LINE_AA);
  }
  const double scale = std::min(1.0, 1280.0 / picture.cols);
  if (scale < 1) cv::resize(picture, picture, {}, scale, scale, cv::INTER_AREA);
  return picture;
}

// A held-out view or, with none, one used; its board is the one that the calibration chooses.
std::optional<CameraView> ToShow(const CameraCalibration& camera,
                                 const std::vector<ViewDetection>& detections) {
  std::optional<CameraView> best;
  for (const ViewDetection& detection : detections) {
    if (best && (best->heldout || !detection.heldout)) continue;
    CameraView chosen = WithChosenCandidate(CameraViewOf(camera.camera, detection),
                                            camera.camera_from_lidar, kJudgeGate);
    if (chosen.usable()) best = std::move(chosen);
  }
  return best;
}

void AddOverlay(const Session& session, const std::vector<ViewDetection>& detections,
                const CameraCalibration& camera, std::vector<ReportPicture>* pictures) {
  const auto shown = ToShow(camera, detections);
  if (!shown) return;
  pictures->push_back(
      {camera.camera + ", view " + shown->view + (shown->heldout ? ", held out" : ""),
       "The board's boundary points in the cloud, laid on the image by the calibration. Green: "
       "within 1 px of the board's outline; yellow: within 4 px; red: beyond.",
       Overlay(session, *shown, camera)});
}

void AddColouring(const Session& session, const CameraCalibration& camera,
                  std::vector<ReportPicture>* pictures) {
  if (!camera.covariance) return;
  cv::Mat picture = ColouringPicture(session.rig.Camera(camera.camera), *camera.covariance);
  if (picture.empty()) return;
  pictures->push_back({camera.camera + ": how sure a colour is", kColouringCaption, picture});
}

std::string PlainPage(const Session& session, const std::vector<ViewDetection>& detections,
                      const Report& report) {
  std::vector<ReportPicture> pictures;
  for (const CameraReport& camera : report.cameras) {
    AddOverlay(session, detections, camera.calibration, &pictures);
    AddColouring(session, camera.calibration, &pictures);
  }
  return ReportHtml(report, pictures);
}

// The picture of how sure a colour is, as the image of a view "sigma".
void AddSigmaFrame(const Session& session, const CameraCalibration& camera,
                   std::vector<viewer::NamedFrame>* frames) {
  std::vector<ReportPicture> pictures;
  AddColouring(session, camera, &pictures);
  for (const ReportPicture& picture : pictures) {
    Image image;
    image.camera = camera.camera;
    image.format = PixelFormat::kBgr8;
    image.pixels = picture.bgr;
    frames->push_back(
        {"image/sigma/" + camera.camera, viewer::ImageFrame(image, "sigma", false, {1280, 90})});
  }
}

// The viewer's page with the whole session in it.
std::string ViewerPage(const Session& session, const std::vector<ViewDetection>& detections,
                       const Report& report) {
  viewer::SessionFramesOptions options;
  options.title = session.root.lexically_normal().string();
  options.version = Version();
  std::vector<viewer::NamedFrame> frames =
      viewer::SessionFrames(session, detections, report, options);
  for (const CameraReport& camera : report.cameras) {
    AddSigmaFrame(session, camera.calibration, &frames);
  }
  return viewer::PageWithFrames(viewer::Page(), frames);
}

void WriteReportFiles(const std::filesystem::path& dir, const Session& session,
                      const std::vector<ViewDetection>& detections, const Report& report) {
  WriteReport(dir / "report.json", report);
  WriteFileAtomically(dir / "report.html", viewer::Page().empty()
                                               ? PlainPage(session, detections, report)
                                               : ViewerPage(session, detections, report));
}

}  // namespace

std::string WriteIfSolved(const std::filesystem::path& dir, const Report& report) {
  const std::filesystem::path path = dir / "calibration.textproto";
  const Calibration calibration = report.ToCalibration();
  if (calibration.cameras.empty()) {
    return "no camera was solved, so " + path.string() + " was not written; wrote";
  }
  WriteCalibration(path, calibration);
  return "wrote " + path.string() + ",";
}

bool FinishReport(const std::filesystem::path& dir, const std::string& truth,
                  const std::string& wrote, const Session& session,
                  const SessionDetection& detection, Report* report) {
  const std::filesystem::path beside = session.root / "truth.textproto";
  if (!truth.empty() || std::filesystem::exists(beside)) {
    AddTruth(ReadTruth(PathOr(truth, beside)), report);
  }
  WriteReportFiles(dir, session, detection.views, *report);
  std::fputs(ReportTable(*report).c_str(), stdout);
  std::printf("%s report.json, report.html\n", wrote.c_str());
  for (const std::string& line : detection.unreadable) {
    std::fprintf(stderr, "rgbdt: %s\n", line.c_str());
  }
  return detection.unreadable.empty();
}

}  // namespace rgbdt
