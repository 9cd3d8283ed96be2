#include "calib/scan_assembly/line_to_cloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace rgbdt {
namespace {

// Beams are taken in blocks: a sine and a cosine of each block's first beam and middle motor angle
// give those of the others, and the arithmetic on them has no branches.
constexpr std::size_t kBlock = 16;
template <typename T>
using Block = std::array<T, kBlock>;

struct Turns {
  Block<double> cos, sin;
};

// Directions in the scan plane, evenly spaced.
class ScanPlane {
 public:
  explicit ScanPlane(const LineScan& line)
      : first_rad_(line.first_angle_rad), step_rad_(line.angle_step_rad) {
    for (std::size_t i = 0; i < kBlock; ++i) {
      const double a = static_cast<double>(i) * step_rad_;
      steps_.cos[i] = std::cos(a);
      steps_.sin[i] = std::sin(a);
    }
  }

  // Of the block that begins with beam `first`.
  Turns At(std::size_t first) const {
    const double a = first_rad_ + static_cast<double>(first) * step_rad_;
    const double c = std::cos(a);
    const double s = std::sin(a);
    Turns turns;
    for (std::size_t i = 0; i < kBlock; ++i) {
      turns.cos[i] = c * steps_.cos[i] - s * steps_.sin[i];
      turns.sin[i] = s * steps_.cos[i] + c * steps_.sin[i];
    }
    return turns;
  }

 private:
  double first_rad_, step_rad_;
  Turns steps_;
};

// Of angles that lie close together, as a motor's do during a block; of any others, too.
Turns TurnsOf(const Block<double>& angles) {
  constexpr double kClose = 0.02;  // [rad]; beyond, the series below are wrong by more than 1e-13
  const double middle = angles[kBlock / 2];
  double farthest = 0;
  for (const double angle : angles) farthest = std::max(farthest, std::abs(angle - middle));
  Turns turns;
  if (!(farthest <= kClose)) {
    for (std::size_t i = 0; i < kBlock; ++i) {
      turns.cos[i] = std::cos(angles[i]);
      turns.sin[i] = std::sin(angles[i]);
    }
    return turns;
  }
  const double c = std::cos(middle);
  const double s = std::sin(middle);
  for (std::size_t i = 0; i < kBlock; ++i) {
    const double d = angles[i] - middle;
    const double dd = d * d;
    const double small_sin = d * (1 - dd * (1.0 / 6 - dd * (1.0 / 120)));
    const double small_cos = 1 - dd * (0.5 - dd * (1.0 / 24));
    turns.cos[i] = c * small_cos - s * small_sin;
    turns.sin[i] = s * small_cos + c * small_sin;
  }
  return turns;
}

struct BlockOfBeams {
  Block<float> x, y, z;     // point
  Block<float> dx, dy, dz;  // direction
};

// Where the scan plane lies in the motor's frame.
struct Mount {
  explicit Mount(const Rigid3& motor_from_scanner)
      : ahead(motor_from_scanner.rotation * Eigen::Vector3d::UnitX()),
        up(motor_from_scanner.rotation * Eigen::Vector3d::UnitZ()),
        lever(motor_from_scanner.translation) {}

  Eigen::Vector3d ahead, up, lever;
};

// Point and direction of each beam of a block; a point is NaN where the range is no number.
BlockOfBeams BeamsOf(const Mount& mount, const Turns& beam, const Turns& motor,
                     const Block<float>& range) {
  const auto& [ahead, up, lever] = mount;
  BlockOfBeams out;
  for (std::size_t i = 0; i < kBlock; ++i) {
    const double x = ahead.x() * beam.cos[i] + up.x() * beam.sin[i];
    const double y = ahead.y() * beam.cos[i] + up.y() * beam.sin[i];
    const double z = ahead.z() * beam.cos[i] + up.z() * beam.sin[i];
    const double dx = motor.cos[i] * x - motor.sin[i] * y;
    const double dy = motor.sin[i] * x + motor.cos[i] * y;
    const double r = static_cast<double>(range[i]);
    out.dx[i] = static_cast<float>(dx);
    out.dy[i] = static_cast<float>(dy);
    out.dz[i] = static_cast<float>(z);
    out.x[i] = static_cast<float>(motor.cos[i] * lever.x() - motor.sin[i] * lever.y() + r * dx);
    out.y[i] = static_cast<float>(motor.sin[i] * lever.x() + motor.cos[i] * lever.y() + r * dy);
    out.z[i] = static_cast<float>(lever.z() + r * z);
  }
  return out;
}

// What a block's beams tell, a last block filled up with its last beam.
template <typename T>
Block<T> BlockAt(const std::vector<T>& values, std::size_t first) {
  Block<T> block;
  const std::size_t count = std::min(kBlock, values.size() - first);
  std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(first), count, block.begin());
  std::fill(block.begin() + count, block.end(), values.back());
  return block;
}

Block<float> RangesAt(const LineScan& line, std::size_t first) {
  Block<float> ranges = BlockAt(line.range, first);
  for (float& range : ranges) {
    const bool hit = std::abs(range) <= std::numeric_limits<float>::max();
    range = hit ? range : std::numeric_limits<float>::quiet_NaN();
  }
  return ranges;
}

}  // namespace

Cloud LineToCloud(const TurnedScanner& scanner, const LineScan& line,
                  const std::vector<double>& angles) {
  const std::size_t beams = line.range.size();
  Cloud cloud;
  cloud.lines = 1;
  cloud.beams = static_cast<int>(beams);
  cloud.points.resize(beams);
  cloud.directions.resize(beams);
  cloud.intensity = line.intensity;
  cloud.utime.resize(beams);
  cloud.ring.resize(beams);
  if (beams > 0) {
    const Eigen::AngleAxisd turn(angles[beams / 2], Eigen::Vector3d::UnitZ());
    cloud.origins = {(turn * scanner.motor_from_scanner.translation).cast<float>()};
  }
  const Mount mount(scanner.motor_from_scanner);
  const ScanPlane plane(line);
  for (std::size_t first = 0; first < beams; first += kBlock) {
    const BlockOfBeams block =
        BeamsOf(mount, plane.At(first), TurnsOf(BlockAt(angles, first)), RangesAt(line, first));
    const std::size_t count = std::min(kBlock, beams - first);
    for (std::size_t i = 0; i < count; ++i) {
      cloud.points[first + i] = {block.x[i], block.y[i], block.z[i]};
      cloud.directions[first + i] = {block.dx[i], block.dy[i], block.dz[i]};
    }
  }
  for (std::size_t i = 0; i < beams; ++i) cloud.utime[i] = line.FiredAt(i);
  std::iota(cloud.ring.begin(), cloud.ring.end(), std::uint16_t{0});
  return cloud;
}

}  // namespace rgbdt
