// Which topics, which moments, which way.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "calib/files/atomic_file.h"
#include "calib/files/import/folders.h"
#include "services/import/moments.h"
#include "services/import/still.h"
#include "services/import/transforms.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

BagSurvey::Topic Topic(const std::string& name, BagData data, const std::vector<double>& seconds) {
  BagSurvey::Topic topic;
  topic.topic.name = name;
  topic.data = data;
  for (const double s : seconds) topic.stamped.push_back({FromSeconds(s), {}});
  if (data == BagData::kCameraInfo) topic.info.emplace();
  return topic;
}

TEST(ChooseTopics, OfEachCameraTheRawest) {
  BagSurvey survey;
  for (const char* name : {"/a/rgb/image_raw", "/a/rgb/image_color", "/Front-Left/image",
                           "/depth/image_raw", "/b/image_rect", "/empty/image_raw"}) {
    survey.topics.push_back(Topic(name, BagData::kImage, {0}));
  }
  survey.topics.back().stamped.clear();
  survey.topics.push_back(Topic("/a/rgb/image_raw/compressed", BagData::kCompressedImage, {0}));
  survey.topics.push_back(Topic("/c/rgb/image_raw/compressed", BagData::kCompressedImage, {0}));
  survey.topics.push_back(Topic("/a/rgb/camera_info", BagData::kCameraInfo, {}));
  survey.topics.push_back(Topic("/points", BagData::kCloud, {0}));
  const TopicChoice choice = ChooseTopics(survey, {});
  std::vector<std::string> taken;
  for (const auto& camera : choice.cameras) {
    taken.push_back(camera.name + " " + camera.images->topic.name);
  }
  EXPECT_THAT(taken, ElementsAre("front_left /Front-Left/image", "a_rgb /a/rgb/image_raw",
                                 "c_rgb /c/rgb/image_raw/compressed"));
  EXPECT_EQ(choice.cameras[0].info, nullptr);
  EXPECT_EQ(choice.cameras[1].info->topic.name, "/a/rgb/camera_info");
  EXPECT_EQ(choice.lidar.clouds->topic.name, "/points");
  EXPECT_THAT(choice.left_out, SizeIs(5));
}

// "name topic" of each camera that is taken of these images; those of CompressedImage end in
// /compressed.
std::vector<std::string> CamerasOf(const std::vector<std::string>& images,
                                   const std::map<std::string, std::string>& frames = {}) {
  BagSurvey survey;
  survey.topics.push_back(Topic("/points", BagData::kCloud, {0}));
  for (const std::string& name : images) {
    const bool compressed = name.find("/compressed") != std::string::npos;
    survey.topics.push_back(
        Topic(name, compressed ? BagData::kCompressedImage : BagData::kImage, {0}));
    const auto frame = frames.find(name);
    if (frame != frames.end()) survey.topics.back().frame = frame->second;
  }
  std::vector<std::string> cameras;
  for (const auto& camera : ChooseTopics(survey, {}).cameras) {
    cameras.push_back(camera.name + " " + camera.images->topic.name);
  }
  return cameras;
}

TEST(ChooseTopics, CamerasThatDifferInOnePartOfTheirTopicsAreTwo) {
  EXPECT_THAT(CamerasOf({"/thermal/temperature", "/rgb/image_raw"}),
              ElementsAre("rgb /rgb/image_raw", "thermal /thermal/temperature"));
  EXPECT_THAT(CamerasOf({"/ir/left", "/ir/right"}),
              ElementsAre("left /ir/left", "right /ir/right"));
  EXPECT_THAT(CamerasOf({"/left", "/right"}), ElementsAre("left /left", "right /right"));
  EXPECT_THAT(CamerasOf({"/stereo/left/image_raw", "/stereo/right/image_raw"}),
              ElementsAre("left /stereo/left/image_raw", "right /stereo/right/image_raw"));
  EXPECT_THAT(CamerasOf({"/cam0/image_raw", "/cam1/image_raw"}),
              ElementsAre("cam0 /cam0/image_raw", "cam1 /cam1/image_raw"));
  EXPECT_THAT(
      CamerasOf({"/front/camera/image_raw/compressed", "/rear/camera/image_raw/compressed"}),
      ElementsAre("front /front/camera/image_raw/compressed",
                  "rear /rear/camera/image_raw/compressed"));
  EXPECT_THAT(CamerasOf({"/oak/left_image_raw", "/oak/right_image_raw"}),
              ElementsAre("left /oak/left_image_raw", "right /oak/right_image_raw"));
  EXPECT_THAT(CamerasOf({"/car/cam/image_0", "/car/cam/image_1"}),
              ElementsAre("cam_0 /car/cam/image_0", "cam_1 /car/cam/image_1"));
  EXPECT_THAT(
      CamerasOf({"/a/x/rgb/image", "/b/x/rgb/image", "/b/x/thermal/image"}),
      ElementsAre("a_rgb /a/x/rgb/image", "b_rgb /b/x/rgb/image", "thermal /b/x/thermal/image"));
}

