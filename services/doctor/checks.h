#pragma once

#include "services/doctor/facts.h"
#include "services/doctor/finding.h"

namespace rgbdt {

// From facts to what is wrong and what mends it. Nothing here looks at the machine.

Finding CheckBuffer(const BufferFacts& facts);
/// `route`: where messages to the group would go.
Findings CheckBusUrl(const BusUrl& url, const Route& route);
Finding CheckMulticast(const MulticastFacts& facts);
/// Of a bus that is to stay on this machine.
Finding CheckFirewall(const FirewallFacts& facts);
Finding CheckClock(const ClockFacts& facts);
Finding CheckDisk(const DiskFacts& facts);
/// `failures`: datagrams that the kernel could not put together (ReassemblyFailures).
Finding CheckReassembly(std::int64_t failures);

/// How the processes on the bus do: who waits for something, loses or refuses messages, is there
/// twice, and whose clock is off. `expected`: names of those that the rig needs; which of them are
/// silent is told where another one speaks.
Findings CheckProcesses(const BusFacts& facts, const std::vector<std::string>& expected);

Finding CheckPort(const PortFacts& facts);
Finding CheckSerial(const SerialFacts& facts);
Finding CheckHokuyo(const HokuyoFacts& facts);

/// Whether each camera is there, can be reached and is free.
Findings CheckCameras(const CameraNetwork& network);
/// Whether a camera's packets fit the interface towards it.
Findings CheckPackets(const CameraNetwork& network);
/// Whether all that the cameras send fits each link.
Findings CheckLinks(const CameraNetwork& network);

}  // namespace rgbdt
