#include "calib/files/keep_aside.h"

#include "calib/files/atomic_file.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

TEST(KeepAside, EachHasTheFirstFreeNumber) {
  const test::TempDir dir;
  EXPECT_EQ(KeepAside(dir / "map.ply"), "");
  for (const char* text : {"a", "b", "c"}) {
    test::WriteQuickly(dir / "map.ply", text);
    if (*text == 'b') std::filesystem::remove(dir / "map.1.ply");
    EXPECT_EQ(KeepAside(dir / "map.ply"), dir / (*text == 'c' ? "map.2.ply" : "map.1.ply"));
  }
  EXPECT_FALSE(std::filesystem::exists(dir / "map.ply"));
  EXPECT_EQ(ReadWholeFile(dir / "map.1.ply"), "b");
  EXPECT_EQ(ReadWholeFile(dir / "map.2.ply"), "c");
}

}  // namespace
}  // namespace rgbdt
