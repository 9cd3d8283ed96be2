#include "services/drivers/packets/packet_sweeps.h"

#include "calib/model/errors.h"
#include "services/drivers/hesai/hesai_sweeps.h"
#include "services/drivers/livox/livox_sweeps.h"
#include "services/drivers/ouster/ouster_sweeps.h"
#include "services/drivers/velodyne/velodyne_sweeps.h"

namespace rgbdt {
namespace {

using Make = PacketLidarDevice::Make;

class Ouster : public PacketSweeps {
 public:
  explicit Ouster(ouster::Metadata metadata) : sweeps_(std::move(metadata)) {}

  std::string name() const override { return sweeps_.metadata().model; }
  std::optional<Make> make() const override { return Make::kOuster; }
  bool IsOurs(const Payload& payload) const override {
    return payload.size() == sweeps_.metadata().PacketBytes();
  }
  std::vector<Cloud> Add(const Payload& payload, Utime arrival) override {
    auto sweep =
        sweeps_.Add(ouster::Decode(sweeps_.metadata(), payload.data(), payload.size()), arrival);
    std::vector<Cloud> sweeps;
    if (sweep) sweeps.push_back(std::move(*sweep));
    return sweeps;
  }
  std::optional<Cloud> Finish() override { return sweeps_.Finish(); }
  Utime begun() const override { return sweeps_.begun(); }
  std::vector<Loss> Losses() const override {
    return {{"lost columns", "columns never came, or were not measured", sweeps_.lost_columns()}};
  }

 private:
  OusterSweeps sweeps_;
};

class Hesai : public PacketSweeps {
 public:
  explicit Hesai(hesai::Angles angles) : sweeps_(std::move(angles)) {}

  // Of several sensors that have so many channels a packet tells which it is.
  std::string name() const override {
    return sensor_ != nullptr ? sensor_->name
                              : "Hesai of " + std::to_string(sweeps_.channels()) + " channels";
  }
  std::optional<Make> make() const override { return Make::kHesai; }
  bool IsOurs(const Payload& payload) const override {
    const hesai::Sensor* sensor = hesai::SensorOf(payload.data(), payload.size());
    return sensor != nullptr && sensor->channels == sweeps_.channels() &&
           (sensor_ == nullptr || sensor == sensor_);
  }
  std::vector<Cloud> Add(const Payload& payload, Utime arrival) override {
    if (sensor_ == nullptr) sensor_ = hesai::SensorOf(payload.data(), payload.size());
    if (sensor_ == nullptr) throw InputError("is no packet of a " + name());
    return sweeps_.Add(hesai::Decode(*sensor_, payload.data(), payload.size()), arrival);
  }
  std::optional<Cloud> Finish() override { return std::nullopt; }
  Utime begun() const override { return sweeps_.begun(); }
  std::vector<Loss> Losses() const override {
    return {{"lost columns", "columns never came", sweeps_.lost_columns()},
            {"sweeps left out", "revolutions left out, as half a turn or more never came",
             sweeps_.left_out()}};
  }

 private:
  HesaiSweeps sweeps_;
  const hesai::Sensor* sensor_ = nullptr;
};

class Velodyne : public PacketSweeps {
 public:
  explicit Velodyne(VelodyneDevice::Model model)
      : sensor_(velodyne::SensorOf(model)), sweeps_(model) {}

  std::string name() const override { return sensor_.name; }
  bool IsOurs(const Payload& payload) const override {
    return payload.size() == velodyne::kDataBytes;
  }
  std::vector<Cloud> Add(const Payload& payload, Utime arrival) override {
    return sweeps_.Add(velodyne::Decode(sensor_, payload.data(), payload.size()), arrival);
  }
  std::optional<Cloud> Finish() override { return std::nullopt; }
  Utime begun() const override { return sweeps_.begun(); }
  std::vector<Loss> Losses() const override {
    return {{"lost packets", "packets never came", sweeps_.lost_packets()}};
  }
  std::int64_t clock_steps() const override { return sweeps_.clock_steps(); }

