#include "services/bus/internal/message_memory.h"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <cstring>

namespace rgbdt {
namespace {

constexpr std::size_t kImage = 2'818'816, kBlock = 44 * MessageMemory::kLarge;

// Whether memory is there, and in use: the system knows.
bool IsMapped(std::uint8_t* data) { return msync(data, 1, MS_ASYNC) == 0; }
bool IsTouched(std::uint8_t* data) {
  unsigned char page = 0;
  return mincore(data, 1, &page) == 0 && (page & 1) != 0;
}

TEST(MessageMemory, WhatOneMessageWasInServesTheNext) {
  MessageMemory memory(0);
  std::uint8_t* first = memory.Take(kImage);
  std::memset(first, 1, kImage);
  std::uint8_t* second = memory.Take(kImage);
  EXPECT_NE(first, second);
  memory.GiveBack(first, kImage, 0);
  std::uint8_t* other = memory.Take(kImage / 2);
  EXPECT_NE(other, first) << "of another size";
  EXPECT_EQ(memory.Take(kImage - 100), first) << "packed images are not all of one size";
  memory.GiveBack(second, kImage, 0);
  memory.GiveBack(first, kImage - 100, 0);
  EXPECT_EQ(memory.Take(kImage), first) << "the one used last, so that others are spare";
  EXPECT_EQ(memory.bytes(), 2 * kBlock + kBlock / 2);
  memory.GiveBack(first, kImage, 0);
  memory.GiveBack(other, kImage / 2, 0);
}

TEST(MessageMemory, ABurstsMemoryGoesBackAndTheRestIsThereFromTheFirstMessage) {
  MessageMemory memory(5 * kBlock);
  EXPECT_EQ(memory.bytes(), 0U);
  std::vector<std::uint8_t*> burst = {memory.Take(kImage)};
  EXPECT_EQ(memory.bytes(), 5 * kBlock);
  while (burst.size() < 5) burst.push_back(memory.Take(kImage));
  for (std::uint8_t* data : burst) EXPECT_TRUE(IsTouched(data)) << "before it is written to";
  EXPECT_EQ(memory.bytes(), 5 * kBlock);
  while (burst.size() < 20) burst.push_back(memory.Take(kImage));
  EXPECT_EQ(memory.bytes(), 20 * kBlock);
  for (std::uint8_t* data : burst) memory.GiveBack(data, kImage, 0);
  // From then on one at a time.
  for (Utime now = 0; now <= MessageMemory::kSpare; now += MessageMemory::kSpare / 10) {
    memory.GiveBack(memory.Take(kImage), kImage, now);
  }
  EXPECT_EQ(memory.bytes(), 20 * kBlock) << "not yet";
  memory.GiveBack(memory.Take(kImage), kImage, MessageMemory::kSpare + 1);
  EXPECT_EQ(memory.bytes(), 5 * kBlock);
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(IsMapped(burst[i]), i >= 15) << i;
}

// The first messages were of another size than those that come from then on.
TEST(MessageMemory, WhatItHoldsFollowsTheMessagesSizes) {
  MessageMemory memory(5 * kBlock);
  memory.GiveBack(memory.Take(kImage / 2), kImage / 2, 0);
  EXPECT_EQ(memory.bytes(), 5 * kBlock);
  for (Utime now = 1; now <= 3; ++now) {
    memory.GiveBack(memory.Take(kImage), kImage, now * (MessageMemory::kSpare + 1));
  }
  EXPECT_EQ(memory.bytes(), 5 * kBlock);
}

TEST(MessageMemory, SmallMessagesAreMallocs) {
  const auto bytes = [] { return MessageMemory::OfProcess().bytes(); };
  const std::size_t before = bytes();
  const MessageBytes small(MessageMemory::kLarge - 1);
  EXPECT_EQ(bytes(), before);
  const MessageBytes large(2 * MessageMemory::kHeld, 7);
  EXPECT_EQ(bytes(), before + large.size());
}

}  // namespace
}  // namespace rgbdt
