// The main of a target that was not built with libFuzzer: runs each input of the folders and files
// named, and then, until --seconds are over, variants of them. The first variant of each, then the
// second of each, ...: in every run the same in the same order, as far as it comes.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz.h"

namespace {

namespace fs = std::filesystem;

constexpr unsigned kMostS = 60;                // that a run may take
constexpr std::size_t kMostVaried = 16 << 20;  // bytes of an input's variants in all

std::string running_name, running_bytes;  // for OnCrash

// Where a debugger is not at hand: what to run again.
void OnCrash(int signal_number) {
  constexpr char kFile[] = "crash-input";
  const int file = open(kFile, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  const auto print = [](int to, const char* bytes, std::size_t size) {
    return write(to, bytes, size) < 0 ? 1 : 0;
  };
  print(file, running_bytes.data(), running_bytes.size());
  for (const char* text : {"ended by ", running_name.c_str(), "; the input is in ", kFile, "\n"}) {
    print(STDERR_FILENO, text, std::strlen(text));
  }
  std::signal(signal_number, SIG_DFL);
  std::raise(signal_number);
}

void Run(const std::string& name, std::string bytes) {
  running_name = name;
  running_bytes = std::move(bytes);
  alarm(kMostS);
  LLVMFuzzerTestOneInput(rgbdt::fuzz::Data(running_bytes), running_bytes.size());
}

std::string Varied(const std::string& bytes, std::mt19937* random) {
  const auto below = [&](std::size_t most) {
    return std::uniform_int_distribution<std::size_t>(0, most)(*random);
  };
  static constexpr char kTelling[] = {'\0', '\xff', '\x7f', '\x80', '\x01', '9', '-', '"'};
  std::string varied = bytes;
  for (std::size_t changes = 1 + below(3); changes > 0 && !varied.empty(); --changes) {
    const std::size_t at = below(varied.size() - 1);
    switch (below(4)) {
      case 0:
        varied.resize(at);
        break;
      case 1:
        varied[at] = static_cast<char>(below(255));
        break;
      case 2:
        varied[at] = kTelling[below(std::size(kTelling) - 1)];
        break;
      case 3:
        varied.erase(at, 1 + below(8));
        break;
      default:
        varied.insert(at, varied.substr(below(varied.size() - 1), 1 + below(32)));
    }
  }
  return varied;
}

std::vector<fs::path> InputsOf(int count, char** names) {
  std::vector<fs::path> inputs;
  for (int i = 0; i < count; ++i) {
    if (!fs::is_directory(names[i])) {
      if (fs::exists(names[i])) inputs.emplace_back(names[i]);
      continue;
    }
    for (const auto& entry : fs::directory_iterator(names[i])) inputs.push_back(entry.path());
  }
  std::sort(inputs.begin(), inputs.end());
  return inputs;
}

std::string BytesOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// Runs inputs and keeps count.
class Replay {
 public:
  using Clock = std::chrono::steady_clock;

  void Add(const std::string& name, std::string bytes) {
    const auto begin = Clock::now();
    Run(name, std::move(bytes));
    const double took_s = std::chrono::duration<double>(Clock::now() - begin).count();
    ++runs_;
    if (took_s > slowest_s_) {
      slowest_s_ = took_s;
      slowest_ = running_name;
    }
  }

  // One of each input; false: there is none any more, or the time is over.
  bool AddVariants(const std::vector<fs::path>& inputs, std::uint32_t number,
                   Clock::time_point end) {
    bool any = false;
    for (const fs::path& path : inputs) {
      if (Clock::now() >= end) return false;
      if (fs::file_size(path) * number > kMostVaried) continue;
      const std::string bytes = BytesOf(path);
      if (bytes.empty()) continue;
      std::mt19937 random(number);
      Add(path.string() + ", variant " + std::to_string(number), Varied(bytes, &random));
      any = true;
    }
    return any;
  }

  void Print(std::size_t inputs) const {
    std::printf("%zu inputs, %zu runs; the slowest took %.3f s: %s\n", inputs, runs_, slowest_s_,
                slowest_.c_str());
  }

 private:
  std::size_t runs_ = 0;
  double slowest_s_ = 0;
  std::string slowest_;
};

}  // namespace

int main(int argc, char** argv) {
  const Replay::Clock::time_point begin = Replay::Clock::now();
  for (const int number : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGALRM}) {
    std::signal(number, OnCrash);
  }
  const bool timed = argc >= 3 && std::strcmp(argv[1], "--seconds") == 0;
  const std::chrono::seconds budget(timed ? std::atoi(argv[2]) : 0);
  const int named = timed ? 3 : 1;
  const std::vector<fs::path> inputs = InputsOf(argc - named, argv + named);
  if (inputs.empty()) {
    std::fprintf(stderr, "usage: %s [--seconds N] FOLDER|FILE...; no input there\n", argv[0]);
    return 1;
  }
  Replay replay;
  for (const fs::path& path : inputs) replay.Add(path.string(), BytesOf(path));
  for (std::uint32_t number = 1; replay.AddVariants(inputs, number, begin + budget);) ++number;
  replay.Print(inputs.size());
  return 0;
}
