#include <cstdlib>
#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <tuple>

#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "services/bags/bag_reader.h"
#include "services/bags/internal/bag_file.h"
#include "services/bags/printable.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;
using bags::BagFile;

// b_9 before b_10.
struct NaturalOrder {
  bool operator()(const std::string& a, const std::string& b) const { return NaturalLess(a, b); }
};

bool EndsIn(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

std::unique_ptr<BagReader> OpenFile(const fs::path& path) {
  const BagFile file(path);
  char first[16] = {};
  const std::string_view begin(first, file.Read(0, first, sizeof(first)));
  const auto begins = [&](std::string_view text) { return begin.substr(0, text.size()) == text; };
  if (begins("\x89MCAP0\r\n")) return bags::OpenMcap(path);
  if (begins(std::string_view("SQLite format 3\0", 16))) return bags::OpenSqlite(path);
  if (begins("#ROSBAG V2.0\n")) return bags::OpenRos1(path);
  if (begins("#ROSBAG V")) {
    throw InputError(path.string() +
                     ": is a ROS 1 bag of an older version; `rosbag fix` makes it 2.0");
  }
  if (begins("\x28\xb5\x2f\xfd")) {
    throw InputError(path.string() + ": is packed as a whole; unpack it first: unzstd " +
                     path.string());
  }
  throw InputError(path.string() +
                   ": is no bag; expected MCAP, a ROS 2 bag (.db3) or a ROS 1 bag (.bag)");
}

const std::vector<std::string> kEndings = {".mcap", ".db3", ".bag"};

// Of a bag's name, packed as a whole or not; empty: it is none's.
std::string EndingOf(const std::string& name) {
  for (const std::string& ending : kEndings) {
    if (EndsIn(name, ending) || (ending != ".bag" && EndsIn(name, ending + ".zstd"))) return ending;
  }
  return "";
}

// Takes out what a tool left of a bag that is there, too: unzstd the packed one, `rosbag fix` and
// `reindex` the one before.
void DropEarlier(std::set<std::string, NaturalOrder>* names) {
  for (const std::string& ending : {std::string(".orig.bag"), std::string(".zstd")}) {
    for (auto it = names->begin(); it != names->end();) {
      const std::string whole = EndsIn(*it, ending) ? it->substr(0, it->size() - ending.size()) +
                                                          (ending == ".zstd" ? "" : ".bag")
                                                    : "";
      it = names->count(whole) != 0 ? names->erase(it) : std::next(it);
    }
  }
}

// What stands in the lines of ROS 2's metadata.yaml, without dashes, quotes and blanks around.
std::vector<std::string> MetadataLines(const fs::path& folder) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  std::vector<std::string> stripped;
  std::error_code ignored;
  if (!fs::exists(folder / "metadata.yaml", ignored)) return stripped;
  const BagFile file(folder / "metadata.yaml");
  std::string text(kMostBytes, '\0');
  text.resize(file.Read(0, text.data(), text.size()));
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin = line.find_first_not_of(" -\"'"),
                      end = line.find_last_not_of(" \"'\r");
    if (begin != std::string::npos) stripped.push_back(line.substr(begin, end + 1 - begin));
  }
  return stripped;
}

// The names that it lists as the recording's.
std::set<std::string> Listed(const fs::path& folder) {
  std::set<std::string> names;
  for (const std::string& line : MetadataLines(folder)) {
    names.insert(fs::path(line).filename().string());
  }
  return names;
}

// Of a part what metadata.yaml tells; 0: it does not say.
struct Recorded {
  double begin_s = 0, length_s = 0;  // since 1970; how long
};

// The value of "key: value"; empty: the line has another key.
std::string ValueOf(const std::string& line, const std::string& key) {
  if (line.compare(0, key.size() + 2, key + ": ") != 0) return "";
  return line.substr(line.find_first_not_of(" \"'", key.size() + 1));
}

// Those that it lists, by name; the recording itself has none.
std::map<std::string, Recorded, NaturalOrder> ListedParts(const fs::path& folder) {
  std::map<std::string, Recorded, NaturalOrder> parts = {{"", {}}};
  std::string current;  // names that are no path's have no times behind them
  for (const std::string& line : MetadataLines(folder)) {
    const std::string path = ValueOf(line, "path");
    const std::string name = fs::path(path.empty() ? line : path).filename().string();
    if (!path.empty()) current = name;
    if (!EndingOf(name).empty()) parts[name];
    Recorded& recorded = parts[current];
    const std::string begin = ValueOf(line, "nanoseconds_since_epoch"),
                      length = ValueOf(line, "nanoseconds");
    if (!begin.empty()) recorded.begin_s = 1e-9 * std::strtod(begin.c_str(), nullptr);
    if (!length.empty()) recorded.length_s = 1e-9 * std::strtod(length.c_str(), nullptr);
  }
  return parts;
}

