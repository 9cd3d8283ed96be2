// What the live tests' scripts need of the bus. See usage().

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "calib/files/schema/calibration_file.h"
#include "calib/model/errors.h"
#include "services/bus/bus.h"
#include "services/bus/log.h"
#include "services/bus/log_writer.h"
#include "services/bus/sequence.h"
#include "services/messages/codec.h"
#include "services/messages/signature.h"
#include "services/messages/status_counters.h"
#include "tests/datagrams.h"
#include "tests/unit/messages/random_messages.h"

namespace rgbdt {
namespace {

using Arguments = std::vector<std::string>;
using Clock = std::chrono::steady_clock;

constexpr auto kPatience = std::chrono::seconds(90);

int Usage() {
  std::fputs(
      "usage: live_helper VERB ...\n"
      "  ready PROCESS[=TEXT]... until the bus carries a status of each, with this in its text\n"
      "  ask next_pose|capture|finish  of the session, as the page does, and waits until it is "
      "done with "
      "it;\n"
      "                         prints what it says; exit code 3: it failed\n"
      "  garbage PROCESS...     publishes garbage on every channel until each names some\n"
      "  flood HZ               garbage on every channel, so many a second, until SIGTERM; prints\n"
      "                         how many a second it became\n"
      "  forge PROCESS...       publishes unsigned commands, rigs, calibrations, ... until each\n"
      "                         says in its status that it ignored some\n"
      "  keep_signed LOG OUT    a log without what is not signed there; prints how many went\n"
      "  calibration VIEWS      until the solver has them of two cameras; prints what it found\n"
      "  gaps LOG               messages that a log lacks, by channel; exit code 3 if any\n"
      "  print FILE             prints a calibration.textproto in the same way\n"
      "  attack ADDRESS PORT CHANNEL...  sends each malformed datagram that there is there; "
      "prints\n"
      "                         how many\n"
      "  malformed LEAST PROCESS...  until their statuses tell of so many; prints how many\n"
      "  hears_malformed CHANNEL  until one came to a bus on which this channel is heard\n"
      "  speaks SEQ             on RIG, numbered from SEQ, for 90 s\n"
      "  hears CHANNEL COUNT    until so many messages came there, each as it has to be\n"
      "Gives up after 90 s with exit code 1.\n",
      stderr);
  return 2;
}

/// Listens to STATUS; knows the newest of each process.
class Listener {
 public:
  Listener() {
    bus.Subscribe("STATUS",
                  [&](const std::string& channel, const std::uint8_t* data, std::size_t size) {
                    try {
                      const Status status = std::get<Status>(Decode(channel, data, size));
                      statuses[status.process] = status;
                    } catch (const InputError&) {  // our own garbage
                    }
                  });
  }

  /// Throws InputError with `what` where it does not happen.
  void RunUntil(const std::function<bool()>& done, const std::string& what) {
    const Clock::time_point end = Clock::now() + kPatience;
    while (!done()) {
      if (Clock::now() > end) throw InputError("waited 90 s for " + what);
      bus.Run(20);
    }
  }

  std::int64_t Counter(const std::string& process, const std::string& name) const {
    const auto found = statuses.find(process);
    return found == statuses.end() ? -1 : CounterOf(found->second, name);
  }

