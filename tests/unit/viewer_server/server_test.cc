#include "viewer/server/server.h"

#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "calib/model/errors.h"
#include "calib/present/layout/frame.h"
#include "test_browser.h"

namespace rgbdt::viewer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kPolicyError = 1008;
constexpr int kBadPayload = 1007;
constexpr int kTooBig = 1009;

class ServerTest : public ::testing::Test {
 protected:
  static ServerOptions Options() {
    ServerOptions options;
    options.port = 0;
    options.hello = {{"source", "live"}, {"title", "udpm://"}, {"version", "0.1.0"}};
    return options;
  }

  // Reads up to the post that only this sends: what was to come before it is there.
  std::vector<GotFrame> UpToNow(TestBrowser* browser) {
    const std::string end = "end " + std::to_string(++ends_);
    server_.Send(LightPost("end", end));
    std::vector<GotFrame> frames;
    while (true) {
      GotFrame frame = browser->Next();
      if (frame.name() == end) return frames;
      frames.push_back(std::move(frame));
    }
  }
  std::vector<std::string> NamesUpToNow(TestBrowser* browser) {
    std::vector<std::string> names;
    for (const GotFrame& frame : UpToNow(browser)) names.push_back(frame.name());
    return names;
  }

  // Returns once the server heard it.
  static void Watch(TestBrowser* browser, bool cloud) {
    browser->Watch(cloud, {});
    ASSERT_EQ(browser->Next().name(), "watched");
  }
  static std::vector<Post> OnMessage(const nlohmann::json& message) {
    if (message["type"] != "watch") return {};
    return {LightPost("watched", "watched")};
  }

  int ends_ = 0;
  Server server_{Options(), OnMessage};
};

TEST_F(ServerTest, HelloIsAnswered) {
  TestBrowser browser(server_);
  const GotFrame hello = browser.Hello();
  EXPECT_EQ(hello.id, 1U);
  EXPECT_EQ(hello.header, nlohmann::json({{"type", "hello"},
                                          {"source", "live"},
                                          {"title", "udpm://"},
                                          {"version", "0.1.0"},
                                          {"may_command", true},
                                          {"why_not", ""}}));
  const auto browsers = server_.Browsers();
  ASSERT_EQ(browsers.size(), 1U);
  EXPECT_THAT(browsers[0].address, HasSubstr("127.0.0.1:"));
  EXPECT_EQ(browsers[0].share, 1);
}

TEST_F(ServerTest, NothingComesBeforeHello) {
  TestBrowser first(server_), second(server_);
  first.Hello();
  server_.Send(LightPost("a", "before"));
  EXPECT_THAT(NamesUpToNow(&first), ElementsAre("before"));
  second.Hello();
  EXPECT_THAT(NamesUpToNow(&second), ElementsAre());
}

TEST_F(ServerTest, FramesAreCounted) {
  TestBrowser browser(server_);
  browser.Hello();
  for (std::uint32_t id = 2; id < 6; ++id) {
    server_.Send(LightPost("a", "x"));
    EXPECT_EQ(browser.Next().id, id);
  }
}

TEST_F(ServerTest, NewcomersGetWhatIsKept) {
  server_.Send(LightPost("rig", "old rig", true));
  server_.Send(LightPost("passing", "passing", false));
  server_.Send(LightPost("session", "session", true));
  server_.Send(LightPost("thumb/1", "thumb", true));
  server_.Send(LightPost("rig", "rig", true));
  server_.Forget("thumb/");
  TestBrowser first(server_);
  first.Hello();
  NamesUpToNow(&first);  // may still have got what passed
  TestBrowser second(server_);
  second.Hello();
  EXPECT_THAT(NamesUpToNow(&second), ElementsAre("rig", "session"));
}

TEST_F(ServerTest, WatchingBringsWhatIsKeptOfIt) {
  Post image = LightPost("image/rgb", "image", true);
  image.watch = "camera/rgb";
  server_.Send(image);
  Post overlay = LightPost("overlay/rgb", "overlay", true);
  overlay.watch = "overlay/rgb";
  server_.Send(overlay);
  TestBrowser browser(server_);
  browser.Hello();
  EXPECT_THAT(NamesUpToNow(&browser), ElementsAre());
  browser.Watch(false, {"rgb"});
  EXPECT_EQ(browser.Next().name(), "image");
  EXPECT_EQ(browser.Next().name(), "overlay");
  EXPECT_EQ(browser.Next().name(), "watched");
  browser.Watch(true, {"rgb"});  // is watched already
  EXPECT_EQ(browser.Next().name(), "watched");
  Watch(&browser, true);
  server_.Send(image);
  EXPECT_THAT(NamesUpToNow(&browser), ElementsAre());
}

