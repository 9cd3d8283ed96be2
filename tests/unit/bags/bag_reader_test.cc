#include "services/bags/bag_reader.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zlib.h>
#include <zstd.h>

#include <fstream>
#include <random>

#include "calib/files/atomic_file.h"
#include "calib/model/errors.h"
#include "tests/unit/bags/bag_bytes.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using test::Little;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

struct Seen {
  std::vector<std::string> messages;  // "/a 1500000 data"
  std::vector<BagPlace> places;
  std::vector<BagTopic> topics;
  std::vector<std::string> problems;
};

std::string Describe(const BagReader& bag, const BagMessage& message) {
  return bag.topics()[message.topic].name + " " + std::to_string(message.log_utime) + " " +
         std::string(message.data, message.data + message.size);
}

Seen ReadAll(const std::filesystem::path& path) {
  const std::unique_ptr<BagReader> bag = OpenBag(path);
  Seen seen;
  BagMessage message;
  while (bag->Next(&message)) {
    seen.messages.push_back(Describe(*bag, message));
    seen.places.push_back(message.place);
  }
  seen.topics = bag->topics();
  seen.problems = bag->problems();
  EXPECT_LE(bag->position(), bag->size());
  for (std::size_t i = seen.places.size(); i-- > 0;) {  // again, from the last to the first
    EXPECT_EQ(Describe(*bag, bag->Read(seen.places[i])), seen.messages[i]);
  }
  return seen;
}

class Bags : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& bytes) {
    std::filesystem::path path = dir_ / "bag";
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  Seen Read(const std::string& bytes) { return ReadAll(Write(bytes)); }

  test::TempDir dir_;
};

std::string Zstd(const std::string& data) {
  std::string packed(ZSTD_compressBound(data.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), data.data(), data.size(), 1));
  return packed;
}

std::string Lz4(const std::string& data) {
  std::string packed(LZ4F_compressFrameBound(data.size(), nullptr), '\0');
  packed.resize(
      LZ4F_compressFrame(packed.data(), packed.size(), data.data(), data.size(), nullptr));
  return packed;
}

std::string Bz2(const std::string& data) {
  std::string packed(data.size() * 2 + 600, '\0'), copy = data;
  unsigned size = static_cast<unsigned>(packed.size());
  BZ2_bzBuffToBuffCompress(packed.data(), &size, copy.data(), static_cast<unsigned>(data.size()), 1,
                           0, 0);
  packed.resize(size);
  return packed;
}

std::uint32_t Crc(const std::string& data) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const std::uint8_t*>(data.data()), data.size()));
}

std::string Mcap() {
  const std::string first = test::McapChannels() + test::McapMessage(1, 1'000'000, "one") +
                            test::McapMessage(2, 2'000'000, "two");
  const std::string second = test::McapMessage(1, 3'000'999, "three");
  return test::kMcapMagic + test::McapRecord(1, test::Text("ros2") + test::Text("test")) +
         test::McapChunk("zstd", Zstd(first), first.size(), Crc(first)) +
         test::McapRecord(7, "an index") + test::McapChunk("lz4", Lz4(second), second.size()) +
         test::McapChunk("", second, second.size(), Crc(second)) +
         test::McapMessage(2, 4'000'000, "four") + test::McapEnd() + test::kMcapMagic;
}

std::string Ros1() {
  const std::string first = test::Ros1Connection() + test::Ros1Message(1, "one"),
                    second = test::Ros1Message(2, "two"), third = test::Ros1Message(3, "three");
  return test::kRos1Magic + test::Ros1Record(test::Ros1Field("op", "\x03"), std::string(100, ' ')) +
         test::Ros1Chunk("none", first, static_cast<std::uint32_t>(first.size())) +
         test::Ros1Record(test::Ros1Field("op", "\x04"), "an index") +
         test::Ros1Chunk("bz2", Bz2(second), static_cast<std::uint32_t>(second.size())) +
         test::Ros1Chunk("lz4", Lz4(third), static_cast<std::uint32_t>(third.size())) +
         test::Ros1Message(4, "four");
}

