#include <gtest/gtest.h>

#include <limits>
#include <opencv2/core.hpp>

#include "calib/model/errors.h"
#include "services/messages/codec.h"
#include "tests/unit/messages/peak_memory.h"
#include "tests/unit/messages/random_messages.h"

// Hostile bytes: every outcome is a message or an InputError, and memory stays bounded. Built with
// -fsanitize=address,undefined these tests also hold that nothing is read past the end; the copy
// into a vector of exact size makes one byte too far visible.

namespace rgbdt {
namespace {

using testing::PeakMemory;
using testing::RandomMessages;

constexpr int kFlipsPerMessage = 400;
constexpr std::size_t kForgedBytes = 4500;
constexpr std::int64_t kMaxGrowth = 300 << 20;  // [bytes]

/// True if the bytes were taken for a message.
bool Survives(const std::string& channel, const Bytes& bytes) {
  const Bytes exact(bytes.begin(), bytes.end());
  try {
    const Message message = Decode(channel, exact.data(), exact.size());
    Encode(message);  // what is accepted can be sent on
    return true;
  } catch (const InputError& e) {
    EXPECT_STRNE(e.what(), "");
    return false;
  }
}

struct Sample {
  std::string channel;
  Bytes bytes;
};

class Fuzz : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  /// A valid one of every type that is decoded.
  std::vector<Sample> Samples() {
    std::vector<Sample> samples;
    for (const Message& message : random_.OneOfEach()) {
      samples.push_back({ChannelOf(message), Encode(message)});
    }
    samples.push_back({"DETECTION", Encode(SmallButWhole())});
    EXPECT_LT(samples.back().bytes.size(), kForgedBytes);
    samples.push_back({"RGBDT_SWEEP", Encode(SmallSweep())});
    return samples;
  }

  // Every nested struct, within the bytes whose counts are forged.
  ViewDetection SmallButWhole() {
    ViewDetection detection = random_.Seen();
    ImageDetection image = random_.InImage();
    image.why_not = "";
    image.edges = ImageEdges{};
    image.edges->width = image.edges->height = 100;
    image.edges->outline_corners.fill({1, 2});
    ImageSide side = random_.Side();
    side.curve.resize(2, {3, 4});
    image.edges->pose = random_.PoseOfTarget();
    image.edges->sides.fill(side);
    detection.images = {image};
    CloudEdges board = random_.Boundary();
    board.boundary.resize(1);
    board.pose = random_.PoseOfTarget();
    board.crossings.assign(2, random_.WhereAScanLeaves());
    board.groups.assign(1, random_.Group());
    detection.cloud.candidates.assign(2, board);
    detection.cloud.why_not = "";
    return detection;
  }

  // With a pose, and its last count within the bytes whose counts are forged.
  RgbdtCloud SmallSweep() {
    RgbdtCloud sweep = random_.Fused();
    while (sweep.size() > 50) sweep = random_.Fused();
    sweep.whole_sweep = true;
    sweep.map_from_lidar = random_.Rigid();
    sweep.frame_utime = random_.Time();
    return sweep;
  }

  RandomMessages random_{GetParam() + 1000};
};

INSTANTIATE_TEST_SUITE_P(Seeds, Fuzz, ::testing::Range(std::uint64_t{0}, std::uint64_t{4}));

TEST_P(Fuzz, EveryTruncationIsRefused) {
  for (const auto& [channel, whole] : Samples()) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      EXPECT_FALSE(Survives(channel, Bytes(whole.data(), whole.data() + size))) << channel << size;
    }
    Bytes longer = whole;
    longer.push_back(0);
    EXPECT_FALSE(Survives(channel, longer)) << channel;
  }
}

