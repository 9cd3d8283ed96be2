// From how wrong a first guess a calibration still succeeds: within 1 deg and 100 mm of the truth.
//   study_basin random COUNT SEED CSV
//   study_basin starts COUNT SEED CSV
// random: COUNT random first guesses, turned by 0 to 180 deg about any axis, the camera's centre
// moved by 0 to 3 m in any direction, both evenly, on sessions of 8 views (paired_sessions.h), 20
// guesses each for every camera. A line of CSV for each guess and method: `paper`, `paper_smooth`
// (its field goes on beyond the borders), `auto` (takes no guess) and `refine`, the joint solve
// alone, from the guess. starts: COUNT sessions, all cameras at once, `auto` with a guess 30 deg
// roll and 40 deg yaw off and with none; for every tenth session `paper` from the former, too.
// Lines: method,start,success.
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>

#include "calib/methods/calibrate.h"
#include "calib/methods/paper/by_paper.h"
#include "calib/simulate/internal/noise.h"
#include "calib/simulate/internal/rig_defaults.h"
#include "calib/simulate/options.h"
#include "tests/study/objectives.h"
#include "tests/study/paired_sessions.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

using simulate::kDegree;
using simulate::Noise;

constexpr double kReachedDeg = 1;
constexpr double kReachedMm = 100;
constexpr double kMostGuessDeg = 180;
constexpr double kMostGuessM = 3;
constexpr int kGuessesPerCamera = 20;

struct Result {
  double rotation_deg = 180, translation_mm = 1e4;
  bool converged = false;
  bool success() const { return rotation_deg <= kReachedDeg && translation_mm <= kReachedMm; }
};

Result ResultOf(const Rigid3& found, const Rigid3& truth, bool converged) {
  return {RotationDistance(found, truth) / kDegree, 1e3 * CentreDistance(found, truth), converged};
}

struct RandomGuess {
  double rotation_deg = 0, translation_m = 0;
  Rigid3 camera_from_lidar;
};

RandomGuess DrawRandomGuess(const Rigid3& truth, const Noise& noise) {
  RandomGuess guess;
  guess.rotation_deg = noise.Uniform(0, 0, kMostGuessDeg);
  guess.translation_m = noise.Uniform(1, 0, kMostGuessM);
  const Eigen::Vector3d centre =
      truth.Inverse().translation + guess.translation_m * simulate::DrawDirection(noise, 2);
  const Rigid3 turn =
      RotationAbout(simulate::DrawDirection(noise, 4), guess.rotation_deg * kDegree);
  guess.camera_from_lidar.rotation = (turn.rotation * truth.rotation).normalized();
  guess.camera_from_lidar.translation = -(guess.camera_from_lidar.rotation * centre);
  return guess;
}

Result ByPaper(const PairedSession& session, std::size_t camera, const Rigid3& guess,
               bool smooth_field) {
  const CameraSpec& spec = session.rig.cameras[camera];
  CalibrateOptions options;
  options.method = kPaperMethod;
  options.smooth_field = smooth_field;
  const std::vector<CameraView> views = ViewsOfCamera(session.by_paper, spec.name);
  std::vector<const CameraView*> used;
  for (const CameraView& view : views) used.push_back(&view);
  const CameraCalibration found = SolvePaper(spec, used, guess, options);
  return ResultOf(found.camera_from_lidar, session.camera_from_lidar[camera], found.converged());
}

// The joint solve alone: no vote, no first guess of its own.
Result ByRefinement(const PairedSession& session, std::size_t camera, const Rigid3& guess) {
  const BoardProblem problem = ProblemOf(session, camera, 1000, guess);
  const BoardSolution found = SolveBoards(problem, StartOf(problem, {guess}));
  return ResultOf(found.state.camera_from_lidar[0], session.camera_from_lidar[camera],
                  found.converged);
}

// As `rgbdt calibrate` runs it: all cameras, whatever the rig's guesses are.
std::vector<Result> ByBoards(const PairedSession& session,
                             const std::vector<std::optional<Rigid3>>& guesses) {
  Rig rig = session.rig;
  for (std::size_t c = 0; c < guesses.size(); ++c) {
    rig.cameras[c].camera_from_lidar_guess = guesses[c];
  }
  CalibrateOptions options;
  options.diagnostics = false;
  const Report report = Calibrate(rig, session.by_boards, options);
  std::vector<Result> results;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const CameraCalibration& found = report.cameras[c].calibration;
    results.push_back(
        ResultOf(found.camera_from_lidar, session.camera_from_lidar[c], found.converged()));
  }
  return results;
}

// Sessions one after the other, without those that have no room.
class Sessions {
 public:
  explicit Sessions(std::uint64_t seed) : next_(100000 * seed) {}

