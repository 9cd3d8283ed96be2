// What the hardware tests' scripts need of the bus. See Usage().

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "calib/files/image_files.h"
#include "calib/model/errors.h"
#include "services/bus/bus.h"
#include "services/messages/codec.h"
#include "services/messages/status_counters.h"
#include "services/posix/clock.h"

namespace rgbdt {
namespace {

using Arguments = std::vector<std::string>;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kPatience(40);

int Usage() {
  std::fputs(
      "usage: hardware_helper VERB ...\n"
      "  frames FILE COUNT WIDTH HEIGHT BYTES  writes COUNT frames of noise, BYTES a pixel\n"
      "  images CHANNEL FILE COUNT [SECONDS]  hears COUNT images, each one of FILE's frames, byte "
      "for "
      "byte;\n"
      "                               prints how many messages are missing and how even they come\n"
      "  counter PROCESS NAME LEAST   until a process counts so many; prints the number\n"
      "  ready PROCESS                until it says so; prints its status' text\n"
      "  problem PROCESS TEXT         until its last problem holds the text\n"
      "  capture VIEW                 asks for a capture\n"
      "  raw PNG FILE                 whether the picture is one of FILE's frames byte for byte\n"
      "Gives up after 40 s with exit code 1.\n",
      stderr);
  return 2;
}

// Noise under a smooth ramp: no two frames alike, none flat.
int WriteFrames(const Arguments& a) {
  const int count = std::stoi(a.at(1));
  const auto pixels = static_cast<std::size_t>(std::stoi(a.at(2)) * std::stoi(a.at(3)));
  const int bytes = std::stoi(a.at(4));
  std::ofstream file(a.at(0), std::ios::binary);
  std::mt19937 random(7);
  for (int frame = 0; frame < count; ++frame) {
    std::vector<char> data;
    data.reserve(pixels * static_cast<std::size_t>(bytes));
    for (std::size_t i = 0; i < pixels; ++i) {
      const auto value = static_cast<unsigned>(random() % 32 + 128 * i / pixels);
      data.push_back(static_cast<char>(value));
      if (bytes == 2) data.push_back(static_cast<char>(20 + 10 * i / pixels));
    }
    file.write(data.data(), static_cast<std::streamsize>(data.size()));
  }
  return file ? 0 : 1;
}

class Listener {
 public:
  Listener() {
    bus.Subscribe("STATUS",
                  [&](const std::string& channel, const std::uint8_t* data, std::size_t size) {
                    const Status status = std::get<Status>(Decode(channel, data, size));
                    statuses[status.process] = status;
                  });
  }

  template <typename Done>
  bool RunUntil(Done done, std::chrono::seconds patience = kPatience) {
    const Clock::time_point end = Clock::now() + patience;
    while (!done()) {
      if (Clock::now() > end) return false;
      bus.Run(20);
    }
    return true;
  }

  std::int64_t Counter(const std::string& process, const std::string& name) const {
    const auto found = statuses.find(process);
    return found == statuses.end() ? -1 : CounterOf(found->second, name, -1);
  }

  LcmBus bus{""};
  std::map<std::string, Status> statuses;
};

// Whether pixels are one of the frames that lie in a file, byte for byte.
class FramesOfFile {
 public:
  explicit FramesOfFile(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(file), {});
  }
  bool Holds(const cv::Mat& pixels) const {
    const std::size_t size = pixels.total() * pixels.elemSize();
    for (std::size_t at = 0; at + size <= bytes_.size(); at += size) {
      if (std::memcmp(&bytes_[at], pixels.data, size) == 0) return true;
    }
    return false;
  }