TEST_P(Fuzz, ForgedCountsAtEveryByte) {
  const PeakMemory memory;
  const std::int32_t forged[] = {-1,      std::numeric_limits<std::int32_t>::min(),
                                 0,       std::numeric_limits<std::int32_t>::max(),
                                 1 << 30, (1 << 30) + 1,
                                 1 << 29, 1 << 28,
                                 1,       100'000};
  for (const auto& [channel, whole] : Samples()) {
    const std::size_t end = std::min(whole.size(), kForgedBytes);
    for (std::size_t at = 8; at + 4 <= end; ++at) {
      for (const std::int32_t count : forged) {
        Bytes bytes = whole;
        for (std::size_t i = 0; i < 4; ++i) {
          bytes[at + i] =
              static_cast<std::uint8_t>(static_cast<std::uint32_t>(count) >> (24 - 8 * i));
        }
        Survives(channel, bytes);
      }
    }
  }
  EXPECT_LT(memory.Grown(), kMaxGrowth);
}

TEST_P(Fuzz, RandomBytesFlipped) {
  const PeakMemory memory;
  for (const auto& [channel, whole] : Samples()) {
    const int last = static_cast<int>(whole.size()) - 1;
    for (int round = 0; round < kFlipsPerMessage; ++round) {
      Bytes bytes = whole;
      for (int flips = random_.Int(1, 6); flips > 0; --flips) {
        // The fingerprint is spared: nothing gets past a wrong one.
        bytes[static_cast<std::size_t>(random_.Int(8, last))] =
            static_cast<std::uint8_t>(random_.Int(0, 255));
      }
      Survives(channel, bytes);
    }
  }
  EXPECT_LT(memory.Grown(), kMaxGrowth);
}

TEST_P(Fuzz, RandomBytesBehindTheFingerprint) {
  for (const auto& [channel, whole] : Samples()) {
    for (int round = 0; round < 100; ++round) {
      Bytes bytes(whole.begin(), whole.begin() + 8);
      for (int size = random_.Int(0, 600); size > 0; --size) {
        bytes.push_back(static_cast<std::uint8_t>(random_.Coin() ? 0 : random_.Int(0, 255)));
      }
      Survives(channel, bytes);
    }
  }
}

// What the bounds above and below measure by.
TEST(FuzzMemory, PeakIsSeenAlthoughAllIsGivenBack) {
  constexpr int kSize = 64 << 20;
  const PeakMemory memory;
  for (int round = 0; round < 8; ++round) {
    const Bytes taken(kSize, 1);
    EXPECT_EQ(taken[static_cast<std::size_t>(round)], 1);
  }
  EXPECT_GE(memory.Grown(), kSize);
  EXPECT_LT(memory.Grown(), kSize + kSize / 8);
  const cv::Mat picture(2, kSize, CV_8U);
  EXPECT_GE(memory.Grown(), 2 * kSize);
  EXPECT_LT(memory.Grown(), 2 * kSize + kSize / 8);
}

// Compressed pictures go through OpenCV: broken files must end in an error or a picture.
TEST_P(Fuzz, BrokenImageFiles) {
  const PeakMemory memory;
  for (const PixelFormat format : {PixelFormat::kPng, PixelFormat::kJpeg}) {
    Image image = random_.Picture(PixelFormat::kBgr8);
    image.format = format;
    const std::string channel = ChannelOf(image);
    const Bytes whole = Encode(image);
    for (int round = 0; round < kFlipsPerMessage; ++round) {
      Bytes bytes = whole;
      bytes[static_cast<std::size_t>(random_.Int(100, static_cast<int>(whole.size()) - 1))] =
          static_cast<std::uint8_t>(random_.Int(0, 255));
      Survives(channel, bytes);
    }
  }
  EXPECT_LT(memory.Grown(), kMaxGrowth);
}

TEST(FuzzChannels, EveryTypeOnEveryOtherChannelIsRefused) {
  RandomMessages random(1);
  Messages messages = random.OneOfEach();
  for (Message& message : messages) {
    if (auto* cloud = std::get_if<RgbdtCloud>(&message)) cloud->whole_sweep = false;
  }
  messages.emplace_back(random.Fused());
  std::get<RgbdtCloud>(messages.back()).whole_sweep = true;
  for (const Message& a : messages) {
    const Bytes bytes = Encode(a);
    for (const Message& b : messages) {
      EXPECT_EQ(Survives(ChannelOf(b), bytes), ChannelOf(a) == ChannelOf(b));
    }
  }
}

}  // namespace
}  // namespace rgbdt
