// How the cost of solving and of detecting grows, on one core.
//   bench_growth solve MOST SEED CSV
//   bench_growth detection MOST SEED CSV
// solve: Calibrate by `auto`, diagnostics off, the simulator's two default cameras, 2 views and
// more up to MOST. detection: FindBoards in clouds of 10,000 points and more up to MOST, as the
// LIDAR saw them and bare (hits in one row, nothing known but their places). Clouds are analytic
// (analytic_cloud.h), corners sampled. A line of CSV for each size: the least processor time of
// several runs, which other processes disturb least.
#include <cstdio>
#include <ctime>
#include <exception>
#include <fstream>
#include <functional>
#include <iostream>
#include <opencv2/core/utility.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/methods/calibrate.h"
#include "calib/simulate/internal/board.h"
#include "calib/simulate/internal/rig_defaults.h"
#include "calib/simulate/internal/spinning.h"
#include "calib/solve/internal/joint_solve.h"
#include "tests/bench/analytic_cloud.h"
#include "tests/simulated_variants.h"
#include "tests/study/cloud_scenes.h"
#include "tests/study/paired_sessions.h"
#include "tests/study/sampled_images.h"

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

// A session whose views are looked at as they come.
class Session {
 public:
  explicit Session(std::uint64_t seed) : seed_(seed) {
    for (const auto& camera : {simulate::DefaultColorCamera(), simulate::DefaultThermalCamera()}) {
      rig_.cameras.push_back(study::SpecOf(camera));
      camera_from_lidar_.push_back(simulate::DrawCameraFromLidar(camera, seed));
    }
    rig_.target = simulate::MakeTarget({});
  }

  void GrowTo(int views) {
    for (; views_ < views; ++next_) {
      if (AddView(DrawBoard(seed_, next_))) ++views_;
    }
  }

  const Rig& rig() const { return rig_; }
  const std::vector<ViewDetection>& detections() const { return detections_; }
  const std::vector<Rigid3>& camera_from_lidar() const { return camera_from_lidar_; }

 private:
  bool AddView(const Rigid3& lidar_from_target) {
    ViewDetection seen;
    seen.view = std::to_string(100'000 + next_);
    for (std::size_t c = 0; c < rig_.cameras.size(); ++c) {
      const std::string& camera = rig_.cameras[c].name;
      auto image = study::BoardInImage(rig_.cameras[c], rig_.target,
                                       camera_from_lidar_[c] * lidar_from_target,
                                       simulate::Noise(seed_, next_, camera));
      if (!image) return false;
      seen.images.push_back({camera, 0, std::move(image), "", 0});
    }
    const Cloud cloud = AnalyticCloud(rig_.target, lidar_from_target, kCloudPoints,
                                      seed_ + static_cast<std::uint64_t>(next_));
    seen.cloud.candidates = FindBoards(cloud, rig_.target).candidates;
    if (seen.cloud.candidates.empty()) return false;
    detections_.push_back(std::move(seen));
    return true;
  }

  std::uint64_t seed_;
  Rig rig_;
  std::vector<Rigid3> camera_from_lidar_;
  std::vector<ViewDetection> detections_;
  int views_ = 0, next_ = 0;
};

// The joint solve from first guesses that are at hand, its set-up included.
double JointMilliseconds(const Session& session) {
  std::vector<GuessedCamera> cameras;
  for (const CameraSpec& spec : session.rig().cameras) {
    auto& [views, guess] =
        cameras.emplace_back(GuessedCamera{ViewsOf(spec, session.detections()), {}});
    guess = GuessFromBoards(views.Used());
    if (!guess.camera_from_lidar) throw std::runtime_error("no first guess");
    for (CameraView& view : views.all) {
      view = WithChosenCandidate(std::move(view), *guess.camera_from_lidar);
    }
  }
  return LeastMilliseconds(
      [&] { SolveJointly(MakeJointProblem(session.rig().target, cameras, 0)); });
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
  for (std::size_t c = 0; c < report.cameras.size(); ++c) {
    const CameraReport& camera = report.cameras[c];
    const PoseError error =
        ErrorOf(camera.calibration.camera_from_lidar, session.camera_from_lidar()[c]);
    worst.rotation_deg = std::max(worst.rotation_deg, error.rotation_deg);
    worst.translation_mm = std::max(worst.translation_mm, error.translation_mm);
    left_out += camera.rejected.size();
  }
  *csv << ',' << left_out << ',' << worst.rotation_deg << ',' << worst.translation_mm << '\n';
}

void BenchSolve(int most, std::uint64_t seed, std::ofstream* csv) {
  *csv << "views,calibrate_ms,joint_ms,guess_ms,left_out,worst_deg,worst_mm\n";
  Session session(seed);
  CalibrateOptions options;
  options.diagnostics = false;
  options.min_views = 2;
  for (const int views : Sizes(1, most)) {
    if (views < 2) continue;
    session.GrowTo(views);
    Report report;
    const double all = LeastMilliseconds(
        [&] { report = Calibrate(session.rig(), session.detections(), options); });
    *csv << views << ',' << all << ',' << JointMilliseconds(session) << ','
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
