// What people give wrong, and whether it is found.
//   study_mistakes sampled SENSOR SESSIONS SEED CSV [MISTAKE...]
//   study_mistakes recorded SESSION CSV
// sampled: sessions of the noise model (sampled_sessions.h), 10 views and 4 held out; the views'
// boards are found anew in their clouds and posed anew by what the rig says. recorded: a session
// directory; images and clouds are looked at anew. MISTAKE: those, and "none", the right rig, only.
// A line of CSV for each session, mistake and camera: chi2 is the result's against the truth or,
// recorded, against that of the right rig.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "calib/camera/target_pose.h"
#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/files/session/session_dir.h"
#include "calib/methods/calibrate.h"
#include "calib/methods/detect_view.h"
#include "calib/model/beam_priors.h"
#include "calib/model/errors.h"
#include "calib/model/linear_algebra.h"
#include "calib/present/report/verdict.h"
#include "tests/study/mistakes.h"
#include "tests/study/sampled_sessions.h"
#include "tests/study/study_main.h"

namespace rgbdt::study {
namespace {

constexpr int kViews = 10, kHeldout = 4;

using Poses = std::map<std::string, CameraCalibration>;  // what is right, by camera

// As a detector would have it that believes this rig: corners and sides are where they are.
// `right`: what the right rig's has of the cloud, which is the same unless board or cloud differ.
ViewDetection SeenBy(const Rig& rig, const Cloud* cloud, const CloudDetection& right,
                     ViewDetection view) {
  for (ImageDetection& image : view.images) {
    if (!image.edges || !image.edges->pose) continue;
    ImageEdges& edges = *image.edges;
    const Camera camera(rig.Camera(image.camera));
    const auto pose = PoseFromCorners(camera, rig.target, edges.corners);
    if (!pose) {
      image.why_not = WhyNoFlatBoard(camera);
      image.edges.reset();
      continue;
    }
    const bool half_turn_known = edges.pose->half_turn_known;
    edges.pose = pose->pose;
    edges.pose->half_turn_known = half_turn_known;
    edges.corner_sigma_px = pose->inflation * pose->corner_sigma_px;
  }
  view.cloud = right;
  if (cloud == nullptr) return view;
  BoardsInCloud boards = FindBoards(*cloud, rig.target, OptionsFor(rig.lidar));
  view.cloud = {std::move(boards.candidates), std::move(boards.why), 0};
  return view;
}

class Table {
 public:
  Table(std::string sensor, const std::string& path)
      : sensor_(std::move(sensor)), path_(path), csv_(path) {
    csv_ << "sensor,session,mistake,size,camera,status,used,rejected,chi2,moved_mm,grade,first,"
            "second,named,first_sigmas,first_moves_sigma,reason\n";
  }

  void Add(std::uint64_t session, const Mistake& mistake, const Report& report,
           const Poses& right) {
    for (const CameraReport& camera : report.cameras) {
      const CameraCalibration& found = camera.calibration;
      csv_ << sensor_ << ',' << session << ',' << mistake.name << ',' << mistake.size << ','
           << found.camera << ',' << static_cast<int>(found.status) << ',' << camera.used.size()
           << ',' << camera.rejected.size() << ',';
      WriteMove(found, right.at(found.camera));
      const std::vector<std::string> read = CausesRead(camera);
      const Verdict verdict = Judge(camera, report.next_view);
      csv_ << ',' << NameOf(verdict.grade);
      for (std::size_t i = 0; i < 2; ++i) csv_ << ",\"" << (i < read.size() ? read[i] : "") << '"';
      bool named = false;
      for (const std::string& cause : read) named = named || Names(mistake, cause);
      csv_ << ',' << named << ',';
      if (!camera.causes.empty()) csv_ << camera.causes.front().Sigmas();
      csv_ << ',';
      if (!camera.causes.empty()) csv_ << camera.causes.front().moves_sigma.value_or(0);
      csv_ << ",\"" << (verdict.reasons.empty() ? "" : verdict.reasons.front()) << "\"\n";
    }
  }

  void Close() {
    if (!csv_.flush()) throw std::runtime_error("cannot write " + path_);
  }

 private:
  // Nothing, where there is no pose; a truth has no covariance.
  void WriteMove(const CameraCalibration& found, const CameraCalibration& right) {
    if (!found.solved() || !found.covariance) {
      csv_ << ',';
      return;
    }
    Matrix6d covariance = *found.covariance;
    if (right.covariance) covariance += *right.covariance;
    const Vector6d delta = Log(right.camera_from_lidar * found.camera_from_lidar.Inverse());
    csv_ << delta.dot(SolveSymmetric(covariance, delta)) << ','
         << rgbdt::ErrorOf(found.camera_from_lidar, right.camera_from_lidar).translation_mm;
  }