  LcmBus bus{""};
  std::map<std::string, Status> statuses;
};

int Ready(const Arguments& processes) {
  Listener listener;
  for (const std::string& word : processes) {
    const std::size_t at = std::min(word.find('='), word.size());
    const std::string process = word.substr(0, at),
                      says = word.substr(std::min(at + 1, word.size()));
    listener.RunUntil(
        [&] {
          const auto status = listener.statuses.find(process);
          return status != listener.statuses.end() &&
                 status->second.text.find(says) != std::string::npos;
        },
        "a status of " + word);
  }
  return 0;
}

int Ask(const Arguments& words) {
  Listener listener;
  listener.RunUntil([&] { return listener.Counter("session", "busy") == 0; }, "an idle session");
  std::optional<SessionEvent> answer;
  listener.bus.Subscribe(
      "SESSION_EVENT", [&](const std::string& channel, const std::uint8_t* data, std::size_t size) {
        const auto event = std::get<SessionEvent>(Decode(channel, data, size));
        const bool ends = event.source == "session" && event.kind != EventKind::kProgress;
        if (ends && !answer) answer = event;
      });
  SessionRequest request;
  const std::map<std::string, SessionRequestKind> kinds = {
      {"next_pose", SessionRequestKind::kNextPose},
      {"capture", SessionRequestKind::kCapture},
      {"finish", SessionRequestKind::kFinish}};
  request.request = kinds.at(words.at(0));
  listener.bus.Publish(ChannelOf(request), Encode(request));
  listener.RunUntil([&] { return answer.has_value(); }, "the session's answer");
  std::printf("%s\n", answer->text.c_str());
  return answer->kind == EventKind::kFailed ? 3 : 0;
}

/// Every channel's messages cut short, torn and drawn by lot.
std::vector<std::pair<std::string, Bytes>> MakeGarbage() {
  std::vector<std::pair<std::string, Bytes>> garbage;
  std::mt19937 random(1);
  for (Message& message : testing::RandomMessages(1).OneOfEach()) {
    if (auto* image = std::get_if<Image>(&message)) image->camera = "rgb";
    const std::string channel = ChannelOf(message);
    const Bytes good = Encode(message);
    for (const std::size_t size : {std::size_t{0}, std::size_t{3}, good.size() / 2}) {
      garbage.emplace_back(channel, Bytes(good.begin(), good.begin() + static_cast<long>(size)));
    }
    Bytes longer = good;
    longer.push_back(0);
    garbage.emplace_back(channel, longer);
    Bytes noise(1000);
    for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random());
    garbage.emplace_back(channel, noise);
    std::copy(good.begin(), good.begin() + 8, noise.begin());  // the type's own fingerprint
    garbage.emplace_back(channel, noise);
  }
  return garbage;
}

int Garbage(const Arguments& processes) {
  Listener listener;
  for (const auto& [channel, bytes] : MakeGarbage()) {
    listener.bus.Publish(channel, bytes);
    // One at a time: lcm-logger's queue holds 30 messages, and a burst would cost it good ones.
    const Clock::time_point next = Clock::now() + std::chrono::milliseconds(10);
    while (Clock::now() < next) listener.bus.Run(5);
  }
  for (const std::string& process : processes) {
    listener.RunUntil(
        [&] {
          return listener.Counter(process, "dropped") > 0 &&
                 !listener.statuses[process].last_problem.empty();
        },
        process + " to name garbage in its status");
    std::printf("%s: dropped %lld, last: %s\n", process.c_str(),
                static_cast<long long>(listener.Counter(process, "dropped")),
                listener.statuses[process].last_problem.c_str());
  }
  return 0;
}

int Flood(const Arguments& arguments) {
  static volatile std::sig_atomic_t stopped = 0;
  std::signal(SIGTERM, [](int) { stopped = 1; });
  const std::chrono::duration<double> period(1 / std::stod(arguments.at(0)));
  const auto garbage = MakeGarbage();
  LcmBus bus("");
  std::int64_t sent = 0;
  const Clock::time_point start = Clock::now();
  while (stopped == 0) {
    const auto& [channel, bytes] = garbage[static_cast<std::size_t>(sent) % garbage.size()];
    bus.Publish(channel, bytes);
    ++sent;
    std::this_thread::sleep_until(
        start + std::chrono::duration_cast<Clock::duration>(static_cast<double>(sent) * period));
  }
  const std::chrono::duration<double> took = Clock::now() - start;
  std::printf("%.0f\n", static_cast<double>(sent) / took.count());
  return 0;
}

/// What would end a session, were it taken: one of each kind that a key keeps out, and RESET.
Messages Forged() {
  Messages forged;
  for (Message& message : testing::RandomMessages(2).OneOfEach()) {
    if (IsSignedChannel(ChannelOf(message))) forged.push_back(std::move(message));
  }
  SessionCommand reset;
  reset.command = reset.seq = 1;
  reset.verb = SessionVerb::kReset;
  forged.emplace_back(reset);
  SessionRequest finish;
  finish.request = SessionRequestKind::kFinish;
  forged.emplace_back(finish);
  return forged;
}

int Forge(const Arguments& processes) {
  Listener listener;
  for (const Message& message : Forged()) {
    listener.bus.Publish(ChannelOf(message), Encode(message));
    const Clock::time_point next = Clock::now() + std::chrono::milliseconds(10);
    while (Clock::now() < next) listener.bus.Run(5);
  }
  for (const std::string& process : processes) {
    listener.RunUntil(
        [&] {
          return listener.Counter(process, "unsigned") > 0 &&
                 listener.statuses[process].last_problem.find("ignored: ") == 0;
        },
        process + " to name in its status what is not signed");
    std::printf("%s: unsigned %lld, last: %s\n", process.c_str(),
                static_cast<long long>(listener.Counter(process, "unsigned")),
                listener.statuses[process].last_problem.c_str());
  }
  return 0;
}

// A log without what Forge put into it.
int KeepSigned(const Arguments& arguments) {
  LogReader log(arguments.at(0));
  LogWriter out(arguments.at(1));
  std::int64_t dropped = 0;
  while (const auto event = log.Next()) {
    if (IsSignedChannel(event->channel) && !SignatureOf(event->bytes.data(), event->bytes.size())) {
      ++dropped;
      continue;
    }
    out.Write(event->channel, event->bytes, event->receive_utime);
  }
  out.Close();
  std::printf("%lld\n", static_cast<long long>(dropped));
  return 0;
}

void Print(const CameraCalibration& calibration) {
  const Rigid3& pose = calibration.camera_from_lidar;
  std::printf("%s %s", calibration.camera.c_str(), calibration.StatusText().c_str());
  for (const double value :
       {pose.rotation.w(), pose.rotation.x(), pose.rotation.y(), pose.rotation.z(),
        pose.translation.x(), pose.translation.y(), pose.translation.z()}) {
    std::printf(" %.17g", value);
  }
  std::printf("\n");
}

// The solver repeats its calibration at 1 Hz: what comes after the last view is the result.
int PrintLive(const Arguments& arguments) {
  const std::int64_t views = std::stoll(arguments.at(0));
  Listener listener;
  std::map<std::string, CameraCalibration> found;
  listener.bus.Subscribe(
      "CALIBRATION", [&](const std::string& channel, const std::uint8_t* data, std::size_t size) {
        if (listener.Counter("solver", "views") < views) return;
        try {
          const auto message = std::get<CalibrationMessage>(Decode(channel, data, size));
          found[message.calibration.camera] = message.calibration;
        } catch (const InputError&) {  // the log's garbage
        }
      });
  listener.RunUntil([&] { return found.size() == 2; }, "two calibrated cameras");
  for (const auto& [camera, calibration] : found) Print(calibration);
  int code = 0;
  for (const auto& [process, status] : listener.statuses) {
    const std::int64_t gaps = listener.Counter(process, "gaps");
    if (gaps <= 0) continue;
    std::fprintf(stderr, "%s counted %lld gaps\n", process.c_str(), static_cast<long long>(gaps));
    code = 3;
  }
  return code;
}

int PrintFile(const Arguments& arguments) {
  std::map<std::string, CameraCalibration> found;
  for (const CameraCalibration& c : ReadCalibration(arguments.at(0)).cameras) found[c.camera] = c;
  for (const auto& [camera, calibration] : found) Print(calibration);
  return 0;
}

// As NodeRunner counts them: by channel, where several speak by channel and sender.
int PrintGaps(const Arguments& arguments) {
  LogReader log(arguments.at(0));
  std::map<std::string, SequenceCounter> counters;
  std::map<std::string, std::int64_t> messages, gaps;
  while (const auto event = log.Next()) {
    try {
      const Message message = Decode(event->channel, event->bytes.data(), event->bytes.size());
      std::string key = event->channel;
      if (const auto* status = std::get_if<Status>(&message)) key += " " + status->process;
      if (const auto* done = std::get_if<SessionEvent>(&message)) key += " " + done->source;
      ++messages[key];
      gaps[key] += counters[key].Add(SeqOf(message)).gaps;
    } catch (const InputError&) {  // garbage
    }
  }
  int code = 0;
  for (const auto& [key, missing] : gaps) {
    if (missing == 0) continue;
    std::printf("%s: %lld of %lld missing\n", key.c_str(), static_cast<long long>(missing),
                static_cast<long long>(missing + messages[key]));
    code = 3;
  }
  return code;
}

int Hears(const Arguments& arguments) {
  const std::size_t wanted = std::stoul(arguments.at(1));
  Listener listener;
  std::vector<std::int64_t> numbers;
  std::string wrong;
  listener.bus.Subscribe(
      arguments.at(0), [&](const std::string& channel, const std::uint8_t* data, std::size_t size) {
        try {
          numbers.push_back(SeqOf(Decode(channel, data, size)));
        } catch (const InputError& e) {
          wrong = e.what();
        }
      });
  listener.RunUntil([&] { return numbers.size() >= wanted || !wrong.empty(); },
                    arguments.at(0) + " (" + std::to_string(numbers.size()) + " came)");
  if (!wrong.empty()) throw InputError(wrong);
  std::printf("%zu messages, number %lld to %lld\n", numbers.size(),
              static_cast<long long>(numbers.front()), static_cast<long long>(numbers.back()));
  return 0;
}

// Needs no bus: the attacker may be another machine.
int AttackBus(const Arguments& arguments) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(std::stoi(arguments.at(1))));
  if (inet_pton(AF_INET, arguments.at(0).c_str(), &to.sin_addr) != 1) return Usage();
  const int udp = socket(AF_INET, SOCK_DGRAM, 0);
  int sent = 0;
  for (std::size_t i = 2; i < arguments.size(); ++i) {
    for (const test::Attack& attack : test::Attacks(arguments[i])) {
      for (const Bytes& datagram : attack.datagrams) {
        if (sendto(udp, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to),
                   sizeof to) < 0) {
          throw InputError("cannot send to " + arguments[0]);
        }
      }
      ++sent;
    }
  }
  std::printf("%d\n", sent);
  return 0;
}

