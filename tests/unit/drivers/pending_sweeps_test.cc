#include "services/drivers/lidar/pending_sweeps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rgbdt {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr Utime kTenth = kMicrosecondsPerSecond / 10;  // a sweep takes as long
constexpr Utime kWall = 1'700'000'000 * kMicrosecondsPerSecond;

PendingSweeps::Clocks At(Utime since, Utime wall_set_by = 0) {
  return {kWall + since + wall_set_by, 5'000 + since};
}

TEST(PendingSweeps, ASweepThatBeganBeforeTheCommandIsNoAnswer) {
  PendingSweeps pending;
  pending.Add(7, kWall, At(kTenth / 2));
  EXPECT_THAT(pending.TakeAnswered(kWall - kTenth, At(kTenth / 2)), IsEmpty()) << "still buffered";
  EXPECT_THAT(pending.TakeAnswered(kWall, At(kTenth)), IsEmpty()) << "the one that was going on";
  EXPECT_THAT(pending.TakeAnswered(kWall + kTenth, At(2 * kTenth)), ElementsAre(7));
  EXPECT_THAT(pending.TakeAnswered(kWall + 2 * kTenth, At(3 * kTenth)), IsEmpty()) << "only once";
}

TEST(PendingSweeps, AClockThatIsSetMeanwhileCostsNoTime) {
  for (const Utime set_by : {-3600, -10, -1, 1, 10, 3600}) {
    const Utime by = set_by * kMicrosecondsPerSecond;
    PendingSweeps pending;
    pending.Add(7, kWall, At(kTenth / 2));
    EXPECT_THAT(pending.TakeAnswered(kWall, At(kTenth)), IsEmpty());
    EXPECT_THAT(pending.TakeAnswered(kWall + kTenth + by, At(2 * kTenth, by)), ElementsAre(7))
        << set_by;
  }
}

TEST(PendingSweeps, OfARecordingTheSweepAfterTheOneThatHasBegunIsTheAnswer) {
  PendingSweeps pending;
  pending.Add(7, 1000, {});
  pending.Add(8, 2000, {});
  EXPECT_THAT(pending.TakeAnswered(1000, {}), IsEmpty());
  EXPECT_THAT(pending.TakeAnswered(2000, {}), ElementsAre(7));
  EXPECT_THAT(pending.TakeAll(), ElementsAre(8));
  EXPECT_THAT(pending.TakeAll(), IsEmpty());
}

}  // namespace
}  // namespace rgbdt
