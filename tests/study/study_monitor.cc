// A mount watched while the rig drives: standing still, knocked, drifting.
//   study_monitor SESSION MODE RUNS SEED SIZE_DEG CSV
// SESSION: a session directory with truth.textproto, its views in the order of driving. MODE: still
// (all views), knock (SIZE_DEG, about an axis drawn from SEED, before the sixth of ten sweeps),
// random (the same, by as much as the watch takes mounts to turn), drift (of yaw, SIZE_DEG a
// sweep). The calibration at hand is off by what it states: 1 sigma 0.02 deg and 1 mm. That a LIDAR
// was knocked is put into its clouds, so it turns about its own origin: shifted clouds would show
// rims that no beam from there sees. A line of CSV for each sweep and camera.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "calib/files/session/session_dir.h"
#include "calib/model/linear_algebra.h"
#include "calib/model/stopwatch.h"
#include "calib/monitor/mount_watch.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

constexpr double kDegree = M_PI / 180;
constexpr std::size_t kBefore = 5, kAfter = 5;

double Even(std::mt19937_64* random) { return static_cast<double>((*random)() >> 11) * 0x1p-53; }

double Normal(std::mt19937_64* random) {
  return std::sqrt(-2 * std::log(1 - Even(random))) * std::cos(2 * M_PI * Even(random));
}

Eigen::Vector3d Normals(std::mt19937_64* random) {
  const double x = Normal(random), y = Normal(random);
  return {x, y, Normal(random)};
}

// The LIDAR turned about its own origin such that the camera is turned by `turn` (camera's axes,
// rad) against it: turned_lidar_from_lidar.
Rigid3 TurnedLidar(const Rigid3& camera_from_lidar, const Eigen::Vector3d& turn) {
  Vector6d delta = Vector6d::Zero();
  delta.head<3>() = -(camera_from_lidar.rotation.inverse() * turn);
  return Exp(delta);
}

// As the turned LIDAR sees it.
Cloud Seen(Cloud cloud, const Rigid3& turned_lidar_from_lidar) {
  const Eigen::Quaterniond& turn = turned_lidar_from_lidar.rotation;
  for (Eigen::Vector3f& point : cloud.points) point = (turn * point.cast<double>()).cast<float>();
  for (Eigen::Vector3f& direction : cloud.directions) {
    direction = (turn * direction.cast<double>()).cast<float>();
  }
  return cloud;
}

struct Case {
  std::string session, mode;
  double size_deg = 0;
};

class Recorder {
 public:
  explicit Recorder(const std::string& path) : csv_(path) {
    csv_ << "session,mode,size_deg,camera,run,sweep,since,holds,state,true_deg,rotation_deg,"
            "translation_mm,sigma_deg,chi2,yaw_error_deg,edges,shown,seconds\n";
  }
  void Write(const Case& own, int run, std::size_t sweep, int since, double turned_rad,
             const Rigid3& now, const MountCheck& check, double seconds) {
    const PoseError error = ErrorOf(check.camera_from_lidar, now);
    const Vector6d off = Log(check.camera_from_lidar * now.Inverse());
    csv_ << own.session << ',' << own.mode << ',' << own.size_deg << ',' << check.camera << ','
         << run << ',' << sweep << ',' << since << ',' << check.holds.value_or(-1) << ','
         << static_cast<int>(check.state) << ',' << turned_rad / kDegree << ','
         << error.rotation_deg << ',' << error.translation_mm << ','
         << std::sqrt(check.covariance.topLeftCorner<3, 3>().trace()) / kDegree << ','
         << off.dot(SolveSymmetric(check.covariance, off)) << ',' << off[1] / kDegree << ','
         << check.edges << ',' << check.shown << ',' << seconds << '\n';
  }

 private:
  std::ofstream csv_;
};

void Run(const std::vector<std::string>& a) {
  const Session session = OpenSession(a[0]);
  const Truth truth = ReadTruth(session.root / "truth.textproto");
  const Case own{session.root.filename().string(), a[1], std::stod(a[4])};
  const bool knocks = own.mode == "knock" || own.mode == "random";
  std::mt19937_64 random(std::stoull(a[3]));
  Recorder recorder(a[5]);
  std::vector<View> views;
  for (const std::string& name : session.views) views.push_back(ReadView(session, name));
  for (const CameraSpec& camera : session.rig.cameras) {
    const Rigid3& right = truth.camera_from_lidar.at(camera.name);
    for (int run = 0; run < std::stoi(a[2]); ++run) {
      CameraCalibration calibration;
      calibration.camera = camera.name;
      calibration.status = SolveStatus::kConverged;
      Vector6d sigma;
      sigma << Eigen::Vector3d::Constant(0.02 * kDegree), Eigen::Vector3d::Constant(1e-3);
      calibration.covariance = Matrix6d(sigma.cwiseAbs2().asDiagonal());
      Vector6d off;
      off << Normals(&random), Normals(&random);
      calibration.camera_from_lidar = Exp(Vector6d(sigma.cwiseProduct(off))) * right;
      Eigen::Vector3d knock = own.size_deg * kDegree * Normals(&random).normalized();
      if (own.mode == "random") {
        const WatchOptions usual;
        knock = usual.moved_rad[random() % usual.moved_rad.size()] * Normals(&random);
      }
      const std::size_t most = views.size() - kBefore - kAfter;
      const std::size_t first =
          knocks ? std::min(most,
                            static_cast<std::size_t>(Even(&random) * static_cast<double>(most + 1)))
                 : 0;
      const std::size_t end = knocks ? first + kBefore + kAfter : views.size();
      MountWatch watch(camera);
      watch.SetCalibration(calibration, 1);
      for (std::size_t v = first; v < end; ++v) {
        const int since = static_cast<int>(v) - static_cast<int>(first + kBefore) + 1;
        Eigen::Vector3d turn = Eigen::Vector3d::Zero();
        if (knocks && since > 0) turn = knock;
        if (own.mode == "drift") turn.y() = own.size_deg * kDegree * static_cast<double>(v);
        const Rigid3 turned_lidar_from_lidar = TurnedLidar(right, turn);
        const Rigid3 now = right * turned_lidar_from_lidar.Inverse();
        const Cloud cloud = Seen(views[v].cloud, turned_lidar_from_lidar);
        const auto image =
            std::find_if(views[v].images.begin(), views[v].images.end(),
                         [&](const Image& one) { return one.camera == camera.name; });
        const Stopwatch stopwatch;
        const MountCheck check = watch.Add({views[v].name, &cloud, &*image});
        recorder.Write(own, run, v, since, turn.norm(), now, check, stopwatch.Seconds());
      }
    }
  }
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  return rgbdt::study::StudyMain(
      {"study_monitor", "SESSION MODE RUNS SEED SIZE_DEG CSV", 6, 6, rgbdt::study::Run}, argc,
      argv);
}
