#include "calib/files/check_writable.h"

#include <iterator>

#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;
using test::ErrorOf;
using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(CheckWritable, LeavesNothingWhereAFileCanBeWritten) {
  const test::TempDir dir;
  test::WriteQuickly(dir / "there", "before");
  for (const char* name : {"there", "new", "a/folder/that/is/to/be/made"}) {
    EXPECT_NO_THROW(CheckWritable(dir / name)) << name;
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(dir.path()), fs::directory_iterator()), 1);
  EXPECT_EQ(fs::file_size(dir / "there"), 6U);
}

TEST(CheckWritable, NamesTheFileAndTheReason) {
  const test::TempDir dir;
  fs::create_directories(dir / "folder");
  test::WriteQuickly(dir / "file", "");
  EXPECT_THAT(ErrorOf([&] { CheckWritable(dir / "folder"); }),
              AllOf(HasSubstr((dir / "folder").string()), HasSubstr("Is a directory")));
  EXPECT_THAT(ErrorOf([&] { CheckWritable(dir / "file/below"); }),
              AllOf(HasSubstr((dir / "file/below").string()), HasSubstr("Not a directory")));
  EXPECT_THAT(ErrorOf([&] { CheckWritable("/proc/no/such/folder"); }),
              HasSubstr("/proc/no/such/folder"));
  EXPECT_THAT(ErrorOf([&] { CheckWritable("/dev/full/x"); }), HasSubstr("Not a directory"));
}

}  // namespace
}  // namespace rgbdt
