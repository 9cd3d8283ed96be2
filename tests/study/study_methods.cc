// All methods on one session, from guesses that are off.
//   study_methods SESSION STARTS SEED CSV [METHOD...]
// SESSION: a session directory with a board in natural surroundings and with truth.textproto.
// From each size of guess, STARTS times: camera_from_lidar is turned and moved off the truth in
// directions drawn from SEED. Methods that need no guess run once. METHODs: of rgbdt calibrate and
// rgbdt refine; default: all. A line of CSV for each method, guess and camera.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "calib/files/schema/calibration_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/methods/calibrate.h"
#include "calib/methods/detect_session.h"
#include "calib/methods/refine.h"
#include "calib/model/errors.h"
#include "calib/model/linear_algebra.h"
#include "tests/study/starts.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

constexpr double kDegree = M_PI / 180;

// How far off a guess is.
struct GuessSize {
  double degrees = 0, millimetres = 0;
};
constexpr GuessSize kGuessSizes[] = {{1, 25}, {2, 50}, {5, 125}, {10, 250}};
// The paper's method smooths whatever lies where its guess puts the board: from farther off that
// may be a street's ground right before the LIDAR, which takes it many minutes.
constexpr double kMostForPaperDeg = 5;

// One session, one file of rows.
class Trials {
 public:
  Trials(const std::string& dir, int starts, std::uint64_t seed, const std::string& csv)
      : session_(OpenSession(dir)),
        truth_(ReadTruth(session_.root / "truth.textproto")),
        starts_(starts),
        seed_(seed),
        csv_(csv) {
    csv_ << "method,camera,guess_deg,guess_mm,start_number,rotation_deg,translation_mm,converged,"
            "sigma_deg,chi2,detect_s,solve_s\n";
  }

  void Run(const std::string& method) {
    if (Has(kRefineMethodNames, method)) {
      FromEachGuess(method, [&](const Rig& rig, const GuessSize& size) {
        return Refined(rig, method, size);
      });
    } else if (method == kPaperMethod) {
      FromEachGuess(method,
                    [&](const Rig& rig, const GuessSize&) { return Calibrated(rig, method); });
    } else {
      Write(method, {}, 0, Calibrated(session_.rig, method));
    }
  }

  static bool Has(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  }

 private:
  // With a rig file whose hand-measured guesses are off.
  template <typename Solve>
  void FromEachGuess(const std::string& method, const Solve& solve) {
    for (const GuessSize& size : kGuessSizes) {
      if (method == kPaperMethod && size.degrees > kMostForPaperDeg) continue;
      std::mt19937_64 random(seed_);  // every method has the same guesses
      for (int start = 0; start < starts_; ++start) {
        Rig rig = session_.rig;
        for (CameraSpec& camera : rig.cameras) {
          camera.camera_from_lidar_guess =
              OffBy(truth_.camera_from_lidar.at(camera.name), size.degrees * kDegree,
                    size.millimetres * 1e-3, &random);
        }
        Write(method, size, start, solve(rig, size));
      }
    }
  }

  Report Calibrated(const Rig& rig, const std::string& method) const {
    Session session = session_;
    session.rig = rig;
    const SessionDetection detection = DetectSession(session, method, [](const std::string&) {});
    CalibrateOptions options;
    options.method = method;
    options.diagnostics = false;
    options.wide_start = false;
    return Calibrate(rig, detection.views, options);
  }

  Report Refined(const Rig& rig, const std::string& method, const GuessSize& size) {
    if (views_.empty()) {
      for (const std::string& name : session_.views) views_.push_back(ReadView(session_, name));
    }
    RefineOptions options;
    options.method = method;
    if (size.degrees > 3) {  // as `rgbdt refine --search` does; natural's alone
      options.natural.rotation_sigma_rad = 6 * kDegree;
      options.natural.translation_sigma_m = 0.12;
    }
    return Refine(rig, views_, {}, options);
  }

  void Write(const std::string& method, const GuessSize& size, int start, const Report& report) {
    for (const CameraReport& camera : report.cameras) {
      const CameraCalibration& found = camera.calibration;
      const Rigid3& right = truth_.camera_from_lidar.at(found.camera);
      csv_ << method << ',' << found.camera << ',';
      if (size.degrees > 0)
        csv_ << size.degrees << ',' << size.millimetres;
      else
        csv_ << ',';
      csv_ << ',' << start << ',';
      if (found.solved()) {
        const PoseError error = ErrorOf(found.camera_from_lidar, right);
        csv_ << error.rotation_deg << ',' << error.translation_mm;
      } else {
        csv_ << ',';
      }
      csv_ << ',' << found.converged() << ',';
      if (found.covariance) {
        const Vector6d delta = Log(right * found.camera_from_lidar.Inverse());
        csv_ << std::sqrt(found.covariance->topLeftCorner<3, 3>().trace()) / kDegree << ','
             << delta.dot(SolveSymmetric(*found.covariance, delta));
      } else {
        csv_ << ',';
      }
      csv_ << ',' << camera.detect_image_s + camera.detect_cloud_s << ',' << camera.solve_s << "\n"
           << std::flush;
    }
  }

  Session session_;
  Truth truth_;
  int starts_;
  std::uint64_t seed_;
  std::ofstream csv_;
  std::vector<View> views_;
};

std::vector<std::string> AllMethods() {
  std::vector<std::string> all = kMethodNames;
  all.insert(all.end(), kRefineMethodNames.begin(), kRefineMethodNames.end());
  return all;
}

void Run(const std::vector<std::string>& a) {
  std::vector<std::string> methods(a.begin() + 4, a.end());
  if (methods.empty()) methods = AllMethods();
  for (const std::string& method : methods) {
    if (!Trials::Has(AllMethods(), method)) throw InputError("there is no method " + method);
  }
  Trials trials(a[0], std::stoi(a[1]), std::stoull(a[2]), a[3]);
  for (const std::string& method : methods) trials.Run(method);
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  return rgbdt::study::StudyMain(
      {"study_methods", "SESSION STARTS SEED CSV [METHOD...]", 4, 20, rgbdt::study::Run}, argc,
      argv);
}
