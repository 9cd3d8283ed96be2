#include "calib/files/schema/rig_file.h"

#include <google/protobuf/util/message_differencer.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/internal/device_convert.h"
#include "calib/files/schema/internal/lens_convert.h"
#include "calib/files/schema/internal/rig_convert.h"
#include "calib/files/schema/internal/target_convert.h"
#include "calib/files/schema/proto_convert.h"
#include "calib/files/schema/rig.pb.h"
#include "calib/files/schema/text_proto.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

using text::Place;

constexpr double kDegreesPerRadian = 180.0 / M_PI;

void CheckLensIsKnown(const CameraSpec& camera, const Place& place) {
  if (camera.lens.known()) return;
  place.Fail(camera.lens.model == Lens::Model::kFisheye ? "fisheye" : "pinhole",
             "is missing: camera \"" + camera.name +
                 "\" has no lens; run `rgbdt intrinsics DIR` to find it, or give pinhole { ... } "
                 "or fisheye { ... }");
}

Radiometry ToRadiometry(const proto::Camera& camera, const Place& place) {
  Radiometry radiometry;
  if (camera.has_linear()) {
    radiometry = text::ToRadiometry(camera.linear(), place.In("linear"));
  } else if (camera.has_planck()) {
    radiometry = text::ToRadiometry(camera.planck(), place.In("planck"));
  }
  const double emissivity = camera.emissivity();
  if (!(emissivity >= 0 && emissivity <= 1)) {
    place.Fail("emissivity", "is " + std::to_string(emissivity) + "; expected 0 to 1");
  }
  const double reflected = camera.reflected_temperature_k();
  if (!(reflected >= 0) || !std::isfinite(reflected)) {
    place.Fail("reflected_temperature_k",
               "is " + std::to_string(reflected) + "; expected kelvin, 0 or more");
  }
  radiometry.emissivity = emissivity > 0 ? emissivity : 1;
  radiometry.reflected_temperature_k = reflected;
  return radiometry;
}

void CheckKindAndFormat(const proto::Camera& camera, const Place& place) {
  if (camera.kind() == proto::Camera::KIND_UNSPECIFIED) {
    place.Fail("kind", "is missing; expected COLOR or THERMAL");
  }
  if (camera.pixel_format() == proto::Camera::PIXEL_FORMAT_UNSPECIFIED) {
    place.Fail("pixel_format",
               "is missing; expected MONO8, MONO16, BAYER_RG8, BAYER_GR8, BAYER_GB8, BAYER_BG8 or "
               "BGR8");
  }
  const bool grey = camera.pixel_format() == proto::Camera::MONO8 ||
                    camera.pixel_format() == proto::Camera::MONO16;
  if (camera.kind() == proto::Camera::THERMAL && !grey) {
    place.Fail("pixel_format", "is " + proto::Camera::PixelFormat_Name(camera.pixel_format()) +
                                   "; a THERMAL camera has one channel: MONO8 or MONO16");
  }
}

CameraSpec ToCamera(const proto::Camera& camera, const Place& place, LensNeed lenses) {
  CheckKindAndFormat(camera, place);
  CameraSpec spec;
  spec.name = camera.name();
  spec.kind = static_cast<CameraKind>(camera.kind());
  spec.width = camera.width();
  spec.height = camera.height();
  spec.format = static_cast<PixelFormat>(camera.pixel_format());
  spec.lens = text::ToLens(camera, place);
  if (camera.has_lens_uncertainty()) {
    spec.lens_uncertainty =
        text::ToLensUncertainty(camera.lens_uncertainty(), spec, place.In("lens_uncertainty"));
  }
  if (lenses == LensNeed::kKnown) CheckLensIsKnown(spec, place);
  spec.radiometry = ToRadiometry(camera, place);
  text::RequireFinite(camera.readout_s(), place, "readout_s");
  spec.readout_s = camera.readout_s();
  text::RequireFinite(camera.rolling_s(), place, "rolling_s");
  spec.rolling_s = camera.rolling_s();
  text::RequireFinite(camera.netd_k(), place, "netd_k");
  spec.netd_k = camera.netd_k();
  if (camera.has_camera_from_lidar_guess()) {
    spec.camera_from_lidar_guess =
        text::ToRigid3(camera.camera_from_lidar_guess(), place.In("camera_from_lidar_guess"));
  }
  if (camera.has_follow()) {
    const Place at = place.In("follow");
    text::RequireFinite(camera.follow().rotation_deg(), at, "rotation_deg");
    text::RequireFinite(camera.follow().translation_mm(), at, "translation_mm");
    spec.follow = {camera.follow().rotation_deg() / kDegreesPerRadian,
                   camera.follow().translation_mm() * 1e-3};
  }
  if (camera.has_device()) spec.device = text::ToDevice(camera.device(), place.In("device"));
  return spec;
}

