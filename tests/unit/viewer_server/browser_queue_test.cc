#include "viewer/server/internal/browser_queue.h"

#include <gmock/gmock.h>

#include <memory>
#include <string>
#include <vector>

#include "calib/present/layout/frame.h"
#include "test_browser.h"
#include "viewer/server/internal/frame_layout.h"
#include "viewer/server/internal/steady_seconds.h"

namespace rgbdt::viewer {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::int64_t kAllPoints = 10'000'000;

void Offer(BrowserQueue* queue, Post post) {
  queue->Offer(std::make_shared<LazyPost>(std::move(post)));
}

std::string NameOf(const BrowserQueue::Outgoing& out) {
  const std::string& frame = *out.frame;
  return nlohmann::json::parse(frame.substr(8, HeaderBytes(frame) - 8)).at("name");
}

// All that may be sent now.
std::vector<std::string> Names(BrowserQueue* queue) {
  std::vector<std::string> names;
  while (const auto out = queue->Next()) names.push_back(NameOf(*out));
  return names;
}

Post HeavyPost(const std::string& topic, std::size_t bytes = 0) {
  Post post;
  post.topic = topic;
  post.heavy = true;
  post.make = [topic, bytes] {
    FrameWriter frame({{"type", "image"}, {"name", topic}, {"ack", true}});
    frame.AddBytes("jpeg", std::string(bytes, 'j'));
    return frame.Finish();
  };
  return post;
}

// A part of a whole sweep.
Post SweepPost(const std::string& name, std::uint32_t records) {
  Post post = CloudPost("sweep/0", name, records);
  post.kept = true;
  return post;
}

TEST(BrowserQueue, NewestOfATopicTakesTheOldersPlace) {
  BrowserQueue queue;
  Offer(&queue, LightPost("a", "a1"));
  Offer(&queue, LightPost("b", "b1"));
  Offer(&queue, LightPost("a", "a2"));
  EXPECT_THAT(Names(&queue), ElementsAre("a2", "b1"));
}

TEST(BrowserQueue, WhatIsNotWatchedIsNotTaken) {
  BrowserQueue queue;
  Offer(&queue, CloudPost("sweep/0", "unseen", 1));
  EXPECT_THAT(Names(&queue), IsEmpty());
  EXPECT_THAT(queue.Watch({"cloud"}, kAllPoints), ElementsAre("cloud"));
  EXPECT_THAT(queue.Watch({"camera/rgb", "cloud"}, kAllPoints), ElementsAre("camera/rgb"));
  Offer(&queue, CloudPost("sweep/0", "seen", 1));
  EXPECT_THAT(Names(&queue), ElementsAre("seen"));
}

TEST(BrowserQueue, WhatIsNotWatchedAnyMoreIsDropped) {
  BrowserQueue queue;
  queue.Watch({"cloud"}, kAllPoints);
  Offer(&queue, CloudPost("sweep/0", "old", 1));
  queue.Watch({}, kAllPoints);
  EXPECT_EQ(queue.waiting(), 0U);
}

TEST(BrowserQueue, LightGoesBeforeHeavy) {
  BrowserQueue queue;
  Offer(&queue, HeavyPost("heavy"));
  Offer(&queue, LightPost("light", "light"));
  EXPECT_THAT(Names(&queue), ElementsAre("light", "heavy"));
}

TEST(BrowserQueue, FourHeavyFramesAreSentAheadOfAcks) {
  BrowserQueue queue;
  for (const char* topic : {"1", "2", "3", "4", "5", "6"}) Offer(&queue, HeavyPost(topic, 300'000));
  EXPECT_THAT(Names(&queue), ElementsAre("1", "2", "3", "4"));
  queue.Acked(17);  // was never sent
  EXPECT_THAT(Names(&queue), IsEmpty());
  queue.Acked(2);
  queue.Acked(2);
  EXPECT_THAT(Names(&queue), ElementsAre("5"));
}

TEST(BrowserQueue, ManySmallFramesAreSentAheadOfAcks) {
  BrowserQueue queue;
  for (int i = 0; i < 200; ++i) Offer(&queue, HeavyPost(std::to_string(i), 20'000));
  EXPECT_EQ(Names(&queue).size(), 53U);  // the last of them reaches 1 MB
}

TEST(BrowserQueue, FourMegabytesAreSentAheadOfAcks) {
  BrowserQueue queue;
  for (const char* topic : {"1", "2", "3", "4"}) Offer(&queue, HeavyPost(topic, 2'200'000));
  EXPECT_THAT(Names(&queue), ElementsAre("1", "2"));
  queue.Acked(1);
  EXPECT_THAT(Names(&queue), ElementsAre("3"));
}

TEST(BrowserQueue, LargeOnesGoOneByOne) {
  BrowserQueue queue;
  for (const char* topic : {"1", "2"}) Offer(&queue, HeavyPost(topic, 5'000'000));
  EXPECT_THAT(Names(&queue), ElementsAre("1"));
  queue.Acked(1);
  EXPECT_THAT(Names(&queue), ElementsAre("2"));
}

TEST(BrowserQueue, AckTellsWhenATimedPostWasSent) {
  BrowserQueue queue;
  Post post = HeavyPost("a");
  post.timed = true;
  const double before = SteadySeconds();
  Offer(&queue, post);
  const double after = SteadySeconds();
  Offer(&queue, HeavyPost("b"));
  Names(&queue);
  const auto sent = queue.Acked(1);
  ASSERT_TRUE(sent);
  EXPECT_GE(*sent, before);
  EXPECT_LE(*sent, after);
  EXPECT_EQ(queue.Acked(1), std::nullopt);
  EXPECT_EQ(queue.Acked(2), std::nullopt);
}

TEST(BrowserQueue, OldestOfMoreThanEightCloudsAreDropped) {
  BrowserQueue queue;
  queue.Watch({"cloud"}, kAllPoints);
  for (int i = 0; i < 10; ++i) {
    Offer(&queue, CloudPost("chunk/" + std::to_string(i), std::to_string(i), 64));
  }
  EXPECT_EQ(queue.waiting(), 8U);
  EXPECT_EQ(queue.thinned(), 2);
  EXPECT_EQ(queue.share(), 0.5);
  EXPECT_THAT(Names(&queue), ElementsAre("2", "3", "4", "5", "6", "7", "8", "9"));
}

// Nothing comes any more: the browser gets what it was spared.
TEST(BrowserQueue, ACutSweepGoesAgainWholeOnceAllIsDrawn) {
  BrowserQueue queue;
  queue.Watch({"cloud"}, kAllPoints);
  for (int i = 0; i < 9; ++i) Offer(&queue, CloudPost("chunk/" + std::to_string(i), "", 100));
  Offer(&queue, SweepPost("sweep", 100));
  const std::size_t sent = Names(&queue).size();
  for (std::size_t id = 1; id < sent; ++id) queue.Acked(static_cast<std::uint32_t>(id));
  EXPECT_FALSE(queue.Next()) << "the last one is not drawn yet";
  queue.Acked(static_cast<std::uint32_t>(sent));
  const auto again = queue.Next();
  ASSERT_TRUE(again);
  EXPECT_EQ(NameOf(*again), "sweep");
  EXPECT_EQ(again->bytes, again->frame->size());
  EXPECT_EQ(queue.Acked(again->id), std::nullopt);
  EXPECT_FALSE(queue.Next());
}

TEST(BrowserQueue, ACutSweepDoesNotGoAgainWhereANewerOneCame) {
  BrowserQueue queue;
  queue.Watch({"cloud"}, kAllPoints);
  for (int i = 0; i < 9; ++i) Offer(&queue, CloudPost("chunk/" + std::to_string(i), "", 100));
  Offer(&queue, SweepPost("old", 100));
  std::uint32_t last = 0;
  while (const auto out = queue.Next()) last = out->id;
  Offer(&queue, SweepPost("new", 1));
  for (std::uint32_t id = 1; id <= last; ++id) queue.Acked(id);
  EXPECT_THAT(Names(&queue), ElementsAre("new"));
  queue.Acked(last + 1);
  EXPECT_THAT(Names(&queue), IsEmpty());
}

TEST(BrowserQueue, CloudIsCutAtAWholeRecord) {
  BrowserQueue queue;
  queue.Watch({"cloud"}, kAllPoints);
  for (int i = 0; i < 9; ++i) Offer(&queue, CloudPost("chunk/" + std::to_string(i), "", 101));
  const auto out = queue.Next();
  ASSERT_TRUE(out);
  const std::size_t header = HeaderBytes(*out->frame);
  EXPECT_EQ(out->frame->substr(header), Records(101));
  EXPECT_EQ(out->bytes - header, 4 * 51U);  // 50.5 rounded
  EXPECT_EQ(queue.thinned(), 2);
}

TEST(BrowserQueue, ReplayDropsNothing) {
  BrowserQueue queue;
  queue.Watch({"cloud"}, kAllPoints);
  for (int i = 0; i < 12; ++i) {
    queue.Replay(std::make_shared<LazyPost>(CloudPost("sweep/" + std::to_string(i), "", 64)));
  }
  EXPECT_EQ(queue.waiting(), 12U);
  EXPECT_EQ(queue.share(), 1);
}

// Topics without end must not fill the memory of a browser that takes nothing.
TEST(BrowserQueue, WhatWaitsIsBounded) {
  BrowserQueue queue;
  queue.Watch({"cloud"}, kAllPoints);
  for (int i = 0; i < 5000; ++i) {
    const std::string number = std::to_string(i);
    Offer(&queue, LightPost("a" + number, ""));
    Offer(&queue, LightPost("b" + number, "", true));
    Offer(&queue, HeavyPost("c" + number));
    Offer(&queue, CloudPost("d" + number, "", 1));
  }
  EXPECT_LE(queue.waiting(), 8U + 256U + 2 * 4096U);
}

TEST(BrowserQueue, WhatCannotBeMadeIsSkipped) {
  BrowserQueue queue;
  Post broken = LightPost("broken", "");
  broken.make = []() -> std::string { throw std::runtime_error("no picture"); };
  Offer(&queue, broken);
  broken.topic = "short";
  broken.make = [] { return std::string("no frame"); };
  Offer(&queue, broken);
  broken.topic = "none";
  broken.make = nullptr;
  Offer(&queue, broken);
  Offer(&queue, LightPost("good", "good"));
  const auto out = queue.Next();
  ASSERT_TRUE(out);
  EXPECT_EQ(NameOf(*out), "good");
  EXPECT_EQ(out->id, 1U);  // the page counts what it gets
}

}  // namespace
}  // namespace rgbdt::viewer
