#include "calib/present/session/internal/overlay_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calib/camera/camera.h"
#include "calib/camera/pixels.h"
#include "calib/solve/evaluate.h"
#include "calib/solve/first_guess.h"

namespace rgbdt {
namespace {

// The boundary points on the image: green within 1 px of the outline, then yellow, red beyond 4 px.
cv::Scalar ColourOf(double distance) {
  if (distance <= 1) return {80, 220, 60};
  if (distance <= 4) return {40, 210, 250};
  return {60, 60, 250};
}

cv::Mat LayOnImage(const Session& session, const CameraView& shown,
                   const CameraCalibration& found) {
  const View view = ReadView(session, shown.view);
  const auto image = std::find_if(view.images.begin(), view.images.end(),
                                  [&](const Image& i) { return i.camera == found.camera; });
  const Camera camera(found.WithSolvedLens(session.rig.Camera(found.camera)));
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

}  // namespace

std::optional<ReportPicture> OverlayPicture(const FinishedSession& finished,
                                            const CameraCalibration& camera) {
  const auto shown = ToShow(camera, finished.detections);
  if (!shown) return std::nullopt;
  return ReportPicture{
      camera.camera + ", view " + shown->view + (shown->heldout ? ", held out" : ""),
      "The board's boundary points in the cloud, laid on the image by the calibration. Green: "
      "within 1 px of the board's outline; yellow: within 4 px; red: beyond.",
      LayOnImage(finished.session, *shown, camera)};
}

}  // namespace rgbdt
