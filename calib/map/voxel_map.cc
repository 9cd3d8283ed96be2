#include "calib/map/voxel_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "calib/model/check.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

void RequireLength(std::size_t have, std::size_t need, const char* what) {
  if (have == 0 || have == need) return;
  throw InputError("map: the cloud has " + std::to_string(need) + " points but " +
                   std::to_string(have) + " values of " + what);
}

void CheckLengths(const RgbdtCloud& cloud) {
  RequireLength(cloud.rgb.size(), cloud.size(), "rgb");
  RequireLength(cloud.temperature_k.size(), cloud.size(), "temperature_k");
  RequireLength(cloud.temperature_sigma_k.size(), cloud.size(), "temperature_sigma_k");
  RequireLength(cloud.utime.size(), cloud.size(), "utime");
}

void AddColour(const std::array<std::uint8_t, 3>& rgb, Voxel* voxel) {
  if ((rgb[0] | rgb[1] | rgb[2]) == 0) return;
  const float share = 1.0F / static_cast<float>(++voxel->coloured);
  for (std::size_t c = 0; c < 3; ++c) voxel->rgb[c] += share * (rgb[c] - voxel->rgb[c]);
}

// Below a millikelvin a sigma is a mistake; as it stands it would silence every other point.
float WeightOf(float sigma) {
  constexpr float kLeastSigma = 1e-3F;
  if (!std::isfinite(sigma) || sigma <= 0) return 1;
  const float s = std::clamp(sigma, kLeastSigma, 1e6F);
  return 1 / (s * s);
}

void AddTemperature(float temperature, float sigma, Voxel* voxel) {
  if (!std::isfinite(temperature)) return;
  const float weight = WeightOf(sigma);
  voxel->weight += weight;
  voxel->temperature_k += weight / voxel->weight * (temperature - voxel->temperature_k);
}

std::uint8_t ToByte(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 1.0F, 255.0F)));
}

Eigen::Vector3d CornerOf(std::uint64_t key, double voxel_m) {
  const auto place = VoxelStore::Place(key);
  return voxel_m * Eigen::Vector3d(static_cast<double>(place[0]), static_cast<double>(place[1]),
                                   static_cast<double>(place[2]));
}

// std::floor is a call without SSE4.1, and this is done for every point.
std::int64_t Floor(double value) {
  const auto whole = static_cast<std::int64_t>(value);
  return whole - (static_cast<double>(whole) > value ? 1 : 0);
}

Utime FrameTime(const RgbdtCloud& cloud) {
  return cloud.frame_utime != 0 ? cloud.frame_utime : cloud.sweep_utime;
}

constexpr std::size_t kBlock = 128;  // points

struct Located {
  std::size_t i;      // of the point
  std::uint64_t key;  // of its voxel
  Eigen::Vector3d in_map;
};

void Append(const Voxel& voxel, double voxel_m, MapCloud* cloud) {
  const Eigen::Vector3f offset(voxel.offset[0], voxel.offset[1], voxel.offset[2]);
  const Eigen::Vector3d point = CornerOf(voxel.key, voxel_m) + offset.cast<double>();
  cloud->points.emplace_back(point.cast<float>());
  std::array<std::uint8_t, 3> rgb{};
  if (voxel.coloured > 0) {
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = ToByte(voxel.rgb[c]);
  }
  cloud->rgb.push_back(rgb);
  cloud->temperature_k.push_back(voxel.weight > 0 ? voxel.temperature_k
                                                  : std::numeric_limits<float>::quiet_NaN());
  cloud->count.push_back(voxel.count);
  cloud->last_seen.push_back(voxel.last_seen);
}

}  // namespace

void VoxelMapOptions::Check() const {
  const OptionCheck check("map");
  check.Require(voxel_m >= 0.001 && voxel_m <= 100, "voxel_m", voxel_m, "0.001 to 100 m");
  check.Require(max_voxels >= 1 && max_voxels <= 1'000'000'000, "max_voxels",
                static_cast<double>(max_voxels), "1 to 1e9");
}

VoxelMap::VoxelMap(const VoxelMapOptions& options)
    : options_((options.Check(), options)),
      per_metre_(1 / options.voxel_m),
      store_(options.max_voxels) {}

