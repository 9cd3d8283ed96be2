// The calibration without a target, from starts that are off.
//   study_natural SESSION SHOTS STARTS SEED ROTATION_DEG TRANSLATION_MM CSV
// SESSION: a session directory with truth.textproto or, without, a calibration to be compared with.
// STARTS: for each group of SHOTS views, camera_from_lidar is turned by ROTATION_DEG and moved by
// TRANSLATION_MM, in directions drawn from SEED. A line of CSV for each start and camera.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "calib/files/schema/calibration_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/methods/natural/by_scene.h"
#include "calib/methods/natural/shot_places.h"
#include "calib/model/linear_algebra.h"
#include "calib/model/stopwatch.h"
#include "tests/study/starts.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

constexpr double kDegree = M_PI / 180;

void Run(const std::vector<std::string>& a) {
  const Session session = OpenSession(a[0]);
  Truth truth;
  Calibration right_one;
  if (std::filesystem::exists(session.root / "truth.textproto")) {
    truth = ReadTruth(session.root / "truth.textproto");
  } else {
    right_one = ReadCalibration(session.root / "calibration.textproto");
    for (const CameraCalibration& camera : right_one.cameras) {
      truth.camera_from_lidar[camera.camera] = camera.camera_from_lidar;
    }
  }
  const std::size_t per_group = std::stoul(a[1]);
  const int starts = std::stoi(a[2]);
  std::mt19937_64 random(std::stoull(a[3]));
  const double rotation = std::stod(a[4]) * kDegree;
  const double translation = std::stod(a[5]) * 1e-3;
  NaturalOptions options;
  if (rotation > 3 * kDegree) {  // as `rgbdt refine --search` does
    options.rotation_sigma_rad = 6 * kDegree;
    options.translation_sigma_m = 0.12;
  }
  std::ofstream csv(a[6]);
  csv << "place,camera,group,start,start_deg,start_mm,rotation_deg,translation_mm,sigma_deg,"
         "sigma_mm,chi2,converged,edges,shown,marks,marks_shown,solve_s\n";
  std::vector<View> views;
  for (const std::string& name : session.views) views.push_back(ReadView(session, name));
  std::vector<ShotPlace> places;  // of a group without the others
  for (std::size_t first = 0; first + per_group <= views.size(); first += per_group) {
    std::vector<const Cloud*> sweeps;
    for (std::size_t v = first; v < first + per_group; ++v) sweeps.push_back(&views[v].cloud);
    for (const ShotPlace& place : FindPlaces(sweeps)) places.push_back(place);
  }
  for (const CameraSpec& given : session.rig.cameras) {
    const CameraSpec camera = right_one.WithSolvedLens(given);
    for (std::size_t first = 0; first + per_group <= views.size(); first += per_group) {
      std::vector<Shot> shots;
      for (std::size_t v = first; v < first + per_group; ++v) {
        for (const Image& image : views[v].images) {
          if (image.camera == camera.name) {
            shots.push_back({views[v].name, &views[v].cloud, &image, places[v]});
            break;
          }
        }
      }
      for (int i = 0; i < starts; ++i) {
        const Rigid3& right = truth.camera_from_lidar.at(camera.name);
        const Rigid3 start = OffBy(right, rotation, translation, &random);
        const Stopwatch watch;
        const SceneAlignment found =
            AlignToScene(MakeSceneProblem(camera, shots, options), start, options);
        const double seconds = watch.Seconds();
        const PoseError error = ErrorOf(found.fit.camera_from_lidar, right);
        const Matrix6d& covariance = *found.fit.covariance;
        const Vector6d delta = Log(right * found.fit.camera_from_lidar.Inverse());
        const PoseError start_error = ErrorOf(start, right);
        csv << session.root.filename().string() << ',' << camera.name << ',' << first << ',' << i
            << ',' << start_error.rotation_deg << ',' << start_error.translation_mm << ','
            << error.rotation_deg << ',' << error.translation_mm << ','
            << std::sqrt(covariance.topLeftCorner<3, 3>().trace()) / kDegree << ','
            << 1e3 * std::sqrt(covariance.bottomRightCorner<3, 3>().trace()) << ','
            << delta.dot(SolveSymmetric(covariance, delta)) << ',' << found.fit.converged << ','
            << found.sums.Depth().edges << ',' << found.sums.Depth().Share() << ','
            << found.sums.shown[1].edges << ',' << found.sums.shown[1].Share() << ',' << seconds
            << '\n';
      }
    }
  }
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  return rgbdt::study::StudyMain(
      {"study_natural", "SESSION SHOTS STARTS SEED ROTATION_DEG TRANSLATION_MM CSV", 7, 7,
       rgbdt::study::Run},
      argc, argv);
}