  PairedSession Next(bool paper) {
    PairedOptions options;
    options.paper = paper;
    for (int tries = 0; tries < 50; ++tries) {
      auto session = MakePairedSession(options, next_++);
      if (session) return std::move(*session);
    }
    throw std::runtime_error("no room");
  }
  std::uint64_t last_seed() const { return next_ - 1; }

 private:
  std::uint64_t next_;
};

class RandomStudy {
 public:
  RandomStudy(std::uint64_t seed, std::ofstream* csv) : sessions_(seed), csv_(csv) {
    *csv_ << "session,camera,guess,guess_deg,guess_m,method,rotation_deg,translation_mm,converged,"
             "success\n";
  }

  void Run(int count) {
    for (int done = 0; done < count;) {
      const PairedSession session = sessions_.Next(true);
      const int cameras = static_cast<int>(session.rig.cameras.size());
      for (int i = 0; i < kGuessesPerCamera * cameras && done < count; ++i, ++done) {
        Try(session, static_cast<std::size_t>(i % cameras), i);
      }
      std::printf("basin: %d of %d guesses\n", done, count);
      std::fflush(stdout);
    }
  }

 private:
  void Try(const PairedSession& session, std::size_t camera, int index) {
    const Noise noise(sessions_.last_seed(), index, "random guess");
    const RandomGuess guess = DrawRandomGuess(session.camera_from_lidar[camera], noise);
    const Rigid3& start = guess.camera_from_lidar;
    const auto write = [&](const char* method, const Result& result) {
      *csv_ << sessions_.last_seed() << ',' << session.rig.cameras[camera].name << ',' << index
            << ',' << guess.rotation_deg << ',' << guess.translation_m << ',' << method << ','
            << result.rotation_deg << ',' << result.translation_mm << ',' << result.converged << ','
            << result.success() << '\n';
    };
    write("paper", ByPaper(session, camera, start, false));
    write("paper_smooth", ByPaper(session, camera, start, true));
    write("refine", ByRefinement(session, camera, start));
    std::vector<std::optional<Rigid3>> guesses(session.rig.cameras.size());
    guesses[camera] = start;
    write("auto", ByBoards(session, guesses)[camera]);
  }

  Sessions sessions_;
  std::ofstream* csv_;
};

std::vector<std::optional<Rigid3>> TurnedGuesses(const PairedSession& session) {
  std::vector<std::optional<Rigid3>> guesses;
  for (const Rigid3& truth : session.camera_from_lidar) {
    const CalibrateOptions defaults;
    guesses.emplace_back(TurnedStart(truth, defaults.wide_roll_rad, defaults.wide_yaw_rad));
  }
  return guesses;
}

bool AllReached(const std::vector<Result>& results) {
  bool all = true;
  for (const Result& result : results) all &= result.success();
  return all;
}

bool PaperReached(const PairedSession& session, bool smooth_field) {
  const auto guesses = TurnedGuesses(session);
  std::vector<Result> results;
  for (std::size_t c = 0; c < guesses.size(); ++c) {
    results.push_back(ByPaper(session, c, *guesses[c], smooth_field));
  }
  return AllReached(results);
}

void RunStarts(int count, std::uint64_t seed, std::ofstream* csv) {
  *csv << "method,start,success\n";
  Sessions sessions(seed);
  for (int i = 0; i < count; ++i) {
    const bool paper = i % 10 == 0;
    const PairedSession session = sessions.Next(paper);
    *csv << "auto,30_40," << AllReached(ByBoards(session, TurnedGuesses(session))) << '\n'
         << "auto,none," << AllReached(ByBoards(session, {})) << '\n';
    if (paper) {
      *csv << "paper,30_40," << PaperReached(session, false) << '\n'
           << "paper_smooth,30_40," << PaperReached(session, true) << '\n';
    }
    if ((i + 1) % 10 != 0 && i + 1 != count) continue;
    std::printf("basin: %d of %d sessions\n", i + 1, count);
    std::fflush(stdout);
  }
}

void Run(const std::string& what, int count, std::uint64_t seed, const std::string& path) {
  std::ofstream csv(path);
  if (what == "random") {
    RandomStudy(seed, &csv).Run(count);
  } else if (what == "starts") {
    RunStarts(count, seed, &csv);
  } else {
    throw std::runtime_error("expected random or starts, not " + what);
  }
  if (!csv.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  const auto run = [](const std::vector<std::string>& arguments) {
    rgbdt::study::Run(arguments[0], std::stoi(arguments[1]), std::stoull(arguments[2]),
                      arguments[3]);
  };
  return rgbdt::study::StudyMain({"study_basin", "random|starts COUNT SEED CSV", 4, 4, run}, argc,
                                 argv);
}
