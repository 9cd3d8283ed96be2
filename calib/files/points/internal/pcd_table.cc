#include "calib/files/points/internal/pcd_table.h"

#include <liblzf/lzf.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "calib/files/points/cloud_files.h"
#include "calib/model/errors.h"
#include "calib/model/printable.h"

namespace rgbdt::pcd {
namespace {

using records::Field;
using records::kMaxRecords;
using Words = std::vector<std::string_view>;

constexpr std::size_t kMaxCount = 100'000;

bool IsKey(std::string_view word) {
  for (const char* key : {"VERSION", "FIELDS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT",
                          "VIEWPOINT", "POINTS", "DATA"}) {
    if (word == key) return true;
  }
  return false;
}

class HeaderParser {
 public:
  HeaderParser(std::string_view bytes, const std::string& where) : bytes_(bytes), where_(where) {}

  Header Parse() {
    std::size_t at = 0;
    while (at < bytes_.size() && header_.data.empty()) {
      line_begin_ = at;
      const std::size_t end = std::min(bytes_.find('\n', at), bytes_.size());
      const std::string_view line = bytes_.substr(at, end - at);
      at = std::min(end + 1, bytes_.size());
      header_.data_begin = at;
      if (!line.empty() && line.front() == '#') {
        header_.comments.emplace_back(line.substr(1));
      } else {
        TakeLine(records::Words(line));
      }
    }
    CheckData();
    DropEmptyFields();
    CheckFields();
    CheckPoints();
    return std::move(header_);
  }

 private:
  void TakeLine(const Words& words) {
    if (words.empty() || words[0].front() == '#') return;
    const std::string_view key = words[0];
    if (!IsKey(key)) {
      Fail(Line() + ": is not a PCD file, or its header is damaged at \"" +
           PrintableText(key.substr(0, 40)) + "\"");
    }
    if (words.size() < 2) Fail("PCD header, " + Line() + ": " + std::string(key) + " is empty");
    if (key == "FIELDS") {
      header_.fields.clear();
      for (std::size_t i = 1; i < words.size(); ++i) {
        header_.fields.push_back({std::string(words[i])});
      }
    } else if (key == "SIZE" || key == "TYPE" || key == "COUNT") {
      TakePerField(words);
    } else if (key == "WIDTH") {
      header_.width = Whole(words[1], "WIDTH", kMaxRecords);
    } else if (key == "HEIGHT") {
      header_.height = Whole(words[1], "HEIGHT", kMaxRecords);
    } else if (key == "POINTS") {
      points_ = Whole(words[1], "POINTS", kMaxRecords);
    } else if (key == "DATA") {
      header_.data = std::string(words[1]);
    }
  }

  void TakePerField(const Words& words) {
    if (words.size() != header_.fields.size() + 1) {
      Fail("PCD header, " + Line() + ": " + std::string(words[0]) + " has " +
           std::to_string(words.size() - 1) + " entries for " +
           std::to_string(header_.fields.size()) + " FIELDS");
    }
    for (std::size_t i = 1; i < words.size(); ++i) {
      Field& field = header_.fields[i - 1];
      if (words[0] == "SIZE") {
        field.size = Whole(words[i], "SIZE", 8);
      } else if (words[0] == "COUNT") {
        field.count = Whole(words[i], "COUNT", kMaxCount);
      } else {
        field.type = words[i].front();
      }
    }
  }

  void CheckData() const {
    if (header_.data == "ascii" || header_.data == "binary" ||
        header_.data == "binary_compressed") {
      return;
    }
    Fail(header_.data.empty()
             ? "is not a PCD file: its header has no DATA line"
             : "PCD header, " + Line() + ": DATA is \"" + header_.data.substr(0, 40) +
                   "\"; expected ascii, binary or binary_compressed");
  }

  // Padding of no bytes, as PCL writes it between fields that follow each other.
  void DropEmptyFields() {
    auto& fields = header_.fields;
    fields.erase(std::remove_if(fields.begin(), fields.end(),
                                [](const Field& field) { return field.count == 0; }),
                 fields.end());
  }

