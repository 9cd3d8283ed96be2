// How far calibrations with a board with holes (velo2cam's and FAST-Calib's) are off, and whether
// they know it.
//   study_holes RINGS VIEWS SESSIONS SEED CSV
// renders sessions (rendered_sessions.h); RINGS 0: the turned scanner. A line of CSV for each
// session and camera: in how many views image and cloud show the board, and how far its pose is
// off.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "calib/methods/calibrate.h"
#include "calib/model/linear_algebra.h"
#include "tests/study/rendered_sessions.h"
#include "tests/study/study_main.h"
#include "tests/unit/detect/image/marked_scene.h"

namespace rgbdt::study {
namespace {

double Nees(const CameraCalibration& found, const Rigid3& truth) {
  const Vector6d delta = Log(truth * found.camera_from_lidar.Inverse());
  return delta.dot(SolveSymmetric(*found.covariance, delta));
}

void WriteLines(int rings, std::uint64_t seed, const RenderedSession& session, std::ofstream* csv) {
  const auto clouds =
      std::count_if(session.detections.begin(), session.detections.end(),
                    [](const ViewDetection& view) { return !view.cloud.candidates.empty(); });
  CalibrateOptions options;
  options.diagnostics = false;
  const Report report = Calibrate(session.rig, session.detections, options);
  for (const CameraReport& camera : report.cameras) {
    const CameraCalibration& found = camera.calibration;
    const auto images = std::count_if(session.detections.begin(), session.detections.end(),
                                      [&](const ViewDetection& view) {
                                        const ImageDetection* image = view.Find(found.camera);
                                        return image != nullptr && image->usable();
                                      });
    const Rigid3& truth = session.truth.camera_from_lidar.at(found.camera);
    const PoseError error = ErrorOf(found.camera_from_lidar, truth);
    *csv << rings << ',' << seed << ',' << found.camera << ',' << session.detections.size() << ','
         << images << ',' << clouds << ',' << found.converged() << ',';
    if (found.converged() && found.covariance) {
      *csv << error.rotation_deg << ',' << error.translation_mm << ',' << Nees(found, truth);
    } else {
      *csv << ",,";
    }
    *csv << ",\"" << found.detail << "\"\n";
  }
}

void Run(const std::vector<std::string>& arguments) {
  RenderedOptions options;
  options.rings = std::stoi(arguments[0]);
  options.views = std::stoi(arguments[1]);
  options.heldout = 0;
  options.board = HolesBoard();
  const int sessions = std::stoi(arguments[2]);
  const std::uint64_t first = std::stoull(arguments[3]);
  std::ofstream csv(arguments[4]);
  csv << "rings,seed,camera,views,images,clouds,converged,rotation_deg,translation_mm,nees,why\n";
  for (int i = 0; i < sessions; ++i) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
    WriteLines(options.rings, seed, RenderSession(options, seed), &csv);
  }
  std::printf("holes, %d rings: %d sessions\n", options.rings, sessions);
  if (!csv.flush()) throw std::runtime_error("cannot write " + arguments[4]);
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  return rgbdt::study::StudyMain(
      {"study_holes", "RINGS VIEWS SESSIONS SEED CSV", 5, 5, rgbdt::study::Run}, argc, argv);
}
