#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <sstream>

#include "calib/files/atomic_file.h"
#include "calib/files/check_writable.h"
#include "calib/files/folder_lock.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "services/bus/bus.h"
#include "services/bus/bus_url.h"
#include "services/bus/host_name.h"
#include "services/nodes/earlier_views.h"
#include "services/rgbdt/verbs.h"
#include "services/runtime/process.h"
#include "services/up/up_node.h"

namespace rgbdt {
namespace {

struct UpFlags {
  BusFlags bus;
  std::string rig, listen, certificate, tls_key, logs, log, host;
  std::string out, drive;
};

constexpr const char* kPageAt = "http";

// As the viewer printed it.
std::string PageOf(const std::filesystem::path& log) {
  std::FILE* file = std::fopen(log.c_str(), "r");
  if (file == nullptr) return "";
  std::string page;
  char line[1000];
  while (std::fgets(line, sizeof(line), file) != nullptr) {
    if (std::string(line).rfind(kPageAt, 0) == 0) page = line;
  }
  std::fclose(file);
  return page.substr(0, page.find_first_of("\r\n"));
}

// On a terminal the newest table stands in place of the one before, what happened above it;
// elsewhere there is only what happened.
class Screen {
 public:
  explicit Screen(std::filesystem::path viewer_log) : viewer_log_(std::move(viewer_log)) {}

  void Tell(const std::string& line) {
    Erase();
    std::printf("%s\n", line.c_str());
    Draw();
  }
  void Show(const std::string& table) {
    const std::string page = PageOf(viewer_log_);
    if (!terminal_) {
      if (page != page_) std::printf("page: %s\n", page.c_str());
      page_ = page;
      std::fflush(stdout);
      return;
    }
    Erase();
    table_ = table + (page.empty() ? "" : "page: " + page + "\n") + "Ctrl-C ends all of it\n";
    Draw();
  }

 private:
  // Without wrapping: a row is a line, however narrow the terminal is, and so can be erased.
  void Draw() const {
    if (!table_.empty()) std::printf("\x1b[?7l%s\x1b[?7h", table_.c_str());
    std::fflush(stdout);
  }
  void Erase() const {
    const auto lines = std::count(table_.begin(), table_.end(), '\n');
    if (lines > 0) std::printf("\x1b[%dA\x1b[J", static_cast<int>(lines));
  }

  std::filesystem::path viewer_log_;
  bool terminal_ = isatty(STDOUT_FILENO) == 1;
  std::string table_, page_;
};

// Hosts of a bus that keeps to its machine hear nothing of each other.
void WarnOfTtl(const Rig& rig, const std::string& url) {
  const BusUrl bus = ParseBusUrl(CompleteUrl(url));
  if (rig.hosts.size() < 2 || bus.ttl > 0 || !bus.error.empty()) return;
  std::fprintf(stderr,
               "rgbdt up: the rig has %zu hosts, but the bus is of ttl=0, which other machines do "
               "not hear: on each, LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=1'\n",
               rig.hosts.size());
}

const Program* Find(const std::vector<Program>& programs, const std::string& name) {
  const auto found = std::find_if(programs.begin(), programs.end(),
                                  [&](const Program& program) { return program.name == name; });
  return found == programs.end() ? nullptr : &*found;
}

// It comes with LCM's programs, which are not always there.
void RequireLogger() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((std::filesystem::path(folder) / kLoggerProgram).c_str(), X_OK) == 0) return;
  }
  throw InputError(std::string(kLoggerProgram) +
                   " is not installed: apt-get install liblcm-bin, or leave --log and the rig's "
                   "`logger` out");
}

// What the fuser would refuse again and again.
void RequireCalibrated(const std::filesystem::path& session, const std::string& rig_file,
                       const Rig& rig) {
  const std::filesystem::path file = session / "calibration.textproto";
  const Calibration calibration = ReadCalibration(file);
  RequireSound(calibration, rig, {file.string(), rig_file}, Use::kIfSound);
  PrintDoubts(calibration, rig, file);
}

// What a process printed in the run before is what tells why one is begun anew.
void KeepEarlier(const std::filesystem::path& log) {
  if (std::filesystem::exists(log)) {
    Rename(log, std::filesystem::path(log) += ".earlier");
  }
}

