// How the cost of solving and of detecting grows, on one core.
//   bench_growth solve MOST SEED CSV
//   bench_growth detection MOST SEED CSV
// solve: the simulator's two default cameras, 2 views and more up to MOST, of one session drawn
// from the noise model with ranges and lenses off (sampled_sessions.h): Calibrate by `auto`,
// diagnostics off; and first guess, joint solve and all that checks it, images not judged.
// detection: FindBoards in clouds of 10,000 points and more up to MOST, as the LIDAR saw them and
// bare (hits in one row, nothing known but their places). Clouds are analytic (analytic_cloud.h),
// corners sampled. A line of CSV for each size: the least processor time of several runs, which
// other processes disturb least.
#include <cstdio>
#include <ctime>
#include <exception>
#include <fstream>
#include <functional>
#include <iostream>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/methods/calibrate.h"
#include "calib/simulate/internal/board.h"
#include "calib/simulate/internal/spinning.h"
#include "calib/solve/closure.h"
#include "calib/solve/internal/cross_check.h"
#include "calib/solve/internal/joint_solve.h"
#include "calib/solve/internal/next_view.h"
#include "tests/bench/analytic_cloud.h"
#include "tests/simulated_variants.h"
#include "tests/study/cloud_scenes.h"
#include "tests/study/sampled_sessions.h"

namespace rgbdt::bench {
namespace {

constexpr int kLeastRuns = 3;
constexpr double kLeastSeconds = 0.3;  // in all runs together
constexpr int kCloudPoints = 120'000;  // of a view that is solved for: the default scanner's

double ProcessorSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double LeastMilliseconds(const std::function<void()>& work) {
  double least = 1e300;
  double all = 0;
  for (int run = 0; run < kLeastRuns || (all < kLeastSeconds && run < 1000); ++run) {
    const double start = ProcessorSeconds();
    work();
    const double seconds = ProcessorSeconds() - start;
    least = std::min(least, seconds);
    all += seconds;
    if (all > 20) break;  // long enough to be sure
  }
  return 1e3 * least;
}

// 1, 2, 5, 10, ... times `first`, up to `most`.
std::vector<int> Sizes(int first, int most) {
  std::vector<int> sizes;
  for (std::int64_t decade = first; decade <= most; decade *= 10) {
    for (const int step : {1, 2, 5}) {
      if (step * decade <= most) sizes.push_back(static_cast<int>(step * decade));
    }
  }
  return sizes;
}

// As many views as are asked for first of one session.
class Session {
 public:
  Session(int most, std::uint64_t seed) {
    study::SampledOptions options;
    options.views = most;
    options.heldout = 0;
    options.range_offset_m = 0.03;
    options.lenses_off = true;
    std::optional<study::SampledSession> sampled;
    for (std::uint64_t next = seed; !sampled && next < seed + 50; ++next) {
      sampled = study::SampleSession(options, next);
    }
    if (!sampled) throw std::runtime_error("no session has room for the board");
    all_ = std::move(*sampled);
  }

  void GrowTo(int views) {
    detections_.assign(all_.detections.begin(), all_.detections.begin() + views);
  }

  const Rig& rig() const { return all_.rig; }
  const std::vector<ViewDetection>& detections() const { return detections_; }
  const Truth& truth() const { return all_.truth; }

