#include "calib/files/import/pairing.h"

#include "calib/files/name_keys.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::nullopt_t kNone = std::nullopt;

Pairs PairNames(const std::vector<std::string>& images, const std::vector<std::string>& clouds,
                const PairOptions& options = {}) {
  return PairFiles({"images", images}, {"clouds", clouds}, options);
}

std::vector<std::string> Numbers(const std::vector<std::string>& stems) {
  return NumbersInNames(stems).numbers;
}

TEST(NameKeys, DatesAreTimes) {
  constexpr Utime kTime = 1'684'059'323'000'000;
  for (const char* name : {"2023-05-14-10-15-23", "20230514_101523", "2023-05-14T10_15_23",
                           "20230514101523", "cam_2023-05-14_10-15-23_rgb", "7_20230514-101523"}) {
    EXPECT_EQ(TimeInName(name), kTime) << name;
  }
  for (const char* name :
       {"2023-05-14-10-15-23.25", "20230514_101523.250000", "20230514101523250",
        "20230514_101523250", "20230514_101523_250000", "2023-05-14-10-15-23-250"}) {
    EXPECT_EQ(TimeInName(name), kTime + 250'000) << name;
  }
}

TEST(NameKeys, AFilesOwnTimeComesBeforeItsSessionsDate) {
  EXPECT_EQ(TimeInName("n015-2018-07-24-11-22-45+0800__LIDAR_TOP__1532402927647951.pcd"),
            1'532'402'927'647'951);
}

TEST(NameKeys, TimesAreThoseSince1970) {
  EXPECT_EQ(TimeInName("1700000000"), 1'700'000'000'000'000);
  EXPECT_EQ(TimeInName("1700000000.25"), 1'700'000'000'250'000);
  EXPECT_EQ(TimeInName("1700000000.123456789"), 1'700'000'000'123'456);
  EXPECT_EQ(TimeInName("rgb_1700000000_012345678"), 1'700'000'000'012'345);
  EXPECT_EQ(TimeInName("1700000000-012"), 1'700'000'000'012'000);
  EXPECT_EQ(TimeInName("1700000000_7"), 1'700'000'000'000'000);  // an index, no fraction
  EXPECT_EQ(TimeInName("1700000000123"), 1'700'000'000'123'000);
  EXPECT_EQ(TimeInName("1700000000123456"), 1'700'000'000'123'456);
  EXPECT_EQ(TimeInName("0007_1700000000123456789"), 1'700'000'000'123'456);
  for (const char* none :
       {"", "pose7", "0000000012", "9999999999", "17000000001", "20231314_101500", "2023-05-14",
        "20231114_1015", "1999-05-14-10-15-23", "9999999999999999999999999"}) {
    EXPECT_EQ(TimeInName(none), kNone) << none;
  }
}

TEST(NameKeys, StemsAreNamesWithoutTheirEndings) {
  EXPECT_EQ(StemOf("a/1700000000.25.pcd"), "1700000000.25");
  EXPECT_EQ(StemOf("n015.pcd.bin"), "n015");
  EXPECT_EQ(StemOf("000012.bin"), "000012");
  EXPECT_EQ(StemOf(""), "");
}

TEST(NameKeys, NumbersAreThoseThatTellNamesApart) {
  EXPECT_THAT(Numbers({"run3_0009_rgb8", "run3_0010_rgb8", "run3_0011_rgb8"}),
              ElementsAre("9", "10", "11"));
  EXPECT_THAT(Numbers({"pose1", "pose02", "background"}), ElementsAre("1", "2", ""));
  EXPECT_THAT(Numbers({"a1_1", "a1_2", "a2_3"}), ElementsAre("1", "2", "3"));
  EXPECT_THAT(Numbers({"a1", "a01"}), ElementsAre("", ""));  // one number twice
  EXPECT_THAT(Numbers({"a", "b"}), ElementsAre("", ""));
}

// It stood for a number once, and numbers were looked for that are not there.
TEST(Pairing, ANumberSignIsNoNumber) {
  EXPECT_THAT(Numbers({"frame#1", "frame#2", "frame##"}), ElementsAre("1", "2", ""));
  EXPECT_THAT(Numbers({"1#", "2#", "#3"}), ElementsAre("1", "2", ""));
}

TEST(Pairing, ByName) {
  const Pairs pairs =
      PairNames({"pose1.png", "pose2.png", "pose10.png"}, {"pose2.pcd", "pose3.pcd", "pose10.pcd"});
  EXPECT_EQ(pairs.by, PairedBy::kName);
  EXPECT_THAT(pairs.cloud_of, ElementsAre(kNone, 0, 2));
  EXPECT_EQ(pairs.count, 2u);
  EXPECT_EQ(pairs.why_not, "of the same name");
}

TEST(Pairing, OneCloudIsNotTakenTwice) {
  const Pairs pairs = PairNames({"a.jpg", "a.png", "b.png"}, {"a.pcd", "b.pcd"});
  EXPECT_THAT(pairs.cloud_of, ElementsAre(0, kNone, 1));
}

TEST(Pairing, ByNumber) {
  const Pairs pairs =
      PairNames({"img_0009.png", "img_0010.png", "test.png"}, {"scan9.pcd", "scan10.pcd"});
  EXPECT_EQ(pairs.by, PairedBy::kNumber);
  EXPECT_THAT(pairs.cloud_of, ElementsAre(0, 1, kNone));
  EXPECT_THAT(pairs.image_utime, ElementsAre(0, 0, 0));
}

// Minutes of some that are seconds of others are no numbers to pair by.
TEST(Pairing, NumbersThatAgreeByChancePairNothing) {
  std::vector<std::string> images, clouds, numbered;
  for (int i = 0; i < 9; ++i) {
    const std::string minute = std::to_string(20 + 3 * i), second = std::to_string(23 + 4 * i);
    images.push_back("im_10-" + minute + "-" + second + ".png");
    clouds.push_back("scan_10-" + second + "_7.pcd");
    numbered.push_back("scan_10-" + std::to_string(11 + i / 2) + "_" + std::to_string(i) + ".pcd");
  }
  EXPECT_THAT(test::ErrorOf([&] { PairNames(images, clouds); }), HasSubstr("--in-order"));
  for (std::size_t i = 0; i < images.size(); ++i) images[i] = "im_1_" + std::to_string(i) + ".png";
  EXPECT_EQ(PairNames(images, numbered).count, 9u) << "most agree";
}

TEST(Pairing, ByDatesOfTheSameMoment) {
  const Pairs pairs = PairNames({"2023-05-14-10-16-42.png", "2023-05-14-10-42-44.png"},
                                {"2023-05-14-10-16-42.pcd", "2023-05-14-10-42-46.pcd"});
  EXPECT_EQ(pairs.by, PairedBy::kTime);
  EXPECT_THAT(pairs.cloud_of, ElementsAre(0, kNone));
}

TEST(Pairing, ByTimeEachTheOthersNearest) {
  const Pairs pairs = PairNames(
      {"1700000000.00.png", "1700000000.03.png", "1700000000.06.png", "1700000000.19.png",
       "1700000005.00.png"},
      {"1700000000_040000000.pcd", "1700000000_200000000.pcd", "1700000003_000000000.pcd"});
  EXPECT_EQ(pairs.by, PairedBy::kTime);
  EXPECT_THAT(pairs.cloud_of, ElementsAre(kNone, 0, kNone, 1, kNone));
  EXPECT_EQ(pairs.image_utime[1], 1'700'000'000'030'000);
  EXPECT_EQ(pairs.cloud_utime[0], 1'700'000'000'040'000);
  EXPECT_THAT(pairs.why_not, HasSubstr("0.1 s"));
}

// Whatever the rates and offsets: each file once, in order, none farther apart than allowed.
TEST(Pairing, ByTimeIsMonotonicAndWithinItsBound) {
  for (const int every : {30, 70, 100, 130}) {
    for (const int offset : {0, 17, 50, 90}) {
      std::vector<std::string> images, clouds;
      for (int i = 0; i < 40; ++i) {
        images.push_back(std::to_string(1'700'000'000'000 + every * i + i * i % 7) + ".png");
        clouds.push_back(std::to_string(1'700'000'000'000 + 100 * i + offset) + ".pcd");
      }
      const Pairs pairs = PairNames(images, clouds, {false, 0.06});
      std::optional<std::size_t> last;
      for (std::size_t i = 0; i < images.size(); ++i) {
        if (!pairs.cloud_of[i]) continue;
        const std::size_t cloud = *pairs.cloud_of[i];
        EXPECT_LE(std::abs(pairs.image_utime[i] - pairs.cloud_utime[cloud]), 60'000);
        EXPECT_TRUE(!last || cloud > *last);
        last = cloud;
      }
      EXPECT_GE(pairs.count, 5u) << every << " " << offset;
    }
  }
}

TEST(Pairing, ASerialNumberIsNoTime) {
  const Pairs pairs = PairNames({"cam1700000000123_1.png", "cam1700000000123_2.png"},
                                {"1700000000123-1.pcd", "1700000000123-2.pcd"});
  EXPECT_EQ(pairs.by, PairedBy::kNumber);
  EXPECT_EQ(pairs.count, 2u);
}

TEST(Pairing, InOrderOnlyWhereCountsAgree) {
  const PairOptions in_order{true, 0.1};
  EXPECT_THAT(PairNames({"x.png", "y.png"}, {"1.pcd", "2.pcd"}, in_order).cloud_of,
              ElementsAre(0, 1));
  EXPECT_THAT(test::ErrorOf([&] {
                PairNames({"x.png", "y.png"}, {"1.pcd"}, in_order);
              }),
              AllOf(HasSubstr("2 images"), HasSubstr("1 clouds")));
}

TEST(Pairing, WhereNothingPairsItIsSaidWhatToDo) {
  EXPECT_THAT(test::ErrorOf([] {
                PairNames({"x.png", "y.png"}, {"1.pcd", "2.pcd"});
              }),
              AllOf(HasSubstr("2 images of images (x.png, ...)"), HasSubstr("--in-order")));
  // Nor do the seconds' fractions pair them, as if they were numbers.
  const auto apart = [] {
    PairNames({"1700000000.25.png", "1700000001.25.png"},
              {"1700000003.25.pcd", "1700000004.25.pcd"});
  };
  EXPECT_THAT(test::ErrorOf(apart), AllOf(HasSubstr("2 s apart"), HasSubstr("--max-apart")));
  EXPECT_THAT(test::ErrorOf([] { PairNames({"1700000000.png"}, {"1700000003.pcd"}); }),
              AllOf(HasSubstr("3 s apart"), HasSubstr("--max-apart")));
}

}  // namespace
}  // namespace rgbdt