TEST_F(Bags, McapInAndOutOfChunksPackedAndNot) {
  const Seen seen = Read(Mcap());
  EXPECT_THAT(seen.messages, ElementsAre("/a 1000 one", "/b 2000 two", "/a 3000 three",
                                         "/a 3000 three", "/b 4000 four"));
  EXPECT_THAT(seen.problems, IsEmpty());
  ASSERT_THAT(seen.topics, SizeIs(2));
  EXPECT_EQ(seen.topics[0].type, "a/A");
  EXPECT_EQ(seen.topics[0].encoding, BagEncoding::kCdr);
  EXPECT_EQ(seen.topics[1].encoding, BagEncoding::kOther);
}

TEST_F(Bags, Ros1InAndOutOfChunksPackedAndNot) {
  const Seen seen = Read(Ros1());
  EXPECT_THAT(seen.messages, ElementsAre("/a 1500000 one", "/a 2500000 two", "/a 3500000 three",
                                         "/a 4500000 four"));
  EXPECT_THAT(seen.problems, IsEmpty());
  EXPECT_EQ(seen.topics.at(0).encoding, BagEncoding::kRos1);
}

// However much is missing: what is whole is read, in order, and the end is told.
TEST_F(Bags, CutOffAnywhereGivesWhatLiesBefore) {
  for (const std::string& whole : {Mcap(), Ros1()}) {
    const std::vector<std::string> all = Read(whole).messages;
    std::size_t most = 0;
    for (std::size_t size = 13; size < whole.size(); ++size) {
      const Seen seen = Read(whole.substr(0, size));
      ASSERT_LE(seen.messages.size(), all.size());
      EXPECT_TRUE(std::equal(seen.messages.begin(), seen.messages.end(), all.begin())) << size;
      EXPECT_LE(seen.problems.size(), 1U) << size;
      EXPECT_GE(seen.messages.size(), most) << size;
      most = seen.messages.size();
    }
    EXPECT_EQ(most, all.size() - (whole[0] == '#' ? 1 : 0));
  }
}

// Any byte may be any other: it ends, and takes no memory on a file's word.
TEST_F(Bags, DamagedAnywhereEndsAndSaysSo) {
  std::mt19937 random(1);
  std::size_t problems = 0;
  for (const std::string& whole : {Mcap(), Ros1()}) {
    for (std::size_t at = 13; at < whole.size(); ++at) {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ (1 + random() % 255));
      problems += Read(damaged).problems.size();
    }
  }
  EXPECT_GT(problems, 200U);
}

TEST_F(Bags, WhatUnpacksToTooMuchIsLeftOutAndTheNextIsRead) {
  const std::string records = test::McapChannels() + test::McapMessage(1, 1000, "one");
  const std::string good =
      test::McapChunk("zstd", Zstd(records), records.size(), Crc(records)) + test::McapEnd();
  const std::string zeros(1'000'000, '\0');
  const struct {
    std::string chunk, says;
  } bad[] = {
      {test::McapChunk("zstd", Zstd(records), std::uint64_t{1} << 40), "at most 134217728"},
      {test::McapChunk("zstd", Zstd(zeros), 1000), "zstd: "},
      {test::McapChunk("lz4", Lz4(zeros), 1000), "lz4: it is longer"},
      {test::McapChunk("lz4", Lz4(zeros), 2'000'000), "1000000 bytes where 2000000"},
      {test::McapChunk("", records, 10), "where 10 are announced"},
      {test::McapChunk("snappy", records, records.size()), "\"snappy\""},
      {test::McapChunk("zstd", Zstd(records), records.size(), 1234), "checksum"},
      {test::McapMessage(9, 1000, "whose?"), "channel 9"},
  };
  for (const auto& [chunk, says] : bad) {
    std::string bytes = test::kMcapMagic;
    bytes += chunk;
    bytes += good;
    const Seen seen = Read(bytes);
    EXPECT_THAT(seen.messages, ElementsAre("/a 1 one")) << says;
    EXPECT_THAT(seen.problems, ElementsAre(HasSubstr(says))) << says;
  }
}