  std::string sensor_, path_;
  std::ofstream csv_;
};

void RunSampled(const std::string& sensor, int sessions, std::uint64_t seed,
                const std::string& path, const std::set<std::string>& only) {
  static const std::map<std::string, int> kRings = {{"dense", 0}, {"32", 32}, {"16", 16}};
  const auto rings = kRings.find(sensor);
  if (rings == kRings.end()) {
    throw std::runtime_error("SENSOR is " + sensor + "; there are: dense, 32, 16");
  }
  Table table(sensor, path);
  int made = 0;
  for (std::uint64_t i = 0; made < sessions; ++i) {
    if (i > 20 * static_cast<std::uint64_t>(sessions)) throw std::runtime_error("no room");
    SampledOptions options{rings->second, kViews, kHeldout};
    options.physics = options.lenses_off = true;
    options.print_sigma = kUsualPrintSigma;
    const auto session = SampleSession(options, 100000 * seed + i);
    if (!session) continue;
    Poses right;
    for (const auto& [camera, pose] : session->truth.camera_from_lidar) {
      right[camera].camera_from_lidar = pose;
    }
    std::vector<CloudDetection> clouds(session->views.size());  // by the right rig
    for (const Mistake& mistake : AllMistakes(session->rig.target)) {
      if (!only.empty() && mistake.name != "none" && only.count(mistake.name) == 0) continue;
      const Rig rig = WithMistake(mistake, session->rig);
      std::vector<ViewDetection> views;
      for (std::size_t v = 0; v < session->views.size(); ++v) {
        std::optional<Cloud> cloud;
        if (mistake.name == "none" || IsOfTheCloud(mistake)) {
          cloud = WithMistake(mistake, session->views[v].cloud, v, session->views.size());
        }
        views.push_back(SeenBy(rig, cloud ? &*cloud : nullptr, clouds[v], session->detections[v]));
        if (mistake.name == "none") clouds[v] = views.back().cloud;
      }
      table.Add(i, mistake, Calibrate(rig, PairedApart(std::move(views), ViewsApart(mistake))),
                right);
    }
    std::printf("%s: %d of %d sessions\n", sensor.c_str(), ++made, sessions);
    std::fflush(stdout);
  }
  table.Close();
}

void RunRecorded(const std::string& dir, const std::string& path) {
  const Session session = OpenSession(dir);
  Table table(session.rig.name, path);
  Poses right;
  for (const Mistake& mistake : AllMistakes(session.rig.target)) {
    const Rig rig = WithMistake(mistake, session.rig);
    std::vector<ViewDetection> views;
    for (std::size_t v = 0; v < session.views.size(); ++v) {
      View view = ReadView(session, session.views[v]);
      view.cloud = WithMistake(mistake, std::move(view.cloud), v, session.views.size());
      views.push_back(DetectView(rig, view));
    }
    const Report report = Calibrate(rig, PairedApart(std::move(views), ViewsApart(mistake)));
    if (mistake.name == "none") {
      for (const CameraReport& camera : report.cameras) {
        right[camera.calibration.camera] = camera.calibration;
      }
    }
    table.Add(0, mistake, report, right);
    std::printf("%s: %s, size %d\n", dir.c_str(), mistake.name.c_str(), mistake.size);
    std::fflush(stdout);
  }
  table.Close();
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  const auto run = [](const std::vector<std::string>& arguments) {
    if (arguments[0] == "recorded" && arguments.size() == 3) {
      rgbdt::study::RunRecorded(arguments[1], arguments[2]);
    } else if (arguments[0] == "sampled" && arguments.size() >= 5) {
      rgbdt::study::RunSampled(arguments[1], std::stoi(arguments[2]), std::stoull(arguments[3]),
                               arguments[4], {arguments.begin() + 5, arguments.end()});
    } else {
      throw std::runtime_error("expected sampled SENSOR SESSIONS SEED CSV or recorded SESSION CSV");
    }
  };
  return rgbdt::study::StudyMain(
      {"study_mistakes", "sampled SENSOR SESSIONS SEED CSV [MISTAKE...] | recorded SESSION CSV", 3,
       16, run},
      argc, argv);
}
