// Who may know whom (DESIGN.md, "The tree"), held by reading the sources and what CMake links.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

using Folders = std::set<std::string>;

// The folders that each folder may include, besides itself. `calib/model` is everybody's.
const std::map<std::string, Folders>& Allowed() {
  static const std::map<std::string, Folders> allowed = {
      {"calib/model", {}},
      {"calib/camera", {}},
      {"calib/scan_assembly", {}},
      {"calib/detect/image", {"calib/camera"}},
      {"calib/detect/cloud", {}},
      {"calib/detect", {"calib/camera", "calib/detect/image", "calib/detect/cloud"}},
      {"calib/solve", {"calib/camera"}},
      {"calib/methods/paper", {"calib/camera", "calib/solve"}},
      {"calib/methods/plane", {"calib/camera", "calib/solve"}},
      {"calib/methods/line_scan", {"calib/solve", "calib/methods/plane"}},
      {"calib/methods/bearing_angle", {"calib/camera", "calib/detect/cloud", "calib/solve"}},
      {"calib/methods/single_shot", {"calib/detect/cloud", "calib/solve", "calib/methods/plane"}},
      {"calib/methods/scene", {"calib/camera"}},
      {"calib/methods/mutual_information", {"calib/camera", "calib/methods/scene"}},
      {"calib/methods/gradient_orientation",
       {"calib/camera", "calib/detect/cloud", "calib/methods/scene"}},
      {"calib/methods/edge_grid", {"calib/camera", "calib/detect/cloud", "calib/methods/scene"}},
      {"calib/methods/natural", {"calib/camera", "calib/detect/cloud", "calib/odometry"}},
      {"calib/methods",
       {"calib/camera", "calib/detect", "calib/detect/image", "calib/detect/cloud", "calib/solve",
        "calib/methods/paper", "calib/methods/plane", "calib/methods/line_scan",
        "calib/methods/bearing_angle", "calib/methods/single_shot", "calib/methods/natural",
        "calib/methods/mutual_information", "calib/methods/gradient_orientation",
        "calib/methods/edge_grid", "calib/files/session"}},
      {"calib/monitor", {"calib/camera", "calib/methods/natural"}},
      {"calib/fuse", {"calib/camera"}},
      {"calib/map", {}},
      {"calib/odometry", {}},
      {"calib/sync", {"calib/camera"}},
      {"calib/terrain", {}},
      {"calib/simulate", {}},  // its own ray tables, nothing from camera/
      {"calib/files", {}},
      {"calib/files/schema", {"calib/files"}},
      {"calib/files/points", {"calib/files"}},
      {"calib/files/session", {"calib/files", "calib/files/schema", "calib/files/points"}},
      {"calib/files/import",
       {"calib/files", "calib/files/schema", "calib/files/points", "calib/files/session"}},
      {"calib/present/layout", {}},
      {"calib/present/pictures",
       {"calib/camera", "calib/scan_assembly", "calib/solve", "calib/sync", "calib/terrain"}},
      {"calib/present/report", {"calib/files"}},
      {"calib/present/frames",
       {"calib/camera", "calib/solve", "calib/fuse", "calib/files", "calib/present/layout",
        "calib/present/report"}},
      {"calib/present/session",
       {"calib/camera", "calib/solve", "calib/fuse", "calib/files", "calib/files/schema",
        "calib/files/session", "calib/present/layout", "calib/present/frames",
        "calib/present/pictures", "calib/present/report"}},
      {"services/command_line", {}},
      {"services/messages", {}},
      {"services/posix", {}},
      {"services/bus", {"calib/files", "services/messages", "services/posix"}},
      {"services/runtime", {"services/bus", "services/messages", "services/posix"}},
      {"services/nodes", {"calib/*", "services/messages", "services/runtime"}},
      {"services/simulator",
       {"calib/model", "calib/scan_assembly", "calib/simulate", "services/messages",
        "services/runtime"}},
      {"services/replay",
       {"calib/*", "services/messages", "services/bus", "services/runtime", "services/nodes"}},
      {"services/drivers", {"services/messages", "services/posix", "services/runtime"}},
      {"services/drivers/*",
       {"calib/camera", "calib/scan_assembly", "calib/files", "calib/files/points",
        "services/messages", "services/posix", "services/runtime", "services/drivers",
        "services/drivers/*"}},
      {"services/bags", {"services/posix"}},
      {"services/foxglove", {}},
      {"services/import",
       {"calib/camera", "calib/detect/image", "calib/scan_assembly", "calib/files",
        "calib/files/points", "calib/files/session", "calib/files/import", "services/messages",
        "services/bus", "services/bags", "services/foxglove"}},
      {"services/foxglove/stream",
       {"calib/scan_assembly", "calib/files/schema", "services/messages", "services/foxglove"}},
      {"services/export",
       {"calib/files", "calib/files/schema", "services/messages", "services/bus", "services/bags",
        "services/foxglove/stream"}},
      {"services/packets",
       {"calib/files", "calib/files/points", "services/drivers", "services/drivers/*",
        "services/bags", "services/import"}},
      {"services/doctor",
       {"services/bus", "services/messages", "services/posix", "services/drivers/*"}},
      {"services/up",
       {"services/command_line", "services/messages", "services/posix", "services/runtime"}},
      {"services/python",
       {"calib/methods", "calib/fuse", "calib/files", "calib/files/schema", "calib/files/points",
        "calib/files/session", "calib/present/report", "services/messages", "services/bus"}},
      {"services/rgbdt", {"calib/*", "services/*"}},
      {"services", {"calib/*", "services/*"}},
      {"viewer/server", {"calib/present/layout"}},
      {"viewer/live",
       {"calib/camera", "calib/files/schema", "calib/present/layout", "calib/present/frames",
        "services/messages", "services/bus", "services/runtime", "services/nodes",
        "services/foxglove", "services/foxglove/stream", "viewer/server"}},
      {"viewer/finished",
       {"calib/methods", "calib/files/session", "calib/present/frames", "calib/present/session",
        "viewer/server"}},
      {"viewer", {"calib/*", "services/*", "viewer/server", "viewer/live", "viewer/finished"}},
  };
  return allowed;
}