  void CheckFields() const {
    if (header_.fields.empty()) Fail("PCD header: no FIELDS");
    for (const Field& field : header_.fields) {
      if (IsKnown(field)) continue;
      Fail("PCD header: field " + field.name + " has TYPE " + field.type + ", SIZE " +
           std::to_string(field.size) + " and COUNT " + std::to_string(field.count) +
           "; expected F with 4 or 8, I or U with 1, 2, 4 or 8");
    }
  }

  void CheckPoints() {
    if (header_.height == 0 && header_.width > 0) header_.height = 1;
    if (header_.width == 0 && header_.height <= 1 && points_) {
      header_.width = *points_;
      header_.height = 1;
    }
    if (points_ && header_.points() != *points_) {
      Fail("PCD header: WIDTH " + std::to_string(header_.width) + " times HEIGHT " +
           std::to_string(header_.height) + " is not POINTS " + std::to_string(*points_));
    }
    if (header_.points() == 0) Fail("holds no points");
    if (header_.points() > kMaxRecords) Fail("PCD header: too many points");
  }

  std::size_t Whole(std::string_view word, const std::string& key, std::size_t most) const {
    std::size_t value = 0;
    if (!records::ParseNumber(word, &value) || value > most) {
      Fail("PCD header, " + Line() + ": " + key + " is \"" + std::string(word.substr(0, 40)) +
           "\"; expected a whole number up to " + std::to_string(most));
    }
    return value;
  }

  std::string Line() const { return records::LineOf(bytes_, line_begin_); }
  [[noreturn]] void Fail(const std::string& what) const { throw InputError(where_ + ": " + what); }

  std::string_view bytes_;
  const std::string& where_;
  std::size_t line_begin_ = 0;
  std::optional<std::size_t> points_;
  Header header_;
};

std::uint32_t LoadU32(std::string_view bytes) {
  std::uint32_t value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

std::string Unpack(std::string_view data, const std::string& where) {
  const auto fail = [&](const std::string& what) { throw InputError(where + ": " + what); };
  if (data.size() < 8) fail("is cut short: the compressed points are missing");
  const std::uint32_t packed = LoadU32(data);
  const std::uint32_t size = LoadU32(data.substr(4));
  data.remove_prefix(8);
  if (data.size() < packed) {
    fail("is cut short: " + std::to_string(packed) + " compressed bytes are announced, " +
         std::to_string(data.size()) + " are there");
  }
  // LZF makes at most 264 bytes of 3: more is a forged length.
  if (size > std::size_t{packed} * 100) fail("is damaged: its unpacked length cannot be true");
  std::string unpacked(size, '\0');
  if (lzf_decompress(data.data(), packed, unpacked.data(), size) != size) {
    fail("is damaged: its points cannot be unpacked");
  }
  return unpacked;
}

records::Table Read(const Header& header, std::string_view bytes, const std::string& where) {
  records::Source source{where, bytes, header.data_begin, header.fields, header.points()};
  if (header.data == "ascii") return records::Table::FromAscii(std::move(source));
  if (header.data == "binary") return records::Table::FromBinary(std::move(source));
  return records::Table::FromColumns(std::move(source),
                                     Unpack(bytes.substr(header.data_begin), where));
}

}  // namespace

void CheckSweepHead(std::string_view head, const std::string& where) {
  const std::size_t points = HeaderParser(head, where).Parse().points();
  if (points <= kMostSweepPoints) return;
  throw InputError(where + ": PCD header: a sweep of " + std::to_string(points) +
                   " points; expected at most " + std::to_string(kMostSweepPoints));
}

File Parse(std::string_view bytes, const std::string& where) {
  Header header = HeaderParser(bytes, where).Parse();
  records::Table table = Read(header, bytes, where);
  return {std::move(header), std::move(table)};
}

}  // namespace rgbdt::pcd
