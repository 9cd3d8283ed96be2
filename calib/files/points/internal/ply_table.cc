#include "calib/files/points/internal/ply_table.h"

#include <algorithm>

#include "calib/files/points/cloud_files.h"
#include "calib/model/errors.h"

namespace rgbdt::ply {
namespace {

using Words = std::vector<std::string_view>;

struct Type {
  std::string_view name, other_name;
  char type;
  std::size_t size;
};

constexpr Type kTypes[] = {{"char", "int8", 'I', 1},     {"uchar", "uint8", 'U', 1},
                           {"short", "int16", 'I', 2},   {"ushort", "uint16", 'U', 2},
                           {"int", "int32", 'I', 4},     {"uint", "uint32", 'U', 4},
                           {"float", "float32", 'F', 4}, {"double", "float64", 'F', 8}};

class HeaderParser {
 public:
  HeaderParser(std::string_view bytes, const std::string& where)
      : bytes_(bytes), source_{where, bytes, 0, {}, 0} {}

  void Parse() {
    if (NextLine() != "ply") {
      throw InputError(source_.where + ": is not a PLY file: its first line is not \"ply\"");
    }
    while (!ended_) TakeLine(NextLine());
    if (format_.empty()) Fail("the header has no format; expected ascii or binary_little_endian");
    if (elements_ == 0) Fail("the header has no element vertex");
    if (source_.fields.empty()) Fail("the element vertex has no properties");
    if (source_.count == 0) throw InputError(source_.where + ": holds no points");
    source_.data_begin = at_;
  }

  bool ascii() const { return format_ == "ascii"; }
  records::Source& source() { return source_; }
  std::vector<std::string>& comments() { return comments_; }

 private:
  std::string_view NextLine() {
    line_begin_ = at_;
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos) {
      if (at_ == 0) return {};
      Fail("the header is cut short; expected end_header");
    }
    std::string_view line = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  }

  void TakeLine(std::string_view line) {
    const Words words = records::Words(line);
    const std::string_view key = words.empty() ? std::string_view() : words[0];
    if (key == "comment" || key == "obj_info") {
      comments_.emplace_back(line.substr(std::min(line.size(), line.find(key) + key.size() + 1)));
    } else if (key == "format") {
      TakeFormat(words);
    } else if (key == "element") {
      TakeElement(words);
    } else if (key == "property") {
      TakeProperty(words);
    } else if (key == "end_header") {
      ended_ = true;
    } else {
      Fail("\"" + std::string(key.substr(0, 40)) +
           "\"; expected format, comment, element, property or end_header");
    }
  }

  void TakeFormat(const Words& words) {
    format_ = words.size() > 1 ? std::string(words[1]) : "";
    if (format_ == "ascii" || format_ == "binary_little_endian") return;
    Fail("format is \"" + format_.substr(0, 40) + "\"; expected ascii or binary_little_endian");
  }

  void TakeElement(const Words& words) {
    ++elements_;
    if (elements_ > 1) return;
    if (words.size() != 3 || words[1] != "vertex") Fail("expected element vertex, with its number");
    if (!records::ParseNumber(words[2], &source_.count) || source_.count > records::kMaxRecords) {
      Fail("the number of vertices is \"" + std::string(words[2].substr(0, 40)) +
           "\"; expected a whole number up to " + std::to_string(records::kMaxRecords));
    }
  }

  void TakeProperty(const Words& words) {
    if (elements_ == 0) Fail("a property before the first element");
    if (elements_ > 1) return;
    if (words.size() != 3) Fail("expected property, one type and a name; vertices have no lists");
    for (const Type& type : kTypes) {
      if (words[1] != type.name && words[1] != type.other_name) continue;
      source_.fields.push_back({std::string(words[2]), type.type, type.size, 1});
      return;
    }
    Fail("property " + std::string(words[2].substr(0, 40)) + " is of type \"" +
         std::string(words[1].substr(0, 40)) + "\"; expected char to uint, float or double");
  }

  [[noreturn]] void Fail(const std::string& what) const {
    throw InputError(source_.where + ": PLY header, " + records::LineOf(bytes_, line_begin_) +
                     ": " + what);
  }

  std::string_view bytes_;
  records::Source source_;
  std::size_t at_ = 0, line_begin_ = 0;
  std::string format_;
  int elements_ = 0;
  bool ended_ = false;
  std::vector<std::string> comments_;
};

}  // namespace

void CheckSweepHead(std::string_view head, const std::string& where) {
  HeaderParser header(head, where);
  header.Parse();
  const std::size_t points = header.source().count;
  if (points <= kMostSweepPoints) return;
  throw InputError(where + ": PLY header: a sweep of " + std::to_string(points) +
                   " points; expected at most " + std::to_string(kMostSweepPoints));
}

File Parse(std::string_view bytes, const std::string& where) {
  HeaderParser header(bytes, where);
  header.Parse();
  records::Source source = std::move(header.source());
  return {std::move(header.comments()), header.ascii()
                                            ? records::Table::FromAscii(std::move(source))
                                            : records::Table::FromBinary(std::move(source))};
}

}  // namespace rgbdt::ply
