#include "calib/present/report/said_once.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rgbdt {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(SaidOnce, OfOneViewSaysItAsItIs) {
  EXPECT_THAT(SaidOnce({}, "rejected"), IsEmpty());
  EXPECT_THAT(SaidOnce({{"rgb", "0001", "no board"}}, "rejected"),
              ElementsAre("rgb: view 0001 rejected: no board"));
  EXPECT_THAT(SaidOnce({{"", "0001", "no board"}}, "not read"),
              ElementsAre("view 0001 not read: no board"));
}

TEST(SaidOnce, TheSameOfSeveralViewsAndCamerasIsALine) {
  std::vector<Said> all;
  for (const char* camera : {"rgb", "thermal"}) {
    for (const std::string view : {"0001", "0002", "pose_a"}) {
      all.push_back({camera, view, "cannot read /data/" + view + "/rgb.png"});
    }
  }
  EXPECT_THAT(SaidOnce(all, "rejected"),
              ElementsAre("rgb, thermal: 3 views rejected (0001, 0002, pose_a), 0001: cannot read "
                          "/data/0001/rgb.png"));
}

TEST(SaidOnce, OtherNumbersAreTheSameOtherWordsAreNot) {
  EXPECT_THAT(SaidOnce({{"rgb", "1", "line 7: 1610 bytes are there"},
                        {"rgb", "2", "line 12: 20 bytes are there"},
                        {"rgb", "3", "it is no image"}},
                       "rejected"),
              ElementsAre("rgb: 2 views rejected (1, 2), 1: line 7: 1610 bytes are there",
                          "rgb: view 3 rejected: it is no image"));
}

TEST(SaidOnce, ANameIsAWord) {
  EXPECT_THAT(
      SaidOnce({{"rgb", "a", "bad data in a.png"}, {"rgb", "d", "bad data in d.png"}}, "rejected"),
      ElementsAre("rgb: 2 views rejected (a, d), a: bad data in a.png"));
}

TEST(SaidOnce, CamerasWithOtherViewsStayApart) {
  EXPECT_THAT(
      SaidOnce({{"rgb", "1", "dark"}, {"rgb", "2", "dark"}, {"thermal", "2", "dark"}}, "rejected"),
      ElementsAre("rgb: 2 views rejected (1, 2), 1: dark", "thermal: view 2 rejected: dark"));
}

TEST(SaidOnce, OfManyViewsTheFirstAreNamed) {
  std::vector<Said> all;
  for (int i = 1; i <= 200; ++i) all.push_back({"", std::to_string(i), "dark"});
  EXPECT_THAT(SaidOnce(all, "not read"),
              ElementsAre("200 views not read (1, 2, 3, 4, 5, 6, 7, 8, ...), 1: dark"));
}

TEST(SaidOnce, WhatIsSaidMostOften) {
  EXPECT_EQ(MostSaid({}).count, 0U);
  const SaidAlike most = MostSaid({{"", "1", "dark"}, {"", "2", "12 mm"}, {"", "3", "7 mm"}});
  EXPECT_EQ(most.count, 2U);
  EXPECT_EQ(most.first.view, "2");
  EXPECT_EQ(most.first.text, "12 mm");
}

TEST(SaidOnce, LinesAreTakenApart) {
  EXPECT_THAT(
      SaidOnce(OfViews({"view monday/0001: /d/0001/a.png: none", "3 messages dropped",
                        "view monday/0002: /d/0002/a.png: none", "3 messages dropped"}),
               "not read"),
      ElementsAre("2 views not read (monday/0001, monday/0002), monday/0001: /d/0001/a.png: none",
                  "3 messages dropped"));
}

}  // namespace
}  // namespace rgbdt
