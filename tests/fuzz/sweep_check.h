#pragma once

#include <cstddef>

#include "calib/model/cloud.h"
#include "tests/fuzz/fuzz.h"

namespace rgbdt::fuzz {

/// What whoever takes a LIDAR's sweep relies on.
inline void RequireWhole(const Cloud& sweep) {
  Require(sweep.lines > 0 && sweep.beams > 0, "a sweep of some lines and beams");
  const std::size_t size =
      static_cast<std::size_t>(sweep.lines) * static_cast<std::size_t>(sweep.beams);
  Require(sweep.points.size() == size, "lines x beams points");
  for (const std::size_t other :
       {sweep.directions.size(), sweep.intensity.size(), sweep.utime.size(), sweep.ring.size()}) {
    Require(other == 0 || other == size, "as many of all as points, or none");
  }
  Require(sweep.origins.empty() || sweep.origins.size() == static_cast<std::size_t>(sweep.lines),
          "an origin a line, or none");
}

}  // namespace rgbdt::fuzz
