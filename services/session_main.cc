#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <memory>

#include "calib/files/schema/rig_file.h"
#include "calib/files/schema/session_script.h"
#include "calib/model/errors.h"
#include "calib/model/version.h"
#include "services/nodes/session_node.h"
#include "services/runtime/process.h"

namespace {

double Seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// A line for each new text, and for each quarter of a long step: how far, how long still.
class ProgressPrinter {
 public:
  void operator()(const rgbdt::SessionProgress& progress) {
    const int quarter = static_cast<int>(progress.fraction * 4);
    if (progress.step == step_ && progress.text == text_ && quarter == quarter_) return;
    step_ = progress.step;
    text_ = progress.text;
    quarter_ = quarter;
    const double done = (progress.step - 1 + progress.fraction) / progress.steps;
    std::string left;
    if (done > 0.05) {
      left = ", about " + std::to_string(std::lround((Seconds() - began_) * (1 - done) / done)) +
             " s left";
    }
    std::printf("[%d/%d] %s, %.0f%%%s\n", progress.step, progress.steps, progress.text.c_str(),
                100 * progress.fraction, left.c_str());
    std::fflush(stdout);
  }

 private:
  double began_ = Seconds();
  int step_ = 0;
  int quarter_ = -1;
  std::string text_;
};

// A person is not hurried.
void GiveTime(rgbdt::SessionScript* script) {
  for (rgbdt::SessionStep& step : script->steps) {
    if (step.kind == rgbdt::SessionStep::Kind::kNextPose) step.timeout_s = 1e9;
  }
}

// Who carries the board, at the keyboard.
class Person {
 public:
  // Asks once for each pose; true once Enter was pressed. Never waits. Throws where there is
  // nobody: standard input has ended.
  bool SaysDone() {
    if (!asked_) {
      std::printf("Put the board where the next view wants it, step aside, then press Enter.\n");
      std::fflush(stdout);
      asked_ = true;
    }
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (poll(&input, 1, 0) <= 0) return false;
    char key = 0;
    if (read(STDIN_FILENO, &key, 1) != 1) {
      throw rgbdt::InputError(
          "standard input has ended, nobody can press Enter; leave out --by-hand");
    }
    if (key != '\n') return false;
    asked_ = false;
    return true;
  }

 private:
  bool asked_ = false;
};

std::unique_ptr<rgbdt::SessionNode> ByScript(const std::string& file, const std::string& rig,
                                             const std::string& out, bool by_hand) {
  rgbdt::SessionScript script = rgbdt::ReadSessionScript(file, rig);
  if (by_hand) GiveTime(&script);
  return std::make_unique<rgbdt::SessionNode>(script, rgbdt::ReadRig(script.rig), out,
                                              ProgressPrinter());
}

std::unique_ptr<rgbdt::SessionNode> LedByThePage(const std::string& rig, const std::string& out,
                                                 bool by_hand) {
  if (rig.empty()) throw rgbdt::InputError("without a script --rig is needed: which rig?");
  if (by_hand) throw rgbdt::InputError("--by-hand goes with a script; the page asks by itself");
  std::printf("The viewer's page leads this session: rgbdt-viewer prints its address.\n");
  std::fflush(stdout);
  return std::make_unique<rgbdt::SessionNode>(rgbdt::ReadRig(rig), out, ProgressPrinter());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Runs a calibration session on the bus and writes the session directory: by a script, or,\n"
      "without one, as you ask in the viewer's page (rgbdt-viewer).\n"
      "Example: rgbdt-session scripts/sessions/demo.session.textproto --rig out/rig.textproto "
      "--out out/session\n"
      "         rgbdt-session --rig out/rig.textproto --out out/session",
      "rgbdt-session"};
  std::string url;
  std::string script_file;
  std::string rig_file;
  std::string out = "out/session";
  bool by_hand = false;
  app.add_option("FILE", script_file, "session.textproto; without it the viewer's page leads");
  app.add_option("--rig", rig_file, "rig.textproto; default: the one that the script names");
  app.add_option("--out", out, "session directory to write")->capture_default_str();
  app.add_flag("--by-hand", by_hand,
               "you carry the board: asks for each pose and waits for Enter, or for the button in "
               "the viewer, however long");
  app.add_option("--lcm-url", url, "the bus; default: LCM_DEFAULT_URL");
  app.set_version_flag("--version", rgbdt::Version());
  CLI11_PARSE(app, argc, argv);
  try {
    const std::unique_ptr<rgbdt::SessionNode> session =
        script_file.empty() ? LedByThePage(rig_file, out, by_hand)
                            : ByScript(script_file, rig_file, out, by_hand);
    rgbdt::SessionNode& node = *session;
    Person person;
    const double began = Seconds();
    const int code = rgbdt::RunOnLcm(node, url, [&](rgbdt::NodeRunner& runner) {
      runner.Publish(node.Advance(Seconds() - began));
      if (by_hand && node.WaitsForPose() && person.SaysDone()) node.PoseIsSet();
      return !node.finished();
    });
    if (!node.failure().empty()) {
      std::fprintf(stderr, "rgbdt-session: %s\n", node.failure().c_str());
      return 1;
    }
    if (!node.finished() && code == 0) {
      std::fprintf(stderr, "rgbdt-session: stopped before its end: %s\n",
                   node.GetStatus().text.c_str());
    }
    return node.finished() ? code : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "rgbdt-session: %s\n", e.what());
    return 1;
  }
}
