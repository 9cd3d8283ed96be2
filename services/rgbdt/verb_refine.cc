#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calib/files/check_writable.h"
#include "calib/files/own_folder.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/methods/refine.h"
#include "calib/model/errors.h"
#include "calib/present/session/report_files.h"
#include "services/replay/drive_session.h"
#include "services/rgbdt/print_report.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

constexpr const char* kDrive = "drive";
constexpr const char* kDrivePart = "drive.part";

struct RefineFlags {
  double every_s = 2;
  std::string dir, calibration, prior, out, truth;
  bool search = false, anyway = false;
  RefineOptions options;
  bool json = false;
};

struct ReadViews {
  std::vector<View> views;
  std::vector<std::string> unreadable;
};

ReadViews ReadAll(const Session& session) {
  ReadViews read;
  for (std::size_t i = 0; i < session.views.size(); ++i) {
    const std::string& name = session.views[i];
    try {
      read.views.push_back(ReadView(session, name));
    } catch (const InputError& e) {
      read.unreadable.push_back("view " + name + ": " + e.what());
    }
    PrintProgress("[" + std::to_string(i + 1) + "/" + std::to_string(session.views.size()) +
                  "] view " + name + " read");
  }
  return read;
}

// From where it starts: a calibration that belongs to the rig, or nothing but the rig's guesses.
Calibration StartOf(const RefineFlags& flags, const Session& session) {
  const std::string& given = flags.prior.empty() ? flags.calibration : flags.prior;
  const std::filesystem::path path = PathOr(given, session.root / "calibration.textproto");
  if (given.empty() && !std::filesystem::exists(path)) return {};
  Calibration start = ReadCalibration(path);
  const CalibrationFiles files = FilesOf(session.root, path.string(), flags.anyway);
  PrintWarnings(RequireSameRig(start, session.rig, files.Names(), files.HowToUse()));
  PrintDoubts(start, session.rig, path);
  return start;
}

// Nobody looked for a board.
std::vector<ViewDetection> WithoutBoards(const Report& report) {
  std::vector<ViewDetection> detections;
  for (const DetectedView& seen : report.detections) {
    ViewDetection& view = detections.emplace_back();
    view.view = seen.view;
    view.heldout = seen.heldout;
    for (const auto& image : seen.images) {
      ImageDetection& one = view.images.emplace_back();
      one.camera = image.camera;
      one.why_not = image.why_not;
    }
    view.cloud.why_not = seen.cloud_why_not;
  }
  return detections;
}

struct Opened {
  Session session;
  std::string cannot_tell;  // what would bend the result, see CameraReport
};

// Of a log, the session that is cut out of it. It has its name once it was refined: what a run that
// was killed left is cut anew.
Opened SessionOf(const RefineFlags& flags) {
  if (!std::filesystem::is_regular_file(flags.dir)) return {OpenSession(flags.dir), ""};
  const std::filesystem::path out = PathOr(flags.out, "out/refine");
  const std::filesystem::path drive = out / kDrive, part = out / kDrivePart;
  if (std::filesystem::exists(drive)) {
    throw InputError(drive.string() +
                     " is there already, of an earlier run: remove it, or choose another --out");
  }
  CheckWritable(drive);
  std::filesystem::remove_all(part);
  CutOptions options;
  options.every = FromSeconds(flags.every_s);
  int percent = -1;
  const CutDrive cut = CutIntoSession(flags.dir, part, options, [&](double fraction) {
    const int now = static_cast<int>(100 * fraction);
    if (now / 10 != percent / 10) PrintProgress("reading the log: " + std::to_string(now) + "%");
    percent = now;
  });
  for (const std::string& problem : cut.problems) {
    std::fprintf(stderr, "%s: %s\n", flags.dir.c_str(), problem.c_str());
  }
  if (cut.by_odometry) {
    PrintProgress("the log has no POSE: the rig's motion is that which the sweeps tell");
  }
  PrintProgress(std::to_string(cut.sweeps) + " sweeps of the log");
  return {OpenSession(part), cut.motion_unknown
                                 ? "Nothing in the log tells how the rig moved; had it driven, the "
                                   "result would be wrong. Record sweeps without gaps, or POSE."
                                 : ""};
}

