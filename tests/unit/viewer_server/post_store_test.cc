#include "viewer/server/internal/post_store.h"

#include <gmock/gmock.h>

#include <memory>
#include <string>
#include <vector>

#include "test_browser.h"

namespace rgbdt::viewer {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> Topics(const std::vector<SharedPost>& posts) {
  std::vector<std::string> topics;
  for (const SharedPost& post : posts) topics.push_back(post->post().topic);
  return topics;
}

TEST(PostStore, OnlyTheFirstSendWakes) {
  PostStore store;
  EXPECT_TRUE(store.Send(LightPost("a", "")));
  EXPECT_FALSE(store.Send(LightPost("b", "")));
  store.Take();
  EXPECT_TRUE(store.Send(LightPost("a", "")));
}

TEST(PostStore, KeptOnesStayInTheOrderInWhichTheyWereFirstSent) {
  PostStore store;
  store.Send(LightPost("a", "", true));
  store.Send(LightPost("b", "", true));
  store.Send(LightPost("passing", "", false));
  EXPECT_THAT(Topics(store.Take().sent), ElementsAre("a", "b", "passing"));
  store.Send(LightPost("a", "", true));
  const PostStore::Taken taken = store.Take();
  EXPECT_THAT(Topics(taken.sent), ElementsAre("a"));
  EXPECT_THAT(Topics(taken.kept), ElementsAre("a", "b"));
  EXPECT_EQ(taken.sent[0], taken.kept[0]);
}

TEST(PostStore, ForgetsByTheTopicsBeginning) {
  PostStore store;
  for (const char* topic : {"thumb/1", "session", "thumb/2", "a/thumb/3"}) {
    store.Send(LightPost(topic, "", true));
  }
  store.Forget("thumb/");
  EXPECT_THAT(Topics(store.Take().kept), ElementsAre("session", "a/thumb/3"));
}

TEST(PostStore, APassingPostTakesTheKeptOnesPlace) {
  PostStore store;
  store.Send(LightPost("a", "", true));
  store.Send(LightPost("a", "", false));
  EXPECT_THAT(Topics(store.Take().kept), IsEmpty());
}

// While the server's thread is busy, what it has not taken must not pile up.
TEST(PostStore, HoldsLittleOfAFlood) {
  PostStore store;
  const auto alive = std::make_shared<int>();
  for (int i = 0; i < 10'000; ++i) {
    Post cloud = CloudPost("chunk/" + std::to_string(i), "", 1);
    cloud.make = [alive] { return std::string(); };
    store.Send(cloud);
    Post light = LightPost("light/" + std::to_string(i), "");
    light.make = [alive] { return std::string(); };
    store.Send(light);
    Post forgotten = LightPost("view/" + std::to_string(i), "", true);
    forgotten.make = [alive] { return std::string(); };
    store.Send(forgotten);
    store.Forget("view/");
  }
  EXPECT_LE(alive.use_count(), 16 + 256 + 2);
  EXPECT_EQ(store.Take().sent.back()->post().topic, "view/9999");
}

}  // namespace
}  // namespace rgbdt::viewer
