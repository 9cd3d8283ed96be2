#include "calib/files/import/internal/view_names.h"

#include <gtest/gtest.h>

#include <chrono>

#include "calib/model/printable.h"

namespace rgbdt {
namespace {

TEST(ViewNames, AreTheFilesNamesEachAnotherOne) {
  ViewNames names;
  EXPECT_EQ(names.NameOf("a b.pcd"), "a_b");
  EXPECT_EQ(names.NameOf("a_b.ply"), "a_b_2");
  EXPECT_EQ(names.NameOf("a_b_3.ply"), "a_b_3");
  EXPECT_EQ(names.NameOf("a\nb.ply"), "a_b_4");
}

// A byte that is no UTF-8 becomes three.
TEST(ViewNames, AreShortAndPrintableInAnyScript) {
  ViewNames names;
  for (const char* letter : {"\xff", "\xe4\xb8\xad", "\xf0\x9f\x98\x80"}) {
    std::string file;
    for (int i = 0; i < 60; ++i) file += letter;
    for (const char* before : {"", "a", "ab", "abc"}) {
      const std::string name = names.NameOf(before + file + ".pcd");
      EXPECT_LE(name.size(), 90u) << name;
      EXPECT_GE(name.size(), 85u) << name;
      EXPECT_TRUE(IsPrintable(name)) << name;
    }
  }
}

TEST(ViewNames, OfManyWhoseFirstLettersAgreeTakeTimeThatGrowsWithTheirNumber) {
  using Clock = std::chrono::steady_clock;
  const std::string alike(90, 'a');
  const auto begin = Clock::now();
  ViewNames names;
  for (int i = 0; i < 40'000; ++i) {
    names.NameOf(alike + std::to_string(i) + ".pcd");
    ASSERT_LT(Clock::now() - begin, std::chrono::seconds(10)) << "after " << i;
  }
  EXPECT_EQ(names.NameOf(alike), alike + "_40001");
}

}  // namespace
}  // namespace rgbdt