LidarSpec ToLidar(const proto::Lidar& lidar, const Place& place) {
  using Make = PacketLidarDevice::Make;
  LidarSpec spec;
  spec.name = lidar.name();
  if (spec.name.empty()) place.Fail("name", "is missing; expected a name such as \"lidar\"");
  if (lidar.range_sigma_m() != 0) spec.range_sigma_m = lidar.range_sigma_m();
  if (lidar.has_range_offset_sigma_m()) spec.range_offset_sigma_m = lidar.range_offset_sigma_m();
  if (lidar.has_hokuyo()) {
    spec.device = text::ToDevice(lidar.hokuyo(), place.In("hokuyo"));
  } else if (lidar.has_velodyne()) {
    spec.device = text::ToDevice(lidar.velodyne(), place.In("velodyne"));
  } else if (lidar.has_ouster()) {
    spec.device = text::ToDevice(lidar.ouster(), Make::kOuster, place.In("ouster"));
  } else if (lidar.has_hesai()) {
    spec.device = text::ToDevice(lidar.hesai(), Make::kHesai, place.In("hesai"));
  } else if (lidar.has_livox()) {
    spec.device = text::ToDevice(lidar.livox(), Make::kLivox, place.In("livox"));
  } else if (lidar.has_robosense()) {
    spec.device = text::ToDevice(lidar.robosense(), Make::kRobosense, place.In("robosense"));
  } else if (lidar.has_pcd_folder()) {
    spec.device = text::ToDevice(lidar.pcd_folder(), place.In("pcd_folder"));
  }
  if (lidar.has_turned_scanner()) {
    const proto::TurnedScanner& scanner = lidar.turned_scanner();
    const Place at = place.In("turned_scanner");
    if (!scanner.has_motor_from_scanner()) {
      at.Fail("motor_from_scanner",
              "is missing; where the scanner sits on the motor's axis, write "
              "motor_from_scanner { quaternion_wxyz: [1, 0, 0, 0] translation_m: [0, 0, 0] }");
    }
    text::RequireFinite(scanner.zero_ticks(), at, "zero_ticks");
    spec.turned_scanner =
        TurnedScanner{text::ToRigid3(scanner.motor_from_scanner(), at.In("motor_from_scanner")),
                      scanner.ticks_per_degree() * kDegreesPerRadian,
                      scanner.zero_ticks(),
                      {},
                      scanner.encoder_delay_s()};
    if (scanner.has_dynamixel()) {
      spec.turned_scanner->motor = text::ToDevice(scanner.dynamixel(), at.In("dynamixel"));
    }
  }
  return spec;
}

// 1400 rather than 1400.0000000000002, wherever both mean the same.
double TicksPerDegree(double ticks_per_rad) {
  const double exact = ticks_per_rad / kDegreesPerRadian;
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.12g", exact);
  const double rounded = std::strtod(digits, nullptr);  // stod throws for the smallest
  return rounded * kDegreesPerRadian == ticks_per_rad ? rounded : exact;
}

void FromCamera(const CameraSpec& spec, proto::Camera* out) {
  out->set_name(ValidUtf8(spec.name));
  out->set_kind(static_cast<proto::Camera::Kind>(spec.kind));
  out->set_width(spec.width);
  out->set_height(spec.height);
  out->set_pixel_format(static_cast<proto::Camera::PixelFormat>(spec.format));
  text::FromLens(spec.lens, out);
  if (spec.lens_uncertainty) {
    text::FromLensUncertainty(spec, out->mutable_lens_uncertainty());
  }
  if (spec.radiometry.kind == Radiometry::Kind::kLinear) {
    text::FromLinear(spec.radiometry, out->mutable_linear());
  } else if (spec.radiometry.kind == Radiometry::Kind::kPlanck) {
    text::FromPlanck(spec.radiometry, out->mutable_planck());
  }
  if (spec.radiometry.emissivity != 1) out->set_emissivity(spec.radiometry.emissivity);
  out->set_reflected_temperature_k(spec.radiometry.reflected_temperature_k);
  out->set_readout_s(spec.readout_s);
  out->set_rolling_s(spec.rolling_s);
  out->set_netd_k(spec.netd_k);
  if (spec.camera_from_lidar_guess) {
    text::FromRigid3(*spec.camera_from_lidar_guess, out->mutable_camera_from_lidar_guess());
  }
  const FollowLimits usual;
  if (spec.follow.rotation_rad != usual.rotation_rad ||
      spec.follow.translation_m != usual.translation_m) {
    out->mutable_follow()->set_rotation_deg(spec.follow.rotation_rad * kDegreesPerRadian);
    out->mutable_follow()->set_translation_mm(spec.follow.translation_m * 1e3);
  }
  if (spec.device) text::FromDevice(*spec.device, out->mutable_device());
}

