#include "services/import/internal/topic_names.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <sstream>

#include "calib/model/text.h"

namespace rgbdt {
namespace {

constexpr std::size_t kMostParts = 16;  // of a topic's path that are looked at

// What stands between these signs.
std::vector<std::string> Divide(const std::string& text, char sign) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, sign);) {
    if (!part.empty()) parts.push_back(part);
  }
  return parts;
}

bool IsNumber(const std::string& text) {
  return std::all_of(text.begin(), text.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

// Of a-z, 0-9 and _, as the rig file has it.
std::string Plain(const std::string& part) {
  std::string name;
  for (const char c : ToLower(part)) {
    name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  }
  return name;
}

}  // namespace

TopicParts SplitTopic(std::string name, bool compressed) {
  static const std::set<std::string> image_words = {
      "image", "images", "img", "raw",   "color",     "colour",     "mono",       "gray",
      "grey",  "rect",   "bgr", "bayer", "rectified", "compressed", "temperature"};
  for (const char* transport : {"/compressed", "/compressedDepth"}) {
    const std::string end = transport;
    if (compressed && name.size() > end.size() &&
        name.compare(name.size() - end.size(), end.size(), end) == 0) {
      name.erase(name.size() - end.size());
      break;
    }
  }
  const std::size_t slash = name.rfind('/');
  TopicParts parts;
  if (slash != std::string::npos) parts.space = name.substr(0, slash);
  parts.leaf = name.substr(slash + 1);  // of none: all of it
  for (const std::string& word : Divide(parts.leaf, '_')) {
    std::string& part = image_words.count(ToLower(word)) != 0 ? parts.images : parts.own;
    part += (part.empty() ? "" : "_") + word;
  }
  return parts;
}

std::string ShortName(const std::string& name) {
  return name.empty() ? "sensor" : name.substr(0, 28);
}

std::vector<std::string> TellApart(const std::vector<std::string>& paths) {
  std::vector<std::vector<std::string>> parts;
  std::map<std::string, std::vector<std::size_t>> alike;
  for (const std::string& path : paths) {
    parts.push_back(Divide(path, '/'));
    std::reverse(parts.back().begin(), parts.back().end());
    parts.back().resize(std::max<std::size_t>(1, parts.back().size()));
    alike[Plain(parts.back()[0])].push_back(parts.size() - 1);
  }
  static const std::set<std::string> says_nothing = {"camera", "cam", "sensor", "driver", "node"};
  std::vector<std::string> names(paths.size());
  for (const auto& [last, group] : alike) {
    std::size_t most = 1;
    for (const std::size_t i : group) {
      const bool number = IsNumber(last) && parts[i].size() > 1;
      names[i] = number ? Plain(parts[i][1]) + "_" + last : last;
    }
    for (std::size_t up = 1; most < group.size() && up < kMostParts; ++up) {
      std::set<std::string> seen;
      for (const std::size_t i : group) seen.insert(up < parts[i].size() ? parts[i][up] : "");
      if (seen.size() <= most) continue;
      most = seen.size();
      for (const std::size_t i : group) {
        const std::string part = up < parts[i].size() ? Plain(parts[i][up]) : "";
        const bool alone = says_nothing.count(last) != 0 && !IsNumber(part);
        names[i] = alone ? part : part + (part.empty() ? "" : "_") + last;
      }
    }
  }
  return names;
}

}  // namespace rgbdt