 private:
  const velodyne::Sensor& sensor_;
  VelodyneSweeps sweeps_;
};

class Livox : public PacketSweeps {
 public:
  explicit Livox(livox::Protocol protocol) : protocol_(protocol) {}

  std::string name() const override {
    return protocol_ == livox::Protocol::kSdk1 ? "Livox Avia" : "Livox Mid-360";
  }
  std::optional<Make> make() const override { return Make::kLivox; }
  bool IsOurs(const Payload& payload) const override {
    return livox::IsPacket(protocol_, payload.data(), payload.size());
  }
  std::vector<Cloud> Add(const Payload& payload, Utime arrival) override {
    auto sweep = sweeps_.Add(livox::Decode(protocol_, payload.data(), payload.size()), arrival);
    std::vector<Cloud> sweeps;
    if (sweep) sweeps.push_back(std::move(*sweep));
    return sweeps;
  }
  std::optional<Cloud> Finish() override { return sweeps_.Finish(); }
  Utime begun() const override { return sweeps_.begun(); }
  std::vector<Loss> Losses() const override {
    return {
        {"lost ms", "ms never came", sweeps_.lost_ms()},
        {"sweeps left out", "seconds left out, as a tenth or more never came", sweeps_.left_out()}};
  }

 private:
  livox::Protocol protocol_;
  LivoxSweeps sweeps_;
};

std::unique_ptr<PacketSweeps> VelodyneByItself(const PacketSweeps::Payload& payload) {
  using Model = VelodyneDevice::Model;
  if (payload.size() != velodyne::kDataBytes) return nullptr;
  switch (payload.back()) {  // the product
    case 0x21:
      return VelodynePackets(Model::kHdl32e);
    case 0x22:
      return VelodynePackets(Model::kVlp16);
    case 0x28:
      return VelodynePackets(Model::kVlp32c);
    default:
      return nullptr;
  }
}

}  // namespace

std::string PacketSweeps::Lost() const {
  std::string text;
  for (const Loss& loss : Losses()) {
    if (loss.count == 0) continue;
    text += (text.empty() ? "" : "; ") + std::to_string(loss.count) + " " + loss.words;
  }
  return text;
}

std::unique_ptr<PacketSweeps> VelodynePackets(VelodyneDevice::Model model) {
  return std::make_unique<Velodyne>(model);
}

std::unique_ptr<PacketSweeps> OusterPackets(ouster::Metadata metadata) {
  return std::make_unique<Ouster>(std::move(metadata));
}

std::unique_ptr<PacketSweeps> HesaiPackets(hesai::Angles angles) {
  const std::size_t channels = angles.elevation_rad.size();
  std::string known;
  for (const hesai::Sensor& sensor : hesai::Sensors()) {
    if (sensor.channels == channels) return std::make_unique<Hesai>(std::move(angles));
    known += (known.empty() ? "" : ", ") + sensor.name;
  }
  throw InputError("no Hesai of " + std::to_string(channels) +
                   " channels is known; those that are: " + known);
}

std::unique_ptr<PacketSweeps> PacketsByMetadata(const std::string& text, const std::string& where) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  const bool is_json = begin != std::string::npos && (text[begin] == '{' || text[begin] == '[');
  if (is_json) return OusterPackets(ouster::ParseMetadata(text, where));
  const hesai::Angles angles = hesai::ParseAngles(text, where);
  try {
    return HesaiPackets(angles);
  } catch (const InputError& error) {
    throw InputError(where + ": " + error.what());
  }
}

std::unique_ptr<PacketSweeps> LivoxPackets(const PacketSweeps::Payload& payload) {
  for (const livox::Protocol protocol : {livox::Protocol::kSdk1, livox::Protocol::kSdk2}) {
    if (livox::IsPacket(protocol, payload.data(), payload.size())) {
      return std::make_unique<Livox>(protocol);
    }
  }
  return nullptr;
}

std::unique_ptr<PacketSweeps> PacketsByThemselves(const PacketSweeps::Payload& payload) {
  if (auto velodyne = VelodyneByItself(payload)) return velodyne;
  return LivoxPackets(payload);
}

}  // namespace rgbdt
