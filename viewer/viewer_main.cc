#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <optional>
#include <random>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/calibration_use.h"
#include "calib/files/schema/report_file.h"
#include "calib/methods/calibrate.h"
#include "calib/methods/detect_session.h"
#include "calib/model/errors.h"
#include "calib/model/version.h"
#include "calib/present/frames/page.h"
#include "services/bus/bus.h"
#include "services/command_line/command_line.h"
#include "services/drivers/net/network_interfaces.h"
#include "services/posix/clock.h"
#include "services/runtime/process.h"
#include "viewer/finished/finished_node.h"
#include "viewer/live/bus_monitor.h"
#include "viewer/live/foxglove_feed.h"
#include "viewer/live/live_node.h"
#include "viewer/server/listening_socket.h"
#include "viewer/server/server.h"

namespace {

using rgbdt::viewer::Server;
using rgbdt::viewer::ServerOptions;
using rgbdt::viewer::TlsIdentity;

constexpr const char* kUsual = "127.0.0.1:8080";

struct Flags {
  std::string listen = kUsual;
  rgbdt::BusFlags bus;
  std::string session;
  std::vector<std::string> run;
  bool anyway = false;
  std::string certificate, key;  // of TLS
  bool clear = false;
  std::vector<std::string> foxglove_origins;
};

// "127.0.0.1:8080", "[::1]:8080", "8080"
void ParseAddress(const std::string& listen, ServerOptions* options) {
  const std::size_t colon = listen.rfind(':');
  const std::string port = colon == std::string::npos ? listen : listen.substr(colon + 1);
  if (colon != std::string::npos) options->address = listen.substr(0, colon);
  if (options->address.size() > 2 && options->address.front() == '[') {
    options->address = options->address.substr(1, options->address.size() - 2);
  }
  std::size_t used = 0;
  try {
    options->port = std::stoi(port, &used);
  } catch (const std::exception&) {
  }
  if (used == 0 || used != port.size()) {
    throw rgbdt::UsageError("--listen is \"" + listen +
                            "\"; expected ADDRESS:PORT, e.g. 0.0.0.0:8080");
  }
}

// Who may command where others than this machine's users may look. Not guessable.
std::string NewToken() {
  std::random_device random;
  std::string token;
  char digits[9];
  for (int i = 0; i < 4; ++i) {
    std::snprintf(digits, sizeof digits, "%08x", random());
    token += digits;
  }
  return token;
}

// Addresses by which others may reach what listens at all of this machine's.
std::vector<std::string> OwnAddresses() {
  std::vector<std::string> addresses;
  for (const rgbdt::NetworkInterface& interface : rgbdt::ListInterfaces()) {
    if (interface.loopback || !interface.up) continue;
    for (const rgbdt::InterfaceAddress& at : interface.addresses) {
      addresses.push_back(rgbdt::AddressText(at.address));
    }
  }
  return addresses;
}

// Beyond loopback always, so that nobody in between reads the token; there by a certificate made
// here, unless another is given.
std::optional<TlsIdentity> IdentityFrom(const Flags& flags, const std::string& address,
                                        bool local) {
  if (!flags.certificate.empty()) {
    return TlsIdentity{rgbdt::ReadWholeFile(flags.certificate), rgbdt::ReadWholeFile(flags.key)};
  }
  if (local || flags.clear) return std::nullopt;
  std::vector<std::string> addresses = OwnAddresses();
  addresses.push_back(address);
  return rgbdt::viewer::SelfSignedIdentity(addresses);
}

ServerOptions OptionsFrom(const Flags& flags) {
  ServerOptions options;
  ParseAddress(flags.listen, &options);
  options.socket = rgbdt::viewer::HandedInSocket();
  const bool local = options.socket >= 0 ? rgbdt::viewer::IsLoopback(options.socket)
                                         : rgbdt::viewer::IsLoopback(options.address);
  if (!local) options.token = NewToken();
  options.tls = IdentityFrom(flags, options.address, local);
  options.foxglove_origins = flags.foxglove_origins;
  options.page = rgbdt::ViewerPage();
  options.hello = {{"type", "hello"}, {"version", rgbdt::Version()}};
  return options;
}

// A phone cannot look up this machine's name: its addresses, where it listens at all of them.
void PrintAddresses(const Server& server, const ServerOptions& options) {
  const std::string url = server.Url();
  std::printf("%s\n", url.c_str());
  const std::size_t host = url.find("//") + 2;
  if (options.socket < 0 && (options.address == "0.0.0.0" || options.address == "::")) {
    for (const std::string& address : OwnAddresses()) {
      std::printf("%s%s%s\n", url.substr(0, host).c_str(), address.c_str(),
                  url.substr(url.find(':', host)).c_str());
    }
  }
  if (options.tls) {
    std::printf("certificate: SHA-256 %s\n", rgbdt::viewer::FingerprintOf(*options.tls).c_str());
  } else if (!options.token.empty()) {
    std::printf("in clear: who listens on this network sees the page and its token\n");
  }
  std::fflush(stdout);
}

// Where the usual port is taken, any will do: what runs prints the address.
int SocketToHandOn(const Flags& flags) {
  ServerOptions options;
  ParseAddress(flags.listen, &options);
  try {
    return rgbdt::viewer::ListeningSocket(options.address, options.port);
  } catch (const rgbdt::InputError&) {
    if (flags.listen != kUsual) throw;
    return rgbdt::viewer::ListeningSocket(options.address, 0);
  }
}

// The socket as its number 3, and the command in place of this process.
int RunWithSocket(const Flags& flags) {
  const int socket = SocketToHandOn(flags);
  if (dup2(socket, 3) < 0) throw rgbdt::InputError(std::string("dup2: ") + std::strerror(errno));
  if (socket == 3) fcntl(socket, F_SETFD, 0);  // it is to stay open
  setenv("LISTEN_FDS", "1", 1);
  std::vector<char*> arguments;
  for (const std::string& word : flags.run) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  execvp(arguments.front(), arguments.data());
  throw rgbdt::InputError(flags.run.front() + ": " + std::strerror(errno));
}

// SIGINT or SIGTERM, kept back from all threads that start after it was made.
class Goodbye {
 public:
  Goodbye() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  }
  void Wait() const {
    int which = 0;
    sigwait(&signals_, &which);
  }

