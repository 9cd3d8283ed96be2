#pragma once

#include <cstdint>
#include <string>

namespace rgbdt::viewer {

/// Which share of the clouds' points a browser gets: halved where it does not keep up, grown again
/// where it does, and never more than it wants to draw.
class Thinning {
 public:
  /// Most points that the browser draws of a whole sweep.
  void WantPoints(std::int64_t points) { wanted_ = points; }

  /// Clouds had to be dropped. Halves once until the smaller share has had time to tell.
  void Dropped();

  /// A cloud of `records` is about to be sent, `waiting` others wait: how many of it to send, at
  /// least one where there is one. The topics "sweep/0", "sweep/1", ... are the parts of a sweep.
  std::size_t Cut(const std::string& topic, std::size_t records, std::size_t waiting);

  /// How many of a part's records the browser draws, were it never behind; at least one where there
  /// is one.
  std::size_t Wanted(std::size_t records) const;

  double share() const;  ///< 0 to 1

 private:
  void CountSweep(const std::string& topic, std::size_t records);
  void Grow(std::size_t waiting);
  double WantedShare() const;

  double share_ = 1;
  int sent_ = 0;             // since the share changed
  bool halved_ = false;      // by its last change
  std::int64_t wanted_ = 0;  // 0: not said
  int part_ = -1;            // of a sweep, counted last
  double sweep_ = 0;         // records of the sweep that is being sent
  double last_sweep_ = 0;
};

}  // namespace rgbdt::viewer
