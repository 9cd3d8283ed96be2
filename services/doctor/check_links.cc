#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calib/model/text.h"
#include "services/doctor/checks.h"

namespace rgbdt {
namespace {

constexpr int kPlainMtu = 1500, kJumboMtu = 9000;
constexpr double kFastBitsPerS = 300e6;  // 25 thousand packets a second of 1500 bytes
constexpr double kUsable = 0.95;         // of a link, beside what headers and gaps take

std::string Mbit(double bits_per_s) { return Format("%.0f Mbit/s", bits_per_s / 1e6); }

std::string RateText(const CameraFacts& camera) {
  return camera.name + " " + Mbit(camera.rate.bits_per_s) + " at " +
         Format("%g Hz", camera.rate.hz) + (camera.rate.assumed ? " (assumed)" : "");
}

// Frame rates at which all fit, each camera slowed by the same factor.
std::string SlowerText(const std::vector<const CameraFacts*>& cameras, double factor) {
  std::string text;
  for (const CameraFacts* camera : cameras) {
    const double hz = std::max(std::floor(camera->rate.hz * factor * 10) / 10, 0.1);
    text += (text.empty() ? "in the rig, device of " : "; of ") + camera->name +
            ": feature { name: \"AcquisitionFrameRate\" value: \"" + Format("%g", hz) + "\" }";
  }
  return text + "; or give each camera an interface of its own";
}

Finding CheckLink(const std::string& name, double mbit_per_s, const CameraNetwork& network) {
  std::vector<const CameraFacts*> cameras;
  std::string rates;
  double sum = 0;
  for (const CameraFacts& camera : network.cameras) {
    if (camera.interface != name || camera.rate.hz <= 0) continue;
    cameras.push_back(&camera);
    sum += camera.rate.bits_per_s;
    rates += (rates.empty() ? "" : ", ") + RateText(camera);
  }
  const std::string check = "link " + name;
  const std::string what = rates + (cameras.size() > 1 ? ", together " + Mbit(sum) : "");
  const double usable = kUsable * mbit_per_s * 1e6;
  if (sum <= usable) return Ok(check, what + " of " + Mbit(mbit_per_s * 1e6));
  return Problem(check, what + ", more than the link's " + Mbit(mbit_per_s * 1e6) + " carry",
                 SlowerText(cameras, usable / sum));
}

}  // namespace

Findings CheckPackets(const CameraNetwork& network) {
  Findings findings;
  for (const CameraFacts& camera : network.cameras) {
    const NetworkInterface* interface = network.Interface(camera.interface);
    if (interface == nullptr || interface->mtu == 0) continue;
    const std::string check = "packets of " + camera.name;
    const std::string mtu = std::to_string(interface->mtu);
    const std::string fix = "sudo ip link set dev " + interface->name + " mtu " +
                            std::to_string(std::max(kJumboMtu, camera.device.packet_bytes));
    if (camera.device.packet_bytes > interface->mtu) {
      findings.push_back(Problem(check,
                                 "the rig asks for packets of " +
                                     std::to_string(camera.device.packet_bytes) + " bytes, and " +
                                     interface->name + " takes " + mtu + ": no image arrives",
                                 fix));
    } else if (interface->mtu <= kPlainMtu && camera.rate.bits_per_s > kFastBitsPerS) {
      findings.push_back(Warning(check,
                                 RateText(camera) + " in packets of " + mtu +
                                     " bytes: each costs an interrupt, and "
                                     "images with holes may follow",
                                 fix + "  # switch and camera must take it, too"));
    } else {
      findings.push_back(Ok(check, interface->name + " takes " + mtu + " bytes"));
    }
  }
  return findings;
}

Findings CheckLinks(const CameraNetwork& network) {
  Findings findings;
  for (const auto& [name, mbit_per_s] : network.mbit_per_s) {
    const auto is_on = [&, on = name](const CameraFacts& camera) {
      return camera.interface == on && camera.rate.hz > 0;
    };
    if (std::any_of(network.cameras.begin(), network.cameras.end(), is_on)) {
      findings.push_back(CheckLink(name, mbit_per_s, network));
    }
  }
  return findings;
}

}  // namespace rgbdt