TEST_F(ServerTest, FramesAreMadeOnceAndOnlyWhereTheyGo) {
  std::atomic<int> made{0};
  const auto cloud = [&](const std::string& name) {
    Post post = CloudPost("sweep/0", name, 10);
    post.make = [&made, make = post.make] {
      ++made;
      return make();
    };
    return post;
  };
  TestBrowser first(server_), second(server_);
  first.Hello();
  second.Hello();
  server_.Send(cloud("unseen"));
  EXPECT_THAT(NamesUpToNow(&first), ElementsAre());
  EXPECT_EQ(second.Next().name(), "end 1");
  EXPECT_EQ(made, 0);
  Watch(&first, true);
  Watch(&second, true);
  server_.Send(cloud("seen"));
  EXPECT_EQ(first.Next().name(), "seen");
  EXPECT_EQ(second.Next().name(), "seen");
  EXPECT_EQ(made, 1);
}

TEST_F(ServerTest, PostThatCannotBeMadeIsDropped) {
  TestBrowser browser(server_);
  browser.Hello();
  Post broken = LightPost("broken", "");
  broken.make = []() -> std::string { throw std::runtime_error("no picture"); };
  server_.Send(broken);
  EXPECT_THAT(NamesUpToNow(&browser), ElementsAre());
}

TEST_F(ServerTest, ScreenTimesRunToTheAck) {
  EXPECT_FALSE(server_.Screen());
  TestBrowser browser(server_);
  browser.Hello();
  Post image = LightPost("image", "image");
  image.heavy = true;
  image.timed = true;
  server_.Send(image);
  const auto id = browser.Next().id;
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  browser.Ack(id);
  browser.Say({{"type", "hello"}, {"token", ""}});  // ends it: the ack was heard
  EXPECT_EQ(browser.CloseCode(), kPolicyError);
  const auto screen = server_.Screen();
  ASSERT_TRUE(screen);
  EXPECT_EQ(screen->count, 1);
  EXPECT_GE(screen->p50, 50);
}

