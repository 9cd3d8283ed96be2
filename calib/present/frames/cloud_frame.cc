#include "calib/present/frames/cloud_frame.h"

#include <algorithm>
#include <cmath>

#include "calib/present/frames/internal/scatter.h"
#include "calib/present/layout/frame.h"

namespace rgbdt {
namespace {

// As protocol.ts lays it out; little-endian, as all machines that this runs on are.
struct Record {
  float x, y, z;
  std::uint8_t red, green, blue, intensity;
  float temperature_k, counts;
  std::uint16_t sigma_mk, valid;
  std::uint32_t offset_us;
};
static_assert(sizeof(Record) == kPointBytes);

constexpr std::uint8_t kUnknownIntensity = 255;
constexpr std::uint16_t kUnknownSigma = 65535;

std::uint8_t IntensityOf(float intensity) {
  if (!(intensity >= 0)) return kUnknownIntensity;  // NaN, too
  return static_cast<std::uint8_t>(254 * std::min(intensity, 1.0F) + 0.5F);
}

std::uint16_t SigmaMilliKelvin(float sigma_k) {
  if (!(sigma_k >= 0)) return kUnknownSigma;
  return static_cast<std::uint16_t>(std::min(1000 * sigma_k + 0.5F, 65534.0F));
}

Record RecordOf(const RgbdtCloud& cloud, std::size_t i, Utime base) {
  const Eigen::Vector3f& p = cloud.points[i];
  const std::array<std::uint8_t, 3>& rgb = cloud.rgb[i];
  return {p.x(),
          p.y(),
          p.z(),
          rgb[0],
          rgb[1],
          rgb[2],
          IntensityOf(cloud.intensity[i]),
          cloud.temperature_k[i],
          cloud.thermal_counts[i],
          SigmaMilliKelvin(cloud.temperature_sigma_k[i]),
          static_cast<std::uint16_t>(cloud.valid[i]),
          static_cast<std::uint32_t>(std::min<Utime>(cloud.utime[i] - base, UINT32_MAX))};
}

// Reads the cloud's arrays in their order; what is scattered is the writing.
void WriteRecords(const RgbdtCloud& cloud, Utime base, char* bytes) {
  const Scatter scatter(cloud.size());
  std::uint64_t place = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i, place = scatter.NextPlace(place)) {
    const Record record = RecordOf(cloud, i, base);
    std::memcpy(bytes + place * kPointBytes, &record, kPointBytes);
  }
}

nlohmann::json CalibratedOf(const RgbdtCloud& cloud) {
  nlohmann::json calibrated = nlohmann::json::array();
  for (const Utime utime : cloud.calibration_utime) calibrated.push_back(utime != 0);
  return calibrated;
}

}  // namespace

std::string CloudFrame(const RgbdtCloud& cloud, int part, const std::string& view) {
  const Utime base =
      cloud.size() == 0 ? 0 : *std::min_element(cloud.utime.begin(), cloud.utime.end());
  nlohmann::json header = {{"type", "cloud"},
                           {"view", view},
                           {"sweep_utime", cloud.sweep_utime},
                           {"whole", cloud.whole_sweep},
                           {"part", part},
                           {"sweep_end", cloud.sweep_end},
                           {"utime", base},
                           {"cameras", cloud.cameras},
                           {"calibrated", CalibratedOf(cloud)},
                           {"map_from_lidar", nullptr},
                           {"count", cloud.size()},
                           {"ack", true}};
  if (cloud.map_from_lidar) header["map_from_lidar"] = MatrixOf(*cloud.map_from_lidar);
  const std::size_t bytes = cloud.size() * kPointBytes;
  std::string frame = FrameWriter(std::move(header)).FinishWith("points", bytes);
  WriteRecords(cloud, base, frame.data() + frame.size() - bytes);
  return frame;
}

}  // namespace rgbdt
