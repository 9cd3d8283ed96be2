#include "viewer/server/internal/channels.h"

#include <gmock/gmock.h>

#include "viewer/server/internal/foxglove_queue.h"

namespace rgbdt::viewer {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

ChannelMessage ForChannel(const std::string& topic, const std::string& text, bool large = false,
                          const std::string& holds_for = "") {
  ChannelMessage message;
  message.topic = topic;
  message.schema_name = "test.Text";
  message.schema = std::make_shared<const std::string>("schema");
  message.large = large;
  message.holds_for = holds_for;
  message.make = [text] { return text; };
  return message;
}

class Listening : public ChannelListener {
 public:
  void OnChannel(const Channel& channel) override { all.push_back("new " + channel.topic); }
  void OnEnd(const std::vector<std::uint32_t>& ids) override {
    all.push_back("end " + std::to_string(ids.size()));
  }
  void OnMessage(std::uint32_t channel, const SharedMessage& message) override {
    all.push_back(std::to_string(channel) + " " + *message->payload.Get());
  }
  std::vector<std::string> all;
};

class ChannelsTest : public testing::Test {
 protected:
  ChannelsTest() { channels_.Join(&listener_); }
  std::vector<std::string> Come() {
    channels_.Dispatch();
    return std::exchange(listener_.all, {});
  }

  Channels channels_;
  Listening listener_;
};

TEST_F(ChannelsTest, AChannelBeginsWithItsFirstMessage) {
  EXPECT_TRUE(channels_.Publish(ForChannel("/a", "1"))) << "the server is to be woken";
  EXPECT_FALSE(channels_.Publish(ForChannel("/b", "2")));
  channels_.Publish(ForChannel("/a", "3"));
  EXPECT_THAT(Come(), ElementsAre("new /a", "1 1", "new /b", "2 2", "1 3"));
  ChannelMessage other = ForChannel("/a", "4");
  other.schema_name = "test.Other";
  channels_.Publish(other);
  EXPECT_THAT(Come(), IsEmpty()) << "a channel is of one type";
}

TEST_F(ChannelsTest, OfWhatIsLargeAndWaitsTheNewestOfItsTopicStays) {
  channels_.Publish(ForChannel("/a", "1", true));
  channels_.Publish(ForChannel("/b", "2", true));
  channels_.Publish(ForChannel("/a", "3", true));
  EXPECT_THAT(Come(), ElementsAre("new /b", "1 2", "new /a", "2 3"));
}

TEST_F(ChannelsTest, WhatWaitsIsBounded) {
  channels_.Publish(ForChannel("/held", "0", false, "rgb"));
  for (int i = 0; i < 300; ++i) channels_.Publish(ForChannel("/log", std::to_string(i)));
  const auto come = Come();
  EXPECT_THAT(come, SizeIs(258));
  EXPECT_EQ(come[1], "1 0") << "what holds";
  EXPECT_EQ(come.back(), "2 299");
  for (int i = 0; i < 300; ++i) channels_.Publish(ForChannel("/" + std::to_string(i), ""));
  channels_.Dispatch();
  EXPECT_THAT(channels_.all(), SizeIs(256));
}

TEST_F(ChannelsTest, WhatHoldsIsTheNewestOfEachName) {
  channels_.Publish(ForChannel("/tf", "guess", false, "rgb"));
  channels_.Publish(ForChannel("/tf", "thermal", false, "thermal"));
  channels_.Publish(ForChannel("/tf", "solved", false, "rgb"));
  channels_.Dispatch();
  const auto& holding = channels_.all().at(1).holding;
  ASSERT_THAT(holding, SizeIs(2));
  EXPECT_EQ(*holding.at("rgb")->payload.Get(), "solved");
  for (int i = 0; i < 100; ++i) {
    channels_.Publish(ForChannel("/tf", "", false, std::to_string(i)));
  }
  channels_.Dispatch();
  EXPECT_THAT(holding, SizeIs(64));
}

TEST_F(ChannelsTest, AfterTheEndAllBeginsAnew) {
  channels_.Publish(ForChannel("/a", "1", false, "x"));
  channels_.End();
  channels_.Publish(ForChannel("/a", "2"));
  EXPECT_THAT(Come(), ElementsAre("new /a", "1 1", "end 1", "new /a", "2 2"));
  EXPECT_THAT(channels_.all().at(2).holding, IsEmpty());
}

TEST_F(ChannelsTest, OneKnowsWhetherAnybodyListens) {
  EXPECT_TRUE(channels_.AnybodyListens());
  channels_.Leave(&listener_);
  EXPECT_FALSE(channels_.AnybodyListens());
  channels_.Publish(ForChannel("/a", "1"));
  EXPECT_THAT(Come(), IsEmpty());
}

// Of a queue: texts, and what stands behind the 13 bytes before a message.
std::vector<std::string> All(FoxgloveQueue* queue) {
  std::vector<std::string> all;
  while (const auto next = queue->Next())
    all.push_back(next->is_text ? next->head : *next->payload);
  return all;
}

SharedMessage Shared(const std::string& text, bool large) {
  return std::make_shared<LazyMessage>(ForChannel("/a", text, large));
}

TEST(FoxgloveQueue, WhoReadsSlowlyLosesWholeMessagesOldestFirst) {
  FoxgloveQueue queue;
  for (int i = 0; i < 5; ++i) queue.Offer(1, Shared("cloud " + std::to_string(i), true));
  for (int i = 0; i < 66; ++i) queue.Offer(2, Shared(std::to_string(i), false));
  queue.Say("text");
  EXPECT_EQ(queue.dropped(), 4 + 2);
  const auto all = All(&queue);
  ASSERT_THAT(all, SizeIs(66));
  EXPECT_EQ(all[0], "text");
  EXPECT_EQ(all[1], "cloud 4");
  EXPECT_EQ(all[2], "2");
  EXPECT_EQ(all[65], "65");
}

TEST(FoxgloveQueue, WhatCannotBeMadeIsPassedOver) {
  FoxgloveQueue queue;
  ChannelMessage broken = ForChannel("/a", "");
  broken.make = []() -> std::string { throw std::runtime_error("no cloud"); };
  queue.Offer(1, std::make_shared<LazyMessage>(broken));
  queue.Offer(1, Shared("next", false));
  EXPECT_THAT(All(&queue), ElementsAre("next"));
}

TEST(FoxgloveQueue, WhatWasUnsubscribedDoesNotCome) {
  FoxgloveQueue queue;
  queue.Offer(1, Shared("one", false));
  queue.Offer(2, Shared("two", false));
  queue.Drop(1);
  EXPECT_THAT(All(&queue), ElementsAre("two"));
}

TEST(FoxgloveQueue, TextsAreBounded) {
  FoxgloveQueue queue;
  for (std::size_t i = 0; i < FoxgloveQueue::kMostTexts; ++i) EXPECT_TRUE(queue.Say("x"));
  EXPECT_FALSE(queue.Say("x"));
}

}  // namespace
}  // namespace rgbdt::viewer
