#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include "calib/files/schema/report_file.h"
#include "calib/model/errors.h"
#include "calib/present/session/report_files.h"
#include "services/bus/log.h"
#include "services/replay/replay.h"
#include "services/rgbdt/print_report.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

struct ReplayFlags {
  std::string log;
  std::string out = "out/replay";
  std::string method = kAutoMethod;
  bool anyway = false;
};

void PrintFused(const Status& fuser) {
  std::printf("fuser: %s", fuser.text.c_str());
  for (const auto& [name, value] : fuser.counters) {
    if (name == "points" || name == "coloured") {
      std::printf(", %s %lld", name.c_str(), static_cast<long long>(value));
    }
  }
  std::printf("\n");
}

void PrintProblems(const NodeRunner& runner) {
  const Status status = runner.GetStatus();
  if (status.last_problem.empty() && runner.gaps() == 0) return;
  std::fprintf(stderr, "%s: %lld messages dropped, %lld missing; last problem: %s\n",
               status.process.c_str(), static_cast<long long>(runner.dropped()),
               static_cast<long long>(runner.gaps()), status.last_problem.c_str());
}

// What the log holds; how many messages.
std::int64_t ReplayLog(const std::string& path, Replay* replay) {
  LogReader log(path);
  std::int64_t events = 0;
  int percent = -1;
  while (const auto event = log.Next()) {
    replay->Take(event->channel, event->bytes);
    ++events;
    const int now = static_cast<int>(100 * log.position() / std::max<std::int64_t>(1, log.size()));
    if (now / 5 != percent / 5) std::fprintf(stderr, "replay: %d%%\n", now);
    percent = now;
  }
  replay->Finish();
  for (const NodeRunner* runner : replay->runners()) PrintProblems(*runner);
  if (log.unreadable_bytes() > 0) {
    std::fprintf(stderr, "%s: %lld bytes belong to no whole message; was the logger killed?\n",
                 path.c_str(), static_cast<long long>(log.unreadable_bytes()));
  }
  return events;
}

// A log without a view gives no result, and leaves an earlier one where it is.
void SetAsideWithTheFirstView(const std::string& out, Replay* replay) {
  replay->bus().Subscribe("DETECTION", [out, done = false](auto&&...) mutable {
    if (!std::exchange(done, true)) SetAside(out);
  });
}

int RunReplay(const ReplayFlags& flags) {
  Replay replay(flags.method, flags.anyway ? Use::kAnyway : Use::kIfSound);
  SetAsideWithTheFirstView(flags.out, &replay);
  const std::int64_t events = ReplayLog(flags.log, &replay);
  const auto [assembler, detector, solver, fuser] = replay.runners();
  std::optional<Report> report = replay.solver().report();
  if (!report && replay.took_calibration()) {
    PrintFused(fuser->GetStatus());
    return EndsWith(flags.anyway || replay.fuser().HasCalibrations());
  }
  if (!report) {
    throw InputError(
        flags.log + ": " + std::to_string(events) +
        " messages, but no view was captured in them, nor do they hold a calibration; solver: " +
        solver->GetStatus().text + "; detector: " + detector->GetStatus().text);
  }
  const std::filesystem::path out = flags.out;
  const std::string written = WriteIfSolved(out, *replay.solver().rig(), &*report);
  WriteReport(out / "report.json", WithVerdicts(*report));
  std::fputs(Summary(*report).FullReport().c_str(), stdout);
  PrintFused(fuser->GetStatus());
  std::printf("%s report.json\n", written.c_str());
  return static_cast<int>(EndOf(*report));
}

}  // namespace

void AddReplay(CommandLine* program) {
  auto flags = std::make_shared<ReplayFlags>();
  CommandLine* verb = program->Verb(
      "replay",
      "Runs the nodes of the live processes on a log of lcm-logger, in one process, in order, as\n"
      "fast as it goes. The same log gives the same bytes. A log without a session is fused\n"
      "by the CALIBRATION in it; one that is not to be used, or was made with another rig, is\n"
      "refused. Of a session calibration.textproto and report.json are written; those of an\n"
      "earlier run are kept aside, as calibration.previous.textproto and so on.\n"
      "Example: rgbdt replay out/demo/session.lcmlog --out out/replay",
      [flags] { return RunReplay(*flags); });
  verb->Ends(ExitCode::kFailed,
             "failed, a camera or LIDAR did not converge, or a calibration was refused");
  AddVerdictEnds(verb);
  verb->Required("LOG", &flags->log, "log written by lcm-logger");
  verb->Option("--out", &flags->out, "where to write");
  verb->Choice("--method", &flags->method, kBusMethodNames, kBusMethodHelp);
  AddAnyway(verb, &flags->anyway, "its verdict is `do not use`, or the rig is another");
}

}  // namespace rgbdt