TEST(ChooseTopics, WhatOneCameraSendsSeveralTimesIsOneCamera) {
  EXPECT_THAT(CamerasOf({"/ir/left", "/ir/left/compressed"}), ElementsAre("left /ir/left"));
  EXPECT_THAT(CamerasOf({"/cam/compressed", "/cam/image_raw"}), ElementsAre("cam /cam/image_raw"));
  EXPECT_THAT(CamerasOf({"/image_color", "/image_raw", "/image_raw/compressed"}),
              ElementsAre("image_raw /image_raw"));
  EXPECT_THAT(CamerasOf({"/oak/left_image_color", "/oak/left_image_raw"}),
              ElementsAre("left /oak/left_image_raw"));
  // What is made of a camera's images is no further one, unless it has a frame of its own.
  EXPECT_THAT(CamerasOf({"/cam/image_raw", "/cam/tracked"}), ElementsAre("cam /cam/image_raw"));
  EXPECT_THAT(CamerasOf({"/cam/image_raw", "/cam/thermal"},
                        {{"/cam/image_raw", "rgb"}, {"/cam/thermal", "thermal"}}),
              ElementsAre("cam /cam/image_raw", "thermal /cam/thermal"));
}

TEST(ChooseTopics, ACameraInfoIsOfTheCameraWhoseFrameItHas) {
  BagSurvey survey;
  survey.topics = {Topic("/ir/left", BagData::kImage, {0}),
                   Topic("/ir/right", BagData::kImage, {0}), Topic("/points", BagData::kCloud, {0}),
                   Topic("/ir/camera_info", BagData::kCameraInfo, {})};
  const auto lenses = [&] {
    std::vector<std::string> names;
    for (const auto& camera : ChooseTopics(survey, {}).cameras) {
      names.push_back(camera.info == nullptr ? "" : camera.info->topic.name);
    }
    return names;
  };
  EXPECT_THAT(lenses(), ElementsAre("", "")) << "whose it is cannot be told";
  survey.topics[0].frame = "left";
  survey.topics[1].frame = survey.topics[3].info->header.frame = "right";
  EXPECT_THAT(lenses(), ElementsAre("", "/ir/camera_info"));
  survey.topics.push_back(Topic("/ir/left/camera_info", BagData::kCameraInfo, {}));
  EXPECT_THAT(lenses(), ElementsAre("/ir/left/camera_info", "/ir/camera_info"));
}

TEST(ChooseTopics, MoreCamerasThanARigMayHaveAreRefused) {
  BagSurvey survey;
  survey.topics.push_back(Topic("/points", BagData::kCloud, {0}));
  for (int i = 0; i < 33; ++i) {
    survey.topics.push_back(Topic("/" + std::to_string(i) + "/cam/image", BagData::kImage, {0}));
  }
  EXPECT_THAT(test::ErrorOf([&] { ChooseTopics(survey, {}); }), HasSubstr("more than 32 cameras"));
  survey.topics.pop_back();
  EXPECT_THAT(ChooseTopics(survey, {}).cameras, SizeIs(32));
}

