#include "services/bus/internal/message_memory.h"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <cstring>

namespace rgbdt {
namespace {

constexpr std::size_t kImage = 2'818'816, kBlock = 44 * MessageMemory::kLarge;

// Whether pages are mapped there: the system knows.
bool IsMapped(std::uint8_t* data) { return msync(data, 1, MS_ASYNC) == 0; }

TEST(MessageMemory, WhatOneMessageWasInServesTheNext) {
  MessageMemory memory;
  std::uint8_t* first = memory.Take(kImage);
  std::memset(first, 1, kImage);
  std::uint8_t* second = memory.Take(kImage);
  EXPECT_NE(first, second);
  memory.GiveBack(first, kImage, 0);
  EXPECT_EQ(memory.bytes_kept(), kBlock);
  std::uint8_t* other = memory.Take(kImage / 2);
  EXPECT_NE(other, first) << "of another size";
  EXPECT_EQ(memory.Take(kImage - 100), first) << "packed images are not all of one size";
  EXPECT_EQ(memory.bytes_kept(), 0U);
  memory.GiveBack(second, kImage, 0);
  memory.GiveBack(first, kImage - 100, 0);
  EXPECT_EQ(memory.Take(kImage), first) << "the one used last, so that others are spare";
  memory.GiveBack(first, kImage, 0);
  memory.GiveBack(other, kImage / 2, 0);
}

TEST(MessageMemory, WhatABurstTookGoesBackToTheSystem) {
  MessageMemory memory;
  std::vector<std::uint8_t*> burst(20);
  for (std::uint8_t*& data : burst) data = memory.Take(kImage);
  for (std::uint8_t* data : burst) memory.GiveBack(data, kImage, 0);
  EXPECT_EQ(memory.bytes_kept(), 20 * kBlock);
  // From then on one at a time.
  for (Utime now = 0; now <= MessageMemory::kKept; now += MessageMemory::kKept / 10) {
    memory.GiveBack(memory.Take(kImage), kImage, now);
  }
  EXPECT_EQ(memory.bytes_kept(), 20 * kBlock) << "not yet";
  memory.GiveBack(memory.Take(kImage), kImage, MessageMemory::kKept + 1);
  EXPECT_EQ(memory.bytes_kept(), kBlock);
  EXPECT_TRUE(IsMapped(burst.back()));
  for (std::size_t i = 0; i + 1 < burst.size(); ++i) EXPECT_FALSE(IsMapped(burst[i])) << i;
}

TEST(MessageMemory, SmallMessagesAreMallocs) {
  const std::size_t before = MessageMemory::OfProcess().bytes_kept();
  { const MessageBytes small(MessageMemory::kLarge - 1); }
  EXPECT_EQ(MessageMemory::OfProcess().bytes_kept(), before);
  { const MessageBytes large(MessageMemory::kLarge, 7); }
  EXPECT_EQ(MessageMemory::OfProcess().bytes_kept(), before + MessageMemory::kLarge);
}

}  // namespace
}  // namespace rgbdt