bool StartsWith(const std::string& text, const std::string& start) {
  return text.rfind(start, 0) == 0;
}

// "calib/*" stands for every folder below calib.
bool Matches(const std::string& folder, const std::string& pattern) {
  if (pattern.size() > 2 && pattern.substr(pattern.size() - 2) == "/*") {
    return StartsWith(folder, pattern.substr(0, pattern.size() - 1));
  }
  return folder == pattern;
}

// The folder whose sources these are; what lies in internal/ belongs to the folder above.
std::string FolderOf(const std::string& path) {
  const fs::path parent = fs::path(path).parent_path();
  return (parent.filename() == "internal" ? parent.parent_path() : parent).string();
}

const Folders* AllowedFor(const std::string& folder) {
  for (const auto& [pattern, allowed] : Allowed()) {
    if (folder == pattern) return &allowed;
  }
  for (const auto& [pattern, allowed] : Allowed()) {
    if (Matches(folder, pattern)) return &allowed;
  }
  return nullptr;
}

bool MayKnow(const std::string& folder, const std::string& other) {
  if (other == folder || other == "calib/model") return true;
  const Folders* allowed = AllowedFor(folder);
  return allowed != nullptr &&
         std::any_of(allowed->begin(), allowed->end(),
                     [&](const std::string& pattern) { return Matches(other, pattern); });
}

std::vector<std::string> IncludesOf(const std::string& text) {
  static const std::regex pattern(R"(^[ \t]*#[ \t]*include[ \t]*[<"]([^>"]+)[>"])");
  std::vector<std::string> includes;
  std::istringstream lines(text);
  std::smatch match;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_search(line, match, pattern)) includes.push_back(match[1]);
  }
  return includes;
}

struct Package {
  std::string include;             // how its headers begin
  std::vector<std::string> users;  // who may include them
};

// Packages that not everybody may carry.
const std::vector<Package>& Packages() {
  static const std::vector<Package> packages = {
      {"lcm", {"services/messages", "services/bus"}},
      {"sodium", {"services/bus"}},
      {"openssl/", {"viewer/server"}},
      {"embree", {"calib/simulate"}},
      {"pcl/", {"calib/methods/paper"}},
      {"CLI/", {"services/command_line"}},
      {"pcap/", {"services/drivers/pcap"}},
      {"arv.h", {"services/drivers/camera"}},
      {"boost/", {"viewer/server"}},
      {"sqlite3", {"services/bags"}},
      {"zstd", {"services/bags"}},
      {"lz4", {"services/bags"}},
      {"bzlib", {"services/bags"}},
      {"pybind11/", {"services/python"}},
  };
  return packages;
}

