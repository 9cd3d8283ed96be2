#include "services/messages/internal/layout.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <stdexcept>
#include <string>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

constexpr std::size_t kFingerprintBytes = 8;

struct Struct {
  std::string_view name;
  std::string_view layout;
};

// What lies within other types.
constexpr std::array<Struct, 8> kStructs = {{
    {"observation_t",
     "2q 2s q b s b 2i b 8d #num_corners num_corners*2d #num_edge_pixels num_edge_pixels*2h "
     "#num_outline num_outline*2d b #num_boundary num_boundary*3d 3d 3d 3d i 2d"},
    {"observation_v2_t",
     "observation_t d b target_pose_t 4image_side_t b target_pose_t #num_cloud_crossings "
     "num_cloud_crossings*board_crossing_t #num_candidates num_candidates*cloud_board_t"},
    {"target_pose_t", "43d b"},
    {"image_side_t", "b s #num_curve num_curve*2d 4d"},
    {"board_crossing_t", "4d 2b"},
    {"cloud_board_t",
     "#num_boundary num_boundary*3d 3d 3d 3d i b target_pose_t #num_crossings "
     "num_crossings*board_crossing_t"},
    {"board_scatter_t", "#num_crossings num_crossings*d 33d"},
    {"rgbdt_cloud_t",
     "3q b q #num_cameras num_cameras*s #num_points num_points*f num_points*f num_points*f "
     "num_points*f num_points*i num_points*b num_points*b num_points*b num_points*f num_points*f "
     "num_points*i"},
}};

std::string_view LayoutOf(std::string_view name) {
  for (const Struct& known : kStructs) {
    if (known.name == name) return known.layout;
  }
  throw std::logic_error("layout: unknown struct " + std::string(name));
}

std::uint64_t BytesOf(char type) {
  switch (type) {
    case 'q':
    case 'd':
      return 8;
    case 'i':
    case 'f':
      return 4;
    case 'h':
      return 2;
    case 'b':
      return 1;
  }
  throw std::logic_error(std::string("layout: unknown type ") + type);
}

class Walker {
 public:
  Walker(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {
    Skip(kFingerprintBytes, "the fingerprint");
  }

  void Fields(std::string_view layout) {
    while (!layout.empty()) {
      const std::size_t end = std::min(layout.find(' '), layout.size());
      if (end > 0) Token(layout.substr(0, end));
      layout.remove_prefix(std::min(end + 1, layout.size()));
    }
  }

  void End() const {
    if (at_ == size_) return;
    throw InputError("the message has " + std::to_string(size_ - at_) +
                     " bytes more than its fields take");
  }

 private:
  struct NamedCount {
    std::string_view name;
    std::uint64_t value = 0;
  };

  void Token(std::string_view token) {
    if (token.front() == '#') return ReadCount(token.substr(1));
    const std::string_view whole = token;
    std::uint64_t times = 1;
    const std::size_t star = token.find('*');
    if (star != std::string_view::npos) {
      times = Count(token.substr(0, star));
      token.remove_prefix(star + 1);
    }
    std::uint64_t repeat = 0;
    for (; std::isdigit(static_cast<unsigned char>(token.front())) != 0; token.remove_prefix(1)) {
      repeat = 10 * repeat + static_cast<std::uint64_t>(token.front() - '0');
    }
    if (repeat > 0) times *= repeat;
    if (token.size() > 1) return Structs(token, times);
    if (token.front() != 's') return Skip(times * BytesOf(token.front()), whole);
    for (std::uint64_t i = 0; i < times; ++i) SkipString();
  }

  // Every struct takes bytes, so a forged `times` soon finds none left.
  void Structs(std::string_view name, std::uint64_t times) {
    const std::string_view layout = LayoutOf(name);
    const auto counts = counts_;
    for (std::uint64_t i = 0; i < times; ++i) {
      counts_ = {};
      Fields(layout);
    }
    counts_ = counts;
  }

  std::uint64_t Count(std::string_view name) const {
    for (const NamedCount& count : counts_) {
      if (count.name == name) return count.value;
    }
    throw std::logic_error("layout: no count " + std::string(name));
  }

  // Counts fit into 31 bits and an element into 24 bytes, so nothing overflows 64.
  void Skip(std::uint64_t bytes, std::string_view what) {
    if (bytes <= size_ - at_) {
      at_ += bytes;
      return;
    }
    throw InputError("the message is cut short: " + std::string(what) + " needs " +
                     std::to_string(bytes) + " bytes at byte " + std::to_string(at_) + " of " +
                     std::to_string(size_));
  }

  std::int32_t ReadInt(std::string_view what) {
    const std::uint8_t* p = data_ + at_;
    Skip(4, what);
    return static_cast<std::int32_t>(std::uint32_t{p[0]} << 24 | std::uint32_t{p[1]} << 16 |
                                     std::uint32_t{p[2]} << 8 | std::uint32_t{p[3]});
  }

  void ReadCount(std::string_view name) {
    const std::int32_t value = ReadInt(name);
    if (value < 0) throw InputError(std::string(name) + " is " + std::to_string(value));
    NamedCount& free = *std::find_if(counts_.begin(), counts_.end(),
                                     [](const NamedCount& c) { return c.name.empty(); });
    free = {name, static_cast<std::uint64_t>(value)};
  }

  // A length that includes the closing NUL, the characters, NUL.
  void SkipString() {
    const std::int32_t length = ReadInt("a string's length");
    if (length < 1) throw InputError("a string's length is " + std::to_string(length));
    const std::uint8_t* text = data_ + at_;
    Skip(static_cast<std::uint64_t>(length), "a string");
    if (std::memchr(text, 0, static_cast<std::size_t>(length)) != text + length - 1) {
      throw InputError("a string at byte " + std::to_string(text - data_) +
                       " does not end with its only NUL");
    }
  }

  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t at_ = 0;
  std::array<NamedCount, 8> counts_;
};

}  // namespace

void CheckLayout(std::string_view layout, const std::uint8_t* data, std::size_t size) {
  Walker walker(data, size);
  walker.Fields(layout);
  walker.End();
}

}  // namespace rgbdt
