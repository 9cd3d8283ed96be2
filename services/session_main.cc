#include <cstdio>
#include <filesystem>
#include <memory>
#include <random>

#include "calib/files/check_writable.h"
#include "calib/files/folder_lock.h"
#include "calib/files/schema/rig_file.h"
#include "calib/files/schema/session_script.h"
#include "calib/model/errors.h"
#include "services/bus/bus.h"
#include "services/bus/host_name.h"
#include "services/bus/multicast.h"
#include "services/command_line/command_line.h"
#include "services/nodes/session_node.h"
#include "services/rgbdt/verdict_ends.h"
#include "services/runtime/process.h"
#include "services/session_terminal.h"

namespace {

struct Flags {
  rgbdt::BusFlags bus;
  std::string script, rig;
  std::string out = "out/session";
  bool by_hand = false;
};

constexpr rgbdt::Utime kListen = 2 * rgbdt::kMicrosecondsPerSecond;  // every STATUS comes at 1 Hz

rgbdt::SessionIdentity Identity(const std::string& out) {
  std::random_device lot;
  rgbdt::SessionIdentity identity;
  identity.id = std::uniform_int_distribution<std::int64_t>(0, identity.kIds - 1)(lot);
  identity.place =
      rgbdt::HostName() + ":" + std::filesystem::absolute(out).lexically_normal().string();
  identity.listen = kListen;
  return identity;
}

std::unique_ptr<rgbdt::SessionNode> ByScript(const Flags& flags) {
  const rgbdt::SessionScript script = rgbdt::ReadSessionScript(flags.script, flags.rig);
  rgbdt::SessionNode::BoardStands board_stands;
  if (flags.by_hand)
    board_stands = [person = rgbdt::Person()]() mutable { return person.BoardStands(); };
  return std::make_unique<rgbdt::SessionNode>(script, rgbdt::ReadRig(script.rig), flags.out,
                                              rgbdt::ProgressPrinter(), board_stands,
                                              Identity(flags.out));
}

std::unique_ptr<rgbdt::SessionNode> LedByThePage(const Flags& flags) {
  if (flags.rig.empty()) throw rgbdt::UsageError("without a script --rig is needed: which rig?");
  if (flags.by_hand)
    throw rgbdt::UsageError("--by-hand goes with a script; the page asks by itself");
  std::printf("The viewer's page leads this session: rgbdt-viewer prints its address.\n");
  std::fflush(stdout);
  return std::make_unique<rgbdt::SessionNode>(rgbdt::ReadRig(flags.rig), flags.out,
                                              rgbdt::ProgressPrinter(), Identity(flags.out));
}

int Run(const Flags& flags) {
  rgbdt::CheckWritable(std::filesystem::path(flags.out) / "rig.textproto");
  const rgbdt::FolderLock lock(flags.out, "rgbdt-session");
  const auto node = flags.script.empty() ? LedByThePage(flags) : ByScript(flags);
  const int code = rgbdt::RunOnLcm(*node, flags.bus);
  if (const std::string lost = node->WriteWhatIsKept(); !lost.empty()) {
    std::fprintf(stderr, "rgbdt-session: %s\n", lost.c_str());
  }
  if (!node->failure().empty()) {
    std::fprintf(stderr, "rgbdt-session: %s\n", node->failure().c_str());
    if (node->failure().find("not heard") != std::string::npos) {
      std::fprintf(stderr, "rgbdt-session: %s\n",
                   rgbdt::WhyNotHeard(rgbdt::CompleteUrl(flags.bus.url)).c_str());
    }
    return rgbdt::EndsWith(false);
  }
  if (node->finished()) {
    const auto& report = node->report();
    return code == 0 && report ? static_cast<int>(rgbdt::EndOf(*report)) : code;
  }
  if (code == 0) {
    std::fprintf(stderr, "rgbdt-session: stopped before its end: %s\n",
                 node->GetStatus().text.c_str());
  }
  return rgbdt::EndsWith(false);
}

}  // namespace

int main(int argc, char** argv) {
  rgbdt::CommandLine line(
      "rgbdt-session",
      "Runs a calibration session on the bus and writes the session directory: by a script, or,\n"
      "without one, as you ask in the viewer's page (rgbdt-viewer).\n"
      "Example: rgbdt-session scripts/sessions/demo.session.textproto --rig out/rig.textproto "
      "--out out/session\n"
      "         rgbdt-session --rig out/rig.textproto --out out/session");
  line.Ends(rgbdt::ExitCode::kFailed, "failed, or ended before its end; stderr says why");
  rgbdt::AddVerdictEnds(&line, "the session is whole, but ");
  Flags flags;
  line.Option("FILE", &flags.script, "session.textproto; without it the viewer's page leads");
  line.Option("--rig", &flags.rig, "rig.textproto; default: the one that the script names");
  line.Option("--out", &flags.out,
              "session directory to write, or, where it was ended before its end, to go on with");
  line.Flag("--by-hand", &flags.by_hand,
            "you carry the board: asks for each pose and waits for Enter, or for the button in "
            "the viewer, however long");
  line.Bus(&flags.bus.url, &flags.bus.key);
  return line.Run(argc, argv, [&] { return Run(flags); });
}
