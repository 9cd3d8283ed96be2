#include "calib/files/schema/internal/device_convert.h"

#include <cmath>

#include "calib/files/schema/proto_convert.h"
#include "calib/model/text.h"

namespace rgbdt::text {
namespace {

constexpr double kDegree = M_PI / 180;

// Either way, as a DYNAMIXEL in its mode of extended positions.
constexpr int kMostTurns = 256;
constexpr int kMostDegreesPerSecond = 10'000;

// A number that may be left out: 0 is not one of its values.
int OrDefault(int value, int otherwise, int least, int most, const Place& place,
              const std::string& field) {
  if (value == 0) return otherwise;
  if (value < least || value > most) {
    place.Fail(field, "is " + std::to_string(value) + "; expected " + std::to_string(least) +
                          " to " + std::to_string(most));
  }
  return value;
}

int Port(int port, int otherwise, const Place& place) {
  return OrDefault(port, otherwise, 1, 65535, place, "port");
}

void RequireText(const std::string& value, const Place& place, const std::string& field,
                 const std::string& example) {
  if (value.empty()) place.Fail(field, "is missing; expected for example \"" + example + "\"");
}

}  // namespace

CameraDevice ToDevice(const proto::CameraDevice& device, const Place& place) {
  constexpr int kHeaders = 36;  // of IP, UDP and GigE Vision
  CameraDevice spec;
  spec.serial = device.serial();
  spec.address = device.address();
  spec.id = device.id();
  if (spec.serial.empty() && spec.address.empty() && spec.id.empty()) {
    place.Fail("serial",
               "is missing; name the camera by serial, address or id (arv-tool-0.8 lists)");
  }
  for (int i = 0; i < device.feature_size(); ++i) {
    const proto::Feature& feature = device.feature(i);
    RequireText(feature.name(), place.In("feature", i), "name", "ExposureTime");
    spec.features.emplace_back(feature.name(), feature.value());
  }
  spec.trigger = static_cast<CameraDevice::Trigger>(device.trigger());
  if (device.has_wire()) spec.wire = static_cast<CameraDevice::Wire>(device.wire());
  spec.packet_bytes =
      OrDefault(device.packet_bytes(), 0, 576, 65535 - kHeaders, place, "packet_bytes");
  return spec;
}

HokuyoDevice ToDevice(const proto::Hokuyo& device, const Place& place) {
  HokuyoDevice spec;
  RequireText(device.address(), place, "address", "192.168.0.10");
  spec.address = device.address();
  spec.port = Port(device.port(), spec.port, place);
  return spec;
}

VelodyneDevice ToDevice(const proto::Velodyne& device, const Place& place) {
  VelodyneDevice spec;
  if (device.model() == proto::Velodyne::MODEL_UNSPECIFIED) {
    place.Fail("model", "is missing; expected VLP16, VLP32C, HDL32E or HDL64E");
  }
  spec.model = static_cast<VelodyneDevice::Model>(device.model());
  spec.port = Port(device.port(), spec.port, place);
  spec.pcap = device.pcap();
  return spec;
}

PacketLidarDevice ToDevice(const proto::PacketLidar& device, PacketLidarDevice::Make make,
                           const Place& place) {
  PacketLidarDevice spec;
  spec.make = make;
  spec.metadata = device.metadata();
  if (make == PacketLidarDevice::Make::kLivox && !spec.metadata.empty()) {
    place.Fail("metadata", "is given, but a Livox has none: its packets say all; leave it out");
  }
  spec.port = Port(device.port(), DefaultPort(make), place);
  spec.pcap = device.pcap();
  return spec;
}

PcdFolderDevice ToDevice(const proto::PcdFolder& device, const Place& place) {
  PcdFolderDevice spec;
  RequireText(device.folder(), place, "folder", "recordings/room");
  spec.folder = device.folder();
  RequireFinite(device.period_s(), place, "period_s");
  if (device.period_s() < 0) {
    place.Fail("period_s",
               "is " + std::to_string(device.period_s()) + "; expected seconds, above 0");
  }
  if (device.period_s() > 0) spec.period_s = device.period_s();
  return spec;
}

DynamixelDevice ToDevice(const proto::Dynamixel& device, const Place& place) {
  DynamixelDevice spec;
  RequireText(device.port(), place, "port", "/dev/ttyUSB0");
  spec.port = device.port();
  spec.baud = OrDefault(device.baud(), spec.baud, 9600, 10'500'000, place, "baud");
  spec.id = OrDefault(device.id(), spec.id, 1, 252, place, "id");
  for (const auto& [angle, field] :
       {std::pair{device.from_deg(), "from_deg"}, std::pair{device.to_deg(), "to_deg"}}) {
    RequireFinite(angle, place, field);
    if (std::abs(angle) > kMostTurns * 360) {
      place.Fail(field, "is " + std::to_string(angle) + "; expected degrees, at most " +
                            std::to_string(kMostTurns) + " turns");
    }
  }
  RequireFinite(device.speed_deg_s(), place, "speed_deg_s");
  if (device.from_deg() == device.to_deg()) {
    place.Fail("to_deg", "is " + std::to_string(device.to_deg()) + ", the same as from_deg");
  }
  if (!(device.speed_deg_s() > 0 && device.speed_deg_s() <= kMostDegreesPerSecond)) {
    place.Fail("speed_deg_s", "is " + std::to_string(device.speed_deg_s()) +
                                  "; expected above 0 and at most " +
                                  std::to_string(kMostDegreesPerSecond));
  }
  spec.from_rad = device.from_deg() * kDegree;
  spec.to_rad = device.to_deg() * kDegree;
  spec.speed_rad_s = device.speed_deg_s() * kDegree;
  return spec;
}

void FromDevice(const CameraDevice& device, proto::CameraDevice* out) {
  if (!device.serial.empty()) {
    out->set_serial(ValidUtf8(device.serial));
  } else if (!device.address.empty()) {
    out->set_address(ValidUtf8(device.address));
  } else {
    out->set_id(ValidUtf8(device.id));
  }
  for (const auto& [name, value] : device.features) {
    proto::Feature* feature = out->add_feature();
    feature->set_name(ValidUtf8(name));
    feature->set_value(ValidUtf8(value));
  }
  out->set_trigger(static_cast<proto::CameraDevice::Trigger>(device.trigger));
  if (device.wire) out->set_wire(static_cast<proto::CameraDevice::Wire>(*device.wire));
  out->set_packet_bytes(device.packet_bytes);
}

void FromDevice(const DynamixelDevice& device, proto::Dynamixel* out) {
  out->set_port(ValidUtf8(device.port));
  out->set_baud(device.baud);
  out->set_id(device.id);
  out->set_from_deg(device.from_rad / kDegree);
  out->set_to_deg(device.to_rad / kDegree);
  out->set_speed_deg_s(device.speed_rad_s / kDegree);
}

namespace {

proto::PacketLidar* PacketLidarIn(PacketLidarDevice::Make make, proto::Lidar* lidar) {
  switch (make) {
    case PacketLidarDevice::Make::kOuster:
      return lidar->mutable_ouster();
    case PacketLidarDevice::Make::kHesai:
      return lidar->mutable_hesai();
    case PacketLidarDevice::Make::kLivox:
      return lidar->mutable_livox();
    case PacketLidarDevice::Make::kRobosense:
      return lidar->mutable_robosense();
  }
  return nullptr;
}

}  // namespace

void FromLidarDevice(const LidarSpec& lidar, proto::Lidar* out) {
  if (const auto* hokuyo = std::get_if<HokuyoDevice>(&lidar.device)) {
    out->mutable_hokuyo()->set_address(ValidUtf8(hokuyo->address));
    out->mutable_hokuyo()->set_port(hokuyo->port);
  } else if (const auto* velodyne = std::get_if<VelodyneDevice>(&lidar.device)) {
    out->mutable_velodyne()->set_model(static_cast<proto::Velodyne::Model>(velodyne->model));
    out->mutable_velodyne()->set_port(velodyne->port);
    out->mutable_velodyne()->set_pcap(ValidUtf8(velodyne->pcap));
  } else if (const auto* packets = std::get_if<PacketLidarDevice>(&lidar.device)) {
    proto::PacketLidar* made = PacketLidarIn(packets->make, out);
    made->set_metadata(ValidUtf8(packets->metadata));
    made->set_port(packets->port);
    made->set_pcap(ValidUtf8(packets->pcap));
  } else if (const auto* folder = std::get_if<PcdFolderDevice>(&lidar.device)) {
    out->mutable_pcd_folder()->set_folder(ValidUtf8(folder->folder));
    out->mutable_pcd_folder()->set_period_s(folder->period_s);
  }
}

}  // namespace rgbdt::text
