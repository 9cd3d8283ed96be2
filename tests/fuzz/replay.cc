// The main of a target that was not built with libFuzzer: runs each input of the folders and files
// named, and variants of it that are the same in every run.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
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

constexpr unsigned kMost_s = 60;               // that a run may take
constexpr int kVariants = 60;                  // of each input
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
  alarm(kMost_s);
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

}  // namespace

int main(int argc, char** argv) {
  using Clock = std::chrono::steady_clock;
  for (const int number : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGALRM}) {
    std::signal(number, OnCrash);
  }
  const std::vector<fs::path> inputs = InputsOf(argc - 1, argv + 1);
  double slowest_s = 0;
  std::string slowest;
  std::size_t runs = 0;
  for (const fs::path& path : inputs) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)),
                            std::istreambuf_iterator<char>());
    std::mt19937 random(1);
    const std::size_t most = bytes.empty() ? 0 : kMostVaried / bytes.size();
    const int variants = static_cast<int>(std::min<std::size_t>(kVariants, most));
    for (int i = 0; i <= variants; ++i) {
      const auto begin = Clock::now();
      Run(path.string() + (i == 0 ? "" : ", variant " + std::to_string(i)),
          i == 0 ? bytes : Varied(bytes, &random));
      const double took_s = std::chrono::duration<double>(Clock::now() - begin).count();
      ++runs;
      if (took_s > slowest_s) {
        slowest_s = took_s;
        slowest = running_name;
      }
    }
  }
  std::printf("%zu inputs, %zu runs; the slowest took %.3f s: %s\n", inputs.size(), runs, slowest_s,
              slowest.c_str());
  if (!inputs.empty()) return 0;
  std::fprintf(stderr, "usage: %s FOLDER|FILE...; no input there\n", argv[0]);
  return 1;
}
