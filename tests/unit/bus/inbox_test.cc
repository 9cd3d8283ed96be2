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

void Add(Inbox* inbox, const std::string& channel, std::size_t size, Utime now = 0) {
  inbox->Add({channel, MessageBytes(size)}, now);
}

bool IsReadable(const Inbox& inbox) {
  pollfd descriptor{inbox.descriptor(), POLLIN, 0};
  return poll(&descriptor, 1, 0) == 1;
}

TEST(Inbox, AFullQueueMissesTheNewest) {
  Inbox inbox;
  std::vector<std::size_t> few, all;
  inbox.Subscribe("A", 2, 0, Collect(&few));
  inbox.Subscribe(".*", 10, 0, Collect(&all));
  for (const std::size_t size : {1, 2, 3}) Add(&inbox, "A", size);
  for (int i = 0; i < 3; ++i) inbox.DeliverOne();
  EXPECT_THAT(few, ElementsAre(1, 2));
  EXPECT_THAT(all, ElementsAre(1, 2, 3));
}

TEST(Inbox, BytesThatWaitAreBoundedAndSmallOnesStillFit) {
  Inbox inbox(100);
  std::vector<std::size_t> sizes, others;
  inbox.Subscribe(".*", 1000, 0, Collect(&sizes));
  inbox.Subscribe("A", 1000, 0, Collect(&others));  // the same bytes: they count once
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
  inbox.Subscribe("A", 4096, 0, Collect(&sizes));
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
  inbox.Subscribe(".*_IMAGE", 2, 0, Collect(&images));
  inbox.Subscribe(".*", 10, 0, Collect(&all));
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
    inbox.Subscribe(channels, 1000, 0,
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

TEST(Inbox, WhatIsStaleGoesWhenNewerComes) {
  Inbox inbox;
  std::vector<std::size_t> stale, all;
  inbox.Subscribe("A|B", 100, 50, Collect(&stale));
  inbox.Subscribe("A", 100, 0, Collect(&all));
  Add(&inbox, "A", 1, 0);
  Add(&inbox, "B", 2, 0);
  Add(&inbox, "A", 3, 40);
  Add(&inbox, "A", 4, 51);
  Add(&inbox, "A", 5, 80);
  while (IsReadable(inbox)) inbox.DeliverOne();
  EXPECT_THAT(stale, ElementsAre(2, 3, 4, 5)) << "the newest of its channel stays, however old";
  EXPECT_THAT(all, ElementsAre(1, 3, 4, 5)) << "who wants all gets all";
  Add(&inbox, "B", 6, 100);
  Add(&inbox, "B", 7, 1000);
  inbox.DeliverOne();
  EXPECT_FALSE(IsReadable(inbox));
  EXPECT_EQ(stale.back(), 7U);
}

// Handlers that hung for three seconds have the newest to do, and no more.
TEST(Inbox, AfterAHangOnlyTheNewestWaits) {
  Inbox inbox;
  std::vector<std::size_t> clouds, commands;
  inbox.Subscribe("CLOUD", 4096, 250'000, Collect(&clouds));
  inbox.Subscribe("SESSION_COMMAND", 4096, 0, Collect(&commands));
  for (std::size_t i = 1; i <= 300; ++i) {
    Add(&inbox, "CLOUD", i, static_cast<Utime>(i) * 10'000);
    if (i % 10 == 0) Add(&inbox, "SESSION_COMMAND", i, static_cast<Utime>(i) * 10'000);
  }
  while (IsReadable(inbox)) inbox.DeliverOne();
  EXPECT_EQ(clouds.size(), 26U);
  EXPECT_EQ(clouds.back(), 300U);
  EXPECT_EQ(commands.size(), 30U) << "never commands";
}

}  // namespace
}  // namespace rgbdt