void FromLidar(const LidarSpec& spec, proto::Lidar* out) {
  out->set_name(ValidUtf8(spec.name));
  out->set_range_sigma_m(spec.range_sigma_m);
  out->set_range_offset_sigma_m(spec.range_offset_sigma_m);
  text::FromLidarDevice(spec, out);
  if (!spec.turned_scanner) return;
  proto::TurnedScanner* scanner = out->mutable_turned_scanner();
  text::FromRigid3(spec.turned_scanner->motor_from_scanner, scanner->mutable_motor_from_scanner());
  scanner->set_ticks_per_degree(TicksPerDegree(spec.turned_scanner->ticks_per_rad));
  scanner->set_zero_ticks(spec.turned_scanner->zero_ticks);
  scanner->set_encoder_delay_s(spec.turned_scanner->encoder_delay_s);
  if (spec.turned_scanner->motor) {
    text::FromDevice(*spec.turned_scanner->motor, scanner->mutable_dynamixel());
  }
}

bool SaysWhich(const proto::Lidar& lidar) {
  return lidar.has_velodyne() || lidar.has_ouster() || lidar.has_hesai() || lidar.has_livox() ||
         lidar.has_robosense();
}

// Of devices only which LIDAR it is counts, and only where both say it; the motor does not.
void KeepModels(proto::Lidar* a, proto::Lidar* b) {
  const bool both = SaysWhich(*a) && SaysWhich(*b);
  for (proto::Lidar* lidar : {a, b}) {
    if (!both) {
      lidar->clear_device();
    } else if (lidar->has_velodyne()) {
      lidar->mutable_velodyne()->clear_port();
      lidar->mutable_velodyne()->clear_pcap();
    } else if (lidar->has_ouster()) {
      lidar->mutable_ouster()->Clear();
    } else if (lidar->has_hesai()) {
      lidar->mutable_hesai()->Clear();
    } else if (lidar->has_livox()) {
      lidar->mutable_livox()->Clear();
    } else if (lidar->has_robosense()) {
      lidar->mutable_robosense()->Clear();
    }
    lidar->mutable_turned_scanner()->clear_dynamixel();
  }
}

// What the rig's LIDARs have in common; the reference may be called otherwise.
void KeepLidars(proto::Rig* a, proto::Rig* b) {
  const int both = std::min(a->lidar_size(), b->lidar_size());
  for (int i = 0; i < both; ++i) KeepModels(a->mutable_lidar(i), b->mutable_lidar(i));
  for (proto::Rig* rig : {a, b}) rig->mutable_lidar(0)->clear_name();
}

// "lidar[0].turned_scanner" is the reference's, of which most rigs have no other.
std::string ReferenceByName(std::string line) {
  const std::string indexed = "lidar[0]";
  for (std::size_t at = line.find(indexed); at != std::string::npos; at = line.find(indexed, at)) {
    line.erase(at + indexed.size() - 3, 3);
  }
  return line;
}

}  // namespace

proto::Rig text::FromRig(const Rig& rig) {
  proto::Rig message;
  message.set_name(ValidUtf8(rig.name));
  FromLidar(rig.lidar, message.add_lidar());
  for (const LidarSpec& lidar : rig.further_lidars) FromLidar(lidar, message.add_lidar());
  for (const CameraSpec& camera : rig.cameras) FromCamera(camera, message.add_camera());
  if (rig.target.width_m > 0) text::FromTarget(rig.target, message.mutable_target());
  for (const HostSpec& host : rig.hosts) {
    proto::Host* out = message.add_host();
    out->set_name(ValidUtf8(host.name));
    for (const std::string& process : host.runs) out->add_runs(ValidUtf8(process));
  }
  return message;
}

