#pragma once

#include <benchmark/benchmark.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace rgbdt::bench {

/// Sizes of a row: 10,000, 100,000, ... up to `most`.
std::vector<std::int64_t> Decades(std::int64_t most);

/// One of a row's two sides, ours or the rival's.
struct Side {
  std::string row;        ///< "fuse_in_view"
  std::string who;        ///< "rgbdt", or the rival: "cv::projectPoints + loop"
  std::int64_t size = 0;  ///< of the input, in `unit`s
  std::string unit;       ///< what throughput counts: "points"
  int cameras = 0;        ///< 0: the row has none
};

/// Makes the input and returns the work on it: called again before each repetition, so that only
/// one row's input is in memory.
using MakeWork = std::function<std::function<void()>()>;

/// Registers a side as "row|who|size|unit|cameras". Each run counts `size` units and tells the most
/// memory that the process held, input included [MB].
void Register(const Side& side, const MakeWork& make_work);

/// main() of a benchmark program: `register_rows` gets the largest size, from --most=N (10^7 unless
/// told). OpenCV keeps to one core. Everything else is Google Benchmark's.
int Main(int argc, char** argv, const std::function<void(std::int64_t)>& register_rows);

}  // namespace rgbdt::bench
