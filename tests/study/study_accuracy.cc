// How far calibrations are off, and whether they know it.
//   study_accuracy sampled|offset|lens|print|physics|rendered|random SENSOR VIEWS HELDOUT SESSIONS
//   SEED CSV [METHOD...]
// SENSOR: dense (the turned scanner), 128, 64, 32 or 16. sampled: sessions drawn from the noise
// model (sampled_sessions.h), beside its Gaussian bound (bound.h). offset: the same with ranges off
// by a constant of up to 30 mm, which the rig does not rule out. lens: the same with lenses that
// are off by what the rig says of them. print: the same, and the pattern's print as far off as is
// usual. physics: the same, and the LIDAR off in every way that real ones are (DrawBeamPhysics).
// rendered: sessions of the simulator. random: the same with physics that are drawn, too
// (rendered_sessions.h). METHOD: auto, separate (each camera by
// itself), plane, first_guess or paper; all but the last, if none is given. A line of CSV for each
// session, method and camera.
#include <chrono>
#include <cstdio>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "calib/methods/calibrate.h"
#include "calib/model/beam_priors.h"
#include "calib/model/errors.h"
#include "calib/present/report/verdict.h"
#include "calib/simulate/lidar_options.h"
#include "tests/study/bound.h"
#include "tests/study/cloud_scenes.h"
#include "tests/study/rendered_sessions.h"
#include "tests/study/sampled_sessions.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

// chi-square of six degrees of freedom: 95% lie below.
constexpr double kInside95 = 12.592;
constexpr double kMostOffsetM = 0.03;

using Bounds = std::map<std::string, CameraBound>;

const std::vector<std::string> kUsualMethods = {"auto", "separate", "plane", "first_guess"};

/// A session, however it was made.
struct Trial {
  Rig rig;
  Truth truth;
  std::vector<ViewDetection> detections;
  Bounds bounds, plane_bounds;  ///< empty: rendered
  BeamModel model;              ///< the truth; rendered: see RenderedSession
};

struct Question {
  std::string how;  ///< the first argument
  std::string sensor;
  int rings = 0, views = 8, heldout = 4;
  std::vector<std::string> methods = kUsualMethods;
};

std::optional<Trial> MakeTrial(const Question& question, std::uint64_t seed) {
  if (question.how != "rendered" && question.how != "random") {
    SampledOptions options{question.rings, question.views, question.heldout};
    if (question.how == "offset") options.range_offset_m = kMostOffsetM;
    options.physics = question.how == "physics";
    const bool print_off = question.how == "print" || options.physics;
    if (print_off) options.print_sigma = kUsualPrintSigma;
    options.lenses_off = question.how == "lens" || print_off;
    auto made = SampleSession(options, seed);
    if (!made) return std::nullopt;
    return Trial{made->rig,
                 made->truth,
                 made->detections,
                 BoundOf(*made),
                 BoundOf(*made, BoundData::kPlanes),
                 made->model};
  }
  const bool random = question.how == "random";
  try {
    RenderedSession made =
        RenderSession({question.rings, question.views, question.heldout, random}, seed);
    return Trial{made.rig, made.truth, std::move(made.detections), {}, {}, made.model};
  } catch (const InputError& error) {
    std::printf("seed %llu left out: %s\n", static_cast<unsigned long long>(seed), error.what());
    return std::nullopt;
  }
}

/// The first guess alone, as a report.
Report GuessOnly(const Rig& rig, const std::vector<ViewDetection>& detections) {
  Report report;
  for (const CameraSpec& camera : rig.cameras) {
    const CameraViews views = ViewsOf(camera, detections);
    const auto begin = std::chrono::steady_clock::now();
    const FirstGuess guess = GuessFromBoards(views.Used());
    CameraReport& result = report.cameras.emplace_back();
    result.solve_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    result.calibration.camera = camera.name;
    result.calibration.status =
        guess.camera_from_lidar ? SolveStatus::kConverged : SolveStatus::kNotSolved;
    result.calibration.detail = guess.detail;
    if (!guess.camera_from_lidar) continue;
    result.calibration.camera_from_lidar = *guess.camera_from_lidar;
    result.calibration.covariance = guess.covariance;
    result.used.resize(static_cast<std::size_t>(guess.agreeing));
  }
  return report;
}

