#include "calib/solve/internal/lens_by_images.h"

#include "tests/unit/camera/intrinsics_testing.h"

namespace rgbdt {
namespace {

// Ten images of a wide fisheye lens, of which the rig file says this.
struct Seen {
  CameraSpec given;
  std::vector<ImageEdges> images;
  CameraViews views;

  explicit Seen(const CameraSpec& spec, int count = 10) : given(spec) {
    const IntrinsicsInput made = InputOf(Acfr(), count, 0.1, 1);
    for (const IntrinsicsView& view : made.views) images.emplace_back().corners = view.corners;
    views.spec = &given;
    for (std::size_t i = 0; i < images.size(); ++i) {
      CameraView& view = views.all.emplace_back();
      view.view = made.views[i].name;
      view.image = &images[i];
    }
  }
  Seen(const Seen&) = delete;
  Seen& operator=(const Seen&) = delete;

  static CameraSpec Acfr() {
    for (const NamedLens& lens : Lenses()) {
      if (lens.name == "acfr_fisheye") return lens.spec;
    }
    return {};
  }
};

TEST(LensByImages, TakesOnlyTheModelOfWhatWasGiven) {
  CameraSpec given = Seen::Acfr();
  std::swap(given.lens.fy, given.lens.cy);
  const Seen seen(given);
  const auto lens = FindLensByImages(PaperTarget(), seen.views);
  ASSERT_TRUE(lens && lens->result.converged);
  EXPECT_NEAR(lens->result.lens.fy, Seen::Acfr().lens.fy, 0.01 * Seen::Acfr().lens.fy);
  EXPECT_FALSE(OtherModel(*lens, given));
}

TEST(LensByImages, SaysThatAFisheyeWasGivenAsAPinhole) {
  CameraSpec given = Seen::Acfr();
  given.name = "rgb";
  given.lens.model = Lens::Model::kPinhole;
  given.lens.distortion = {};
  const Seen seen(given);
  const auto lens = FindLensByImages(PaperTarget(), seen.views);
  ASSERT_TRUE(lens);
  const auto cause = OtherModel(*lens, given);
  ASSERT_TRUE(cause);
  EXPECT_EQ(cause->name, "lens model");
  EXPECT_GT(cause->Sigmas(), kGivenWrongSigmas);
  EXPECT_THAT(cause->words, testing::HasSubstr("rgb has no pinhole lens"));
  EXPECT_THAT(cause->words, testing::HasSubstr("rgbdt intrinsics --model fisheye"));
}

TEST(LensByImages, NothingIsSaidByFewImagesOrWithoutAPattern) {
  const Seen few(Seen::Acfr(), 4);
  EXPECT_FALSE(FindLensByImages(PaperTarget(), few.views));
  const Seen enough(Seen::Acfr());
  Target plain = PaperTarget();
  plain.squares_x = plain.squares_y = 0;
  ASSERT_FALSE(plain.HasPattern());
  EXPECT_FALSE(FindLensByImages(plain, enough.views));
}

}  // namespace
}  // namespace rgbdt