 private:
  sigset_t signals_;
};

nlohmann::json Browsers(const Server& server) {
  nlohmann::json all = nlohmann::json::array();
  for (const auto& browser : server.Browsers()) {
    all.push_back({{"address", browser.address},
                   {"waiting", browser.waiting},
                   {"thinned", browser.thinned},
                   {"share", browser.share}});
  }
  return all;
}

nlohmann::json DescribeBus(const rgbdt::viewer::BusMonitor& monitor, double now_s,
                           const Server& server) {
  nlohmann::json frame = {{"type", "bus"},
                          {"channels", monitor.Channels(now_s)},
                          {"browsers", Browsers(server)},
                          {"screen_ms", nullptr}};
  if (const auto screen = server.Screen()) {
    frame["screen_ms"] = {{"p50", screen->p50}, {"p95", screen->p95}, {"count", screen->count}};
  }
  return frame;
}

int ShowBus(const Flags& flags) {
  ServerOptions options = OptionsFrom(flags);
  options.hello["source"] = "live";
  options.hello["title"] = rgbdt::CompleteUrl(flags.bus.url);
  rgbdt::viewer::LiveNode node(flags.anyway ? rgbdt::Use::kAnyway : rgbdt::Use::kIfSound);
  Server server(options, [&](const nlohmann::json& message) { return node.OnBrowser(message); });
  node.PostTo(&server);
  rgbdt::viewer::FoxgloveFeed foxglove(&server);
  node.AlsoTo([&](const rgbdt::Message& message) { foxglove.Take(message, rgbdt::HostUtime()); });
  PrintAddresses(server, options);
  std::printf("for Foxglove: %s\n", server.FoxgloveUrl().c_str());
  std::fflush(stdout);
  rgbdt::viewer::BusMonitor monitor;
  node.PostBus([&](double now_s) { return DescribeBus(monitor, now_s, server); });
  return rgbdt::RunOnLcm(
      node, flags.bus, [&](const std::string& channel, const std::uint8_t* data, std::size_t size) {
        monitor.Add(channel, data, size, rgbdt::ToSeconds(rgbdt::SteadyUtime()),
                    rgbdt::HostUtime());
        foxglove.Overhear(channel, data, size);
      });
}

// The session's report; where it has none, that of a calibration now. Nothing is written.
rgbdt::Report ReportOf(const rgbdt::Session& session,
                       const std::vector<rgbdt::ViewDetection>& detections) {
  const auto path = session.root / "report.json";
  if (std::filesystem::exists(path)) return rgbdt::ReadReport(path);
  return rgbdt::Calibrate(session.rig, detections, {});
}