// One browser takes 4 heavy frames and says nothing; the other one gets everything.
TEST_F(ServerTest, ABrowserThatDoesNotDrawCostsOnlyItself) {
  TestBrowser stalled(server_), drawing(server_);
  for (TestBrowser* browser : {&stalled, &drawing}) {
    browser->Hello();
    Watch(browser, true);
  }
  std::vector<std::string> sent, got;
  for (int i = 0; i < 40; ++i) {
    sent.push_back(std::to_string(i));
    server_.Send(CloudPost("chunk/" + sent.back(), sent.back(), 80'000));
    const GotFrame frame = drawing.Next();
    got.push_back(frame.name());
    EXPECT_EQ(frame.payload.size(), 320'000U);
    drawing.Ack(frame.id);
    if (i >= 4) continue;
    EXPECT_EQ(stalled.Next().name(), sent.back());
  }
  EXPECT_EQ(got, sent);
  const auto browsers = server_.Browsers();
  ASSERT_EQ(browsers.size(), 2U);
  EXPECT_EQ(browsers[0].waiting, 8U);
  EXPECT_EQ(browsers[0].thinned, 40 - 4 - 8);
  EXPECT_EQ(browsers[0].share, 0.5);
  EXPECT_EQ(browsers[1].thinned, 0);
  EXPECT_THAT(NamesUpToNow(&stalled), ElementsAre());
  stalled.Ack(3);  // one place: the oldest that still waits, its points halved
  const GotFrame next = stalled.Next();
  EXPECT_EQ(next.name(), "32");
  EXPECT_EQ(next.payload, Records(40'000));
}

// A browser whose window is full does not even take what is being written.
TEST_F(ServerTest, ABrowserThatDoesNotReadCostsOnlyItself) {
  TestBrowser stalled(server_), reading(server_);
  stalled.Hello();
  Watch(&stalled, true);
  reading.Hello();
  for (int i = 0; i < 20; ++i) {
    server_.Send(CloudPost("chunk/" + std::to_string(i), "", 6'000'000));  // 24 MB
    server_.Send(LightPost("light", std::to_string(i)));
    EXPECT_EQ(reading.Next().name(), std::to_string(i));
  }
  EXPECT_EQ(server_.Browsers()[0].thinned, 20 - 1 - 8);
}

TEST_F(ServerTest, AFloodIsHeldInLittleMemory) {
  TestBrowser stalled(server_);
  stalled.Hello();
  Watch(&stalled, true);
  const auto alive = std::make_shared<int>();
  for (int i = 0; i < 10'000; ++i) {
    Post post = CloudPost("chunk/" + std::to_string(i), "", 100'000);
    post.make = [alive, make = post.make] { return make(); };
    server_.Send(std::move(post));
    ASSERT_LE(alive.use_count(), 1 + 16 + 16 + 8 + 2);
  }
  (void)NamesUpToNow(&stalled);
  const auto browsers = server_.Browsers();
  ASSERT_EQ(browsers.size(), 1U);
  EXPECT_LE(browsers[0].waiting, 8U);
}

TEST_F(ServerTest, MalformedMessagesCloseOnlyTheirConnection) {
  TestBrowser other(server_);
  other.Hello();
  const std::vector<std::pair<std::string, int>> malformed = {
      {"", kBadPayload},
      {"hello", kBadPayload},
      {"{\"type\":", kBadPayload},
      {std::string(1000, '['), kBadPayload},
      {std::string("\0\0\0", 3), kBadPayload},
      {"\xff\xfe", kBadPayload},
      {"null", kPolicyError},
      {"[]", kPolicyError},
      {"{}", kPolicyError},
      {R"({"type":"reboot"})", kPolicyError},
      {R"({"type":"hello","token":""})", kPolicyError},
      {R"({"type":"ack","id":-1})", kPolicyError},
      {R"({"type":"ack","id":"1"})", kPolicyError},
      {R"({"type":"ack","id":1,"more":2})", kPolicyError},
      {R"({"type":"watch"})", kPolicyError},
      {R"({"type":"watch","cloud":1,"cameras":[],"overlay_cloud":false,"points":1})", kPolicyError},
      {R"({"type":"watch","cloud":true,"cameras":[],"overlay_cloud":false,"points":0})",
       kPolicyError},
      {R"({"type":"view","view":7})", kPolicyError},
      {R"({"type":"request","request":"reboot","heldout":true})", kPolicyError},
      {R"({"type":"request","request":"finish","heldout":"no"})", kPolicyError},
      {R"({"type":"pick","camera":"rgb","image_utime":1,"corners":[[1,2]]})", kPolicyError},
      {R"({"type":"pick","camera":"rgb","image_utime":1.5,)"
       R"("corners":[[1,2],[1,2],[1,2],[1,2]]})",
       kPolicyError},
      {std::string(64 * 1024 + 1, ' '), kTooBig}};
  for (const auto& [text, code] : malformed) {
    SCOPED_TRACE(text.substr(0, 100));
    TestBrowser browser(server_);
    browser.Hello();
    browser.SayText(text);
    EXPECT_EQ(browser.CloseCode(), code);
  }
  EXPECT_THAT(NamesUpToNow(&other), ElementsAre());
  // A browser hears of its end a little before the server is done with it.
  for (int turns = 0; turns < 10'000 && server_.Browsers().size() > 1; ++turns) UpToNow(&other);
  EXPECT_EQ(server_.Browsers().size(), 1U);
}

TEST_F(ServerTest, WhatIsOutOfOrderClosesTheConnection) {
  TestBrowser early(server_);
  early.Ack(1);
  EXPECT_EQ(early.CloseCode(), kPolicyError);
  EXPECT_EQ(early.CloseReason(), "hello must come first");
  TestBrowser binary(server_);
  binary.SayText(R"({"type":"hello","token":""})", true);
  EXPECT_EQ(binary.CloseCode(), kPolicyError);
  EXPECT_EQ(binary.CloseReason(), "binary message");
}

TEST_F(ServerTest, RandomBytesCloseOnlyTheirConnection) {
  TestBrowser other(server_);
  other.Hello();
  std::mt19937 random(11);
  for (int i = 0; i < 200; ++i) {
    std::string bytes(20 + random() % 200, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    bytes[0] = static_cast<char>(bytes[0] | 0x40);  // a reserved bit: no frame begins so
    TestBrowser browser(server_);
    browser.Hello();
    browser.SayRaw(bytes);
    EXPECT_NE(browser.CloseCode(), 1000);  // or a reset, as bytes were left unread
  }
  EXPECT_THAT(NamesUpToNow(&other), ElementsAre());
}

// The same with messages to answer.
class Answering {
 public:
  explicit Answering(const std::string& token = "") : server_(Options(token), OnMessage()) {}
  Server* operator->() { return &server_; }
  const Server& server() const { return server_; }
  int asked() const { return asked_; }

 private:
  static ServerOptions Options(const std::string& token) {
    ServerOptions options;
    options.port = 0;
    options.token = token;
    return options;
  }
  Server::OnMessage OnMessage() {
    return [this](const nlohmann::json& message) -> std::vector<Post> {
      ++asked_;
      if (message["type"] == "view") throw InputError("view is " + message["view"].dump());
      if (message["type"] == "pick") throw std::logic_error("oh");
      if (message["type"] == "watch") return {};
      return {LightPost("answer", message.dump())};
    };
  }

  std::atomic<int> asked_{0};
  Server server_;
};

const nlohmann::json kCapture = {{"type", "request"}, {"request", "capture"}, {"heldout", true}};
const nlohmann::json kPick = {{"type", "pick"},
                              {"camera", "rgb"},
                              {"image_utime", 1},
                              {"corners", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}}};

TEST(ServerAnswers, OnlyTheBrowserThatAsked) {
  Answering node;
  TestBrowser asking(node.server()), other(node.server());
  asking.Hello();
  other.Hello();
  asking.Say(kCapture);
  EXPECT_EQ(nlohmann::json::parse(asking.Next().name()), kCapture);
  node->Send(LightPost("a", "end"));
  EXPECT_EQ(other.Next().name(), "end");
}

TEST(ServerAnswers, AnErrorBecomesANotice) {
  Answering node;
  TestBrowser browser(node.server());
  browser.Hello();
  browser.Say({{"type", "view"}, {"view", "0007"}});
  EXPECT_EQ(browser.Next().header,
            nlohmann::json({{"type", "notice"}, {"level", "error"}, {"text", "view is \"0007\""}}));
  browser.Say(kPick);
  EXPECT_EQ(browser.Next().header["text"], "oh");
}

TEST(ServerAnswers, CommandsNeedTheToken) {
  Answering node("s3cret");
  for (const char* token : {"", "s3cre", "s3crets", "S3cret"}) {
    TestBrowser browser(node.server());
    const GotFrame hello = browser.Hello(token);
    EXPECT_EQ(hello.header["may_command"], false);
    EXPECT_THAT(hello.header["why_not"], HasSubstr("token that rgbdt-viewer printed"));
    for (const nlohmann::json& command : {kCapture, kPick}) {
      browser.Say(command);
      const GotFrame notice = browser.Next();
      EXPECT_EQ(notice.type(), "notice");
      EXPECT_THAT(notice.header["text"], HasSubstr("token that rgbdt-viewer printed"));
    }
    EXPECT_EQ(node.asked(), 0);
  }
}

TEST(ServerAnswers, CommandsWithTheTokenAreTaken) {
  Answering node("s3cret");
  TestBrowser browser(node.server());
  EXPECT_EQ(browser.Hello("s3cret").header["may_command"], true);
  browser.Say(kCapture);
  EXPECT_EQ(nlohmann::json::parse(browser.Next().name()), kCapture);
}

// What is to be shown is no command.
TEST(ServerAnswers, ViewsAreShownWithoutTheToken) {
  Answering node("s3cret");
  TestBrowser browser(node.server());
  browser.Hello();
  browser.Watch(false, {});
  browser.Say({{"type", "view"}, {"view", "0007"}});
  EXPECT_EQ(browser.Next().header["text"], "view is \"0007\"");
  EXPECT_EQ(node.asked(), 2);
}

}  // namespace
}  // namespace rgbdt::viewer