TEST(ChooseTopics, PacketsAreTakenWhereThereAreNoClouds) {
  BagSurvey survey;
  survey.topics = {Topic("/cam/image", BagData::kImage, {0}),
                   Topic("/os/packets", BagData::kPackets, {}),
                   Topic("/os/metadata", BagData::kMetadata, {}),
                   Topic("/other/metadata", BagData::kMetadata, {})};
  EXPECT_THAT(test::ErrorOf([&] { ChooseTopics(survey, {}); }), HasSubstr("holds no clouds"))
      << "none of its messages was read";
  survey.topics[1].what = "packets of 1206 bytes, 1 a message";
  EXPECT_EQ(ChooseTopics(survey, {}).lidar.clouds->topic.name, "/os/packets");
  survey.topics[3].text = "other";
  EXPECT_EQ(MetadataOf(survey, survey.topics[1])->text, "other") << "the only one";
  survey.topics[2].text = "os";
  EXPECT_EQ(MetadataOf(survey, survey.topics[1])->text, "os") << "the one beside";
  survey.topics.push_back(Topic("/points", BagData::kCloud, {0}));
  EXPECT_EQ(ChooseTopics(survey, {}).lidar.clouds->topic.name, "/points");
  EXPECT_THAT(ChooseTopics(survey, {}).left_out, ElementsAre(HasSubstr("/os/packets: packets")));
  EXPECT_EQ(ChooseTopics(survey, {{}, {{"", "/os/packets"}}}).lidar.clouds->topic.name,
            "/os/packets");
}

TEST(ChooseTopics, AColouredCloudIsNoLidarsWhereThereIsAnother) {
  BagSurvey survey;
  survey.topics = {Topic("/cam/image", BagData::kImage, {0}), Topic("/fused", BagData::kCloud, {0}),
                   Topic("/lidar", BagData::kCloud, {0})};
  survey.topics[1].what = "5x1 x y z red green blue";
  survey.topics[2].what = "5x1 x y z intensity";
  EXPECT_EQ(ChooseTopics(survey, {}).lidar.clouds->topic.name, "/lidar");
  EXPECT_THAT(ChooseTopics(survey, {}).left_out, ElementsAre(HasSubstr("/fused: coloured")));
  EXPECT_EQ(ChooseTopics(survey, {{}, {{"", "/fused"}}}).lidar.clouds->topic.name, "/fused");
  survey.topics.pop_back();
  EXPECT_EQ(ChooseTopics(survey, {}).lidar.clouds->topic.name, "/fused");
}

TEST(ChooseTopics, NumbersOfFloatingPointAreTakenWhereTheyAreTemperatures) {
  BagSurvey survey;
  survey.topics = {Topic("/cam/image", BagData::kImage, {0}), Topic("/d", BagData::kImage, {0}),
                   Topic("/points", BagData::kCloud, {0})};
  BagSurvey::Topic& floats = survey.topics[1];
  floats.what = "640x512 32FC1";
  const auto cameras = [&](const std::string& name, FloatUnit unit) {
    floats.topic.name = name;
    floats.unit = unit;
    return ChooseTopics(survey, {}).cameras.size();
  };
  EXPECT_EQ(cameras("/d/image", FloatUnit::kKelvin), 2U);
  EXPECT_EQ(cameras("/d/image", FloatUnit::kMaybeCelsius), 1U);
  EXPECT_THAT(
      ChooseTopics(survey, {}).left_out,
      ElementsAre(AllOf(HasSubstr("metres of depth"), HasSubstr("--image thermal=/d/image"))));
  EXPECT_EQ(cameras("/flir/ir/temperature", FloatUnit::kMaybeCelsius), 2U);
  EXPECT_EQ(cameras("/thermal/image", FloatUnit::kNone), 1U);
  EXPECT_EQ(cameras("/thermal/depth", FloatUnit::kKelvin), 1U);
}

