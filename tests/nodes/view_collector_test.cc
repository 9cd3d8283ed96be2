#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "services/nodes/detector_node.h"
#include "tests/nodes/nodes_testing.h"
#include "tests/numbers.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr Utime kCaptureTime = kSweep + 13 * kSecond;

Rig TwoCameras() {
  Rig rig;
  for (const char* name : {"rgb", "thermal"}) {
    CameraSpec camera;
    camera.name = name;
    rig.cameras.push_back(camera);
  }
  return rig;
}

CloudChunk LinesOf(Utime sweep, int first_line, int lines = 1, int beams = 4) {
  CloudChunk chunk;
  chunk.cloud.sweep_utime = sweep;
  chunk.cloud.first_line = first_line;
  chunk.cloud.lines = lines;
  chunk.cloud.beams = beams;
  chunk.cloud.points.assign(static_cast<std::size_t>(lines * beams),
                            Eigen::Vector3f(1, 2, static_cast<float>(first_line)));
  return chunk;
}

CloudChunk End(Utime sweep, int lines) {
  CloudChunk end;
  end.cloud.sweep_utime = sweep;
  end.sweep_end = true;
  end.sweep_lines = lines;
  return end;
}

Image MakeImage(const std::string& camera, Utime utime) {
  Image image;
  image.camera = camera;
  image.utime = utime;
  return image;
}

CornerSelection Picks(const std::string& camera, Utime image_utime) {
  CornerSelection picks;
  picks.camera = camera;
  picks.image_utime = image_utime;
  return picks;
}

SessionCommand Capture(Utime utime = kCaptureTime, Utime sweep = kSweep,
                       std::vector<std::string> picked = {}) {
  SessionCommand command;
  command.command = 3;
  command.verb = SessionVerb::kCapture;
  command.utime = utime;
  command.view = "0001";
  command.sweep_utime = sweep;
  command.heldout = true;
  command.picked_cameras = std::move(picked);
  return command;
}

class ViewCollectorTest : public ::testing::Test {
 protected:
  void AddSweep(Utime sweep = kSweep, int lines = 3) {
    for (int i = 0; i < lines; ++i) collector_.Add(LinesOf(sweep, i));
    collector_.Add(End(sweep, lines));
  }
  void AddImages(Utime utime = kCaptureTime) {
    for (const CameraSpec& camera : rig_.cameras) collector_.Add(MakeImage(camera.name, utime));
  }

  Rig rig_ = TwoCameras();
  ViewCollector collector_;
};

TEST_F(ViewCollectorTest, WhatArrivesFirstDoesNotMatter) {
  std::vector<int> order = {0, 1, 2, 3};
  do {
    ViewCollector collector;
    for (const int what : order) {
      EXPECT_FALSE(collector.Take(rig_).has_value());
      if (what == 0) {
        for (int i = 0; i < 3; ++i) collector.Add(LinesOf(kSweep, i));
        collector.Add(End(kSweep, 3));
      } else if (what == 1) {
        collector.Begin(Capture(kCaptureTime, kSweep, {"thermal"}));
      } else if (what == 2) {
        collector.Add(MakeImage("rgb", kCaptureTime));
        collector.Add(MakeImage("thermal", kCaptureTime));
      } else {
        collector.Add(Picks("thermal", kCaptureTime));
      }
    }
    const auto view = collector.Take(rig_);
    ASSERT_TRUE(view.has_value());
    EXPECT_EQ(view->name, "0001");
    EXPECT_TRUE(view->heldout);
    EXPECT_EQ(view->cloud.sweep_utime, kSweep);
    EXPECT_EQ(view->cloud.lines, 3);
    ASSERT_EQ(view->images.size(), 2U);
    ASSERT_EQ(view->picks.size(), 1U);
    EXPECT_EQ(view->picks.front().image_utime, kCaptureTime);
    EXPECT_FALSE(collector.Take(rig_).has_value()) << "only once";
  } while (std::next_permutation(order.begin(), order.end()));
}

