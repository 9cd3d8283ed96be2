#include "services/packets/packet_sweeps.h"

#include "services/drivers/hesai/hesai_sweeps.h"
#include "services/drivers/ouster/ouster_sweeps.h"
#include "services/drivers/velodyne/velodyne_sweeps.h"

namespace rgbdt {
namespace {

class Ouster : public PacketSweeps {
 public:
  explicit Ouster(ouster::Metadata metadata) : sweeps_(std::move(metadata)) {}

  std::string name() const override { return sweeps_.metadata().model; }
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
  std::string Lost() const override {
    const std::int64_t lost = sweeps_.lost_columns();
    return lost == 0 ? "" : std::to_string(lost) + " columns never came, or were not measured";
  }

 private:
  OusterSweeps sweeps_;
};

class Hesai : public PacketSweeps {
 public:
  explicit Hesai(hesai::Angles angles) : sweeps_(std::move(angles)) {}

  std::string name() const override { return sweeps_.sensor().name; }
  bool IsOurs(const Payload& payload) const override {
    return hesai::IsPacket(sweeps_.sensor(), payload.data(), payload.size());
  }
  std::vector<Cloud> Add(const Payload& payload, Utime arrival) override {
    return sweeps_.Add(hesai::Decode(sweeps_.sensor(), payload.data(), payload.size()), arrival);
  }
  std::optional<Cloud> Finish() override { return std::nullopt; }
  std::string Lost() const override {
    const std::int64_t lost = sweeps_.lost_columns(), left_out = sweeps_.left_out();
    std::string text;
    if (lost > 0) text = std::to_string(lost) + " columns never came";
    if (left_out > 0) {
      text +=
          (text.empty() ? "" : "; ") +
          ("revolutions left out, as half a turn or more never came: " + std::to_string(left_out));
    }
    return text;
  }

 private:
  HesaiSweeps sweeps_;
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
  std::string Lost() const override {
    const std::int64_t lost = sweeps_.lost_packets();
    return lost == 0 ? "" : std::to_string(lost) + " packets never came";
  }

 private:
  const velodyne::Sensor& sensor_;
  VelodyneSweeps sweeps_;
};

}  // namespace

std::unique_ptr<PacketSweeps> OusterPackets(ouster::Metadata metadata) {
  return std::make_unique<Ouster>(std::move(metadata));
}

std::unique_ptr<PacketSweeps> HesaiPackets(hesai::Angles angles) {
  return std::make_unique<Hesai>(std::move(angles));
}

std::unique_ptr<PacketSweeps> VelodynePackets(const PacketSweeps::Payload& payload) {
  using Model = VelodyneDevice::Model;
  if (payload.size() != velodyne::kDataBytes) return nullptr;
  switch (payload.back()) {  // the product
    case 0x21:
      return std::make_unique<Velodyne>(Model::kHdl32e);
    case 0x22:
      return std::make_unique<Velodyne>(Model::kVlp16);
    case 0x28:
      return std::make_unique<Velodyne>(Model::kVlp32c);
    default:
      return nullptr;
  }
}

}  // namespace rgbdt