// Why a file of `folder` may not include this; empty: it may.
std::string WhyNot(const std::string& folder, const std::string& include) {
  for (const Package& package : Packages()) {
    if (!StartsWith(include, package.include)) continue;
    const auto& users = package.users;
    if (std::find(users.begin(), users.end(), folder) == users.end()) {
      return folder + " knows no " + package.include;
    }
  }
  const std::string top = include.substr(0, include.find('/'));
  if (top == "tests") return "tests are known to tests alone";
  if (top != "calib" && top != "services" && top != "viewer") return "";
  const std::string other = FolderOf(include);
  if (!MayKnow(folder, other)) return folder + " does not know " + other;
  const bool internal = fs::path(include).parent_path().filename() == "internal";
  if (internal && other != folder) return include + " is " + other + "'s own";
  return "";
}

std::string ReadText(const fs::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

bool IsSource(const fs::path& path) {
  static const std::set<std::string> extensions = {".cc", ".h", ".cpp", ".hpp", ".c", ".inc"};
  return extensions.count(path.extension().string()) != 0;
}

const fs::path kRoot = RGBDT_SOURCE_DIR;

// Paths below the root of all files of these three trees, the page's packages apart.
std::vector<std::string> AllFiles() {
  std::vector<std::string> files;
  for (const char* tree : {"calib", "services", "viewer"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / tree)) {
      const std::string path = fs::relative(entry.path(), kRoot).string();
      if (entry.is_regular_file() && !StartsWith(path, "viewer/page/")) files.push_back(path);
    }
  }
  return files;
}

TEST(Layers, EveryIncludeGoesWhereTheDesignsArrowsGo) {
  int files = 0;
  for (const std::string& path : AllFiles()) {
    if (!IsSource(path)) continue;
    const std::string folder = FolderOf(path);
    ASSERT_NE(AllowedFor(folder), nullptr) << path << " lies in no known folder";
    for (const std::string& include : IncludesOf(ReadText(kRoot / path))) {
      EXPECT_EQ(WhyNot(folder, include), "") << path << " includes " << include;
    }
    ++files;
  }
  EXPECT_GT(files, 400);
}

// Who installs the public headers has all that these include.
TEST(Layers, NoPublicHeaderIncludesAnInternalOne) {
  int headers = 0;
  for (const std::string& path : AllFiles()) {
    if (fs::path(path).extension() != ".h" || path.find("/internal/") != std::string::npos)
      continue;
    for (const std::string& include : IncludesOf(ReadText(kRoot / path))) {
      EXPECT_EQ(include.find("/internal/"), std::string::npos) << path << " includes " << include;
    }
    ++headers;
  }
  EXPECT_GT(headers, 100);
}

// The folder of a target, by its name: rgbdt_detect_image is calib/detect/image's.
const std::map<std::string, std::string>& FolderOfTarget() {
  static const std::map<std::string, std::string> folders = [] {
    std::map<std::string, std::string> found;
    for (const std::string& path : AllFiles()) {
      std::string folder = FolderOf(path);
      std::string name = folder.substr(StartsWith(folder, "viewer") ? 0 : folder.find('/') + 1);
      std::replace(name.begin(), name.end(), '/', '_');
      found["rgbdt_" + name] = folder;
    }
    return found;
  }();
  return folders;
}

// A target that links more than it includes would carry it into every user's program.
TEST(Layers, EveryTargetLinksNoMoreThanItMayInclude) {
  int targets = 0;
  for (const std::string& path : AllFiles()) {
    if (fs::path(path).filename() != "CMakeLists.txt") continue;
    const std::string folder = FolderOf(path);
    if (folder == "services" || folder == "viewer" || AllowedFor(folder) == nullptr) continue;
    const std::string text = ReadText(kRoot / path);
    static const std::regex target(R"(rgbdt_[a-z_]+)");
    for (std::sregex_iterator i(text.begin(), text.end(), target), end; i != end; ++i) {
      const auto found = FolderOfTarget().find(i->str());
      if (found == FolderOfTarget().end()) continue;  // the function's own name and the like
      EXPECT_TRUE(MayKnow(folder, found->second)) << path << " links " << i->str();
    }
    ++targets;
  }
  EXPECT_GE(targets, 25);
}