// Of who was started in the midst of the sweep, and has later images by now.
TEST_F(ViewCollectorTest, WhatIsSaidAgainMakesTheSameViewForWhoLacksIt) {
  AddImages(kSweep + kSecond);
  AddImages(kSweep + 4 * kSecond);
  AddSweep();
  collector_.Begin(Capture(kCaptureTime, kSweep, {"rgb"}));
  AddImages();
  collector_.Add(Picks("rgb", kCaptureTime));
  const std::optional<View> view = collector_.Take(rig_);
  ASSERT_TRUE(view.has_value());
  const Messages again = collector_.Again(*view);

  ViewCollector other;
  other.Add(LinesOf(kSweep, 2));
  for (int i = -40; i < 9; ++i) {
    if (i == 0) continue;  // the view's own never came
    for (const CameraSpec& camera : rig_.cameras) {
      other.Add(MakeImage(camera.name, kCaptureTime + i * kSecond / 10));
    }
  }
  other.Begin(Capture(kCaptureTime, kSweep, {"rgb"}));
  std::optional<View> same;
  for (const Message& message : again) {
    ASSERT_FALSE(same.has_value()) << "before all was said";
    EXPECT_EQ(SeqOf(message), kSaidAgain);
    if (const auto* image = std::get_if<Image>(&message)) other.Add(*image);
    if (const auto* picks = std::get_if<CornerSelection>(&message)) other.Add(*picks);
    if (const auto* chunk = std::get_if<CloudChunk>(&message)) other.Add(*chunk);
    same = other.Take(rig_);
  }
  ASSERT_TRUE(same.has_value()) << other.Missing(rig_);
  ASSERT_EQ(same->images.size(), view->images.size());
  for (std::size_t i = 0; i < view->images.size(); ++i) {
    EXPECT_EQ(same->images[i].camera, view->images[i].camera);
    EXPECT_EQ(same->images[i].utime, view->images[i].utime);
  }
  EXPECT_EQ(same->picks.size(), 1U);
  EXPECT_EQ(same->cloud.lines, 3);
}

TEST_F(ViewCollectorTest, AnImageThatIsTooLargeRawIsSaidAgainAsPng) {
  AddSweep();
  collector_.Begin(Capture());
  AddImages();
  View view = *collector_.Take(rig_);
  view.images[0].format = PixelFormat::kBgr8;
  view.images[0].pixels = cv::Mat(1200, 1600, CV_8UC3, cv::Scalar(1, 2, 3));
  const auto image = std::get<Image>(collector_.Again(view)[0]);
  const Bytes bytes = Encode(image);
  const auto back = std::get<Image>(Decode("RGB_IMAGE", bytes.data(), bytes.size()));
  EXPECT_EQ(back.format, PixelFormat::kBgr8);
  EXPECT_EQ(cv::norm(back.pixels, view.images[0].pixels), 0);
}

TEST_F(ViewCollectorTest, ASweepThatIsNoLongerKeptIsNotSaidAgain) {
  AddSweep();
  collector_.Begin(Capture());
  AddImages();
  const View view = *collector_.Take(rig_);
  collector_.Reset();
  EXPECT_TRUE(collector_.Again(view).empty());
}

TEST_F(ViewCollectorTest, TheFirstImageAtOrAfterTheCommandCounts) {
  AddSweep();
  AddImages(kCaptureTime - kSecond);
  AddImages(kCaptureTime - 1);
  collector_.Begin(Capture());
  EXPECT_FALSE(collector_.Take(rig_).has_value());
  EXPECT_THAT(collector_.Missing(rig_), HasSubstr("an image of camera rgb"));
  collector_.Add(MakeImage("rgb", kCaptureTime));
  collector_.Add(MakeImage("rgb", kCaptureTime + kSecond));
  collector_.Add(MakeImage("thermal", kCaptureTime + 2 * kSecond));
  const auto view = collector_.Take(rig_);
  ASSERT_TRUE(view.has_value());
  EXPECT_EQ(view->images[0].utime, kCaptureTime);
  EXPECT_EQ(view->images[1].utime, kCaptureTime + 2 * kSecond);
}