 private:
  study::SampledSession all_;
  std::vector<ViewDetection> detections_;
};

// First guesses, and their boards chosen.
std::vector<GuessedCamera> Guessed(const Session& session) {
  CalibrateOptions options;
  options.min_views = 2;
  options.first_guess.accept = kVotingGate;  // as CalibrateByBoards does
  options.first_guess.range_offset_sigma_m = session.rig().lidar.range_offset_sigma_m;
  std::vector<CameraViews> views;
  for (const CameraSpec& camera : session.rig().cameras) {
    views.push_back(ViewsOf(camera, session.detections()));
  }
  std::vector<GuessedCamera> cameras = GuessCameras(options, std::move(views));
  for (const GuessedCamera& camera : cameras) {
    if (!camera.guess.camera_from_lidar) throw std::runtime_error("no first guess");
  }
  return cameras;
}

JointResult SolvedJointly(const Session& session, const std::vector<GuessedCamera>& cameras) {
  return SolveJointly(
      MakeJointProblem(session.rig().target, cameras, session.rig().lidar.range_offset_sigma_m));
}

// The joint solve from first guesses that are at hand, its set-up included; and with all that
// checks it.
struct JointTimes {
  double solve_ms = 0, checked_ms = 0;
};

JointTimes JointMilliseconds(const Session& session) {
  const std::vector<GuessedCamera> cameras = Guessed(session);
  const CalibrateOptions options;
  JointTimes times;
  times.solve_ms = LeastMilliseconds([&] { SolvedJointly(session, cameras); });
  times.checked_ms = LeastMilliseconds([&] {
    const JointResult result = CrossValidate(SolvedJointly(session, cameras), options.folds);
    FindNextView(result);
    CloseLoops(cameras);
  });
  return times;
}

double GuessMilliseconds(const Session& session) {
  std::vector<CameraViews> views;
  for (const CameraSpec& camera : session.rig().cameras) {
    views.push_back(ViewsOf(camera, session.detections()));
  }
  return LeastMilliseconds([&] {
    for (const CameraViews& camera : views) GuessFromBoards(camera.Used());
  });
}

// Whether what was timed was worth it.
void WriteOutcome(const Session& session, const Report& report, std::ofstream* csv) {
  PoseError worst;
  std::size_t left_out = 0;  // views, and sides of views: each costs a round
  for (const CameraReport& camera : report.cameras) {
    const PoseError error =
        ErrorOf(camera.calibration.camera_from_lidar,
                session.truth().camera_from_lidar.at(camera.calibration.camera));
    worst.rotation_deg = std::max(worst.rotation_deg, error.rotation_deg);
    worst.translation_mm = std::max(worst.translation_mm, error.translation_mm);
    left_out += camera.rejected.size();
  }
  *csv << ',' << left_out << ',' << worst.rotation_deg << ',' << worst.translation_mm << '\n';
}

void BenchSolve(int most, std::uint64_t seed, std::ofstream* csv) {
  *csv << "views,calibrate_ms,joint_ms,checked_ms,guess_ms,left_out,worst_deg,worst_mm\n";
  Session session(most, seed);
  CalibrateOptions options;
  options.diagnostics = false;
  options.min_views = 2;
  for (const int views : Sizes(1, most)) {
    if (views < 2) continue;
    session.GrowTo(views);
    Report report;
    const double all = LeastMilliseconds(
        [&] { report = Calibrate(session.rig(), session.detections(), options); });
    const JointTimes joint = JointMilliseconds(session);
    *csv << views << ',' << all << ',' << joint.solve_ms << ',' << joint.checked_ms << ','
         << GuessMilliseconds(session);
    WriteOutcome(session, report, csv);
    std::printf("growth: solved %d views\n", views);
    std::fflush(stdout);
  }
}

void BenchDetection(int most, std::uint64_t seed, std::ofstream* csv) {
  constexpr int kBoards = 3;
  *csv << "points,board,organised_ms,organised_found,bare_ms,bare_found\n";
  const Target target = simulate::MakeTarget({});
  for (const int points : Sizes(10'000, most)) {
    for (int board = 0; board < kBoards; ++board) {
      const Rigid3 lidar_from_target = DrawBoard(seed, board);
      *csv << points << ',' << board;
      const auto bench = [&](const Cloud& cloud) {
        BoardsInCloud boards;
        *csv << ',' << LeastMilliseconds([&] { boards = FindBoards(cloud, target); }) << ','
             << (study::FindAmong(boards.candidates, lidar_from_target) >= 0);
      };
      Cloud cloud = AnalyticCloud(target, lidar_from_target, points, seed);
      bench(cloud);
      cloud = simulate::Unorganised(cloud, false);
      bench(cloud);
      *csv << '\n';
    }
    std::printf("growth: looked at %d points\n", points);
    std::fflush(stdout);
  }
}

void Run(const std::string& what, int most, std::uint64_t seed, const std::string& path) {
  std::ofstream csv(path);
  if (what == "solve") {
    BenchSolve(most, seed, &csv);
  } else if (what == "detection") {
    BenchDetection(most, seed, &csv);
  } else {
    throw std::runtime_error("expected solve or detection, not " + what);
  }
  if (!csv.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace
}  // namespace rgbdt::bench

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "Usage: bench_growth solve|detection MOST SEED CSV\n";
    return 2;
  }
  try {
    cv::setNumThreads(1);
    rgbdt::bench::Run(argv[1], std::stoi(argv[2]), std::stoull(argv[3]), argv[4]);
  } catch (const std::exception& error) {
    std::cerr << "bench_growth: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