// Why the report does not belong to the session's rig; empty: it does. What differs is known by the
// calibration that was written with it.
std::string WhyRefused(const rgbdt::Session& session, const rgbdt::Report& report) {
  rgbdt::Calibration calibration = report.ToCalibration();
  const auto path = session.root / "calibration.textproto";
  if (std::filesystem::exists(path)) {
    const rgbdt::Calibration written = rgbdt::ReadCalibration(path);
    if (written.rig_hash == report.rig_hash) calibration = written;
  }
  return rgbdt::WhyAnotherRig(
      calibration, session.rig,
      {(session.root / "report.json").string(), (session.root / "rig.textproto").string()});
}

int ShowSession(const Flags& flags) {
  ServerOptions options = OptionsFrom(flags);
  rgbdt::Session session = rgbdt::OpenSession(flags.session);
  auto detections = rgbdt::DetectSession(session, rgbdt::kAutoMethod, [](const std::string& line) {
                      std::fprintf(stderr, "%s\n", line.c_str());
                    }).views;
  session = rgbdt::ListedOnly(std::move(session), detections);
  rgbdt::Report report = ReportOf(session, detections);
  const std::string why = WhyRefused(session, report);
  if (!why.empty()) {
    std::fprintf(stderr, "rgbdt-viewer: %s%s\n", flags.anyway ? "shown anyway: " : "", why.c_str());
    if (!flags.anyway) report = rgbdt::WithoutPoses(std::move(report), why);
  }
  rgbdt::viewer::FinishedNode node(std::move(session), std::move(detections), report, why);
  const Goodbye goodbye;
  options.hello["source"] = "session";
  options.hello["title"] = flags.session;
  Server server(options, [&](const nlohmann::json& message) { return node.OnBrowser(message); });
  node.PostTo(&server, flags.session);
  PrintAddresses(server, options);
  goodbye.Wait();
  return 0;
}

void CheckFlags(const Flags& flags, bool run) {
  if (run == flags.run.empty()) {
    throw rgbdt::UsageError(run ? "--run: which command?"
                                : "unexpected \"" + flags.run.front() + "\"");
  }
  if (!flags.session.empty() && !flags.bus.url.empty()) {
    throw rgbdt::UsageError("--session shows files, --lcm-url a bus; give one of them");
  }
  if (!flags.session.empty() && !flags.foxglove_origins.empty()) {
    throw rgbdt::UsageError("--foxglove-origin is of a bus, and --session shows files");
  }
  if (flags.clear && !flags.certificate.empty()) {
    throw rgbdt::UsageError("--tls and --no-tls; give one of them");
  }
}

}  // namespace

int main(int argc, char** argv) {
  rgbdt::CommandLine line(
      "rgbdt-viewer",
      "Shows the rig, the session and the fused cloud in a browser, live from the bus or of a\n"
      "finished session. Prints the address to open.\n"
      "Example: rgbdt-viewer\n"
      "         rgbdt-viewer --session out/demo/session\n"
      "         rgbdt-viewer --listen 0.0.0.0:8080    # a phone in the same network may look, "
      "too,\n"
      "                                               # by TLS\n"
      "         rgbdt-viewer --run COMMAND ARGUMENT...");
  Flags flags;
  line.Option("--listen", &flags.listen,
              "address and port; beyond loopback, commands need the token that the printed\n"
              "address has");
  line.Two(
      "--tls", &flags.certificate, &flags.key, "CERT KEY",
      "PEM files to speak TLS with; default: beyond loopback a certificate made at the start,\n"
      "whose fingerprint is printed, to be compared with what the browser shows");
  line.Flag("--no-tls", &flags.clear,
            "beyond loopback, too, in clear: who listens on the network sees page and token");
  line.Option("--foxglove-origin", &flags.foxglove_origins,
              "a page of another site that may look by Foxglove's protocol, as its browser names\n"
              "it: https://app.foxglove.dev; may be given again. Programs may without");
  line.Bus(&flags.bus.url, &flags.bus.key);
  line.Option("--session", &flags.session, "a session directory, in place of the bus");
  line.Flag("--anyway", &flags.anyway, "show a calibration although it was made with another rig");
  bool run = false;
  line.Flag("--run", &run,
            "run COMMAND with the listening socket handed in (LISTEN_FDS), e.g. where it goes\n"
            "into a network namespace and starts rgbdt-viewer there");
  line.Rest(&flags.run);
  return line.Run(argc, argv, [&] {
    CheckFlags(flags, run);
    if (!flags.run.empty()) return RunWithSocket(flags);
    return flags.session.empty() ? ShowBus(flags) : ShowSession(flags);
  });
}