TEST_F(ViewCollectorTest, ImagesFromTheSweepsStartAndMiddleComeAfterTheViewsOwn) {
  // Ten a second, in two orders; the sweep takes 12 s, the command comes at 13 s.
  std::vector<Utime> times;
  for (int i = -20; i < 140; ++i) times.push_back(kSweep + i * kSecond / 10);
  std::vector<std::vector<Utime>> taken;
  for (const bool backwards : {false, true}) {
    ViewCollector collector;
    if (backwards) {  // each second's images the other way round
      for (std::size_t i = 0; i + 10 <= times.size(); i += 10) {
        std::reverse(times.begin() + static_cast<std::ptrdiff_t>(i),
                     times.begin() + static_cast<std::ptrdiff_t>(i) + 10);
      }
    }
    collector.Add(LinesOf(kSweep, 0));
    collector.Add(End(kSweep, 1));
    for (const Utime utime : times) collector.Add(MakeImage("thermal", utime));
    SessionCommand capture;
    capture.verb = SessionVerb::kCapture;
    capture.view = "0001";
    capture.utime = kCaptureTime;
    capture.sweep_utime = kSweep;
    collector.Begin(capture);
    collector.Add(MakeImage("rgb", kCaptureTime));
    collector.Add(MakeImage("thermal", kCaptureTime));
    const auto view = collector.Take(TwoCameras());
    ASSERT_TRUE(view);
    ASSERT_EQ(view->images.size(), 4U);
    EXPECT_EQ(view->images[0].camera, "rgb");
    EXPECT_EQ(view->images[1].camera, "thermal");
    EXPECT_EQ(view->images[1].utime, kCaptureTime);
    EXPECT_EQ(view->images[2].camera, "thermal");
    EXPECT_EQ(view->images[2].utime, kSweep);
    EXPECT_NEAR(ToSeconds(view->images[3].utime - kSweep), 6.5, 0.6);
    std::vector<Utime> now;
    for (const Image& image : view->images) now.push_back(image.utime);
    taken.push_back(now);
  }
  EXPECT_EQ(taken[0], taken[1]);
}

// For minutes nobody asks for a view, sweeps take minutes, and images are large.
TEST_F(ViewCollectorTest, WhatIsKeptOfLongSweepsIsBoundedAndServesTheirStartAndMiddle) {
  const cv::Mat pixels(1456, 1936, CV_8UC1, cv::Scalar(0));  // one for all
  const std::size_t bytes = pixels.total();
  const std::size_t most = ViewCollector::kSweepsKept * ViewCollector::kMostBytes +
                           (ViewCollector::kTail + ViewCollector::kKept) * bytes;
  constexpr Utime kLong = 200 * kSecond;
  Utime begin = kSweep;
  for (int sweep = 0; sweep < 4; ++sweep, begin += kLong) {
    collector_.Add(LinesOf(begin, 0));
    for (Utime now = begin; now < begin + kLong; now += kSecond / 2) {
      Image image = MakeImage("thermal", now);
      image.pixels = pixels;
      collector_.Add(image);
      ASSERT_LE(collector_.ImageBytes(), most);
    }
    collector_.Add(End(begin, 1));
  }
  EXPECT_GT(collector_.ImageBytes(), most / 2);
  begin -= kLong;
  collector_.Begin(Capture(begin + kLong, begin));
  AddImages(begin + kLong);
  const auto view = collector_.Take(rig_);
  ASSERT_TRUE(view);
  ASSERT_EQ(view->images.size(), 4U);
  EXPECT_LE(view->images[2].utime - begin, kSecond);
  EXPECT_NEAR(ToSeconds(view->images[3].utime - begin), 100, 32);
}

TEST_F(ViewCollectorTest, WithoutSweepsTheNewestSecondsAloneAreKept) {
  for (int i = 0; i < 100; ++i) {
    Image image = MakeImage("rgb", kSweep + i * kSecond);
    image.pixels = cv::Mat(10, 10, CV_8UC1, cv::Scalar(0));
    collector_.Add(image);
  }
  EXPECT_EQ(collector_.ImageBytes(), 100U * (ViewCollector::kTail + ViewCollector::kKept));
}

TEST_F(ViewCollectorTest, ItStaysTheFirstHoweverManyCome) {
  AddSweep();
  collector_.Begin(Capture());
  for (int i = 0; i < 10; ++i) collector_.Add(MakeImage("rgb", kCaptureTime + i * kSecond / 4));
  collector_.Add(MakeImage("thermal", kCaptureTime));
  EXPECT_EQ(collector_.Take(rig_)->images[0].utime, kCaptureTime);
}

