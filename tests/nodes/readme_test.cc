// The table of processes in services/README.md is what the nodes subscribe to.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <memory>
#include <regex>

#include "services/nodes/assembler_node.h"
#include "services/nodes/detector_node.h"
#include "services/nodes/fuser_node.h"
#include "services/nodes/mapper_node.h"
#include "services/nodes/monitor_node.h"
#include "services/nodes/odometry_node.h"
#include "services/nodes/session_node.h"
#include "services/nodes/solver_node.h"
#include "services/simulator/simulator_node.h"
#include "tests/nodes/session_world.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

// Channels by process, as the table has them.
std::map<std::string, std::vector<std::string>> Table() {
  std::ifstream file(std::string(RGBDT_SOURCE_DIR) + "/services/README.md");
  static const std::regex row(R"(\| `rgbdt-([a-z]+)` \| ([^|]+) \|.*)");
  static const std::regex channel(R"([A-Z_*]+)");
  std::map<std::string, std::vector<std::string>> table;
  std::smatch match;
  for (std::string line; std::getline(file, line);) {
    if (!std::regex_match(line, match, row)) continue;
    const std::string channels = match[2];
    for (std::sregex_iterator it(channels.begin(), channels.end(), channel), end; it != end; ++it) {
      table[match[1]].push_back(it->str() == "*_IMAGE" ? ".*_IMAGE" : it->str());
    }
  }
  return table;
}

TEST(ServicesReadme, SaysWhatTheNodesSubscribeTo) {
  const test::TempDir dir;
  std::vector<std::unique_ptr<Node>> nodes;
  nodes.push_back(std::make_unique<SimulatorNode>(test::TinyOptions()));
  nodes.push_back(std::make_unique<AssemblerNode>());
  nodes.push_back(std::make_unique<DetectorNode>());
  nodes.push_back(std::make_unique<SolverNode>());
  nodes.push_back(std::make_unique<FuserNode>());
  nodes.push_back(std::make_unique<MonitorNode>());
  nodes.push_back(std::make_unique<OdometryNode>());
  nodes.push_back(std::make_unique<MapperNode>(VoxelMapOptions()));
  nodes.push_back(
      std::make_unique<SessionNode>(test::TinyRig(), dir / "session", SessionNode::OnProgress()));
  auto table = Table();
  for (const auto& node : nodes) {
    EXPECT_THAT(table[node->name()], ::testing::UnorderedElementsAreArray(node->Subscriptions()))
        << node->name();
  }
}

}  // namespace
}  // namespace rgbdt