// Of zeros, or of records that are of no use, as many as a chunk holds: the file is small, and so
// is the work.
TEST_F(Bags, ChunksThatUnpackToFarMoreThanTheFileAreLeftOut) {
  constexpr std::size_t kLargest = std::size_t{128} << 20;
  const std::string useless = test::McapMessage(9, 0, "");
  std::string many;
  while (many.size() + useless.size() <= kLargest) many += useless;
  const std::string zeros(kLargest, '\0');
  for (const std::string& records : {zeros, many}) {
    const std::string chunk = test::McapChunk("zstd", Zstd(records), records.size());
    std::string bytes = test::kMcapMagic;
    for (int i = 0; i < 12; ++i) bytes += chunk;
    const Seen seen = Read(bytes + test::McapEnd());
    EXPECT_THAT(seen.messages, IsEmpty());
    EXPECT_THAT(seen.problems, testing::Not(IsEmpty()));
  }
  const std::string packed = Bz2(zeros);
  ASSERT_LT(packed.size(), 10'000U);
  std::string bag = test::kRos1Magic;
  for (int i = 0; i < 100; ++i) bag += test::Ros1Chunk("bz2", packed, kLargest);
  const Seen seen = Read(bag);
  EXPECT_THAT(seen.messages, IsEmpty());
  EXPECT_THAT(seen.problems, testing::Contains(HasSubstr("a thousand times its size")));
}

TEST_F(Bags, AFileOfZerosBehindItsHeadEndsAtOnce) {
  for (const std::string& magic : {test::kMcapMagic, test::kRos1Magic}) {
    const std::filesystem::path path = Write(magic);
    std::filesystem::resize_file(path, 10'000'000'000);  // sparse: no room on the disk
    const Seen seen = ReadAll(path);
    EXPECT_THAT(seen.messages, IsEmpty());
    EXPECT_THAT(seen.problems, ElementsAre(HasSubstr("is damaged")));
  }
}

TEST_F(Bags, ATopicCannotWriteToTheTerminal) {
  const std::uint16_t id = 1;
  const Seen seen =
      Read(test::kMcapMagic +
           test::McapRecord(4, Little(id) + Little(id) + test::Text("/\x1b[2J\n\xff") +
                                   test::Text("cdr") + Little(std::uint32_t{0})));
  EXPECT_EQ(seen.topics.at(0).name, "/?[2J?\xEF\xBF\xBD");
}

TEST_F(Bags, AMessageOfAnUnknownChannelCostsItselfAlone) {
  const std::string records = test::McapChannels() + test::McapMessage(9, 0, "lost") +
                              test::McapMessage(1, 1'000'000, "one");
  const Seen mcap = Read(test::kMcapMagic + test::McapChunk("", records, records.size()));
  EXPECT_THAT(mcap.messages, ElementsAre("/a 1000 one"));
  EXPECT_THAT(mcap.problems, ElementsAre(HasSubstr("channel 9")));
  const std::string ros1 =
      test::Ros1Message(1, "lost") + test::Ros1Connection() + test::Ros1Message(2, "two");
  const Seen seen = Read(test::kRos1Magic +
                         test::Ros1Chunk("none", ros1, static_cast<std::uint32_t>(ros1.size())));
  EXPECT_THAT(seen.messages, ElementsAre("/a 2500000 two"));
  EXPECT_THAT(seen.problems, ElementsAre(HasSubstr("connection 5")));
}

TEST_F(Bags, OfManyProblemsTheFirstAreTold) {
  std::string bytes = test::kMcapMagic;
  for (int i = 0; i < 1000; ++i) bytes += test::McapMessage(9, 0, "");
  const Seen seen = Read(bytes);
  EXPECT_THAT(seen.problems, SizeIs(11));
  EXPECT_EQ(seen.problems.back(), "and 990 more like these");
}

class SqliteBag : public Bags {
 protected:
  std::filesystem::path Make(const std::string& script) {
    std::filesystem::path path = dir_ / "bag.db3";
    std::filesystem::remove(path);
    sqlite3* database = nullptr;
    sqlite3_open(path.c_str(), &database);
    char* error = nullptr;
    EXPECT_EQ(sqlite3_exec(database, script.c_str(), nullptr, nullptr, &error), SQLITE_OK) << error;
    sqlite3_close(database);
    return path;
  }
};

const std::string kTables =
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);"
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);"
    "INSERT INTO topics VALUES(3, '/a', 'a/msg/A', 'cdr');";