 private:
  std::vector<char> bytes_;
};

int HearImages(const Arguments& a) {
  const FramesOfFile frames(a.at(1));
  const std::size_t wanted = std::stoul(a.at(2));
  Listener listener;
  std::vector<Image> images;
  listener.bus.Subscribe(
      a.at(0), [&](const std::string& channel, const std::uint8_t* data, std::size_t size) {
        images.push_back(std::get<Image>(Decode(channel, data, size)));
        if (!frames.Holds(images.back().pixels)) {
          throw InputError("an image is none of the frames served");
        }
        images.back().pixels.release();
      });
  const auto done = [&] { return images.size() >= wanted || listener.bus.handler_failures() > 0; };
  const auto patience = a.size() > 3 ? std::chrono::seconds(std::stoi(a[3])) : kPatience;
  if (!listener.RunUntil(done, patience)) {
    std::fprintf(stderr, "%zu images of %zu in time\n", images.size(), wanted);
    return 1;
  }
  if (listener.bus.handler_failures() > 0) {
    std::fputs("an image is none of the frames served\n", stderr);
    return 1;
  }
  std::int64_t missing = 0;
  std::vector<double> steps_ms;
  for (std::size_t i = 1; i < images.size(); ++i) {
    missing += images[i].seq - images[i - 1].seq - 1;
    steps_ms.push_back(1e-3 * static_cast<double>(images[i].utime - images[i - 1].utime));
    if (steps_ms.back() <= 0) {
      std::fputs("images go back in time\n", stderr);
      return 1;
    }
  }
  std::sort(steps_ms.begin(), steps_ms.end());
  std::printf("missing %lld, period %.1f ms, exposure %.1f ms, shutter %d\n",
              static_cast<long long>(missing), steps_ms.empty() ? 0 : steps_ms[steps_ms.size() / 2],
              1e3 * images.back().exposure_s, images.back().shutter_correcting ? 1 : 0);
  return 0;
}

int WaitForCounter(const Arguments& a) {
  Listener listener;
  const std::int64_t least = std::stoll(a.at(2));
  if (!listener.RunUntil([&] { return listener.Counter(a.at(0), a.at(1)) >= least; })) {
    std::fprintf(stderr, "%s counts %lld %s\n", a.at(0).c_str(),
                 static_cast<long long>(listener.Counter(a.at(0), a.at(1))), a.at(1).c_str());
    return 1;
  }
  for (const auto& [name, value] : listener.statuses[a.at(0)].counters) {
    std::printf("%s: %lld\n", name.c_str(), static_cast<long long>(value));
  }
  return 0;
}

int WaitUntilReady(const Arguments& a) {
  Listener listener;
  if (!listener.RunUntil([&] { return listener.statuses[a.at(0)].ready; })) {
    std::fprintf(stderr, "%s: %s\n", a.at(0).c_str(), listener.statuses[a.at(0)].text.c_str());
    return 1;
  }
  std::puts(listener.statuses[a.at(0)].text.c_str());
  return 0;
}

int WaitForProblem(const Arguments& a) {
  Listener listener;
  const std::string& problem = listener.statuses[a.at(0)].last_problem;
  if (!listener.RunUntil([&] { return problem.find(a.at(1)) != std::string::npos; })) {
    std::fprintf(stderr, "%s: last problem: %s\n", a.at(0).c_str(), problem.c_str());
    return 1;
  }
  std::puts(problem.c_str());
  return 0;
}

int SendCapture(const Arguments& a) {
  SessionCommand command;
  command.verb = SessionVerb::kCapture;
  command.command = 1;
  command.utime = HostUtime();  // each asks anew: a repeated command is carried out once
  command.view = a.at(0);
  LcmBus bus("");
  bus.Publish("SESSION_COMMAND", Encode(command));
  return 0;
}

int Run(const std::string& verb, const Arguments& arguments) {
  if (verb == "frames") return WriteFrames(arguments);
  if (verb == "images") return HearImages(arguments);
  if (verb == "counter") return WaitForCounter(arguments);
  if (verb == "ready") return WaitUntilReady(arguments);
  if (verb == "problem") return WaitForProblem(arguments);
  if (verb == "capture") return SendCapture(arguments);
  if (verb == "raw")
    return FramesOfFile(arguments.at(1)).Holds(DecodeImageFile(arguments.at(0))) ? 0 : 1;
  return Usage();
}

}  // namespace
}  // namespace rgbdt

int main(int argc, char** argv) {
  if (argc < 2) return rgbdt::Usage();
  try {
    return rgbdt::Run(argv[1], {argv + 2, argv + argc});
  } catch (const std::exception& e) {
    std::fprintf(stderr, "hardware_helper: %s\n", e.what());
    return 1;
  }
}
