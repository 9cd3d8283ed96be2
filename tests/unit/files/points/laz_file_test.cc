#include "calib/files/points/internal/laz_file.h"

#include <random>
#include <set>
#include <tuple>

#include "calib/files/points/internal/laz_chunk.h"
#include "calib/files/points/internal/laz_gps_times.h"
#include "calib/files/points/internal/laz_integers.h"
#include "calib/files/points/internal/octree.h"
#include "tests/unit/files/points/laz_decoder.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt::laz {
namespace {

using test::DecodeLazChunk;
using test::LazDecoder;
using test::LazIntegers;
using test::LazTimes;
using ::testing::Contains;
using ::testing::Key;
using Place = std::array<std::int32_t, 3>;
using Engine = std::mt19937;

constexpr std::size_t kRecord = 36 + 12;
constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();

template <typename T>
void Set(std::size_t at, T value, std::string* record) {
  std::memcpy(record->data() + at, &value, sizeof value);
}

template <typename T>
T Get(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

std::string Record(Place place, std::uint16_t intensity, double time, std::array<int, 3> rgb,
                   std::array<std::uint32_t, 3> extra) {
  std::string record(kRecord, '\0');
  Set(0, place, &record);
  Set(kIntensityAt, intensity, &record);
  Set<std::uint8_t>(kFlagsAt, 0x11, &record);
  Set(kGpsTimeAt, time, &record);
  for (std::size_t c = 0; c < 3; ++c) {
    Set(kColourAt + 2 * c, static_cast<std::uint16_t>(rgb[c]), &record);
  }
  Set(kExtraAt, extra, &record);
  return record;
}

// Anything, as far as the format goes.
std::string WildRecord(Engine* engine) {
  const auto any = [&] { return static_cast<std::uint32_t>((*engine)()); };
  const auto place = [&] {
    const std::uint32_t kind = any() % 8;
    return kind == 0 ? kLeast : kind == 1 ? kMost : static_cast<std::int32_t>(any() >> kind);
  };
  const auto colour = [&] { return static_cast<int>(any() % 3 == 0 ? any() & 0xffff : 257); };
  const std::uint32_t kind = any() % 4;
  const double time = kind == 0 ? 1e8 : kind == 1 ? any() * 1e3 : kind == 2 ? -1.0 * any() : 0.0;
  return Record({place(), place(), place()}, static_cast<std::uint16_t>(any()), time,
                {colour(), colour(), colour()}, {any(), any() % 2, 7});
}

std::string WildRecords(std::size_t count) {
  Engine engine(1);
  std::string records;
  for (std::size_t i = 0; i < count; ++i) records += WildRecord(&engine);
  return records;
}

las::Layout LayoutOf(const std::string& records) {
  las::Layout layout;
  layout.points = records.size() / kRecord;
  layout.step_m = 1e-4;
  layout.least.setConstant(-1);
  layout.most.setConstant(1);
  layout.extra.resize(3, {"name", "what", las::ExtraDimension::Type::kFloat});
  return layout;
}

std::string Joined(const Parts& parts) {
  std::string file;
  for (const std::string& part : parts) file += part;
  return file;
}

// Sizes of chunks, with the counts of points where they vary.
std::vector<std::pair<std::uint32_t, std::uint32_t>> ReadChunkTable(const std::string& file,
                                                                    bool counts) {
  const auto at = Get<std::uint64_t>(file, Get<std::uint32_t>(file, 96));
  EXPECT_EQ(Get<std::uint32_t>(file, at), 0U) << "its version";
  std::vector<std::pair<std::uint32_t, std::uint32_t>> table(Get<std::uint32_t>(file, at + 4));
  LazDecoder decoder(file.substr(at + 8));
  LazIntegers integers;
  std::int32_t points = 0, bytes = 0;
  for (auto& entry : table) {
    if (counts) points = integers.Next(points, 0, &decoder);
    bytes = integers.Next(bytes, 1, &decoder);
    entry = {static_cast<std::uint32_t>(points), static_cast<std::uint32_t>(bytes)};
  }
  return table;
}

TEST(LazFile, SymbolsBitsAndRawBitsComeBack) {
  Engine engine(2);
  std::vector<SymbolModel> models;
  std::vector<LazDecoder::Symbols> decoded;
  for (const std::uint32_t symbols : {2, 3, 16, 17, 128, 515, 2048}) {
    models.emplace_back(symbols);
    decoded.emplace_back(symbols);
  }
  BitModel bit;
  ArithmeticEncoder encoder;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> kinds;
  for (int i = 0; i < 100'000; ++i) {
    const auto kind = static_cast<std::uint32_t>(engine() % 40);
    // Mostly the same symbol for a while, then another one: models grow sure and are wrong.
    auto value = static_cast<std::uint32_t>(engine() % 16 == 0 ? engine() : i / 5000);
    if (kind < models.size()) {
      encoder.Encode(value %= models[kind].Symbols(), &models[kind]);
    } else if (kind < 8) {
      encoder.EncodeBit((value %= 2) == 1, &bit);
    } else {
      const std::uint32_t bits = kind - 7;
      if (bits < 32) value &= (1U << bits) - 1;
      encoder.EncodeRaw(bits, value);
    }
    kinds.emplace_back(kind, value);
  }
  LazDecoder decoder(encoder.Finish());
  LazDecoder::Bits decoded_bit;
  for (const auto& [kind, value] : kinds) {
    ASSERT_EQ(kind < decoded.size() ? decoder.Symbol(&decoded[kind])
              : kind < 8            ? (decoder.Bit(&decoded_bit) ? 1U : 0U)
                                    : decoder.Raw(kind - 7),
              value);
  }
}

TEST(LazFile, IntegersComeBackFromEveryPrediction) {
  std::vector<std::int32_t> values = {0, kLeast, kMost};
  for (int bit = 0; bit < 31; ++bit) {
    for (const std::int32_t off : {-1, 0, 1}) {
      values.push_back((1 << bit) + off);
      values.push_back(-(1 << bit) + off);
    }
  }
  for (const std::uint32_t bits : {16U, 32U}) {
    IntegerModel model(bits, 3);
    ArithmeticEncoder encoder;
    const auto held = [&](std::int32_t value) { return bits == 16 ? value & 0xffff : value; };
    for (const std::int32_t a : values) {
      for (const std::int32_t b : values) model.Encode(held(a), held(b), a & 1 ? 2 : 0, &encoder);
    }
    LazDecoder decoder(encoder.Finish());
    LazIntegers integers(bits);
    for (const std::int32_t a : values) {
      for (const std::int32_t b : values) {
        ASSERT_EQ(integers.Next(held(a), a & 1 ? 2 : 0, &decoder), held(b)) << a << " " << b;
      }
    }
  }
}

TEST(LazFile, TimesComeBackByEveryKindOfStep) {
  Engine engine(3);
  constexpr std::int64_t begin = std::int64_t{0x41b6e3a5} << 32;
  std::vector<std::int64_t> times = {begin};
  const std::int64_t steps[] = {1000, 1000, 1000, 1000, 0, 2000, 700'000, -1000, -20'000, 37};
  for (int i = 0; i < 20'000; ++i) {
    const auto kind = engine() % 12;
    if (kind < 10)
      times.push_back(times.back() + steps[kind] * (1 + static_cast<int>(engine() % 9)));
    if (kind == 10) times.push_back(times[engine() % times.size()]);  // an earlier run goes on
    if (kind == 11) times.push_back(static_cast<std::int64_t>(engine()) << (engine() % 33));
    if (engine() % 500 == 0) times.insert(times.end(), {kLeast, kMost, -begin, begin, 0, -1});
  }
  times.erase(std::unique(times.begin(), times.end()), times.end());
  GpsTimes gps(times[0]);
  ArithmeticEncoder encoder;
  for (std::size_t i = 1; i < times.size(); ++i) gps.Encode(times[i], &encoder);
  LazDecoder decoder(encoder.Finish());
  LazTimes decoded(times[0]);
  for (std::size_t i = 1; i < times.size(); ++i) ASSERT_EQ(decoded.Next(&decoder), times[i]) << i;
  for (const int multiple : {0, 1, 2, 9, 10, 70, 500, -1, -9, -10}) {
    EXPECT_THAT(decoded.seen, Contains(Key(multiple))) << "the test lacks it";
  }
}

TEST(LazFile, AChunkComesBackToTheBit) {
  for (const std::size_t count : {1, 2, 3, 1000, 20'000}) {
    const std::string records = WildRecords(count);
    const std::string chunk = EncodeChunk(records, kRecord);
    EXPECT_EQ(chunk.substr(0, kRecord), records.substr(0, kRecord));
    EXPECT_EQ(Get<std::uint32_t>(chunk, kRecord), count);
    EXPECT_TRUE(DecodeLazChunk(chunk, kRecord) == records) << count;
  }
  std::string same;
  for (int i = 0; i < 3000; ++i) same += Record({1, 2, 3}, 9, 1e8, {257, 514, 0}, {1, 2, 3});
  const std::string chunk = EncodeChunk(same, kRecord);
  EXPECT_TRUE(DecodeLazChunk(chunk, kRecord) == same);
  for (std::size_t layer = 2; layer < 10 + 12; ++layer) {
    EXPECT_EQ(Get<std::uint32_t>(chunk, kRecord + 4 + 4 * layer), 0U) << layer << ": never changes";
  }
}

TEST(LazFile, AWrongByteIsNotTakenForRight) {
  const std::string records = WildRecords(500);
  std::string chunk = EncodeChunk(records, kRecord);
  const std::size_t layers = kRecord + 4 + 4 * (10 + 12);
  chunk[layers + 5] ^= 0x10;
  EXPECT_FALSE(DecodeLazChunk(chunk, kRecord) == records);
}

TEST(LazFile, PointsOfOtherKindsAreRefused) {
  for (const std::size_t at : {kFlagsAt, kFlagsAt + 1, kFlagsAt + 2, kGpsTimeAt - 1}) {
    std::string records = WildRecords(2);
    records[kRecord + at] ^= 0x22;
    EXPECT_THROW(EncodeChunk(records, kRecord), std::invalid_argument) << at;
  }
  std::string second_return = WildRecords(1);
  second_return[kFlagsAt] = 0x22;
  EXPECT_THROW(EncodeChunk(second_return, kRecord), std::invalid_argument);
}

TEST(LazFile, ChunksHaveFiftyThousandPoints) {
  for (const std::size_t count : {std::size_t{1}, kChunkPoints, kChunkPoints + 1}) {
    const std::string records = WildRecords(count);
    const std::string file = Joined(LazFile(LayoutOf(records), records));
    EXPECT_EQ(static_cast<std::uint8_t>(file[104]), 0x87) << "format 7, compressed";
    const auto table = ReadChunkTable(file, false);
    ASSERT_EQ(table.size(), (count + kChunkPoints - 1) / kChunkPoints);
    std::size_t at = Get<std::uint32_t>(file, 96) + 8;
    std::string decoded;
    for (const auto& [points, bytes] : table) {
      decoded += DecodeLazChunk(file.substr(at, bytes), kRecord);
      at += bytes;
    }
    EXPECT_EQ(at, Get<std::uint64_t>(file, Get<std::uint32_t>(file, 96)));
    EXPECT_TRUE(decoded == records) << count;
  }
}

std::vector<Place> Room(std::size_t count) {
  Engine engine(4);
  std::vector<Place> points(count);
  for (Place& point : points) {
    for (std::int32_t& x : point) x = static_cast<std::int32_t>(engine() % 60'000) - 20'000;
    point[engine() % 3] = -20'000;  // walls
  }
  return points;
}

TEST(LazFile, EveryPointIsInOneNodeThatHoldsIt) {
  const std::vector<Place> points = Room(60'000);
  const OctreeSettings settings{500, 20};
  const Octree octree = MakeOctree(points, settings);
  std::vector<int> seen(points.size());
  std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>> keys;
  std::uint32_t deepest = 0;
  for (const Octree::Node& node : octree.nodes) {
    ASSERT_FALSE(node.points.empty());
    EXPECT_TRUE(std::is_sorted(node.points.begin(), node.points.end()));
    EXPECT_TRUE(keys.emplace(node.level, node.at[0], node.at[1], node.at[2]).second);
    deepest = std::max(deepest, node.level);
    if (node.level > 0) {
      EXPECT_TRUE(keys.count({node.level - 1, node.at[0] / 2, node.at[1] / 2, node.at[2] / 2}));
    }
    const std::int64_t side = octree.side >> node.level;
    EXPECT_EQ(side << node.level, octree.side);
    for (const std::uint32_t point : node.points) {
      ++seen[point];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int64_t within = points[point][axis] - octree.least[axis] - side * node.at[axis];
        ASSERT_TRUE(within >= 0 && within < side) << node.level;
      }
    }
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(points.size()));
  EXPECT_GT(deepest, 0U);
}

TEST(LazFile, ACoarseNodeHasOnePointACell) {
  const std::vector<Place> points = Room(60'000);
  const Octree octree = MakeOctree(points, {500, 0});
  std::set<std::tuple<std::int64_t, std::int64_t, std::int64_t>> cells;
  for (const std::uint32_t i : octree.nodes[0].points) {
    const auto cell = [&](std::size_t axis) {
      return (points[i][axis] - octree.least[axis]) * kCellsAlong / octree.side;
    };
    EXPECT_TRUE(cells.emplace(cell(0), cell(1), cell(2)).second);
  }
  EXPECT_GT(cells.size(), 1000U);
}

TEST(LazFile, PointsInOnePlaceEndTheDivision) {
  std::vector<Place> points(3000, Place{5, 5, 5});
  const OctreeSettings settings{100, 10};
  EXPECT_EQ(MakeOctree(points, settings).nodes.size(), 1U);
  points.push_back({kMost, kMost, kMost});
  points.push_back({kLeast, kLeast, kLeast});
  const Octree octree = MakeOctree(points, settings);
  std::size_t held = 0;
  for (const Octree::Node& node : octree.nodes) held += node.points.size();
  EXPECT_EQ(held, points.size());
  EXPECT_LE(octree.nodes.back().level, 32U);
}

TEST(LazFile, CopcSaysWhereEachNodeIs) {
  const std::string records = WildRecords(50'000);
  const std::string file = Joined(CopcFile(LayoutOf(records), records));
  EXPECT_EQ(file.substr(377, 4), "copc");
  EXPECT_EQ(Get<std::uint16_t>(file, 393), 1);
  const std::size_t info = 375 + 54;
  const auto hierarchy = Get<std::uint64_t>(file, info + 40);
  const auto bytes = Get<std::uint64_t>(file, info + 48);
  EXPECT_EQ(Get<std::uint64_t>(file, 235), hierarchy - 60) << "the extended record";
  EXPECT_EQ(hierarchy + bytes, file.size());
  const auto table = ReadChunkTable(file, true);
  ASSERT_EQ(table.size(), bytes / 32);
  EXPECT_GT(table.size(), 1U);
  std::uint64_t at = Get<std::uint32_t>(file, 96) + 8;
  std::multiset<std::string> decoded, given;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const std::size_t entry = hierarchy + 32 * i;
    EXPECT_EQ(Get<std::uint64_t>(file, entry + 16), at);
    EXPECT_EQ(Get<std::uint32_t>(file, entry + 24), table[i].second);
    EXPECT_EQ(Get<std::uint32_t>(file, entry + 28), table[i].first);
    const std::string node = DecodeLazChunk(file.substr(at, table[i].second), kRecord);
    EXPECT_EQ(node.size(), table[i].first * kRecord);
    for (std::size_t p = 0; p < node.size(); p += kRecord) decoded.insert(node.substr(p, kRecord));
    at += table[i].second;
  }
  for (std::size_t p = 0; p < records.size(); p += kRecord)
    given.insert(records.substr(p, kRecord));
  EXPECT_TRUE(decoded == given);
}

}  // namespace
}  // namespace rgbdt::laz