int RunUp(UpFlags flags) {
  const Rig rig = ReadRig(flags.rig);
  const bool drives = !flags.drive.empty();
  if (flags.out.empty()) flags.out = drives ? "out/drive" : "out/session";
  UpOptions options;
  options.programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  options.rig = flags.rig;
  options.out = flags.out;
  options.drive = flags.drive;
  options.logs = PathOr(flags.logs, flags.out + ".logs");
  options.listen = flags.listen;
  options.certificate = flags.certificate;
  options.tls_key = flags.tls_key;
  options.url = CompleteUrl(flags.bus.url);  // the logger, too, is to have a large buffer
  options.key = flags.bus.key;
  options.log = flags.log;
  const std::string host = flags.host.empty() ? HostName() : flags.host;
  std::vector<Program> programs = ProgramsOn(host, rig, ProgramsOf(rig, options));
  if (programs.empty()) throw InputError("the rig's file has nothing for this machine to run");
  const bool logs = Find(programs, kLogger) != nullptr;
  if (!flags.log.empty() && !logs) {
    throw InputError("--log: by the rig's file another host runs the logger; leave --log out here");
  }
  if (logs) {
    RequireLogger();
    CheckWritable(Find(programs, kLogger)->arguments.back());
  }
  WarnOfTtl(rig, flags.bus.url);
  if (Find(programs, "monitor") != nullptr) RequireCalibrated(flags.drive, flags.rig, rig);
  if (Find(programs, "mapper") != nullptr) {
    CheckWritable(std::filesystem::path(flags.out) / "map.ply");
  }
  // What the session would refuse again and again.
  if (Find(programs, "session") != nullptr) {
    ReadEarlierViews(flags.out, rig);
    CheckWritable(std::filesystem::path(flags.out) / "rig.textproto");
    const FolderLock free(flags.out, "rgbdt-session");
  }
  for (const Program& program : programs) KeepEarlier(program.log);
  const Program* viewer = Find(programs, "viewer");
  Screen screen(viewer == nullptr ? std::filesystem::path() : viewer->log);
  std::printf("What the processes print is in %s\n", options.logs.c_str());
  UpNode node(
      std::move(programs), [&](const std::string& line) { screen.Tell(line); },
      [&](const std::string& table) { screen.Show(table); },
      rig.hosts.empty() ? "up" : "up-" + host);
  const int code = RunOnLcm(node, flags.bus);
  node.Stop();
  return code;
}

}  // namespace

void AddUp(CommandLine* program) {
  auto flags = std::make_shared<UpFlags>();
  CommandLine* verb =
      program->Verb("up",
                    "Runs all processes of a rig on this machine, and again where one dies: the\n"
                    "drivers of its devices, assembler, detector, solver, fuser, a session that\n"
                    "the viewer's page leads, and the viewer. One table tells how each does;\n"
                    "Ctrl-C ends all of it. Where the rig file names hosts, the same command on\n"
                    "each of them runs what is that machine's. With --drive: monitor, odometry\n"
                    "and mapper in place of detector, solver and session.\n"
                    "Examples: rgbdt up rig.textproto --out out/monday\n"
                    "          rgbdt up rig.textproto --drive out/monday --log out/drive.lcmlog",
                    [flags] { return RunUp(*flags); });
  verb->Required("RIG", &flags->rig, "rig.textproto");
  verb->Option("--out", &flags->out,
               "session directory to write, or, where it was ended before its end, to go on with;\n"
               "of a drive the folder of its map, map.ply. Default: out/session; out/drive");
  verb->Option("--drive", &flags->drive,
               "SESSION, a calibrated one: the rig drives, and is watched and mapped");
  verb->Option(
      "--logs", &flags->logs,
      "folder for what the processes print, and printed in the run before (NAME.log.earlier); "
      "default: beside the session's, OUT.logs");
  verb->Option(
      "--log", &flags->log,
      "keep what is said on the bus here, by lcm-logger: FILE.00, and FILE.01 where it died "
      "and was started again. Default: only where a host of the rig runs `logger`, in "
      "OUT.lcmlog.00");
  verb->Option("--host", &flags->host,
               "which of the rig's hosts this machine is; default: its host name");
  verb->Option("--listen", &flags->listen,
               "of the page, e.g. 0.0.0.0:8080 for a phone; default: the viewer's");
  verb->Two("--tls", &flags->certificate, &flags->tls_key, "CERT KEY",
            "PEM files of the page's TLS; default: the viewer's");
  verb->Bus(&flags->bus.url, &flags->bus.key);
}

}  // namespace rgbdt