TEST(ChooseTopics, WishesComeFirstAndMustBeThere) {
  BagSurvey survey;
  survey.topics = {Topic("/b/image_rect", BagData::kImage, {0}),
                   Topic("/one", BagData::kCloud, {0}), Topic("/two", BagData::kCloud, {0})};
  const auto error = [&](const TopicWishes& wishes) {
    return test::ErrorOf([&] { ChooseTopics(survey, wishes); });
  };
  EXPECT_THAT(error({}), HasSubstr("no camera's images"));
  EXPECT_THAT(error({{{"rgb", "/b/image_rect"}}, {}}), HasSubstr("--cloud: /one, /two"));
  EXPECT_THAT(error({{{"rgb", "/one"}}, {{"", "/one"}}}), HasSubstr("--image /one"));
  const TopicChoice choice = ChooseTopics(survey, {{{"rgb", "/b/image_rect"}}, {{"", "/two"}}});
  EXPECT_EQ(choice.cameras.at(0).name, "rgb");
  EXPECT_EQ(choice.lidar.clouds->topic.name, "/two");
}

std::vector<std::string> LidarsOf(const TopicChoice& choice) {
  std::vector<std::string> lidars = {choice.lidar.name + " " + choice.lidar.clouds->topic.name};
  for (const TopicChoice::Lidar& lidar : choice.further_lidars) {
    lidars.push_back(lidar.name + " " + lidar.clouds->topic.name);
  }
  return lidars;
}

TEST(ChooseTopics, EachFrameIsALidar) {
  BagSurvey survey;
  survey.topics = {Topic("/cam/depth/points", BagData::kCloud, {0}),
                   Topic("/cam/image", BagData::kImage, {0}),
                   Topic("/front/points", BagData::kCloud, {0}),
                   Topic("/front/points_filtered", BagData::kCloud, {0}),
                   Topic("/rear/packets", BagData::kPackets, {}),
                   Topic("/rear/points", BagData::kCloud, {0})};
  survey.topics[2].frame = survey.topics[3].frame = "front";
  survey.topics[4].frame = survey.topics[5].frame = "rear";
  survey.topics[4].what = "packets of 1206 bytes, 1 a message";
  const TopicChoice choice = ChooseTopics(survey, {});
  EXPECT_THAT(LidarsOf(choice), ElementsAre("front /front/points", "rear /rear/points"));
  EXPECT_THAT(choice.left_out, ElementsAre(HasSubstr("/cam/depth/points: named \"depth\""),
                                           HasSubstr("/front/points_filtered: named \"filter\""),
                                           HasSubstr("/rear/packets: packets")));
  survey.topics.push_back(Topic("/rear/image", BagData::kImage, {0}));
  const TopicChoice beside = ChooseTopics(survey, {});
  EXPECT_EQ(beside.cameras.back().name, "rear");
  EXPECT_NE(beside.further_lidars.at(0).name, "rear") << "a rig's sensors have names of their own";
  survey.topics.pop_back();
  TopicWishes wishes{{}, {{"back", "/rear/packets"}, {"", "/front/points_filtered"}}};
  EXPECT_THAT(LidarsOf(ChooseTopics(survey, wishes)),
              ElementsAre("back /rear/packets", "front /front/points_filtered"))
      << "as they were asked for";
  const auto error = [&](const TopicWishes& of) {
    return test::ErrorOf([&] { ChooseTopics(survey, of); });
  };
  wishes.clouds = {{"a", "/rear/points"}, {"a", "/front/points"}};
  EXPECT_THAT(error(wishes), HasSubstr("two sensors are called \"a\""));
  wishes.clouds[1] = {"b", "/rear/points"};
  EXPECT_THAT(error(wishes), HasSubstr("/rear/points is given for two LIDARs"));
  wishes.clouds.clear();
  wishes.one_lidar = true;
  EXPECT_THAT(error(wishes), HasSubstr("a log carries the clouds of one (CLOUD); say which by "
                                       "--cloud: /cam/depth/points, /front/points"));
  survey.topics[5].frame = "front";
  EXPECT_THAT(error({}), HasSubstr("clouds of one frame, \"front\""));
}

TEST(ChooseTopics, PacketsThatTellNoFrameAreEachALidars) {
  BagSurvey survey;
  survey.topics = {Topic("/a/image", BagData::kImage, {0}),
                   Topic("/left/packets", BagData::kPackets, {}),
                   Topic("/right/packets", BagData::kPackets, {})};
  for (BagSurvey::Topic& topic : survey.topics) topic.what = "packets of 1206 bytes, 1 a message";
  EXPECT_THAT(LidarsOf(ChooseTopics(survey, {})),
              ElementsAre("left /left/packets", "right /right/packets"));
}

