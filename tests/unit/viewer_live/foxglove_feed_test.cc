#include "viewer/live/foxglove_feed.h"

#include <gmock/gmock.h>

#include "calib/files/schema/rig_file.h"
#include "services/messages/codec.h"
#include "tests/nodes/session_world.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt::viewer {
namespace {

using test::SweepOfTwo;
using test::TinyRig;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr Utime kReceived = 1'800'000'000'000'000;

class Published : public ChannelOutbox {
 public:
  void Publish(ChannelMessage message) override { all.push_back(std::move(message)); }
  void EndChannels() override { ++ends; }
  bool AnybodyListens() const override { return listens; }

  std::vector<std::string> Topics() {
    std::vector<std::string> topics;
    for (const ChannelMessage& message : std::exchange(all, {})) topics.push_back(message.topic);
    return topics;
  }

  std::vector<ChannelMessage> all;
  int ends = 0;
  bool listens = true;
};

class FoxgloveFeedTest : public ::testing::Test {
 protected:
  void Take(const Message& message) { feed_.Take(message, kReceived); }
  // As it comes over the bus.
  void Come(const Message& message) {
    const Bytes bytes = Encode(message);
    feed_.Overhear(ChannelOf(message), bytes.data(), bytes.size());
    Take(Decode(ChannelOf(message), bytes.data(), bytes.size()));
  }

  Published out_;
  FoxgloveFeed feed_{&out_};
};

TEST_F(FoxgloveFeedTest, MessagesGoOnWithTheTimeOfTheirArrival) {
  Take(SweepOfTwo(5000));
  ASSERT_EQ(out_.all.size(), 1U);
  const ChannelMessage& cloud = out_.all[0];
  EXPECT_EQ(cloud.topic, "/lidar/points");
  EXPECT_EQ(cloud.schema_name, "foxglove.PointCloud");
  EXPECT_EQ(cloud.utime, kReceived);
  EXPECT_TRUE(cloud.large);
  foxglove::PointCloud decoded;
  ASSERT_TRUE(decoded.ParseFromString(cloud.make()));
  EXPECT_EQ(decoded.timestamp().nanos(), 5'000'000) << "its own time is the sensor's";
}

TEST_F(FoxgloveFeedTest, NothingLargeIsTakenWhileNobodyListens) {
  out_.listens = false;
  Take(test::TextOf(TinyRig()));
  EXPECT_THAT(out_.Topics(), Contains("/rgb/camera_info"));
  Take(SweepOfTwo(5000));
  Come(test::Blank(TinyRig().cameras[0], 5000));
  EXPECT_THAT(out_.Topics(), IsEmpty());
}

TEST_F(FoxgloveFeedTest, AnImageThatCameAsAFileGoesOnAsThatFile) {
  Image image = test::Blank(TinyRig().Camera("rgb"), 5000);
  image.format = PixelFormat::kJpeg;
  Come(image);
  ASSERT_EQ(out_.all.size(), 1U);
  EXPECT_EQ(out_.all[0].topic, "/rgb/image_raw/compressed");
  foxglove::CompressedImage decoded;
  ASSERT_TRUE(decoded.ParseFromString(out_.all[0].make()));
  const Bytes sent = Encode(image), file = ImageFileOf(sent.data(), sent.size());
  EXPECT_EQ(decoded.data(), std::string(file.begin(), file.end()));
  out_.all.clear();
  // Overheard, but of another channel than what is taken.
  feed_.Overhear("THERMAL_IMAGE", sent.data(), sent.size());
  Take(test::Blank(TinyRig().Camera("rgb"), 6000));
  EXPECT_THAT(out_.Topics(), ElementsAre("/rgb/image_raw"));
}

TEST_F(FoxgloveFeedTest, AnotherRigsChannelsAreNewOnes) {
  Take(test::TextOf(TinyRig()));
  Take(test::TextOf(TinyRig()));
  EXPECT_EQ(out_.ends, 0);
  Rig other = TinyRig();
  other.name += "2";
  other = ParseRig(PrintRig(other), "rig");
  Take(test::TextOf(other));
  EXPECT_EQ(out_.ends, 1);
}

}  // namespace
}  // namespace rgbdt::viewer
