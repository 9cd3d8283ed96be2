#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calib/methods/calibrate_by_views.h"
#include "calib/methods/calibrate_sessions.h"
#include "calib/methods/calibrate_without.h"
#include "calib/methods/detect_session.h"
#include "calib/model/beam_priors.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "calib/present/session/report_files.h"
#include "services/rgbdt/print_report.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

struct CalibrateFlags {
  std::vector<std::string> dirs;
  std::vector<std::string> without;
  std::string out, truth;
  CalibrateOptions options;
  bool separate = false;
  bool range_offset = false;
  bool mounts_moved = false;
  bool json = false;
};

// Where one result goes, what it is compared with, and whether it is told as JSON.
struct Place {
  std::filesystem::path out;
  std::optional<Truth> truth;
  bool json = false;
};

SessionDetection Detect(const Session& session, const std::string& method) {
  SessionDetection detection = DetectSession(session, method, PrintProgress);
  RequireReadable(session, detection.unreadable);
  std::fprintf(stderr, "solving ...\n");
  return detection;
}

// The views that a person names, which must be there.
std::set<std::string> LeftOutOf(const CalibrateFlags& flags, const Session& session) {
  for (const std::string& view : flags.without) {
    if (std::find(session.views.begin(), session.views.end(), view) == session.views.end()) {
      throw UsageError("--without " + view + ": there is no such view in " + session.Title());
    }
  }
  return {flags.without.begin(), flags.without.end()};
}

// Writes and prints one result, made without the views that are left out.
ExitCode Finish(const Place& place, const Session& session, const SessionDetection& detection,
                Report report, const std::set<std::string>& left_out = {}) {
  report = WithUnlisted(std::move(report), session, detection.views);
  const std::string wrote = WriteIfSolved(place.out, session.rig, &report);
  if (place.truth) report = WithTruth(std::move(report), *place.truth);
  const auto reports = CalibrateByViews(session.rig, detection.views, report);
  const Session listed = ListedOnly(session, detection.views);
  WriteReportFiles(place.out, {listed, detection.views, reports, {left_out, {}, ""}});
  PrintReport(place.json, report, place.out, wrote, detection.unreadable);
  return WorseOf(EndsIf(detection.unreadable.empty()), EndOf(report));
}

// What a person does with the result.
void PrintNext(const Session& session, const std::filesystem::path& out, ExitCode end) {
  const std::string page = ForShell((out / "report.html").string());
  if (end != ExitCode::kDone) {
    std::printf("next: open %s in a browser; it shows each view, and what is wrong\n",
                page.c_str());
    return;
  }
  std::string fuse = "rgbdt fuse " + ForShell(session.root.string());
  if (out != session.root) {
    fuse += " --calibration " + ForShell((out / "calibration.textproto").string()) + " --out " +
            ForShell(out.string());
  }
  std::printf("next: %s --png; %s shows each view in a browser\n", fuse.c_str(), page.c_str());
}

ExitCode CalibrateOne(const CalibrateFlags& flags) {
  const Session session = OpenSession(flags.dirs[0]);
  const std::set<std::string> left_out = LeftOutOf(flags, session);
  const std::filesystem::path out = PathOr(flags.out, session.root);
  const Place place{out, ReadTruthOf(flags.truth, session.root), flags.json};  // before the work
  SetAside(out);
  const SessionDetection detection = Detect(session, flags.options.method);
  const ExitCode end =
      Finish(place, session, detection,
             CalibrateWithout(session.rig, detection.views, left_out, flags.options), left_out);
  PrintUnreadable(detection.unreadable);
  if (!flags.json) PrintNext(session, out, end);
  return end;
}

Session OpenAll(const CalibrateFlags& flags) {
  if (flags.out.empty()) {
    throw UsageError("several sessions: say with --out where the result is to be written");
  }
  std::vector<Session> sessions;
  for (const std::string& dir : flags.dirs) sessions.push_back(OpenSession(dir));
  return JoinSessions(std::move(sessions));
}

// Each part's views of a joined session, in its order. A view is called "PART/VIEW".
std::vector<SessionViews> Divided(const Session& joined, const std::vector<ViewDetection>& views) {
  std::vector<SessionViews> sessions;
  for (const Session::Part& part : joined.parts) {
    SessionViews& of_part = sessions.emplace_back(SessionViews{part.name, {}});
    std::copy_if(views.begin(), views.end(), std::back_inserter(of_part.detections),
                 [&](const ViewDetection& view) {
                   return view.view.substr(0, view.view.rfind('/')) == part.name;
                 });
  }
  return sessions;
}

// One pose of each camera in all sessions.
ExitCode CalibrateTogether(const CalibrateFlags& flags) {
  const Session session = OpenAll(flags);
  const Place place{flags.out, ReadTruthOf(flags.truth, session.parts[0].session.root), flags.json};
  SetAside(flags.out);
  const SessionDetection detection = Detect(session, flags.options.method);
  std::vector<CalibrationComparison> comparisons;
  if (flags.options.method == kAutoMethod) {
    CalibrateOptions brief = flags.options;
    brief.diagnostics = false;
    comparisons =
        CalibrateSessions(session.rig, Divided(session, detection.views), brief).comparisons;
  }
  const Report report =
      WithChanges(Calibrate(session.rig, detection.views, flags.options), comparisons);
  const ExitCode end = Finish(place, session, detection, report);
  PrintUnreadable(detection.unreadable);
  if (!flags.json) PrintComparisons(comparisons);
  return end;
}