TEST(FindTransform, AlongAChainBothWays) {
  Random random(1);
  const Rigid3 base_from_lidar = random.Pose(), base_from_link = random.Pose(),
               link_from_optical = random.Pose();
  const std::vector<ros::Transform> transforms = {{"base", "lidar", base_from_lidar},
                                                  {"base", "link", base_from_link},
                                                  {"link", "optical", link_from_optical}};
  const std::optional<Rigid3> found = FindTransform(transforms, "optical", "lidar");
  ASSERT_TRUE(found);
  EXPECT_THAT(*found, Rigid3Near((base_from_link * link_from_optical).Inverse() * base_from_lidar,
                                 1e-9, 1e-9));
  EXPECT_THAT(*FindTransform(transforms, "lidar", "optical"),
              Rigid3Near(found->Inverse(), 1e-9, 1e-9));
  EXPECT_FALSE(FindTransform(transforms, "elsewhere", "lidar"));
  EXPECT_FALSE(FindTransform(transforms, "", ""));
}

struct Paired {
  BagSurvey::Topic cloud = Topic("/points", BagData::kCloud, {10, 11, 12, 13}),
                   rgb = Topic("/rgb", BagData::kImage, {9.98, 10.03, 11.9, 12.05}),
                   thermal = Topic("/thermal", BagData::kImage, {10.05});
  TopicChoice choice{
      {{"rgb", &rgb, nullptr}, {"thermal", &thermal, nullptr}}, {"lidar", &cloud}, {}, {}};
};

TEST(Moments, EachCloudWithTheNearestImages) {
  const Paired paired;
  std::vector<std::string> left_over;
  const auto moments = PairAt(paired.choice, EverySeconds(paired.choice, 1), 0.1, &left_over);
  ASSERT_THAT(moments, SizeIs(2));
  EXPECT_EQ(moments[0].cloud.utime, FromSeconds(10));
  EXPECT_EQ(moments[0].images[0]->utime, FromSeconds(9.98));
  EXPECT_EQ(moments[0].images[1]->utime, FromSeconds(10.05));
  EXPECT_EQ(moments[1].images[0]->utime, FromSeconds(12.05));
  EXPECT_FALSE(moments[1].images[1]);
  EXPECT_THAT(left_over, ElementsAre(HasSubstr("1.02 s, 3.02 s")));
}

TEST(Moments, FurtherLidarsCloudsAreTheNearest) {
  Paired paired;
  const BagSurvey::Topic rear = Topic("/rear", BagData::kCloud, {9.5, 9.94, 10.04, 12.2});
  paired.choice.further_lidars = {{"rear", &rear}};
  std::vector<std::string> left_over;
  const auto moments = PairAt(paired.choice, EverySeconds(paired.choice, 1), 0.1, &left_over);
  EXPECT_EQ(StartOf(paired.choice), FromSeconds(9.5));
  ASSERT_THAT(moments, SizeIs(2));
  ASSERT_THAT(moments[0].further_clouds, SizeIs(1));
  EXPECT_EQ(moments[0].further_clouds[0]->utime, FromSeconds(10.04));
  ASSERT_THAT(moments[1].further_clouds, SizeIs(1));
  EXPECT_FALSE(moments[1].further_clouds[0]);
  EXPECT_THAT(test::ErrorOf([&] { PairAt(paired.choice, {FromSeconds(12)}, 0.1, &left_over); }),
              HasSubstr("no view has a cloud of LIDAR rear within 0.100 s of its cloud of lidar; "
                        "the nearest is 0.2 s away"));
}

TEST(Moments, AtTimesEachCloudOnce) {
  const Paired paired;
  std::vector<std::string> left_over;
  const auto moments = PairAt(paired.choice, {FromSeconds(12.2), FromSeconds(9), FromSeconds(10.4)},
                              0.1, &left_over);
  ASSERT_THAT(moments, SizeIs(2));
  EXPECT_EQ(moments[0].cloud.utime, FromSeconds(10));
  EXPECT_EQ(moments[1].cloud.utime, FromSeconds(12));
  EXPECT_THAT(EverySeconds(paired.choice, 1.5), ElementsAre(FromSeconds(10), FromSeconds(12)));
}

