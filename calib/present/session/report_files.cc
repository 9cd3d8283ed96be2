#include "calib/present/session/report_files.h"

#include "calib/files/atomic_file.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/report_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/present/pictures/colouring_picture.h"
#include "calib/present/pictures/lidar_picture.h"
#include "calib/present/report/report_html.h"
#include "calib/present/report/summary.h"
#include "calib/present/report/verdict.h"
#include "calib/present/session/internal/overlay_picture.h"

namespace rgbdt {
namespace {

std::string PlainPage(const FinishedSession& finished) {
  std::vector<ReportPicture> pictures;
  for (const CameraReport& report : finished.report().cameras) {
    const CameraCalibration& camera = report.calibration;
    if (auto picture = OverlayPicture(finished, camera)) pictures.push_back(std::move(*picture));
    const cv::Mat map = ColouringPicture(finished.session.rig.Camera(camera.camera), camera);
    if (!map.empty()) {
      pictures.push_back({camera.camera + ": projection uncertainty", kColouringCaption, map});
    }
    const cv::Mat lidar = LidarPicture(report);
    if (!lidar.empty()) {
      pictures.push_back({camera.camera + ": the LIDAR's own errors", kLidarCaption, lidar});
    }
  }
  return ReportHtml(ContentOf(finished.report()), pictures);
}

// The viewer's page with the whole session in it.
std::string PageOf(const FinishedSession& finished) {
  SessionFramesOptions options;
  options.title = finished.session.Title();
  return PageWithFrames(ViewerPage(), SessionFrames(finished, options),
                        Summary(finished.report()).FullReport());
}

}  // namespace

std::string WriteIfSolved(const std::filesystem::path& dir, const Rig& rig, Report* report) {
  const std::filesystem::path path = dir / "calibration.textproto";
  const std::string kept = KeepTimings(dir, rig, report);
  const Calibration calibration = JudgedCalibration(*report, rig);
  if (calibration.cameras.empty()) {
    return "no camera was solved, so " + path.string() + " was not written; wrote";
  }
  WriteCalibration(path, calibration);
  return (kept.empty() ? "" : kept + "\n") + "wrote " + path.string() + ",";
}

void WriteReportFiles(const std::filesystem::path& dir, const FinishedSession& finished) {
  WriteReport(dir / "report.json", WithVerdicts(finished.report()));
  WriteFileAtomically(dir / "report.html",
                      ViewerPage().empty() ? PlainPage(finished) : PageOf(finished));
}

}  // namespace rgbdt
