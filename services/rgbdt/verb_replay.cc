#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>

#include "calib/files/schema/report_file.h"
#include "calib/model/errors.h"
#include "calib/present/report/report_table.h"
#include "services/bus/log.h"
#include "services/nodes/assembler_node.h"
#include "services/nodes/detector_node.h"
#include "services/nodes/fuser_node.h"
#include "services/nodes/solver_node.h"
#include "services/rgbdt/verbs.h"
#include "services/rgbdt/write_report.h"
#include "services/runtime/node_runner.h"

namespace rgbdt {
namespace {

struct Flags {
  std::string log;
  std::string out = "out/replay";
  std::string method = kAutoMethod;
};

// What sensors, people and the session said. All else in a log is what nodes made of it.
bool IsInput(const std::string& channel) {
  static const std::string kImage = "_IMAGE";
  return channel == "RIG" || channel == "LINE_SCAN" || channel == "ENCODER" ||
         channel == "CORNER_SELECTION" || channel == "SESSION_COMMAND" || channel == "POSE" ||
         (channel.size() > kImage.size() &&
          channel.compare(channel.size() - kImage.size(), kImage.size(), kImage) == 0);
}

// What is taken from a log, as far as it has been read.
class InputChannels {
 public:
  bool Takes(const std::string& channel) {
    has_lines_ |= channel == "LINE_SCAN";
    has_session_ |= channel == "SESSION_COMMAND";
    // A log of clouds only (a 3D LIDAR) has no lines; one with lines gets its clouds from them.
    if (channel == "CLOUD") return !has_lines_;
    // A log of a session gets its calibration from its views; any other brings it along.
    if (channel == "CALIBRATION") return !has_session_;
    return IsInput(channel);
  }

 private:
  bool has_lines_ = false, has_session_ = false;
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
  if (runner.dropped() == 0 && runner.gaps() == 0) return;
  std::fprintf(stderr, "%s: %lld messages dropped, %lld missing; last problem: %s\n",
               status.process.c_str(), static_cast<long long>(runner.dropped()),
               static_cast<long long>(runner.gaps()), status.last_problem.c_str());
}

// To the newest time that any of them has heard.
void Advance(const std::array<NodeRunner*, 4>& runners, MemoryBus* bus) {
  Utime now = 0;
  for (const NodeRunner* runner : runners) now = std::max(now, runner->newest_utime());
  for (NodeRunner* runner : runners) runner->Advance(now);
  bus->Run();
}

int Run(const Flags& flags) {
  LogReader log(flags.log);
  MemoryBus bus;
  AssemblerNode assembler;
  DetectorNode detector(flags.method, DetectorNode::Looks::kNo);
  CalibrateOptions options;
  options.method = flags.method;
  SolverNode solver(options);
  FuserNode fuser;
  NodeRunner assembler_runner(&assembler, &bus);
  NodeRunner detector_runner(&detector, &bus);
  NodeRunner solver_runner(&solver, &bus);
  NodeRunner fuser_runner(&fuser, &bus);
  const std::array<NodeRunner*, 4> runners = {&assembler_runner, &detector_runner, &solver_runner,
                                              &fuser_runner};
  InputChannels input;
  bool has_calibration = false;
  std::int64_t events = 0;
  int percent = -1;
  while (const auto event = log.Next()) {
    if (input.Takes(event->channel)) {
      has_calibration |= event->channel == "CALIBRATION";
      bus.Publish(event->channel, event->bytes);
      bus.Run();
      Advance(runners, &bus);
    }
    ++events;
    const int now = static_cast<int>(100 * log.position() / std::max<std::int64_t>(1, log.size()));
    if (now / 5 != percent / 5) std::fprintf(stderr, "replay: %d%%\n", now);
    percent = now;
  }
  for (const NodeRunner* runner : runners) PrintProblems(*runner);
  if (log.unreadable_bytes() > 0) {
    std::fprintf(stderr, "%s: %lld bytes belong to no whole message; was the logger killed?\n",
                 flags.log.c_str(), static_cast<long long>(log.unreadable_bytes()));
  }
  if (!solver.report() && has_calibration) {
    PrintFused(fuser_runner.GetStatus());
    return 0;
  }
  if (!solver.report()) {
    throw InputError(
        flags.log + ": " + std::to_string(events) +
        " messages, but no view was captured in them, nor do they hold a calibration; solver: " +
        solver.GetStatus().text + "; detector: " + detector.GetStatus().text);
  }
  const std::filesystem::path out = flags.out;
  const std::string written = WriteIfSolved(out, *solver.report());
  WriteReport(out / "report.json", *solver.report());
  std::fputs(ReportTable(*solver.report()).c_str(), stdout);
  PrintFused(fuser_runner.GetStatus());
  std::printf("%s report.json\n", written.c_str());
  return AllConverged(*solver.report()) ? 0 : 1;
}

}  // namespace

void AddReplay(CLI::App* app, int* exit_code) {
  CLI::App* verb = app->add_subcommand(
      "replay",
      "Runs the nodes of the live processes on a log of lcm-logger, in one process, in order, as\n"
      "fast as it goes. The same log gives the same bytes. A log without a session is fused\n"
      "by the CALIBRATION in it.\n"
      "Example: rgbdt replay out/demo/session.lcm --out out/replay");
  auto flags = std::make_shared<Flags>();
  verb->add_option("LOG", flags->log, "log written by lcm-logger")->required();
  verb->add_option("--out", flags->out, "where to write")->capture_default_str();
  verb->add_option("--method", flags->method, kMethodHelp)->capture_default_str();
  verb->callback([flags, exit_code] { *exit_code = Run(*flags); });
}

}  // namespace rgbdt
