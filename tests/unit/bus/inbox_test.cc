#include "services/bus/internal/inbox.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include "services/messages/limits.h"

namespace rgbdt {
namespace {

using ::testing::ElementsAre;

Bus::Handler Collect(std::vector<std::size_t>* sizes) {
  return [sizes](const std::string&, const std::uint8_t*, std::size_t size) {
    sizes->push_back(size);
  };
}

void Add(Inbox* inbox, const std::string& channel, std::size_t size) {
  inbox->Add({channel, MessageBytes(size)});
}

bool IsReadable(const Inbox& inbox) {
  pollfd descriptor{inbox.descriptor(), POLLIN, 0};
  return poll(&descriptor, 1, 0) == 1;
}

TEST(Inbox, AFullQueueMissesTheNewest) {
  Inbox inbox;
  std::vector<std::size_t> few, all;
  inbox.Subscribe("A", {2}, Collect(&few));
  inbox.Subscribe(".*", {10}, Collect(&all));
  for (const std::size_t size : {1, 2, 3}) Add(&inbox, "A", size);
  for (int i = 0; i < 3; ++i) inbox.DeliverOne();
  EXPECT_THAT(few, ElementsAre(1, 2));
  EXPECT_THAT(all, ElementsAre(1, 2, 3));
}

TEST(Inbox, BytesThatWaitAreBoundedAndSmallOnesStillFit) {
  Inbox inbox(100);
  std::vector<std::size_t> sizes, others;
  inbox.Subscribe(".*", {1000}, Collect(&sizes));
  inbox.Subscribe("A", {1000}, Collect(&others));  // the same bytes: they count once
  for (const std::size_t size : {60, 41, 40, 1}) Add(&inbox, "A", size);
  Add(&inbox, "A", 0);
  for (int i = 0; i < 3; ++i) inbox.DeliverOne();
  EXPECT_THAT(sizes, ElementsAre(60, 40, 0));
  EXPECT_EQ(others, sizes);
  Add(&inbox, "A", 100);  // there is room again
  inbox.DeliverOne();
  Add(&inbox, "A", 101);
  inbox.DeliverOne();
  EXPECT_THAT(sizes, ElementsAre(60, 40, 0, 100));
}

// A flood of the largest messages to a handler that is busy.
TEST(Inbox, AFloodTakesNoMoreThanIsPromised) {
  Inbox inbox;
  std::vector<std::size_t> sizes;
  inbox.Subscribe("A", {4096}, Collect(&sizes));
  for (int i = 0; i < 200; ++i) Add(&inbox, "A", kMaxMessageBytes);
  Add(&inbox, "A", 100);
  for (int i = 0; i < 200; ++i) inbox.DeliverOne();
  const std::size_t large = (Inbox::kMaxBytes - Inbox::kForSmall) / kMaxMessageBytes;
  ASSERT_EQ(sizes.size(), large + 1);
  EXPECT_EQ(sizes.back(), 100U);  // for which there still was room
}

TEST(Inbox, AFullQueueOfImagesGivesUpTheOldest) {
  Inbox inbox;
  std::vector<std::size_t> images, all;
  inbox.Subscribe(".*_IMAGE", {2}, Collect(&images));
  inbox.Subscribe(".*", {10}, Collect(&all));
  for (const std::size_t size : {1, 2, 3, 4}) Add(&inbox, size == 2 ? "A_IMAGE" : "B_IMAGE", size);
  while (IsReadable(inbox)) inbox.DeliverOne();
  EXPECT_THAT(images, ElementsAre(3, 4));
  EXPECT_THAT(all, ElementsAre(1, 2, 3, 4)) << "another subscriber has room";
}

// However many of them are there, and in whatever order they came.
TEST(Inbox, ImagesGiveWayToClouds) {
  const std::size_t large = Inbox::kSmall + 1;
  Inbox inbox(Inbox::kForSmall + 4 * large);
  std::vector<std::string> came;
  for (const char* channels : {"CLOUD", ".*_IMAGE"}) {
    inbox.Subscribe(channels, {1000},
                    [&](const std::string& channel, auto&&...) { came.push_back(channel); });
  }
  for (const char* channel : {"CLOUD", "A_IMAGE", "B_IMAGE", "CLOUD"}) Add(&inbox, channel, large);
  Add(&inbox, "CLOUD", large);
  Add(&inbox, "C_IMAGE", large);
  while (IsReadable(inbox)) inbox.DeliverOne();
  EXPECT_THAT(came, ElementsAre("CLOUD", "CLOUD", "CLOUD", "C_IMAGE"));
  came.clear();
  for (int i = 0; i < 5; ++i) Add(&inbox, "CLOUD", large);
  Add(&inbox, "A_IMAGE", large);
  while (IsReadable(inbox)) inbox.DeliverOne();
  EXPECT_THAT(came, ElementsAre("CLOUD", "CLOUD", "CLOUD", "CLOUD")) << "no cloud for an image";
}

TEST(Inbox, WhoWantsTheNewestMissesTheOldest) {
  Inbox inbox;
  std::vector<std::size_t> newest, all;
  inbox.Subscribe("A|B", {100, 10}, Collect(&newest));
  inbox.Subscribe("A", {100}, Collect(&all));
  Add(&inbox, "B", 1);
  for (const std::size_t size : {2, 3, 4, 5}) Add(&inbox, "A", size);
  while (IsReadable(inbox)) inbox.DeliverOne();
  EXPECT_THAT(newest, ElementsAre(4, 5));
  EXPECT_THAT(all, ElementsAre(2, 3, 4, 5)) << "who wants all gets all";
  newest.clear();
  for (const std::size_t size : {6, 11, 12}) Add(&inbox, "B", size);
  inbox.DeliverOne();
  EXPECT_FALSE(IsReadable(inbox));
  EXPECT_THAT(newest, ElementsAre(12)) << "the newest, however large";
  Inbox few;
  newest.clear();
  few.Subscribe("A", {2, 10}, Collect(&newest));
  for (const std::size_t size : {1, 2, 3}) Add(&few, "A", size);
  while (IsReadable(few)) few.DeliverOne();
  EXPECT_THAT(newest, ElementsAre(2, 3));
}

// Whatever came while handlers hung, what they then have to do is bounded.
TEST(Inbox, AfterAHangOnlyTheNewestWaits) {
  Inbox inbox;
  std::vector<std::size_t> clouds, commands;
  inbox.Subscribe("CLOUD", {4096, 10'000}, Collect(&clouds));
  inbox.Subscribe("SESSION_COMMAND", {4096}, Collect(&commands));
  for (std::size_t i = 1; i <= 300; ++i) {
    Add(&inbox, "CLOUD", 1000 + i % 2);
    if (i % 10 == 0) Add(&inbox, "SESSION_COMMAND", i);
  }
  while (IsReadable(inbox)) inbox.DeliverOne();
  EXPECT_THAT(clouds, ElementsAre(1000, 1001, 1000, 1001, 1000, 1001, 1000, 1001, 1000));
  EXPECT_EQ(commands.size(), 30U) << "never commands";
}

}  // namespace
}  // namespace rgbdt
