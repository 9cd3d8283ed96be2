#pragma once

#include <string>

#include "services/import/import_bag.h"

namespace rgbdt {

/// A recording of a LIDAR's packets, for `import`. Gives the exit code.
struct PacketsToImport {
  std::string file, metadata, out;
  int port = 0;
};
int ImportPackets(const PacketsToImport& packets);

/// A LIDAR's packets in a bag.
struct PacketsInBag {
  std::string bag;
  std::string metadata;  ///< file; empty: what the bag says
  const BagSurvey* survey = nullptr;
  BagSurvey::Topic* topic = nullptr;  ///< gets its sweeps' times
};
/// Finds the sweeps, prints what there is to say of them, gives what reads them.
CloudReader ReadPacketsInBag(const PacketsInBag& packets);

/// What `import` does with packets.
struct PacketImport {
  int (*recording)(const PacketsToImport&) = nullptr;
  CloudReader (*in_bag)(const PacketsInBag&) = nullptr;
};

}  // namespace rgbdt