std::optional<std::string> VoxelMap::frame() const {
  if (!posed_) return std::nullopt;
  return *posed_ ? "map" : "lidar";
}

void VoxelMap::CheckFrame(const RgbdtCloud& cloud) {
  const bool posed = cloud.map_from_lidar.has_value();
  if (posed_ && *posed_ != posed) {
    throw InputError(posed ? "map: a cloud with a pose, but those before it had none: they are in "
                             "the LIDAR frame; start the map anew"
                           : "map: a cloud without a pose, but those before it had one: where was "
                             "the rig? Is the pose stream (POSE) still there?");
  }
  posed_ = posed;
}

void VoxelMap::Add(const RgbdtCloud& cloud) {
  CheckLengths(cloud);
  if (cloud.points.empty()) return;
  CheckFrame(cloud);
  for (std::size_t begin = 0; begin < cloud.size(); begin += kBlock) {
    AddBlock(cloud, begin, std::min(begin + kBlock, cloud.size()));
  }
}

// Where points go is looked up for many at once: the memory that a large map is spread over is
// fetched while others are worked on.
void VoxelMap::AddBlock(const RgbdtCloud& cloud, std::size_t begin, std::size_t end) {
  constexpr double kReach = VoxelStore::kReach - 1;
  const Rigid3 map_from_lidar = cloud.map_from_lidar.value_or(Rigid3());
  const Eigen::Matrix3d rotation = map_from_lidar.rotation.toRotationMatrix();
  std::array<Located, kBlock> located;
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const Eigen::Vector3d in_map =
        rotation * cloud.points[i].cast<double>() + map_from_lidar.translation;
    const Eigen::Vector3d scaled = in_map * per_metre_;
    if (!(scaled.allFinite() && scaled.cwiseAbs().maxCoeff() < kReach)) {
      ++skipped_;
      continue;
    }
    const std::uint64_t key =
        VoxelStore::Key(Floor(scaled.x()), Floor(scaled.y()), Floor(scaled.z()));
    located[count++] = {i, key, in_map};
    store_.FetchSlot(key);
  }
  for (std::size_t k = 0; k < count; ++k) store_.FetchVoxel(located[k].key);
  for (std::size_t k = 0; k < count; ++k) {
    AddPoint(cloud, located[k].i, located[k].key, located[k].in_map);
  }
}

void VoxelMap::AddPoint(const RgbdtCloud& cloud, std::size_t i, std::uint64_t key,
                        const Eigen::Vector3d& in_map) {
  bool evicted = false;
  Voxel& voxel = store_.FindOrMake(key, &evicted);
  evicted_ += evicted ? 1 : 0;
  ++points_;
  const Utime utime = cloud.utime.empty() ? FrameTime(cloud) : cloud.utime[i];
  if (voxel.count == 0 || utime >= voxel.last_seen) {
    voxel.last_seen = utime;
    store_.Touch();
  }
  if (voxel.count < std::numeric_limits<std::uint32_t>::max()) ++voxel.count;
  const float share = 1.0F / static_cast<float>(voxel.count);
  const Eigen::Vector3f offset = (in_map - CornerOf(key, options_.voxel_m)).cast<float>();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    voxel.offset[axis] += share * (offset[static_cast<int>(axis)] - voxel.offset[axis]);
  }
  if (!cloud.rgb.empty()) AddColour(cloud.rgb[i], &voxel);
  if (!cloud.temperature_k.empty()) {
    const float sigma = cloud.temperature_sigma_k.empty() ? std::numeric_limits<float>::quiet_NaN()
                                                          : cloud.temperature_sigma_k[i];
    AddTemperature(cloud.temperature_k[i], sigma, &voxel);
  }
}

MapCloud VoxelMap::Cloud() const {
  MapCloud cloud;
  cloud.frame = frame().value_or("map");
  cloud.voxel_m = options_.voxel_m;
  cloud.points.reserve(size());
  cloud.rgb.reserve(size());
  cloud.temperature_k.reserve(size());
  cloud.count.reserve(size());
  cloud.last_seen.reserve(size());
  for (const Voxel* voxel : store_.Sorted()) Append(*voxel, options_.voxel_m, &cloud);
  return cloud;
}

}  // namespace rgbdt
