#include "services/bus/internal/inbox.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/messages/limits.h"

namespace rgbdt {
namespace {

using ::testing::ElementsAre;

Bus::Handler Collect(std::vector<std::size_t>* sizes) {
  return [sizes](const std::string&, const std::uint8_t*, std::size_t size) {
    sizes->push_back(size);
  };
}

TEST(Inbox, AFullQueueMissesTheNewest) {
  Inbox inbox;
  std::vector<std::size_t> few, all;
  inbox.Subscribe("A", 2, Collect(&few));
  inbox.Subscribe(".*", 10, Collect(&all));
  for (const std::size_t size : {1, 2, 3}) inbox.Add({"A", Bytes(size)});
  for (int i = 0; i < 3; ++i) inbox.DeliverOne();
  EXPECT_THAT(few, ElementsAre(1, 2));
  EXPECT_THAT(all, ElementsAre(1, 2, 3));
}

TEST(Inbox, BytesThatWaitAreBoundedAndSmallOnesStillFit) {
  Inbox inbox(100);
  std::vector<std::size_t> sizes, others;
  inbox.Subscribe(".*", 1000, Collect(&sizes));
  inbox.Subscribe("A", 1000, Collect(&others));  // the same bytes: they count once
  for (const std::size_t size : {60, 41, 40, 1}) inbox.Add({"A", Bytes(size)});
  inbox.Add({"A", {}});
  for (int i = 0; i < 3; ++i) inbox.DeliverOne();
  EXPECT_THAT(sizes, ElementsAre(60, 40, 0));
  EXPECT_EQ(others, sizes);
  inbox.Add({"A", Bytes(100)});  // there is room again
  inbox.DeliverOne();
  inbox.Add({"A", Bytes(101)});
  inbox.DeliverOne();
  EXPECT_THAT(sizes, ElementsAre(60, 40, 0, 100));
}

// A flood of the largest messages to a handler that is busy.
TEST(Inbox, AFloodTakesNoMoreThanIsPromised) {
  Inbox inbox;
  std::vector<std::size_t> sizes;
  inbox.Subscribe("A", 4096, Collect(&sizes));
  for (int i = 0; i < 200; ++i) inbox.Add({"A", Bytes(kMaxMessageBytes)});
  inbox.Add({"A", Bytes(100)});
  for (int i = 0; i < 200; ++i) inbox.DeliverOne();
  const std::size_t large = (Inbox::kMaxBytes - Inbox::kForSmall) / kMaxMessageBytes;
  ASSERT_EQ(sizes.size(), large + 1);
  EXPECT_EQ(sizes.back(), 100U);  // for which there still was room
}

}  // namespace
}  // namespace rgbdt
