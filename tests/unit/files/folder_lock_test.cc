#include "calib/files/folder_lock.h"

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <memory>

#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;
using test::ErrorOf;
using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(FolderLock, OneAtATime) {
  const test::TempDir dir;
  auto first = std::make_unique<FolderLock>(dir.path(), "rgbdt-session");
  EXPECT_THAT(ErrorOf([&] { FolderLock(dir.path(), "rgbdt-session"); }),
              AllOf(HasSubstr(dir.path().string() + ": another rgbdt-session writes to it"),
                    HasSubstr("name another folder")));
  first.reset();
  EXPECT_NO_THROW(FolderLock(dir.path(), "rgbdt-session"));
}

// As kill -9 ends it: its destructor is not run.
TEST(FolderLock, GoesWithItsProcess) {
  const test::TempDir dir;
  int has_it[2];
  ASSERT_EQ(pipe(has_it), 0);
  const Descriptor hears(has_it[0]), says(has_it[1]);
  const pid_t child = fork();
  if (child == 0) {
    const FolderLock lock(dir.path(), "rgbdt-session");
    if (write(says.get(), "x", 1) != 1) _exit(1);
    for (;;) pause();
  }
  char byte = 0;
  ASSERT_EQ(read(hears.get(), &byte, 1), 1);
  EXPECT_THAT(ErrorOf([&] { FolderLock(dir.path(), "rgbdt-session"); }),
              HasSubstr("another rgbdt-session"));
  ASSERT_EQ(kill(child, SIGKILL), 0);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  EXPECT_NO_THROW(FolderLock(dir.path(), "rgbdt-session"));
}

TEST(FolderLock, LeavesNoFolderThatItMadeAndNobodyUsed) {
  const test::TempDir dir;
  { const FolderLock lock(dir / "unused", "rgbdt-session"); }
  EXPECT_FALSE(fs::exists(dir / "unused"));
  {
    const FolderLock lock(dir / "used", "rgbdt-session");
    test::WriteQuickly(dir / "used/file", "");
  }
  EXPECT_TRUE(fs::exists(dir / "used/file"));
  fs::create_directory(dir / "there");
  { const FolderLock lock(dir / "there", "rgbdt-session"); }
  EXPECT_TRUE(fs::exists(dir / "there"));
}

TEST(FolderLock, SaysWhatCannotBeMade) {
  const test::TempDir dir;
  test::WriteQuickly(dir / "file", "");
  EXPECT_THAT(ErrorOf([&] { FolderLock(dir / "file/below", "rgbdt-session"); }),
              HasSubstr((dir / "file/below").string()));
  EXPECT_THAT(ErrorOf([&] { FolderLock(dir / "file", "rgbdt-session"); }),
              HasSubstr((dir / "file").string()));
}

}  // namespace
}  // namespace rgbdt