int PrintMalformed(const Arguments& arguments) {
  const std::int64_t least = std::stoll(arguments.at(0));
  const Arguments processes(arguments.begin() + 1, arguments.end());
  Listener listener;
  // The first one that comes may have been made before what was sent arrived.
  for (int i = 0; i < 2; ++i) {
    listener.statuses.clear();
    for (const std::string& process : processes) {
      listener.RunUntil([&] { return listener.Counter(process, "malformed") >= least; },
                        "a status of " + process + " that tells of " + arguments[0] +
                            " malformed datagrams or more");
    }
  }
  for (const std::string& process : processes) {
    std::printf("%s %lld\n", process.c_str(),
                static_cast<long long>(listener.Counter(process, "malformed")));
  }
  return 0;
}

int HearsMalformed(const Arguments& arguments) {
  Listener listener;
  listener.bus.Subscribe(arguments.at(0),
                         [](const std::string&, const std::uint8_t*, std::size_t) {});
  listener.RunUntil([&] { return listener.bus.malformed().count > 0; }, "a malformed datagram");
  std::printf("%s\n", listener.bus.malformed().newest.c_str());
  return 0;
}

// Four times a second on RIG, numbered from the argument.
int Speaks(const Arguments& arguments) {
  LcmBus bus("");
  RigText rig;
  rig.hash = "hash";
  rig.text = "text";
  const Clock::time_point end = Clock::now() + kPatience;
  for (rig.seq = std::stoll(arguments.at(0)); Clock::now() < end; ++rig.seq) {
    bus.Publish("RIG", Encode(rig));
    bus.Run(250);
  }
  return 0;
}

int Run(const std::string& verb, const Arguments& arguments) {
  if (verb == "ready") return Ready(arguments);
  if (verb == "ask") return Ask(arguments);
  if (verb == "garbage") return Garbage(arguments);
  if (verb == "flood") return Flood(arguments);
  if (verb == "forge") return Forge(arguments);
  if (verb == "keep_signed") return KeepSigned(arguments);
  if (verb == "calibration") return PrintLive(arguments);
  if (verb == "gaps") return PrintGaps(arguments);
  if (verb == "print") return PrintFile(arguments);
  if (verb == "attack") return AttackBus(arguments);
  if (verb == "malformed") return PrintMalformed(arguments);
  if (verb == "hears_malformed") return HearsMalformed(arguments);
  if (verb == "hears") return Hears(arguments);
  if (verb == "speaks") return Speaks(arguments);
  return Usage();
}

}  // namespace
}  // namespace rgbdt

int main(int argc, char** argv) {
  if (argc < 3) return rgbdt::Usage();
  try {
    return rgbdt::Run(argv[1], rgbdt::Arguments(argv + 2, argv + argc));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "live_helper: %s\n", e.what());
    return 1;
  }
}