TEST_F(ViewCollectorTest, AnImageTooLongAfterTheCommandDoesNotCount) {
  AddSweep();
  collector_.Begin(Capture());
  AddImages(kCaptureTime + ViewCollector::kImageWait + 1);
  EXPECT_FALSE(collector_.Take(rig_).has_value());
  EXPECT_THAT(collector_.Missing(rig_), HasSubstr("an image of camera thermal"));
}

TEST_F(ViewCollectorTest, ImagesWhileTheShutterCorrectsAreSkipped) {
  AddSweep();
  collector_.Begin(Capture());
  collector_.Add(MakeImage("rgb", kCaptureTime));
  for (int i = 0; i < 8; ++i) {
    Image image = MakeImage("thermal", kCaptureTime + i * kSecond / 10);
    image.shutter_correcting = true;
    collector_.Add(image);
  }
  EXPECT_FALSE(collector_.Take(rig_).has_value());
  collector_.Add(MakeImage("thermal", kCaptureTime + kSecond));
  EXPECT_EQ(collector_.Take(rig_)->images[1].utime, kCaptureTime + kSecond);
}

TEST_F(ViewCollectorTest, PicksOfAnotherImageDoNotCount) {
  AddSweep();
  AddImages();
  collector_.Begin(Capture(kCaptureTime, kSweep, {"rgb"}));
  collector_.Add(Picks("rgb", kCaptureTime - kSecond));
  EXPECT_FALSE(collector_.Take(rig_).has_value());
  EXPECT_EQ(collector_.Missing(rig_), "picked corners for camera rgb");
  collector_.Add(Picks("rgb", kCaptureTime));
  EXPECT_TRUE(collector_.Take(rig_).has_value());
}

TEST_F(ViewCollectorTest, PicksThatNobodyAskedForStayOut) {
  AddSweep();
  AddImages();
  collector_.Add(Picks("rgb", kCaptureTime));
  collector_.Begin(Capture());
  EXPECT_TRUE(collector_.Take(rig_)->picks.empty());
}

TEST_F(ViewCollectorTest, MissingNamesEverything) {
  EXPECT_EQ(collector_.Missing(rig_), "");
  collector_.Begin(Capture());
  EXPECT_EQ(collector_.Missing(rig_), "the end of sweep " + std::to_string(kSweep) +
                                          ", an image of camera rgb, an image of camera thermal");
  for (int i = 0; i < 3; ++i) collector_.Add(LinesOf(kSweep, i));
  EXPECT_THAT(collector_.Missing(rig_), HasSubstr("the end of sweep"));
  collector_.Add(End(kSweep, 3));
  EXPECT_THAT(collector_.Missing(rig_), Not(HasSubstr("sweep")));
}

TEST_F(ViewCollectorTest, ANewCaptureReplacesAnIncompleteOne) {
  collector_.Begin(Capture());
  const Utime next = kCaptureTime + 20 * kSecond;
  AddSweep(kSweep + 20 * kSecond);
  SessionCommand second = Capture(next, kSweep + 20 * kSecond);
  second.view = "0002";
  collector_.Begin(second);
  AddImages(next);
  AddSweep(kSweep);
  EXPECT_EQ(collector_.Take(rig_)->name, "0002");
  EXPECT_FALSE(collector_.active());
}

TEST_F(ViewCollectorTest, ResetForgetsCaptureAndSweeps) {
  AddSweep();
  AddImages();
  collector_.Begin(Capture());
  collector_.Reset();
  EXPECT_FALSE(collector_.active());
  collector_.Begin(Capture());
  EXPECT_THAT(collector_.Missing(rig_), HasSubstr("the end of sweep"));
}

TEST_F(ViewCollectorTest, AClockSetBackForgetsTheImagesFromBefore) {
  AddSweep();
  for (int i = 0; i < 5; ++i) AddImages(kCaptureTime + 1000 * kSecond + i);
  AddImages(kCaptureTime);
  AddImages(kCaptureTime + kSecond);
  collector_.Begin(Capture());
  const auto view = collector_.Take(rig_);
  ASSERT_TRUE(view.has_value());
  EXPECT_EQ(view->images[0].utime, kCaptureTime);
}

}  // namespace
}  // namespace rgbdt