// A newcomer finds in a folder's README what lies in it, in the order in which data flows.
TEST(Layers, EveryFolderOfMoreThanFiveSourcesHasATableOfContents) {
  std::map<std::string, std::vector<std::string>> sources;  // by folder
  for (const std::string& path : AllFiles()) {
    if (IsSource(path)) sources[FolderOf(path)].push_back(path);
  }
  int large = 0;
  for (const auto& [folder, paths] : sources) {
    if (paths.size() <= 5) continue;
    const std::string readme = ReadText(kRoot / folder / "README.md");
    for (const std::string& path : paths) {
      std::string name = fs::path(path).stem().string();
      static const std::regex process("[a-z]+_main");
      name = std::regex_replace(name, process, "*_main");
      EXPECT_NE(readme.find(name), std::string::npos) << folder << "/README.md: " << path;
    }
    ++large;
  }
  EXPECT_GE(large, 30);
}

TEST(Layers, TheTestItselfCanFail) {
  EXPECT_THAT(IncludesOf("#include \"calib/model/rig.h\"\n  # include <lcm/lcm-cpp.hpp>\n"
                         "// the text include \"x\"\n"),
              testing::ElementsAre("calib/model/rig.h", "lcm/lcm-cpp.hpp"));
  EXPECT_EQ(WhyNot("calib/solve", "calib/camera/camera.h"), "");
  EXPECT_EQ(WhyNot("calib/solve", "calib/solve/internal/degenerate.h"), "");
  EXPECT_EQ(WhyNot("services/bus", "lcm/lcm-cpp.hpp"), "");
  EXPECT_EQ(WhyNot("services/drivers/lidar", "services/drivers/packets/packet_source.h"), "");
  EXPECT_NE(WhyNot("calib/simulate", "calib/camera/lens.h"), "");
  EXPECT_NE(WhyNot("calib/model", "calib/camera/lens.h"), "");
  EXPECT_NE(WhyNot("calib/solve", "calib/methods/detect_view.h"), "");
  EXPECT_NE(WhyNot("calib/detect/image", "calib/detect/cloud/range_grid.h"), "");
  EXPECT_NE(WhyNot("calib/detect/cloud", "calib/detect/image/checkerboard.h"), "");
  EXPECT_NE(WhyNot("calib/methods", "calib/solve/internal/degenerate.h"), "");
  EXPECT_NE(WhyNot("calib/files", "lcm/lcm-cpp.hpp"), "");
  EXPECT_NE(WhyNot("calib/files", "lcmtypes/rgbdt/image_t.hpp"), "");
  EXPECT_NE(WhyNot("calib/fuse", "services/messages/codec.h"), "");
  EXPECT_NE(WhyNot("calib/fuse", "embree3/rtcore.h"), "");
  EXPECT_NE(WhyNot("calib/detect/cloud", "pcl/point_types.h"), "");
  EXPECT_NE(WhyNot("services/bus", "services/drivers/clock_fit.h"), "");
  EXPECT_NE(WhyNot("services/bus", "services/runtime/node.h"), "");
  EXPECT_NE(WhyNot("services/import", "zstd.h"), "");
  EXPECT_NE(WhyNot("services/bags", "calib/files/points/cloud_files.h"), "");
  EXPECT_NE(WhyNot("services/rgbdt", "viewer/server/server.h"), "");
  EXPECT_NE(WhyNot("services", "viewer/server/server.h"), "");
  EXPECT_NE(WhyNot("viewer/server", "calib/present/frames/cloud_frame.h"), "");
  EXPECT_EQ(FolderOfTarget().at("rgbdt_detect_image"), "calib/detect/image");
  EXPECT_EQ(FolderOfTarget().at("rgbdt_viewer_server"), "viewer/server");
}

}  // namespace
}  // namespace rgbdt
