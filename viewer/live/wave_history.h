#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "calib/model/wave_progress.h"

namespace rgbdt::viewer {

/// How far `rgbdt sync live` is, and how the sigma of each camera's time offset fell so far: words
/// and a chart. Times [s] are of a steady clock.
class WaveHistory {
 public:
  static constexpr std::size_t kKept = 600;  ///< steps, the newest
  static constexpr double kGone = 5;         ///< [s] without a word while it is not over

  /// One that is at an earlier phase than before is of another wave, which begins anew.
  void Add(const WaveProgress& progress, double now_s);
  /// Whether it has just gone without a word.
  bool Update(double now_s);

  /// A WaveFrame (page/src/protocol.ts).
  nlohmann::json Frame() const;

 private:
  struct Step {
    int seconds;                           // since the wave began
    std::map<std::string, double> sigmas;  // by camera [s]
  };
  WaveProgress newest_;
  double began_s_ = 0, heard_s_ = 0;
  bool begun_ = false, gone_ = false;
  std::deque<Step> steps_;
};

}  // namespace rgbdt::viewer
