#include "services/bags/mcap_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/files/atomic_file.h"
#include "calib/model/errors.h"
#include "services/bags/bag_reader.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

std::uint64_t NumberAt(const std::string& bytes, std::size_t at) {
  std::uint64_t number = 0;
  for (std::size_t i = 8; i-- > 0;) {
    number = number << 8 | static_cast<std::uint8_t>(bytes.at(at + i));
  }
  return number;
}

class McapWriting : public testing::Test {
 protected:
  std::string bytes_;
  McapWriter writer_{[this](std::string_view piece) { bytes_.append(piece); }, "test"};

  std::unique_ptr<BagReader> Open() {
    WriteFileAtomically(dir_ / "x.mcap", bytes_);
    return OpenBag(dir_ / "x.mcap");
  }
  test::TempDir dir_;
};

TEST_F(McapWriting, WhatIsWrittenIsReadChunkByChunk) {
  const std::uint16_t schema = writer_.AddSchema("foxglove.Log", "protobuf", "described");
  const std::uint16_t a = writer_.AddChannel("/a", schema, "protobuf");
  const std::string large(3'000'000, 'x');  // two do not fit a chunk
  writer_.Write(a, 1, 1, "one");
  writer_.Write(a, 2, 2, large);
  const std::uint16_t b = writer_.AddChannel("/b", schema, "protobuf");
  writer_.Write(b, 3, 0, large);
  writer_.Write(a, 4, 4, "");
  EXPECT_EQ(writer_.messages(), 4U);
  writer_.Finish();
  const auto bag = Open();
  BagMessage message;
  std::vector<std::string> seen;
  std::vector<std::int64_t> chunks;
  while (bag->Next(&message)) {
    seen.push_back(bag->topics()[message.topic].name + " " + std::to_string(message.log_utime) +
                   " " + std::to_string(message.size));
    chunks.push_back(message.place.at);
  }
  EXPECT_THAT(seen, ElementsAre("/a 1 3", "/a 2 3000000", "/b 3 3000000", "/a 4 0"));
  EXPECT_EQ(chunks[0], chunks[1]);
  EXPECT_LT(chunks[1], chunks[2]);
  EXPECT_EQ(chunks[2], chunks[3]);
  EXPECT_THAT(bag->problems(), IsEmpty());
  ASSERT_THAT(bag->topics(), SizeIs(2));
  EXPECT_EQ(bag->topics()[0].type, "foxglove.Log");
  EXPECT_EQ(bag->topics()[0].encoding, BagEncoding::kProtobuf);
}

// The footer, 8 bytes of magic behind it, leads to the summary: other readers begin there.
TEST_F(McapWriting, TheFooterLeadsToTheSummary) {
  const std::uint16_t schema = writer_.AddSchema("s", "protobuf", "");
  writer_.Write(writer_.AddChannel("/a", schema, "protobuf"), 7, 7, "one");
  writer_.Finish();
  const std::size_t footer = bytes_.size() - 8 - 20;
  const std::uint64_t summary = NumberAt(bytes_, footer), offsets = NumberAt(bytes_, footer + 8);
  EXPECT_EQ(bytes_.at(footer - 9), 0x02);
  EXPECT_EQ(bytes_.at(summary), 0x03) << "schemas first";
  EXPECT_EQ(bytes_.at(offsets), 0x0e);
  EXPECT_EQ(bytes_.at(summary - 13), 0x0f) << "the data ends before it";
}

TEST_F(McapWriting, WithoutMessagesItIsAFileAllTheSame) {
  writer_.Finish();
  const auto bag = Open();
  BagMessage message;
  EXPECT_FALSE(bag->Next(&message));
  EXPECT_THAT(bag->problems(), IsEmpty());
}

TEST_F(McapWriting, WhatNoReaderTakesIsNotWritten) {
  const std::uint16_t channel =
      writer_.AddChannel("/a", writer_.AddSchema("s", "protobuf", ""), "protobuf");
  EXPECT_THROW(writer_.Write(channel, 1, 1, std::string(kMostBagBytes, 'x')), InputError);
  EXPECT_EQ(writer_.messages(), 0U);
}

}  // namespace
}  // namespace rgbdt
