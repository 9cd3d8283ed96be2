// How far a LIDAR's pose relative to another one is off, calibrated from the same views, and
// whether its covariance says so.
//   study_lidars sampled|physics RINGS FURTHER VIEWS SESSIONS SEED CSV
// draws sessions of the noise model (sampled_sessions.h): the reference of RINGS rings, a second
// LIDAR of FURTHER. physics: lenses, the board's print and both LIDARs are off in every way that
// real ones are. A line of CSV for each session.
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "calib/methods/calibrate.h"
#include "calib/model/linear_algebra.h"
#include "tests/study/sampled_sessions.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

SampledOptions OptionsOf(const std::string& how, int rings, int further, int views) {
  SampledOptions options;
  options.rings = rings;
  options.views = views;
  options.heldout = 0;
  options.further_rings = {further};
  options.physics = how == "physics";
  options.lenses_off = options.physics;
  if (options.physics) options.print_sigma = kUsualPrintSigma;
  return options;
}

double Nees(const LidarCalibration& found, const Rigid3& truth) {
  const Vector6d delta = Log(truth * found.reference_from_lidar.Inverse());
  return delta.dot(SolveSymmetric(*found.covariance, delta));
}

void WriteLine(const std::string& how, std::uint64_t seed, const SampledSession& session,
               std::ofstream* csv) {
  CalibrateOptions options;
  options.diagnostics = false;
  const Report report = Calibrate(session.rig, session.detections, options);
  const LidarReport& lidar = report.lidars.at(0);
  const LidarCalibration& found = lidar.calibration;
  const Rigid3& truth = session.truth.reference_from_lidar.at(found.lidar);
  const PoseError error = ErrorOfLidar(found.reference_from_lidar, truth);
  *csv << how << ',' << seed << ',' << found.converged() << ',' << lidar.used.size() << ','
       << found.covariance.has_value() << ',' << error.rotation_deg << ',' << error.translation_mm
       << ',' << (found.covariance ? Nees(found, truth) : 0) << ",\"" << found.detail << "\"\n";
}

void Run(const std::vector<std::string>& arguments) {
  const std::string& how = arguments[0];
  if (how != "sampled" && how != "physics") throw std::runtime_error("no sessions " + how);
  const SampledOptions options =
      OptionsOf(how, std::stoi(arguments[1]), std::stoi(arguments[2]), std::stoi(arguments[3]));
  const int count = std::stoi(arguments[4]);
  const std::uint64_t first = std::stoull(arguments[5]);
  std::ofstream csv(arguments[6]);
  csv << "how,seed,converged,used,has_sigma,rotation_deg,translation_mm,nees,why\n";
  int made = 0;
  for (std::uint64_t seed = first; made < count; ++seed) {
    if (seed > first + 10 * static_cast<std::uint64_t>(count)) {
      throw std::runtime_error("no room in the scenes");
    }
    const auto session = SampleSession(options, seed);
    if (!session) continue;
    WriteLine(how, seed, *session, &csv);
    ++made;
  }
  std::printf("lidars %s: %d sessions\n", how.c_str(), made);
  if (!csv.flush()) throw std::runtime_error("cannot write " + arguments[6]);
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  return rgbdt::study::StudyMain(
      {"study_lidars", "sampled|physics RINGS FURTHER VIEWS SESSIONS SEED CSV", 7, 7,
       rgbdt::study::Run},
      argc, argv);
}