TEST_F(SqliteBag, RowsInTheirOrder) {
  const Seen seen =
      ReadAll(Make(kTables + "INSERT INTO messages VALUES(7, 3, 9000, 'late'), (8, 3, 1999, "
                             "'early'), (9, 4, 0, 'whose'), (10, 3, 2000, NULL);"));
  EXPECT_THAT(seen.messages, ElementsAre("/a 9 late", "/a 1 early", "/a 2 "));
  EXPECT_THAT(seen.problems, ElementsAre(HasSubstr("topic 4")));
  EXPECT_EQ(seen.topics.at(0).type, "a/A");
}

TEST_F(SqliteBag, ATopicsNameMovesNoCursorAndTurnsNothingAbout) {
  const Seen seen = ReadAll(Make(kTables + "UPDATE topics SET name = '/\u0432\x7f\u009b2J\u202e';"
                                           "INSERT INTO messages VALUES(7, 3, 9000, 'one');"));
  EXPECT_THAT(seen.messages, ElementsAre("/\u0432??2J? 9 one"));
}

TEST_F(SqliteBag, CutOffAnywhereNeverBreaks) {
  const std::filesystem::path path =
      Make(kTables + "INSERT INTO messages VALUES(1, 3, 0, zeroblob(20000)), (2, 3, 0, 'x');");
  std::string whole = ReadWholeFile(path);
  std::size_t refused = 0;
  for (std::size_t size = 16; size < whole.size(); size += 97) {
    try {
      refused += Read(whole.substr(0, size)).problems.size();
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100U);
}

TEST_F(SqliteBag, OnlyTablesCount) {
  const auto path = Make(
      "CREATE TABLE topics(id INTEGER);"
      "CREATE VIEW messages AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) "
      "SELECT i AS id, 1 AS topic_id, 0 AS timestamp, 'x' AS data FROM n;");
  EXPECT_THAT(test::ErrorOf([&] { OpenBag(path); }), HasSubstr("no ROS 2 bag"));
}

TEST_F(Bags, AFolderIsTheBagsInItInOrder) {
  const std::string begin = test::kMcapMagic + test::McapChannels();
  WriteFileAtomically(dir_ / "b/b_10.mcap", begin + test::McapMessage(1, 3000, "three"));
  WriteFileAtomically(dir_ / "b/b_9.mcap", begin + test::McapMessage(1, 2000, "two"));
  WriteFileAtomically(dir_ / "b/metadata.yaml", "of no use");
  EXPECT_THAT(ReadAll(dir_ / "b").messages, ElementsAre("/a 2 two", "/a 3 three"));
  // What unzstd and `rosbag fix` leave.
  WriteFileAtomically(dir_ / "b/b_9.mcap.zstd", "\x28\xb5\x2f\xfd");
  EXPECT_THAT(ReadAll(dir_ / "b").messages, ElementsAre("/a 2 two", "/a 3 three"));
  WriteFileAtomically(dir_ / "b/b_11.mcap.zstd", "\x28\xb5\x2f\xfd");
  EXPECT_THAT(test::ErrorOf([&] { OpenBag(dir_ / "b"); }), HasSubstr("unzstd"));
  std::filesystem::create_directory(dir_ / "empty");
  EXPECT_THAT(test::ErrorOf([&] { OpenBag(dir_ / "empty"); }), HasSubstr("holds no bag"));
}

TEST_F(Bags, AFolderOfSeveralKindsIsTheOneThatItsMetadataLists) {
  const std::string begin = test::kMcapMagic + test::McapChannels();
  WriteFileAtomically(dir_ / "b/b_1.mcap", begin + test::McapMessage(1, 3000, "three"));
  WriteFileAtomically(dir_ / "b/b_0.mcap", begin + test::McapMessage(1, 2000, "two"));
  WriteFileAtomically(dir_ / "b/b_0.db3", "SQLite format 3");
  WriteFileAtomically(dir_ / "b/old.bag", "#ROSBAG V2.0\n");
  const auto error = [&] { return test::ErrorOf([&] { OpenBag(dir_ / "b"); }); };
  EXPECT_THAT(error(), HasSubstr("several kinds (1 .bag, 1 .db3, 2 .mcap)"));
  WriteFileAtomically(dir_ / "b/metadata.yaml",
                      "rosbag2_bagfile_information:\n  storage_identifier: mcap\n"
                      "  relative_file_paths:\n    - b_0.mcap\n    - \"b/b_1.mcap\"\n");
  EXPECT_THAT(ReadAll(dir_ / "b").messages, ElementsAre("/a 2 two", "/a 3 three"));
  WriteFileAtomically(dir_ / "b/metadata.yaml", "- b_0.mcap\n- b_0.db3\n");
  EXPECT_THAT(error(), HasSubstr("several kinds"));
  WriteFileAtomically(dir_ / "b/metadata.yaml", "- other.mcap\n");
  EXPECT_THAT(error(), HasSubstr("several kinds"));
}

TEST_F(Bags, PartsThatAreNotThereAreTold) {
  const std::string begin = test::kMcapMagic + test::McapChannels();
  WriteFileAtomically(dir_ / "b/b_0.mcap", begin + test::McapMessage(1, 2000, "two"));
  const auto metadata = [&](const std::string& lines) {
    WriteFileAtomically(dir_ / "b/metadata.yaml",
                        "rosbag2_bagfile_information:\n  duration:\n    nanoseconds: 9000000000\n"
                        "  starting_time:\n    nanoseconds_since_epoch: 1600000000000000000\n"
                        "  relative_file_paths:\n" +
                            lines);
    return ReadAll(dir_ / "b").problems;
  };
  EXPECT_THAT(metadata("    - b_0.mcap\n"), IsEmpty());
  EXPECT_THAT(metadata("    - b_0.mcap.zstd\n"), IsEmpty()) << "unpacked since";
  EXPECT_THAT(metadata("    - c_0.mcap\n    - c_1.mcap\n"), IsEmpty()) << "renamed since";
  EXPECT_THAT(metadata("    - b_0.mcap\n    - b_1.mcap\n"),
              ElementsAre(AllOf(HasSubstr("not there: b_1.mcap;"), HasSubstr("their time"))));
  EXPECT_THAT(metadata("    - b_0.mcap\n    - b_1.mcap\n    - b_2.mcap\n  files:\n"
                       "    - path: b_0.mcap\n      starting_time:\n"
                       "        nanoseconds_since_epoch: 1600000000000000000\n"
                       "      duration:\n        nanoseconds: 2000000000\n"
                       "    - path: \"b_1.mcap\"\n      starting_time:\n"
                       "        nanoseconds_since_epoch: 1600000002000000000\n"
                       "      duration:\n        nanoseconds: 3000000000\n"
                       "    - path: b_2.mcap\n      starting_time:\n"
                       "        nanoseconds_since_epoch: 1600000005000000000\n"
                       "      duration:\n        nanoseconds: 4000000000\n"),
              ElementsAre(AllOf(HasSubstr("b_1.mcap (2.0 to 5.0 s), b_2.mcap (5.0 to 9.0 s)"),
                                HasSubstr("7.0 s of it are missing"))));
  EXPECT_THAT(ReadAll(dir_ / "b").messages, ElementsAre("/a 2 two"));
}

TEST_F(Bags, WhatRosbagFixLeftDoesNotCount) {
  WriteFileAtomically(dir_ / "b/b.orig.bag", "#ROSBAG V1.2\n");
  EXPECT_THAT(test::ErrorOf([&] { OpenBag(dir_ / "b"); }), HasSubstr("older version"));
  WriteFileAtomically(dir_ / "b/b.bag", "#ROSBAG V2.0\n");
  EXPECT_EQ(OpenBag(dir_ / "b")->format(), "ROS 1 bag");
}

}  // namespace
}  // namespace rgbdt
