// How good the first guess is, and whether a wrong detection ever passes the views' consistency.
//   study_first_guess good|wrong SESSIONS SEED CSV
// good: 5 views each, turned scanner, camera and LIDAR in any orientation. wrong: 8 views with
// clutter, the cloud of every third one not its own; turned scanner, 32 and 16 rings in turn.
// A line of CSV for each session.
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>

#include "calib/solve/first_guess.h"
#include "tests/study/cloud_scenes.h"
#include "tests/study/sessions.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

struct Accepted {
  int all = 0, wrong = 0;
  int wrong_clouds = 0;       ///< of the views, accepted or not
  int from_wrong_clouds = 0;  ///< accepted though the cloud is not the view's
  double worst_deg = 0, worst_mm = 0;
};

// What WithChosenCandidate lets pass, held against where the camera's board truly is.
CameraView CameraViewOfIts(const SessionView& view) {
  return CameraViewOf(view.detection.images[0].camera, view.detection);
}

Accepted CountAccepted(const Session& session, const Rigid3& camera_from_lidar) {
  Accepted accepted;
  for (const SessionView& view : session.views) {
    accepted.wrong_clouds += view.wrong_cloud ? 1 : 0;
    const CameraView chosen = WithChosenCandidate(CameraViewOfIts(view), camera_from_lidar);
    if (!chosen.usable()) continue;
    ++accepted.all;
    accepted.from_wrong_clouds += view.wrong_cloud ? 1 : 0;
    const PoseError error = ErrorOf(*chosen.cloud->pose, view.lidar_from_target);
    if (error.IsBoard()) continue;
    ++accepted.wrong;
    accepted.worst_deg = std::max(accepted.worst_deg, error.rotation_deg);
    accepted.worst_mm = std::max(accepted.worst_mm, error.centre_mm);
  }
  return accepted;
}

int ViewsWithBoard(const Session& session) {
  int views = 0;
  for (const SessionView& view : session.views) {
    views += FindAmong(view.detection.cloud.candidates, view.lidar_from_target) >= 0 ? 1 : 0;
  }
  return views;
}

void WriteLine(const Session& session, std::uint64_t seed, int rings, std::ofstream* csv) {
  std::vector<CameraView> views;
  for (const SessionView& view : session.views) views.push_back(CameraViewOfIts(view));
  std::vector<const CameraView*> pointers;
  for (const CameraView& view : views) pointers.push_back(&view);
  const FirstGuess guess = GuessFromBoards(pointers);
  const bool guessed = guess.camera_from_lidar.has_value();
  Accepted accepted;
  double degrees = 180;
  double millimetres = 1e4;
  double chi2 = 0;
  if (guessed) {
    const Rigid3& found = *guess.camera_from_lidar;
    degrees = RotationDistance(found, session.camera_from_lidar) / simulate::kDegree;
    millimetres = 1e3 * CentreDistance(found, session.camera_from_lidar);
    const Vector6d delta = Log(session.camera_from_lidar * found.Inverse());
    chi2 = delta.dot(guess.covariance.ldlt().solve(delta));
    accepted = CountAccepted(session, found);
  }
  *csv << seed << ',' << rings << ',' << (session.kind == CameraKind::kColor ? "color" : "thermal")
       << ',' << session.holder << ',' << session.views.size() << ',' << ViewsWithBoard(session)
       << ',' << guessed << ',' << degrees << ',' << millimetres << ',' << chi2 << ','
       << accepted.all << ',' << accepted.wrong << ',' << accepted.wrong_clouds << ','
       << accepted.from_wrong_clouds << ',' << accepted.worst_deg << ',' << accepted.worst_mm
       << ",\"" << guess.detail << "\"\n";
}

SessionOptions OptionsOf(const std::string& kind, int session) {
  SessionOptions options;
  if (kind == "good") return options;
  if (kind != "wrong") throw std::runtime_error("expected good or wrong, not " + kind);
  options.views = 8;
  options.rings = session % 3 == 0 ? 0 : session % 3 == 1 ? 32 : 16;
  options.clutter = true;
  options.wrong_clouds = 3;
  return options;
}

void Run(const std::string& kind, int sessions, std::uint64_t seed, const std::string& path) {
  std::ofstream csv(path);
  csv << "seed,rings,kind,holder,views,views_with_board,guessed,rotation_deg,centre_mm,chi2,"
         "accepted,"
         "wrong_accepted,wrong_clouds,from_wrong_clouds,worst_deg,worst_mm,status\n";
  int made = 0;
  for (std::uint64_t i = 0; made < sessions; ++i) {
    if (i > 20 * static_cast<std::uint64_t>(sessions)) throw std::runtime_error("no room");
    const SessionOptions options = OptionsOf(kind, made);
    const auto session = MakeSession(options, 10000 * seed + i);
    if (!session) continue;
    WriteLine(*session, 10000 * seed + i, options.rings, &csv);
    if (++made % 20 == 0 || made == sessions) {
      std::printf("first guess, %s: %d of %d sessions\n", kind.c_str(), made, sessions);
      std::fflush(stdout);
    }
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
  return rgbdt::study::StudyMain({"study_first_guess", "good|wrong SESSIONS SEED CSV", 4, 4, run},
                                 argc, argv);
}