int RunRefine(RefineFlags flags) {
  constexpr double kDegree = M_PI / 180;
  if (flags.search) {  // about each axis, so that 10 degrees and 0.2 m are well within it
    flags.options.natural.rotation_sigma_rad = 6 * kDegree;
    flags.options.natural.translation_sigma_m = 0.12;
  }
  flags.options.join_start = !flags.prior.empty();
  flags.options.Check();
  auto [session, cannot_tell] = SessionOf(flags);
  const bool is_log = std::filesystem::is_regular_file(flags.dir);
  const std::filesystem::path out = !flags.out.empty() ? std::filesystem::path(flags.out)
                                    : is_log           ? session.root.parent_path()
                                                       : OwnFolder(session.root, "refined");
  CheckWritable(out / "report.json");
  const std::optional<Truth> truth = ReadTruthOf(flags.truth, session.root);  // before the work
  const Calibration start = StartOf(flags, session);
  const ReadViews read = ReadAll(session);
  RequireReadable(session, read.unreadable);
  PrintProgress("solving ...");
  std::filesystem::create_directories(out);
  SetAside(out);
  Report report = Refine(session.rig, read.views, start, flags.options);
  for (CameraReport& camera : report.cameras) camera.cannot_tell = cannot_tell;
  if (is_log) {
    Rename(session.root, out / kDrive);
    session.root = out / kDrive;
    PrintProgress("the log's sweeps are a session: " + session.root.string());
  }
  const std::string wrote = WriteIfSolved(out, session.rig, &report);
  if (truth) report = WithTruth(std::move(report), *truth);
  WriteReportFiles(out, {session, WithoutBoards(report), {report}});
  PrintReport(flags.json, report, out, wrote, read.unreadable);
  PrintUnreadable(read.unreadable);
  return static_cast<int>(WorseOf(EndsIf(read.unreadable.empty()), EndOf(report)));
}

}  // namespace

void AddRefine(CommandLine* program) {
  auto flags = std::make_shared<RefineFlags>();
  CommandLine* verb = program->Verb(
      "refine",
      "Refines a calibration without a target, by the edges of whatever stands about: where a\n"
      "nearer thing ends before a farther one. DIR is a session directory of any scenes, or a log\n"
      "of a drive (lcm-logger), out of which one is cut; every third view is left out to judge "
      "the\n"
      "result: what fits those worse than the start is not taken. Writes calibration.textproto,\n"
      "report.json and report.html.\n"
      "Examples: rgbdt refine out/drive --calibration out/demo/calibration.textproto\n"
      "          rgbdt refine out/drive --search        # from a rough guess in the rig file\n"
      "          rgbdt refine drive.lcmlog --out out/refine",
      [flags] { return RunRefine(*flags); });
  verb->Ends(ExitCode::kFailed,
             "failed, or not all of it: a camera did not converge, or a view could not be read");
  AddVerdictEnds(verb);
  verb->Required("DIR", &flags->dir, "session directory (rig.textproto, views/), or a log");
  verb->Within("--every", &flags->every_s, 0, 3600,
               "of a log's sweeps, one in so many seconds is taken, 60 at most");
  verb->Option("--calibration", &flags->calibration,
               "where to start; default: DIR/calibration.textproto or, without, the rig file's\n"
               "camera_from_lidar_guess. Its error may be some 2 degrees and 50 mm");
  verb->Option("--prior", &flags->prior,
               "natural: start from this calibration and join what it knows of itself with what\n"
               "the scene says, by their covariances; it must not be made from the same views");
  verb->Flag("--search", &flags->search,
             "natural: look farther, for a start that is off by up to 10 degrees and 0.2 m");
  verb->Choice("--method", &flags->options.method, kRefineMethodNames,
               "natural, this project's own; published ones to compare with: mi, nmi, mutual\n"
               "information (Pandey 2012, Taylor 2012); gom, gradient orientation (Taylor 2013);\n"
               "edge-grid, depth discontinuities (Levinson and Thrun 2013)");
  verb->Option("--out", &flags->out, "where to write; default: DIR/refined, of a log out/refine");
  verb->Option("--truth", &flags->truth, "truth.textproto; default: DIR's, where there is one");
  AddJson(verb, &flags->json);
  AddAnyway(verb, &flags->anyway, "the rig is another");
}

}  // namespace rgbdt
