#include "services/drivers/packets/packet_sweeps.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "calib/model/errors.h"
#include "services/drivers/livox/livox_sweeps.h"
#include "services/drivers/ouster/ouster_sweeps.h"
#include "services/drivers/robosense/robosense_packets.h"
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

std::vector<PacketSweeps::Loss> LossesOf(const SpinningSweeps& sweeps) {
  return {{"lost columns", "columns never came", sweeps.lost_columns()},
          {"sweeps left out", "revolutions left out, as half a turn or more never came",
           sweeps.left_out()}};
}

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
  std::vector<Loss> Losses() const override { return LossesOf(sweeps_); }

 private:
  SpinningSweeps sweeps_;
  const hesai::Sensor* sensor_ = nullptr;
};

class Robosense : public PacketSweeps {
 public:
  // Without angles it takes those that its packets tell.
  explicit Robosense(std::optional<robosense::Angles> angles) : angles_(std::move(angles)) {}

  std::string name() const override { return sensor_ != nullptr ? sensor_->name : "RoboSense"; }
  std::optional<Make> make() const override { return Make::kRobosense; }
  int information_port() const override { return robosense::kInformationPort; }
  bool IsOurs(const Payload& payload) const override {
    if (robosense::IsInformation(payload.data(), payload.size())) return true;
    const robosense::Sensor* sensor = robosense::SensorOf(payload.data(), payload.size());
    return sensor != nullptr && (sensor_ == nullptr || sensor == sensor_) &&
           (!angles_ || angles_->elevation_rad.size() == sensor->channels);
  }
  std::vector<Cloud> Add(const Payload& payload, Utime arrival) override {
    if (robosense::IsInformation(payload.data(), payload.size())) {
      information_ = payload;
    } else if (sensor_ == nullptr) {
      sensor_ = robosense::SensorOf(payload.data(), payload.size());
      if (sensor_ != nullptr && angles_) sweeps_.emplace(*angles_, sensor_->lens);
    }
    if (sensor_ != nullptr && !information_.empty()) Learn();
    if (robosense::IsInformation(payload.data(), payload.size())) return {};
    if (sensor_ != nullptr && !sweeps_) return Wait();
    if (sensor_ == nullptr) throw InputError("is no packet of a RoboSense");
    return sweeps_->Add(robosense::Decode(*sensor_, dual_, payload.data(), payload.size()),
                        arrival);
  }
  std::optional<Cloud> Finish() override { return std::nullopt; }
  Utime begun() const override { return sweeps_ ? sweeps_->begun() : 0; }
  std::vector<Loss> Losses() const override {
    std::vector<Loss> losses = {
        {"packets before angles", "packets came before one that told the angles", waited_}};
    const std::vector<Loss> others =
        sweeps_ ? LossesOf(*sweeps_) : LossesOf(SpinningSweeps(robosense::Angles()));
    losses.insert(losses.end(), others.begin(), others.end());
    return losses;
  }

 private:
  void Learn() {
    const Payload payload = std::exchange(information_, {});
    const robosense::Information told =
        robosense::ParseInformation(*sensor_, payload.data(), payload.size());
    dual_ = told.dual;
    if (!sweeps_) sweeps_.emplace(told.angles, sensor_->lens);
  }
  // It tells its angles once a second.
  std::vector<Cloud> Wait() {
    constexpr std::int64_t kMany = 3000;
    if (++waited_ % kMany != 0) return {};
    throw InputError(name() + ": no packet tells its angles (DIFOP, to UDP port " +
                     std::to_string(robosense::kInformationPort) +
                     "); let it send them, or give its angle.csv as metadata");
  }

  std::optional<robosense::Angles> angles_;  // of a file
  const robosense::Sensor* sensor_ = nullptr;
  std::optional<SpinningSweeps> sweeps_;
  Payload information_;  // not read yet
  bool dual_ = false;
  std::int64_t waited_ = 0;
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

// Of a CSV, the first line that begins with a number.
bool IsOfTwoColumns(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    double number = 0;
    if (!(std::istringstream(line) >> number)) continue;
    return std::count(line.begin(), line.end(), ',') == 1;
  }
  return false;
}

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
  if (IsOfTwoColumns(text)) {
    robosense::Angles angles = robosense::ParseAngles(text, where);
    const std::size_t channels = angles.elevation_rad.size();
    if (channels != 16 && channels != 32) {
      throw InputError(where + ": has angles of " + std::to_string(channels) +
                       " channels; expected a RoboSense's, 16 or 32");
    }
    return std::make_unique<Robosense>(std::move(angles));
  }
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

std::unique_ptr<PacketSweeps> RobosensePackets() {
  return std::make_unique<Robosense>(std::nullopt);
}

std::unique_ptr<PacketSweeps> PacketsByThemselves(const PacketSweeps::Payload& payload) {
  if (auto velodyne = VelodyneByItself(payload)) return velodyne;
  if (auto robosense = RobosensePackets(); robosense->IsOurs(payload)) return robosense;
  return LivoxPackets(payload);
}

}  // namespace rgbdt