Rig text::ToRig(const proto::Rig& message, const Place& place, LensNeed lenses) {
  Rig rig;
  rig.name = message.name();
  // A message of sensors alone may have none.
  if (message.lidar_size() > 0) rig.lidar = ToLidar(message.lidar(0), place.In("lidar"));
  for (int i = 1; i < message.lidar_size(); ++i) {
    rig.further_lidars.push_back(ToLidar(message.lidar(i), place.In("lidar", i)));
  }
  for (int i = 0; i < message.camera_size(); ++i) {
    rig.cameras.push_back(ToCamera(message.camera(i), place.In("camera", i), lenses));
  }
  if (message.has_target()) rig.target = text::ToTarget(message.target(), place.In("target"));
  for (const proto::Host& host : message.host()) {
    rig.hosts.push_back({host.name(), {host.runs().begin(), host.runs().end()}});
  }
  return rig;
}

Rig ReadRig(const std::filesystem::path& path, LensNeed lenses) {
  return ParseRig(ReadWholeFile(path), path.string(), lenses);
}

Rig ParseRig(const std::string& text, const std::string& where, LensNeed lenses) {
  proto::Rig message;
  Place::Tree tree;
  const Place place = rgbdt::text::ParseText(text, where, &message, &tree);
  if (message.lidar_size() == 0)
    place.Fail("lidar", "is missing; expected lidar { name: \"...\" }");
  if (!message.has_target()) place.Fail("target", "is missing; expected target { ... }");
  Rig rig = rgbdt::text::ToRig(message, place, lenses);
  rig.text = text;
  rig.hash = HashOfRigText(text);
  try {
    rig.Check(lenses);
  } catch (const InputError& error) {
    throw InputError(where + ": " + error.what());
  }
  return rig;
}

std::string PrintRig(const Rig& rig) {
  return text::PrintText(
      text::FromRig(rig),
      "A rig (schema: calib/files/schema/rig.proto). Metres, pixels, seconds, kelvin.\n"
      "a_from_b: point_in_a = R(quaternion w x y z) * point_in_b + translation. LIDAR: x forward,\n"
      "y left, z up. Camera: x right, y down, z forward.");
}

std::string InOneLine(const std::vector<std::string>& differences) {
  constexpr std::size_t kMost = 5, kMaxBytes = 150;
  std::string text;
  for (std::size_t i = 0; i < std::min(differences.size(), kMost); ++i) {
    const std::string& line = differences[i];
    text += (i == 0 ? "" : "; ") +
            (line.size() <= kMaxBytes ? line : ValidUtf8(line.substr(0, kMaxBytes)) + " ...");
  }
  const std::size_t more = differences.size() - std::min(differences.size(), kMost);
  return more == 0 ? text : text + "; and " + std::to_string(more) + " more";
}

std::vector<std::string> DifferencesOf(const Rig& a, const Rig& b) {
  proto::Rig was = text::FromRig(a);
  proto::Rig is = text::FromRig(b);
  KeepLidars(&was, &is);
  for (proto::Rig* rig : {&was, &is}) {
    rig->clear_name();
    rig->clear_host();
    for (proto::Camera& camera : *rig->mutable_camera()) {
      camera.clear_device();
      camera.clear_camera_from_lidar_guess();
      camera.clear_follow();
      camera.clear_emissivity();
      camera.clear_reflected_temperature_k();
    }
  }
  std::string text;
  google::protobuf::util::MessageDifferencer differencer;
  // Degrees become radians and back: the last bit is no difference.
  differencer.set_float_comparison(google::protobuf::util::MessageDifferencer::APPROXIMATE);
  // Cameras are told by their names, whatever their order.
  differencer.TreatAsMap(proto::Rig::descriptor()->FindFieldByName("camera"),
                         proto::Camera::descriptor()->FindFieldByName("name"));
  differencer.ReportDifferencesToString(&text);
  differencer.Compare(was, is);
  std::vector<std::string> lines;
  std::istringstream in(text);
  // What only stands elsewhere is no difference.
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("moved:", 0) != 0) lines.push_back(ReferenceByName(line));
  }
  return lines;
}

std::string HashOfRigText(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(hash));
  return digits;
}

}  // namespace rgbdt
