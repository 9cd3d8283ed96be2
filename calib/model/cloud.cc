#include "calib/model/cloud.h"

#include <algorithm>

namespace rgbdt {

int LostLines(const Cloud& cloud) {
  if (!cloud.organised || cloud.directions.size() != cloud.size()) return 0;
  int lost = 0;
  for (int line = 0; line < cloud.lines; ++line) {
    const auto begin = cloud.directions.begin() + static_cast<std::ptrdiff_t>(line) * cloud.beams;
    lost += std::none_of(begin, begin + cloud.beams,
                         [](const Eigen::Vector3f& d) { return d.allFinite(); })
                ? 1
                : 0;
  }
  return lost;
}

}  // namespace rgbdt