Report Solve(const std::string& method, const Trial& trial) {
  if (method == "first_guess") return GuessOnly(trial.rig, trial.detections);
  CalibrateOptions options;
  options.diagnostics = false;
  options.wide_start = false;
  options.joint = method != "separate";
  options.method = method == "separate" ? kAutoMethod : method;
  return Calibrate(trial.rig, trial.detections, options);
}

/// What the true extrinsics make of the views held out.
Report JudgeTruth(const Trial& trial) {
  std::vector<ViewDetection> heldout;
  for (const ViewDetection& view : trial.detections) {
    if (view.heldout) heldout.push_back(view);
  }
  Calibration calibration;
  calibration.method = kAutoMethod;
  for (const auto& [camera, pose] : trial.truth.camera_from_lidar) {
    calibration.cameras.push_back({camera, pose, std::nullopt, SolveStatus::kConverged, ""});
  }
  return Evaluate(trial.rig, heldout, calibration);
}

/// Chi-square of the boards in the views' clouds by their stated covariances: 1 on average.
std::optional<double> BoardChi2Per6(const Trial& trial) {
  double sum = 0;
  int count = 0;
  for (const ViewDetection& view : trial.detections) {
    const Rigid3& lidar_from_target = trial.truth.lidar_from_target.at(view.view);
    const int found = FindAmong(view.cloud.candidates, lidar_from_target);
    if (found < 0) continue;
    const auto& board = view.cloud.candidates[static_cast<std::size_t>(found)];
    sum += study::ErrorOf(*board.pose, lidar_from_target).chi2 / 6;
    ++count;
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

class Table {
 public:
  Table(const Question& question, const std::string& path)
      : question_(question), path_(path), csv_(path) {
    csv_ << "how,sensor,seed,views,method,camera,converged,used,rotation_deg,centre_mm,chi2,"
            "inside95,sigma_rotation_deg,sigma_centre_mm,bound_rotation_deg,bound_centre_mm,"
            "bound_rotation_deg_median,bound_centre_mm_median,plane_bound_rotation_deg,"
            "plane_bound_centre_mm,edge_rms_whitened,dt_px,dt_truth_px,board_chi2_per_6,solve_ms,"
            "calibrate_ms,range_offset_mm,range_offset_error_mm,range_offset_chi2,dark_range_mm,"
            "beams_meet_mm,doubtful,status\n";
  }

  void Add(const Trial& trial, std::uint64_t seed) {
    const Report truth = JudgeTruth(trial);
    const auto board_chi2 = BoardChi2Per6(trial);
    for (const std::string& method : question_.methods) {
      const auto begin = std::chrono::steady_clock::now();
      const Report report = Solve(method, trial);
      const double seconds =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      for (std::size_t i = 0; i < report.cameras.size(); ++i) {
        const CameraReport& camera = report.cameras[i];
        csv_ << question_.how << ',' << question_.sensor << ',' << seed << ',' << question_.views
             << ',' << method;
        WriteError(camera, trial);
        WriteBounds(camera.calibration.camera, trial);
        Write(camera.edge_rms_whitened.heldout);
        Write(camera.distance_transform_px.heldout);
        Write(truth.cameras[i].distance_transform_px.heldout);
        Write(board_chi2);
        csv_ << ',' << 1e3 * camera.solve_s << ',' << 1e3 * seconds;
        WriteOffset(camera, trial);
        csv_ << ",\"" << camera.calibration.StatusText() << "\"\n";
      }
    }
  }

  void Close() {
    if (!csv_.flush()) throw std::runtime_error("cannot write " + path_);
  }

 private:
  // Nothing, where a figure is not to be had.
  void Write(const std::optional<double>& value) {
    csv_ << ',';
    if (value) csv_ << *value;
  }

  void WriteError(const CameraReport& camera, const Trial& trial) {
    const CameraCalibration& found = camera.calibration;
    const Rigid3& truth = trial.truth.camera_from_lidar.at(found.camera);
    const rgbdt::PoseError error = rgbdt::ErrorOf(found.camera_from_lidar, truth);
    std::optional<double> chi2, inside, sigma_deg, sigma_mm;
    if (found.covariance) {
      const Vector6d delta = Log(truth * found.camera_from_lidar.Inverse());
      chi2 = delta.dot(found.covariance->ldlt().solve(delta));
      inside = *chi2 <= kInside95 ? 1 : 0;
      sigma_deg = std::sqrt(found.covariance->topLeftCorner<3, 3>().trace()) / simulate::kDegree;
      sigma_mm = 1e3 * std::sqrt(found.covariance->bottomRightCorner<3, 3>().trace());
    }
    csv_ << ',' << found.camera << ',' << found.converged() << ',' << camera.used.size() << ','
         << error.rotation_deg << ',' << error.translation_mm;
    for (const auto& value : {chi2, inside, sigma_deg, sigma_mm}) Write(value);
  }

  // And whether the report itself says that the result is not to be trusted.
  void WriteOffset(const CameraReport& camera, const Trial& trial) {
    std::optional<double> error_mm, chi2;
    const auto& errors = camera.calibration.range_errors;
    if (errors && errors->offset_m.sigma > 0) {
      const double error_m = errors->offset_m.value - trial.model.range_offset_m;
      error_mm = 1e3 * error_m;
      chi2 = std::pow(error_m / errors->offset_m.sigma, 2);
    }
    Write(1e3 * trial.model.range_offset_m);
    Write(error_mm);
    Write(chi2);
    Write(1e3 * trial.model.dark_range_m);
    Write(1e3 * trial.model.beams_meet_m);
    csv_ << ',' << (Judge(camera).grade > Grade::kUsable);
  }

  void WriteBounds(const std::string& camera, const Trial& trial) {
    if (trial.bounds.empty()) {
      csv_ << ",,,,,,";
      return;
    }
    const CameraBound& bound = trial.bounds.at(camera);
    const CameraBound& planes = trial.plane_bounds.at(camera);
    csv_ << ',' << bound.rotation_deg << ',' << bound.centre_mm << ',' << bound.rotation_deg_median
         << ',' << bound.centre_mm_median << ',' << planes.rotation_deg << ',' << planes.centre_mm;
  }

  Question question_;
  std::string path_;
  std::ofstream csv_;
};

int RingsOf(const std::string& sensor) {
  static const std::map<std::string, int> kRings = {
      {"dense", 0}, {"128", 128}, {"64", 64}, {"32", 32}, {"16", 16}};
  const auto found = kRings.find(sensor);
  if (found == kRings.end()) {
    throw std::runtime_error("SENSOR is " + sensor + "; there are: dense, 128, 64, 32, 16");
  }
  return found->second;
}

void Run(Question question, int sessions, std::uint64_t seed, const std::string& path) {
  const std::set<std::string> ways = {"sampled", "offset",   "lens",  "print",
                                      "physics", "rendered", "random"};
  if (ways.count(question.how) == 0) {
    throw std::runtime_error(
        "expected sampled, offset, lens, print, physics, rendered or random, not " + question.how);
  }
  question.rings = RingsOf(question.sensor);
  Table table(question, path);
  int made = 0;
  for (std::uint64_t i = 0; made < sessions; ++i) {
    if (i > 20 * static_cast<std::uint64_t>(sessions)) throw std::runtime_error("no room");
    const std::uint64_t session = 100000 * seed + i;
    const auto trial = MakeTrial(question, session);
    if (!trial) continue;
    table.Add(*trial, session);
    if (++made % 10 == 0 || made == sessions) {
      std::printf("%s, %s: %d of %d sessions\n", question.how.c_str(), question.sensor.c_str(),
                  made, sessions);
      std::fflush(stdout);
    }
  }
  table.Close();
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  const auto run = [](const std::vector<std::string>& arguments) {
    rgbdt::study::Question question{arguments[0], arguments[1]};
    question.views = std::stoi(arguments[2]);
    question.heldout = std::stoi(arguments[3]);
    if (arguments.size() > 7) question.methods.assign(arguments.begin() + 7, arguments.end());
    rgbdt::study::Run(question, std::stoi(arguments[4]), std::stoull(arguments[5]), arguments[6]);
  };
  return rgbdt::study::StudyMain({"study_accuracy",
                                  "sampled|offset|lens|print|physics|rendered|random SENSOR VIEWS "
                                  "HELDOUT SESSIONS SEED CSV [METHOD...]",
                                  7, 1000, run},
                                 argc, argv);
}
