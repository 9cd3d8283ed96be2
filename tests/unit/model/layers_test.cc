// Who may know whom (DESIGN.md, "The tree"), held by reading the sources.
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

// Folders of calib/ that each folder may include, besides itself.
const std::map<std::string, std::set<std::string>>& Allowed() {
  static const std::map<std::string, std::set<std::string>> allowed = {
      {"model", {}},
      {"camera", {"model"}},
      {"scan_assembly", {"model"}},
      {"detect", {"model", "camera"}},
      {"solve", {"model", "camera"}},
      {"fuse", {"model", "camera"}},
      {"map", {"model"}},
      {"terrain", {"model"}},
      {"simulate", {"model"}},  // its own ray tables, nothing from camera/
      {"files", {"model"}},
  };
  return allowed;
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

bool StartsWith(const std::string& text, const std::string& start) {
  return text.rfind(start, 0) == 0;
}

// Why a file of calib/`folder` may not include this; empty: it may.
std::string WhyNot(const std::string& folder, const std::string& include) {
  if (StartsWith(include, "lcm")) return "calib/ knows no LCM";
  for (const char* outside : {"services/", "tests/", "viewer/"}) {
    if (StartsWith(include, outside)) return "calib/ knows nothing above it";
  }
  if (StartsWith(include, "embree") && folder != "simulate") return "Embree is simulate/'s alone";
  if (!StartsWith(include, "calib/")) return "";
  const std::string other = include.substr(6, include.find('/', 6) - 6);
  if (other == folder || Allowed().at(folder).count(other) != 0) return "";
  return "calib/" + folder + " does not know calib/" + other;
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

const fs::path kCalib = fs::path(RGBDT_SOURCE_DIR) / "calib";

TEST(Layers, EveryIncludeGoesWhereTheDesignsArrowsGo) {
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(kCalib)) {
    if (!entry.is_regular_file() || !IsSource(entry.path())) continue;
    const std::string folder = fs::relative(entry.path(), kCalib).begin()->string();
    ASSERT_EQ(Allowed().count(folder), 1U) << entry.path() << " lies in no known folder";
    for (const std::string& include : IncludesOf(ReadText(entry.path()))) {
      const std::string why = WhyNot(folder, include);
      EXPECT_EQ(why, "") << entry.path() << " includes " << include;
    }
    ++files;
  }
  EXPECT_GT(files, 20);
}

// A target that links more than it includes would carry it into every user's program.
TEST(Layers, EveryTargetLinksNoMoreThanItMayInclude) {
  int targets = 0;
  for (const auto& [folder, allowed] : Allowed()) {
    const fs::path path = kCalib / folder / "CMakeLists.txt";
    if (!fs::exists(path)) continue;
    const std::string text = ReadText(path);
    static const std::regex stage(R"(rgbdt_([a-z_]+))");
    for (std::sregex_iterator i(text.begin(), text.end(), stage), end; i != end; ++i) {
      const std::string name = (*i)[1];
      if (Allowed().count(name) == 0) continue;  // the function's own name and the like
      EXPECT_TRUE(name == folder || allowed.count(name) != 0) << path << " links rgbdt_" << name;
    }
    std::string lower = text;
    std::transform(lower.begin(), lower.end(), lower.begin(), ::tolower);
    EXPECT_EQ(lower.find("lcm"), std::string::npos) << path;
    EXPECT_TRUE(folder == "simulate" || lower.find("embree") == std::string::npos) << path;
    ++targets;
  }
  EXPECT_GE(targets, 8);
}

TEST(Layers, TheTestItselfCanFail) {
  EXPECT_THAT(IncludesOf("#include \"calib/model/rig.h\"\n  # include <lcm/lcm-cpp.hpp>\n"
                         "// the text include \"x\"\n"),
              testing::ElementsAre("calib/model/rig.h", "lcm/lcm-cpp.hpp"));
  EXPECT_EQ(WhyNot("solve", "calib/camera/camera.h"), "");
  EXPECT_NE(WhyNot("simulate", "calib/camera/lens.h"), "");
  EXPECT_NE(WhyNot("model", "calib/camera/lens.h"), "");
  EXPECT_NE(WhyNot("solve", "calib/detect/detect.h"), "");
  EXPECT_NE(WhyNot("files", "lcm/lcm-cpp.hpp"), "");
  EXPECT_NE(WhyNot("files", "lcmtypes/rgbdt/image_t.hpp"), "");
  EXPECT_NE(WhyNot("fuse", "services/bus/codec.h"), "");
  EXPECT_NE(WhyNot("fuse", "embree3/rtcore.h"), "");
}

}  // namespace
}  // namespace rgbdt
