#include "services/drivers/ouster/ouster_metadata.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "calib/model/errors.h"
#include "calib/model/printable.h"

namespace rgbdt::ouster {
namespace {

using nlohmann::json;

constexpr double kDegree = M_PI / 180;
constexpr double kMillimetre = 1e-3;
constexpr int kMostRows = 256, kMostColumns = 8192;

// Parts of one object as a reader that says where what is missing.
class Reader {
 public:
  Reader(const json& all, std::string where) : all_(all), where_(std::move(where)) {}

  // A key of the whole (older firmware) or of the named part.
  const json& Find(const std::string& part, const std::string& key) const {
    const json* found = FindOrNot(part, key);
    if (found == nullptr) Fail("has no " + key);
    return *found;
  }
  const json* FindOrNot(const std::string& part, const std::string& key) const {
    for (const json* object : {Object(all_, part), &all_}) {
      if (object == nullptr || !object->is_object()) continue;
      const auto found = object->find(key);
      if (found != object->end()) return &*found;
    }
    return nullptr;
  }
  int Integer(const std::string& part, const std::string& key, int most) const {
    const json& value = Find(part, key);
    if (!value.is_number_integer() || value.get<std::int64_t>() < 1 ||
        value.get<std::int64_t>() > most) {
      Fail(key + " is " + value.dump() + "; expected 1 to " + std::to_string(most));
    }
    return value.get<int>();
  }
  std::string Text(const std::string& part, const std::string& key,
                   const std::string& otherwise) const {
    const json* value = FindOrNot(part, key);
    return value != nullptr && value->is_string() ? PrintableText(value->get<std::string>())
                                                  : otherwise;
  }
  std::vector<double> Numbers(const std::string& part, const std::string& key,
                              std::size_t count) const {
    const json& value = Find(part, key);
    const bool numbers = value.is_array() && value.size() == count &&
                         std::all_of(value.begin(), value.end(), [](const json& number) {
                           return number.is_number() && std::abs(number.get<double>()) < 1e5;
                         });
    if (!numbers) Fail(key + " is no list of " + std::to_string(count) + " numbers");
    return value.get<std::vector<double>>();
  }
  [[noreturn]] void Fail(const std::string& what) const {
    throw InputError(
        where_ + ": " + PrintableText(what.substr(0, 200)) +
        "; expected the metadata of an Ouster sensor (JSON), of firmware 2.0 or newer");
  }

 private:
  static const json* Object(const json& in, const std::string& key) {
    if (!in.is_object()) return nullptr;
    const auto found = in.find(key);
    return found == in.end() ? nullptr : &*found;
  }

  const json& all_;
  std::string where_;
};

Profile ProfileOf(const Reader& reader, const std::string& format) {
  static const std::map<std::string, Profile> profiles = {
      {"LEGACY", Profile::kLegacy},
      {"RNG19_RFL8_SIG16_NIR16", Profile::kSingle},
      {"RNG19_RFL8_SIG16_NIR16_DUAL", Profile::kDual},
      {"RNG15_RFL8_NIR8", Profile::kLowBandwidth}};
  const std::string name = reader.Text(format, "udp_profile_lidar", "LEGACY");
  const auto found = profiles.find(name);
  if (found != profiles.end()) return found->second;
  std::string known;
  for (const auto& [other, profile] : profiles) known += " " + other;
  reader.Fail("udp_profile_lidar is " + name + ", which is not read; those that are:" + known);
}

// Row by row, millimetres.
Rigid3 TransformOf(const Reader& reader, const std::vector<double>& m) {
  Eigen::Matrix3d rotation;
  rotation << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
  if (!(rotation * rotation.transpose()).isIdentity(1e-3) || rotation.determinant() < 0) {
    reader.Fail("lidar_to_sensor_transform is no rotation");
  }
  return {Eigen::Quaterniond(rotation).normalized(),
          Eigen::Vector3d(m[3], m[7], m[11]) * kMillimetre};
}

std::vector<double> Radians(std::vector<double> degrees) {
  for (double& angle : degrees) angle *= kDegree;
  return degrees;
}

}  // namespace

std::size_t Metadata::BeamBytes() const {
  switch (profile) {
    case Profile::kLegacy:
    case Profile::kSingle:
      return 12;
    case Profile::kDual:
      return 16;
    case Profile::kLowBandwidth:
      return 4;
  }
  return 0;
}

std::size_t Metadata::ColumnBytes() const {
  const std::size_t around = profile == Profile::kLegacy ? 16 + 4 : 12;
  return around + static_cast<std::size_t>(rows) * BeamBytes();
}

std::size_t Metadata::PacketBytes() const {
  const std::size_t around = profile == Profile::kLegacy ? 0 : 32 + 32;
  return around + static_cast<std::size_t>(columns_per_packet) * ColumnBytes();
}

Metadata ParseMetadata(const std::string& text, const std::string& where) {
  // Nested deeper than any sensor's, it would be parsed by as deep a recursion when it is freed.
  const json all = json::parse(
      text, [](int depth, json::parse_event_t, json&) { return depth < 20; }, false);
  const Reader reader(all, where);
  if (!all.is_object()) reader.Fail("is no JSON object");
  const std::string format =
      reader.FindOrNot("", "lidar_data_format") != nullptr ? "lidar_data_format" : "data_format";
  const std::string beams = "beam_intrinsics", lidar = "lidar_intrinsics";
  Metadata metadata;
  metadata.model = reader.Text("sensor_info", "prod_line", "Ouster");
  metadata.profile = ProfileOf(reader, format);
  metadata.columns_per_frame = reader.Integer(format, "columns_per_frame", kMostColumns);
  metadata.columns_per_packet = reader.Integer(format, "columns_per_packet", 64);
  metadata.rows = reader.Integer(format, "pixels_per_column", kMostRows);
  const auto rows = static_cast<std::size_t>(metadata.rows);
  for (const double shift : reader.Numbers(format, "pixel_shift_by_row", rows)) {
    metadata.pixel_shift.push_back(static_cast<int>(shift));
  }
  metadata.altitude_rad = Radians(reader.Numbers(beams, "beam_altitude_angles", rows));
  metadata.azimuth_rad = Radians(reader.Numbers(beams, "beam_azimuth_angles", rows));
  if (reader.FindOrNot(beams, "beam_to_lidar_transform") != nullptr) {
    const auto m = reader.Numbers(beams, "beam_to_lidar_transform", 16);
    metadata.beam_origin_m = Eigen::Vector2d(m[3], m[11]) * kMillimetre;
  } else {
    const json& origin = reader.Find(beams, "lidar_origin_to_beam_origin_mm");
    if (!origin.is_number() || std::abs(origin.get<double>()) > 1000) {
      reader.Fail("lidar_origin_to_beam_origin_mm is " + origin.dump());
    }
    metadata.beam_origin_m.x() = origin.get<double>() * kMillimetre;
  }
  metadata.sensor_from_lidar =
      TransformOf(reader, reader.Numbers(lidar, "lidar_to_sensor_transform", 16));
  return metadata;
}

}  // namespace rgbdt::ouster
