#include "tests/study/visibility.h"

#include <gtest/gtest.h>

#include "tests/simulated_variants.h"

namespace rgbdt {
namespace {

using study::ScoreVisibility;
using study::VisibilityScores;

// Against shadow rays into the synthetic scenes: what the simulator renders with knows no depth
// buffer. Seeds that nothing was tuned on.
TEST(Visibility, ColoursWhatIsSeenAndNothingElse) {
  VisibilityScores all;
  for (int i = 0; i < 6; ++i) {
    simulate::Options options;
    options.seed = 7100 + static_cast<std::uint64_t>(i);
    options.scene = static_cast<simulate::Scene>(i % 3);
    const VisibilityScores scores = ScoreVisibility(options);
    all.whole.Add(scores.whole);
    all.live.Add(scores.live);
  }
  ASSERT_GT(all.whole.hidden, 3000);
  EXPECT_LE(all.whole.HiddenColoured(), 0.005);
  EXPECT_GE(all.whole.VisibleColoured(), 0.98);
  EXPECT_LE(all.live.HiddenColoured(), 0.005);
  EXPECT_GE(all.live.VisibleColoured(), 0.97);
}

// Which beams stand in a line says nothing of the scene.
TEST(Visibility, IsTheSameWhereLasersLookPastEachOther) {
  simulate::Options options;
  options.seed = 7200;
  options.scene = simulate::Scene::kOutdoor;
  simulate::UseLidar(64, &options);
  const VisibilityScores aligned = ScoreVisibility(options);
  const VisibilityScores staggered = ScoreVisibility(options, study::Columns::kStaggered);
  ASSERT_GT(aligned.whole.visible, 3000);
  EXPECT_EQ(staggered.whole.visible, aligned.whole.visible);
  EXPECT_NEAR(staggered.whole.VisibleColoured(), aligned.whole.VisibleColoured(), 0.01);
  EXPECT_NEAR(staggered.whole.HiddenColoured(), aligned.whole.HiddenColoured(), 0.01);
}

}  // namespace
}  // namespace rgbdt
