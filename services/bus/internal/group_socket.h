#pragma once

#include "calib/model/descriptor.h"
#include "services/bus/bus_url.h"

namespace rgbdt {

/// A socket that hears the URL's group on its port and nothing else: what is sent to an address of
/// the machine does not arrive. With ttl 0 the kernel also drops what other machines send to the
/// group. Not blocking. Throws InputError: what the kernel refuses.
Descriptor OpenGroupSocket(const BusUrl& url);

}  // namespace rgbdt
