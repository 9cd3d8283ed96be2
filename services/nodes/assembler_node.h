#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/scan_assembly/assembler.h"
#include "services/runtime/node.h"

namespace rgbdt {

/// LINE_SCAN + ENCODER -> CLOUD: what leaves when, in which order lines may come, and which are
/// refused stands in Assembler. Needs the rig first; another rig forgets the sweep at hand. Of a
/// rig whose LIDAR gives whole sweeps it is ready and has nothing to do.
class AssemblerNode : public Node {
 public:
  std::string name() const override { return "assembler"; }
  std::vector<std::string> Subscriptions() const override {
    return {"RIG", "LINE_SCAN", "ENCODER"};
  }
  Messages Handle(const Message& message) override;
  Status GetStatus() const override;

 private:
  void OnRig(const RigText& text);

  std::string rig_hash_;
  std::optional<Assembler> assembler_;  // from a rig with a turned scanner on
};

}  // namespace rgbdt
