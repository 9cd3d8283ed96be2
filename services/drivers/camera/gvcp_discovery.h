#pragma once

#include <string>
#include <vector>

#include "services/drivers/camera/gvcp_message.h"
#include "services/drivers/net/network_interfaces.h"

namespace rgbdt {

/// A camera and where it was heard. One that is heard on two interfaces is there twice.
struct FoundGvcpDevice {
  GvcpDevice device;
  std::string interface;
};

/// Asks on every interface that is up who is there, and listens for half a second, also to cameras
/// of another subnet than the interface's. `also` are addresses asked beside: behind a router no
/// broadcast arrives. Sorted by interface, then serial number.
///
/// What the kernel's reverse-path filter (rp_filter) drops is not heard.
std::vector<FoundGvcpDevice> DiscoverGvcp(const std::vector<NetworkInterface>& interfaces,
                                          const std::vector<std::uint32_t>& also = {});

/// Who controls a camera.
enum class GvcpControl { kFree, kHeld, kNoAnswer };

/// Asks for at most half a second. Changes nothing at the camera.
GvcpControl AskGvcpControl(std::uint32_t address);

}  // namespace rgbdt
