#pragma once

#include <string>

#include "calib/files/import/folders.h"
#include "services/import/import_bag.h"

namespace rgbdt {

/// A recording of a LIDAR's packets, for `import`. Gives the exit code.
struct PacketsToImport {
  std::string file, metadata, out;
  int port = 0;
};
int ImportPackets(const PacketsToImport& packets);
/// Of a recording and the cameras' images a session directory, `out`; the sweeps that belong to
/// images lie in its folder `clouds`.
int ImportPacketsAsSession(const PacketsToImport& packets, Folders folders);

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
  int (*as_session)(const PacketsToImport&, Folders) = nullptr;
  CloudReader (*in_bag)(const PacketsInBag&) = nullptr;
};

}  // namespace rgbdt