// Where the result of one of several sessions goes.
std::filesystem::path OutOf(const CalibrateFlags& flags, const std::string& session) {
  return flags.out / std::filesystem::path(session).relative_path();
}

// Poses of its own in each session; what all have in common is told by all.
ExitCode CalibrateEach(const CalibrateFlags& flags) {
  const Session session = OpenAll(flags);
  std::vector<Place> places;
  for (const Session::Part& part : session.parts) {
    places.push_back(
        {OutOf(flags, part.name), ReadTruthOf(flags.truth, part.session.root), flags.json});
  }
  for (const Place& place : places) SetAside(place.out);
  const SessionDetection detection = Detect(session, flags.options.method);
  const std::vector<SessionViews> views = Divided(session, detection.views);
  CalibratedSessions result = CalibrateSessions(session.rig, views, flags.options);
  const std::vector<Session> parts = PartsOf(session);
  ExitCode end = EndsIf(detection.unreadable.empty());
  for (std::size_t s = 0; s < parts.size(); ++s) {
    if (!flags.json) {
      std::printf("%s%s\n", s == 0 ? "" : "\n", parts[s].Title().c_str());
    }
    end = WorseOf(end, Finish(places[s], parts[s], {views[s].detections, detection.unreadable},
                              result.reports[s]));
  }
  PrintUnreadable(detection.unreadable);
  if (!flags.json) PrintComparisons(result.comparisons);
  return end;
}

int RunCalibrate(const CalibrateFlags& flags) {
  flags.options.Check();
  if (!flags.without.empty() && flags.dirs.size() > 1) {
    throw UsageError("--without is for one session; each has its own views");
  }
  if (flags.mounts_moved && flags.dirs.size() < 2) {
    throw UsageError("--mounts-moved is for several sessions; name two or more");
  }
  return static_cast<int>(flags.dirs.size() == 1 ? CalibrateOne(flags)
                          : flags.mounts_moved   ? CalibrateEach(flags)
                                                 : CalibrateTogether(flags));
}

}  // namespace

void AddCalibrate(CommandLine* program) {
  auto flags = std::make_shared<CalibrateFlags>();
  CommandLine* verb = program->Verb(
      "calibrate",
      "Finds each camera's pose relative to the LIDAR from a session directory; of a rig with\n"
      "several LIDARs the others' poses relative to the first, too.\n"
      "Writes calibration.textproto, report.json and report.html; those of an earlier run are "
      "kept\n"
      "aside, as calibration.previous.textproto and so on. Several sessions of one rig are\n"
      "solved together: the lenses and the LIDAR's own errors are the same in all of them, the\n"
      "poses, too, unless --mounts-moved; where they disagree a warning says so.\n"
      "Examples: rgbdt calibrate out/demo/session --out out/again\n"
      "          rgbdt calibrate monday friday --mounts-moved --out out/week",
      [flags] {
        flags->options.joint = !flags->separate;
        if (flags->range_offset)
          flags->options.first_guess.range_offset_sigma_m = kRangeOffsetSigmaM;
        return RunCalibrate(*flags);
      });
  verb->Ends(
      ExitCode::kFailed,
      "failed, or not all of it: a camera or LIDAR did not converge, or a view could not be read");
  AddVerdictEnds(verb);
  verb->Required("DIR", &flags->dirs, "session directories (rig.textproto, views/)");
  verb->Option("--out", &flags->out,
               "where to write; default: DIR. Of several sessions it must be given");
  verb->Choice("--method", &flags->options.method, kMethodNames, kMethodHelp);
  verb->Flag("--mounts-moved", &flags->mounts_moved,
             "auto: each session has poses of its own, written to OUT/SESSION, since a camera was\n"
             "touched in between; how far each one moved is said with its uncertainty");
  verb->Flag("--range-offset", &flags->range_offset,
             "auto: take each LIDAR's ranges to be off by any constant, whatever the rig file\n"
             "says of them (lidar.range_offset_sigma_m)");
  verb->Flag("--separate", &flags->separate,
             "auto: solve cameras separately, not all in one problem; further LIDARs go with\n"
             "the first of them");
  verb->Flag("--smooth-field", &flags->options.smooth_field,
             "paper: extend the distance field beyond the images' borders, so that points\n"
             "outside are drawn back; otherwise half of them must lie inside");
  verb->Option("--without", &flags->without,
               "leave this view out; may be given again. rgbdt-viewer --session DIR shows what\n"
               "leaving views out changes");
  verb->Option("--truth", &flags->truth, "truth.textproto; default: DIR's, where there is one");
  AddJson(verb, &flags->json);
}

}  // namespace rgbdt