TEST(Moments, ATimeFarFromAnyCloudIsLeftOver) {
  const Paired paired;
  std::vector<std::string> left_over;
  const auto moments = PairAt(paired.choice, {FromSeconds(500), FromSeconds(12)}, 0.1, &left_over);
  ASSERT_THAT(moments, SizeIs(1));
  EXPECT_EQ(moments[0].cloud.utime, FromSeconds(12));
  EXPECT_THAT(left_over, ElementsAre(HasSubstr("of: 490.02 s")));
  EXPECT_THAT(test::ErrorOf([&] { PairAt(paired.choice, {FromSeconds(500)}, 0.1, &left_over); }),
              HasSubstr("no cloud is within 1.000 s of: 490.02 s"));
}

TEST(LensFiles, OneFileOfOneLensIsNotTwoCameras) {
  const test::TempDir dir;
  WriteFileAtomically(dir / "left.yaml",
                      "width: 640\nheight: 480\nK: [500, 0, 320, 0, 500, 240, 0, 0, 1]\n"
                      "D: [0, 0, 0, 0, 0]\n");
  const Folders::LensFile unnamed{"", dir / "left.yaml", ""};
  Folders::LensFile of_a = unnamed;
  of_a.camera = "a";
  const std::vector<std::string> two = {"a", "b"}, three = {"a", "b", "c"};
  EXPECT_TRUE(LensOf({unnamed}, two, 0, {}));
  EXPECT_FALSE(LensOf({unnamed}, two, 1, {}));
  EXPECT_TRUE(LensOf({of_a, unnamed, unnamed}, three, 2, {}));
  EXPECT_THAT(test::ErrorOf([&] { CheckLensFiles({of_a}, {"left"}); }),
              HasSubstr("the cameras are left"));
  EXPECT_THAT(test::ErrorOf([&] {
                CheckLensFiles({unnamed, unnamed, unnamed}, two);
              }),
              HasSubstr("3 lens files are given for 2 cameras"));
}

TEST(Moments, ClocksThatDisagreeAreTold) {
  Paired paired;
  for (Stamped& image : paired.rgb.stamped) image.utime -= FromSeconds(5000);
  for (Stamped& image : paired.thermal.stamped) image.utime -= FromSeconds(5000);
  std::vector<std::string> left_over;
  EXPECT_THAT(test::ErrorOf(
                  [&] { PairAt(paired.choice, EverySeconds(paired.choice, 1), 0.1, &left_over); }),
              HasSubstr("4997.95 s away"));
}

BoardLook Look(double x, double y) {
  return {0, {{x, y}, {x + 10, y}, {x, y + 10}, {x + 10, y + 10}}};
}

TEST(Still, HowFarTheBoardMoved) {
  const BoardLook look = Look(5, 5);
  EXPECT_NEAR(Moved(look, Look(8, 9)), 5, 1e-12);
  BoardLook turned = look;
  std::reverse(turned.corners.begin(), turned.corners.end());
  EXPECT_EQ(Moved(look, turned), 0);
  BoardLook hidden = look;
  hidden.corners[0] = hidden.corners[1] = hidden.corners[2] = UnseenCorner();
  EXPECT_TRUE(std::isinf(Moved(look, hidden)));
}

TEST(Still, StandsAreSpreadOverTheImage) {
  const std::vector<BoardLook> looks = {Look(0, 0), Look(1, 0), Look(500, 0), Look(510, 400),
                                        Look(250, 0)};
  EXPECT_THAT(SpreadOver(looks, 1000, 3), ElementsAre(0, 2, 3));
  EXPECT_THAT(SpreadOver(looks, 1000, 99), ElementsAre(0, 2, 3, 4));  // 1 is 0 again
  EXPECT_THAT(SpreadOver({}, 1000, 3), IsEmpty());
}

}  // namespace
}  // namespace rgbdt
