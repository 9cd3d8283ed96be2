#include "tests/bench/measure.h"

#include <malloc.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <iostream>
#include <opencv2/core/utility.hpp>
#include <string>

namespace rgbdt::bench {
namespace {

// "5" makes the kernel forget the peak so far (proc(5)); where it does not, peaks only grow.
void ForgetPeakMemory() {
  malloc_trim(0);  // what earlier rows have freed
  std::ofstream("/proc/self/clear_refs") << "5";
}

double PeakMegabytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmHWM:", 0) == 0) return std::stod(line.substr(6)) / 1024;
  }
  return 0;
}

// For both sides of a row, as the processes do (services/bus/process.cc): pages that are new for
// each call would cost more than much of what is timed.
void KeepMemory() {
  constexpr int kKeptBytes = 64 * 1024 * 1024;
  mallopt(M_MMAP_THRESHOLD, kKeptBytes / 2);
  mallopt(M_TRIM_THRESHOLD, kKeptBytes);
}

}  // namespace

std::vector<std::int64_t> Decades(std::int64_t most) {
  std::vector<std::int64_t> sizes;
  for (std::int64_t size = 10'000; size <= most; size *= 10) sizes.push_back(size);
  return sizes;
}

void Register(const Side& side, const MakeWork& make_work) {
  const std::string name = side.row + '|' + side.who + '|' + std::to_string(side.size) + '|' +
                           side.unit + '|' + std::to_string(side.cameras);
  benchmark::RegisterBenchmark(name.c_str(), [side, make_work](benchmark::State& state) {
    try {
      ForgetPeakMemory();
      const std::function<void()> work = make_work();
      for (auto _ : state) work();
      state.SetItemsProcessed(state.iterations() * side.size);
      state.counters["peak_mb"] = PeakMegabytes();
    } catch (const std::exception& error) {
      state.SkipWithError(error.what());
    }
  });
}

int Main(int argc, char** argv, const std::function<void(std::int64_t)>& register_rows) {
  constexpr const char* kMost = "--most=";
  std::int64_t most = 10'000'000;
  char** end = std::remove_if(argv + 1, argv + argc, [&](const char* argument) {
    if (std::strncmp(argument, kMost, std::strlen(kMost)) != 0) return false;
    most = std::atoll(argument + std::strlen(kMost));
    return true;
  });
  argc = static_cast<int>(end - argv);
  try {
    cv::setNumThreads(1);
    KeepMemory();
    KeepMemory();
    register_rows(most);
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": " << error.what() << "\n";
    return 1;
  }
  return 0;
}

}  // namespace rgbdt::bench
