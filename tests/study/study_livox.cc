// How many boards are found in a Livox's clouds of one second, and how exactly; and how honest the
// calibration of sessions is.
//   study_livox scenes|sessions COUNT SEED CSV MODEL...
// makes COUNT scenes, or sessions of ten views, of each model (mid360, avia), and writes one line
// for each, or for each camera, to CSV.
#include <cstdio>
#include <ctime>
#include <fstream>
#include <stdexcept>
#include <string>

#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/methods/calibrate.h"
#include "calib/present/report/verdict.h"
#include "tests/study/livox_scenes.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

constexpr int kViews = 10;

// Degrees between the normals; the sign does not count.
double NormalError(const CloudEdges& found, const Rigid3& truth) {
  const Eigen::Vector3d normal = truth.rotation * Eigen::Vector3d::UnitZ();
  return std::asin(std::min(1.0, found.normal.normalized().cross(normal).norm())) /
         simulate::kDegree;
}

void WriteLine(const std::string& model, int index, const CloudScene& scene, std::ofstream* csv) {
  BoardInCloudOptions options;
  options.range_sigma_m = scene.range_sigma_m;
  const std::clock_t start = std::clock();  // CPU time: other programs do not count
  const BoardsInCloud boards = FindBoards(scene.cloud, scene.target, options);
  const double ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  // The likeliest is what counts: it is named the board.
  double centre_mm = 0, normal_deg = 0;
  PoseError error;
  if (!boards.candidates.empty()) {
    const CloudEdges& first = boards.candidates.front();
    error = ErrorOf(*first.pose, scene.lidar_from_target);
    centre_mm = 1e3 * (first.centre - scene.lidar_from_target.translation).norm();
    normal_deg = NormalError(first, scene.lidar_from_target);
  }
  *csv << model << ',' << index << ',' << scene.scene << ',' << scene.form << ','
       << scene.lidar_from_target.translation.norm() << ',' << !boards.candidates.empty() << ','
       << boards.candidates.size() << ',' << normal_deg << ',' << centre_mm << ','
       << error.rotation_deg << ',' << error.chi2 << ',' << scene.cloud.size() << ',' << ms << ",\""
       << boards.why << "\"\n";
}

void WriteSession(const std::string& model, std::uint64_t seed, const LivoxSession& session,
                  std::ofstream* csv) {
  const Report report = Calibrate(session.rig, session.detections, {});
  for (const CameraReport& camera : report.cameras) {
    const CameraCalibration& found = camera.calibration;
    const Rigid3& truth = session.truth.camera_from_lidar.at(found.camera);
    const rgbdt::PoseError error = rgbdt::ErrorOf(found.camera_from_lidar, truth);
    double sigma_deg = 0, sigma_mm = 0, nees = 0;
    if (found.covariance) {
      const Vector6d delta = Log(truth * found.camera_from_lidar.Inverse());
      nees = delta.dot(found.covariance->ldlt().solve(delta));
      sigma_deg = std::sqrt(found.covariance->topLeftCorner<3, 3>().trace()) / simulate::kDegree;
      sigma_mm = 1e3 * std::sqrt(found.covariance->bottomRightCorner<3, 3>().trace());
    }
    *csv << model << ',' << seed << ',' << found.camera << ',' << found.converged() << ','
         << camera.used.size() << ',' << found.covariance.has_value() << ',' << error.rotation_deg
         << ',' << error.translation_mm << ',' << sigma_deg << ',' << sigma_mm << ',' << nees << ','
         << (Judge(camera).grade > Grade::kUsable) << '\n';
  }
}

void WriteSessions(const std::string& model, simulate::LivoxModel which, int count,
                   std::uint64_t first, std::ofstream* csv) {
  int made = 0;
  for (std::uint64_t seed = first; made < count; ++seed) {
    if (seed > first + 10 * static_cast<std::uint64_t>(count)) {
      throw std::runtime_error("no room in the scenes");
    }
    const auto session = MakeLivoxSession(which, kViews, seed);
    if (!session) continue;
    WriteSession(model, seed, *session, csv);
    ++made;
  }
}

void Run(const std::vector<std::string>& arguments) {
  const bool sessions = arguments[0] == "sessions";
  if (!sessions && arguments[0] != "scenes") throw std::runtime_error("no part " + arguments[0]);
  const int count = std::stoi(arguments[1]);
  const std::uint64_t seed = std::stoull(arguments[2]);
  const std::string& path = arguments[3];
  std::ofstream csv(path);
  csv << (sessions ? "model,seed,camera,converged,used,has_sigma,rotation_deg,translation_mm,"
                     "sigma_deg,sigma_mm,nees,doubted\n"
                   : "model,scene,scenery,form,range_m,named,candidates,normal_deg,centre_mm,"
                     "rotation_deg,chi2,points,ms,why\n");
  for (std::size_t i = 4; i < arguments.size(); ++i) {
    const std::string& model = arguments[i];
    if (model != "mid360" && model != "avia") throw std::runtime_error("no model " + model);
    const auto which =
        model == "avia" ? simulate::LivoxModel::kAvia : simulate::LivoxModel::kMid360;
    if (sessions) {
      WriteSessions(model, which, count, seed, &csv);
    } else {
      RenderLivoxClouds(which, count, seed, [&](int index, const CloudScene& scene) {
        WriteLine(model, index, scene, &csv);
      });
    }
    std::printf("livox %s: %d %s\n", model.c_str(), count, arguments[0].c_str());
    std::fflush(stdout);
  }
  if (!csv.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  return rgbdt::study::StudyMain(
      {"study_livox", "scenes|sessions COUNT SEED CSV MODEL...", 5, 1000, rgbdt::study::Run}, argc,
      argv);
}