// What metadata.yaml lists and is not there, and what time is lost by it; empty: nothing.
std::string MissingParts(const fs::path& folder) {
  constexpr std::size_t kMostNamed = 5;
  const std::map<std::string, Recorded, NaturalOrder> parts = ListedParts(folder);
  std::size_t there = 0, missing = 0;
  double lost_s = 0;
  bool all_told = true;
  std::string names;
  for (const auto& [name, recorded] : parts) {
    if (EndingOf(name).empty()) continue;
    const std::string bare = EndsIn(name, ".zstd") ? name.substr(0, name.size() - 5) : name;
    std::error_code ignored;
    if (fs::exists(folder / bare, ignored) || fs::exists(folder / (bare + ".zstd"), ignored)) {
      ++there;
      continue;
    }
    lost_s += recorded.length_s;
    all_told &= recorded.length_s > 0;
    if (++missing > kMostNamed) continue;
    names += (missing == 1 ? "" : ", ") + Printable(name);
    if (recorded.length_s > 0) {
      names += Format(" (%.1f to %.1f s)", recorded.begin_s - parts.at("").begin_s,
                      recorded.begin_s + recorded.length_s - parts.at("").begin_s);
    }
  }
  if (missing == 0 || there == 0) return "";  // of another recording, or renamed
  if (missing > kMostNamed) names += Format(" and %zu more", missing - kMostNamed);
  return (folder / "metadata.yaml").string() +
         ": lists parts of the recording that are not there: " + names + "; " +
         (all_told ? Format("%.1f s of it are missing", lost_s) : "their time is missing") +
         "; put them beside the others";
}

// Several kinds are one recording twice, as after a conversion, or no recording: metadata.yaml may
// say which is.
void RequireOneKind(const fs::path& folder, std::set<std::string, NaturalOrder>* names) {
  const auto kinds = [&] {
    std::map<std::string, int> counts;
    for (const std::string& name : *names) ++counts[EndingOf(name)];
    return counts;
  };
  if (kinds().size() == 1) return;
  std::string found;
  for (const auto& [ending, count] : kinds()) {
    found += (found.empty() ? "" : ", ") + std::to_string(count) + " " + ending;
  }
  const std::set<std::string> listed = Listed(folder);
  for (auto it = names->begin(); it != names->end();) {
    it = listed.count(*it) == 0 ? names->erase(it) : std::next(it);
  }
  if (kinds().size() == 1) return;
  throw InputError(folder.string() + ": holds bags of several kinds (" + found +
                   "), which may be one recording twice; name one of the files, or move those of "
                   "one kind into a folder of their own");
}

// A folder's bags, as ROS 2 records one: NAME_0.mcap, NAME_1.mcap, ...
std::vector<fs::path> FilesOf(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return {path};
  std::set<std::string, NaturalOrder> names;
  for (fs::directory_iterator it(path, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (!EndingOf(name).empty()) names.insert(name);
  }
  if (error) throw InputError("cannot read " + path.string() + ": " + error.message());
  if (names.empty()) {
    throw InputError(path.string() + ": holds no bag; expected .mcap, .db3 or .bag files");
  }
  DropEarlier(&names);
  RequireOneKind(path, &names);
  std::vector<fs::path> files;
  files.reserve(names.size());
  for (const std::string& name : names) files.push_back(path / name);
  return files;
}

// One file after the other as one bag.
class SplitReader : public BagReader {
 public:
  SplitReader(const std::vector<fs::path>& files, const std::string& problem) {
    if (!problem.empty()) problems_.push_back(problem);
    for (const fs::path& file : files) {
      parts_.push_back({OpenFile(file), {}});
      size_ += parts_.back().reader->size();
    }
  }

  bool Next(BagMessage* message) override {
    for (; current_ < parts_.size(); ++current_) {
      BagReader& reader = *parts_[current_].reader;
      const bool found = reader.Next(message);
      MapTopics();
      if (found) {
        ToBag(message);
        return true;
      }
      problems_.insert(problems_.end(), reader.problems().begin(), reader.problems().end());
      before_ += reader.size();
      reader.Rest();
    }
    return false;
  }

  BagMessage Read(const BagPlace& place) override {
    const auto part = static_cast<std::size_t>(place.file);
    if (current_ < parts_.size() && part != current_) parts_[current_].reader->Rest();
    current_ = part;
    BagMessage message = parts_.at(part).reader->Read(place);
    ToBag(&message);
    return message;
  }

  void Rest() override {
    for (const Part& part : parts_) part.reader->Rest();
  }
  const std::vector<BagTopic>& topics() const override { return topics_.topics(); }
  const std::vector<std::string>& problems() const override { return problems_; }
  std::int64_t position() const override {
    return current_ < parts_.size() ? before_ + parts_[current_].reader->position() : size_;
  }
  std::int64_t size() const override { return size_; }
  std::string format() const override { return parts_[0].reader->format(); }

 private:
  struct Part {
    std::unique_ptr<BagReader> reader;
    std::vector<std::size_t> topic_of;  // ours, of each of its topics
  };

  void MapTopics() {
    Part& part = parts_[current_];
    while (part.topic_of.size() < part.reader->topics().size()) {
      const BagTopic& topic = part.reader->topics()[part.topic_of.size()];
      part.topic_of.push_back(topics_.Add(topic.name, topic.type, topic.encoding));
    }
  }

  void ToBag(BagMessage* message) const {
    message->topic = parts_[current_].topic_of[message->topic];
    message->place.file = static_cast<std::int32_t>(current_);
  }

  std::vector<Part> parts_;
  std::size_t current_ = 0;
  std::int64_t before_ = 0, size_ = 0;
  bags::TopicList topics_;
  std::vector<std::string> problems_;
};

}  // namespace

bool operator<(const BagPlace& a, const BagPlace& b) {
  return std::tie(a.file, a.at, a.within) < std::tie(b.file, b.at, b.within);
}

std::unique_ptr<BagReader> OpenBag(const fs::path& path) {
  const std::vector<fs::path> files = FilesOf(path);
  std::error_code ignored;
  const std::string problem = fs::is_directory(path, ignored) ? MissingParts(path) : "";
  if (files.size() == 1 && problem.empty()) return OpenFile(files[0]);
  return std::make_unique<SplitReader>(files, problem);
}

}  // namespace rgbdt
