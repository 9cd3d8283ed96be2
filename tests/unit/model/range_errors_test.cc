#include "calib/model/range_errors.h"

#include <cmath>
#include <functional>
#include <limits>

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using ::testing::ElementsAre;
using Points = std::vector<Eigen::Vector3f>;

constexpr double kTolerance = 1e-6;  // of a float, at a few metres
const Eigen::Vector3f kMiss = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());

Cloud CloudOf(const Points& points) {
  Cloud cloud;
  cloud.lines = 1;
  cloud.beams = static_cast<int>(points.size());
  cloud.points = points;
  return cloud;
}

// How much farther from the origin each point lies than before.
std::vector<double> Farther(const Cloud& before, const RangeErrors& errors) {
  const Cloud after = Corrected(before, errors);
  std::vector<double> farther;
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_LT(after.points[i].cross(before.points[i]).norm(), 1e-5) << "not along the beam";
    farther.push_back(double{after.points[i].norm()} - double{before.points[i].norm()});
  }
  return farther;
}

auto Near(double expected) { return ::testing::DoubleNear(expected, kTolerance); }

TEST(Corrected, AllRangesByTheCommonOffset) {
  RangeErrors errors;
  errors.offset_m = {0.03, 0.001};
  const Cloud cloud = CloudOf({{3, 0, 0}, {0, -4, 3}, {0, 0, 2}});
  EXPECT_THAT(Farther(cloud, errors), ElementsAre(Near(0.03), Near(0.03), Near(0.03)));
  errors.offset_m.value = -0.03;
  EXPECT_THAT(Farther(cloud, errors), ElementsAre(Near(-0.03), Near(-0.03), Near(-0.03)));
}

TEST(Corrected, EachRingByItsOwnOffsetBesides) {
  RangeErrors errors;
  errors.offset_m.value = 0.03;
  errors.rings = {{1, {0.01, 0}}, {4, {-0.02, 0}}};
  Cloud cloud = CloudOf(Points(5, {2, 1, 1}));
  cloud.ring = {0, 1, 2, 4, 9};
  EXPECT_THAT(Farther(cloud, errors),
              ElementsAre(Near(0.03), Near(0.04), Near(0.03), Near(0.01), Near(0.03)));
}

TEST(Corrected, ByIntensityInterpolatedBetweenOctaves) {
  RangeErrors errors;
  errors.offset_m.value = 0.1;
  errors.intensities = {{-2, {0.01, 0}}, {-1, {0.02, 0}}, {0, {0.05, 0}}};
  Cloud cloud = CloudOf(Points(7, {2, 1, 1}));
  const auto power = [](double log2) { return static_cast<float>(std::exp2(log2)); };
  cloud.intensity = {0, power(-5), power(-2), power(-1.5), power(-1), power(-0.25), 1};
  EXPECT_THAT(Farther(cloud, errors), ElementsAre(Near(0.11), Near(0.11), Near(0.11), Near(0.115),
                                                  Near(0.12), Near(0.1425), Near(0.15)));
}

TEST(Corrected, OneOctaveIsTheOffsetOfAllIntensities) {
  RangeErrors errors;
  errors.intensities = {{-3, {0.01, 0}}};
  Cloud cloud = CloudOf(Points(3, {2, 1, 1}));
  cloud.intensity = {0, 0.125F, 1};
  EXPECT_THAT(Farther(cloud, errors), ElementsAre(Near(0.01), Near(0.01), Near(0.01)));
}

TEST(Corrected, WithoutRingsAndIntensitiesByTheCommonOffsetOnly) {
  RangeErrors errors;
  errors.offset_m.value = 0.03;
  errors.rings = {{0, {0.01, 0}}};
  errors.intensities = {{-1, {0.02, 0}}, {0, {0.02, 0}}};
  EXPECT_THAT(Farther(CloudOf({{3, 0, 0}}), errors), ElementsAre(Near(0.03)));
}

// A beam at elevation e starts at z = -m tan(e).
TEST(Corrected, BeamsThatMeetAtARadiusStartLowerTheHigherTheyLook) {
  RangeErrors errors;
  errors.beams_meet_m = {0.05, 0.001};
  const Points beams = {{3, 4, 5}, {4, 0, -2}, {5, 0, 0}};
  const Cloud cloud = Corrected(CloudOf(beams), errors);
  EXPECT_THAT(cloud.points[0], EigenNear(Eigen::Vector3f(3, 4, 5 - 0.05F * 1), kTolerance));
  EXPECT_THAT(cloud.points[1], EigenNear(Eigen::Vector3f(4, 0, -2 + 0.05F * 0.5F), kTolerance));
  EXPECT_EQ(cloud.points[2], beams[2]);
}

TEST(Corrected, StraightUpThereIsNoRadiusToMeetAt) {
  RangeErrors errors;
  errors.offset_m.value = 0.5;
  errors.beams_meet_m.value = 0.05;
  const Cloud cloud = Corrected(CloudOf({{0, 0, 2}, {0, 0, 0}}), errors);
  EXPECT_THAT(cloud.points[0], EigenNear(Eigen::Vector3f(0, 0, 2.5F), kTolerance));
  EXPECT_EQ(cloud.points[1], Eigen::Vector3f(0, 0, 0)) << "has no direction";
}

TEST(Corrected, EachLineFromItsOwnOrigin) {
  RangeErrors errors;
  errors.offset_m.value = 0.5;
  Cloud cloud = CloudOf({{3, 0, 1}, {1, 2, 1}, {1, 4, 2}, {4, 0, 2}});
  cloud.lines = cloud.beams = 2;
  cloud.origins = {{1, 0, 1}, {1, 0, 2}};
  const Cloud moved = Corrected(cloud, errors);
  EXPECT_THAT(moved.points[0], EigenNear(Eigen::Vector3f(3.5F, 0, 1), kTolerance));
  EXPECT_THAT(moved.points[1], EigenNear(Eigen::Vector3f(1, 2.5F, 1), kTolerance));
  EXPECT_THAT(moved.points[2], EigenNear(Eigen::Vector3f(1, 4.5F, 2), kTolerance));
  EXPECT_THAT(moved.points[3], EigenNear(Eigen::Vector3f(4.5F, 0, 2), kTolerance));
  EXPECT_EQ(moved.origins, cloud.origins);
  // Level beams start where they did, wherever their origin is.
  errors = {};
  errors.beams_meet_m.value = 0.05;
  EXPECT_EQ(Corrected(cloud, errors).points, cloud.points);
}

TEST(Corrected, MissesKeepTheirDirectionsAndAllElseStays) {
  RangeErrors errors;
  errors.offset_m.value = 0.5;
  errors.rings = {{1, {0.5, 0}}};
  errors.beams_meet_m.value = 0.05;
  Cloud cloud = CloudOf({{3, 0, 0}, kMiss});
  cloud.directions = {kMiss, {0.6F, 0, 0.8F}};
  cloud.ring = {0, 1};
  cloud.utime = {7, 8};
  cloud.intensity = {0.25F, 0.5F};
  cloud.sweep_utime = 5;
  cloud.first_line = 3;
  const Cloud moved = Corrected(cloud, errors);
  EXPECT_TRUE(moved.IsHit(0));
  EXPECT_TRUE(moved.points[1].array().isNaN().all());
  EXPECT_EQ(moved.directions[1], cloud.directions[1]);
  EXPECT_EQ(moved.ring, cloud.ring);
  EXPECT_EQ(moved.utime, cloud.utime);
  EXPECT_EQ(moved.intensity, cloud.intensity);
  EXPECT_EQ(moved.sweep_utime, 5);
  EXPECT_EQ(moved.first_line, 3);
}

TEST(Corrected, WithoutErrorsNothingMoves) {
  const Cloud cloud = CloudOf({{3, 0.1F, 1.7F}, {-0.3F, -4, 3}});
  const Cloud same = Corrected(cloud, RangeErrors{});
  EXPECT_EQ(same.points, cloud.points);
}

TEST(NamesLasers, WhereEveryHitHasTheNumberOfOne) {
  Cloud cloud = CloudOf({{3, 0, 0}, {4, 0, 0}, kMiss});
  EXPECT_FALSE(NamesLasers(cloud)) << "no numbers at all";
  cloud.ring = {0, kMostLasers - 1, 0};
  EXPECT_TRUE(NamesLasers(cloud));
  cloud.ring = {0, kMostLasers, 0};
  EXPECT_FALSE(NamesLasers(cloud)) << "a turned scanner's beam";
  cloud.ring = {0, 1, kMostLasers};
  EXPECT_TRUE(NamesLasers(cloud)) << "a miss' number does not count";
  cloud.ring = {0, 1, 2, 3};
  EXPECT_FALSE(NamesLasers(cloud)) << "not one a point";
}

TEST(Log2Intensity, EndsWhereTheLeastIs) {
  EXPECT_EQ(Log2Intensity(1), 0);
  EXPECT_EQ(Log2Intensity(0.125), -3);
  // An Ouster's boards are 5 to 200 of 65535.
  EXPECT_EQ(Log2Intensity(1.0 / 1024), -10);
  EXPECT_EQ(Log2Intensity(1.0 / 65536), kLeastLog2Intensity);
  EXPECT_EQ(Log2Intensity(1e-6), kLeastLog2Intensity);
  EXPECT_EQ(Log2Intensity(0), kLeastLog2Intensity);
  EXPECT_EQ(Log2Intensity(-1), kLeastLog2Intensity);
  EXPECT_EQ(Log2Intensity(std::numeric_limits<double>::quiet_NaN()), kLeastLog2Intensity);
  EXPECT_EQ(Log2Intensity(2), 0) << "brighter than can be";
}

TEST(PlaceOf, BetweenPlacesAndAtAndBeyondTheEnds) {
  const auto at = [](double value, std::size_t count) {
    const OctavePlace place = PlaceOf(value, -4, count);
    return std::make_pair(place.lower, place.share);
  };
  using Place = std::pair<std::size_t, double>;
  EXPECT_EQ(at(-3.75, 4), Place(0, 0.25));
  EXPECT_EQ(at(-2.5, 4), Place(1, 0.5));
  EXPECT_EQ(at(-3, 4), Place(1, 0));
  EXPECT_EQ(at(-4, 4), Place(0, 0)) << "at the first";
  EXPECT_EQ(at(-7, 4), Place(0, 0)) << "before it";
  // There is no place after the last to take a share of.
  EXPECT_EQ(at(-1, 4), Place(2, 1)) << "at the last";
  EXPECT_EQ(at(0, 4), Place(2, 1)) << "beyond it";
  EXPECT_EQ(at(-2.5, 1), Place(0, 0)) << "one place is all places";
  EXPECT_EQ(at(-2.5, 0), Place(0, 0));
}

TEST(RangeErrors, EqualWhereAllOfThemAre) {
  RangeErrors errors;
  errors.offset_m = {0.03, 0.001};
  errors.rings = {{1, {0.01, 0.002}}};
  errors.intensities = {{-1, {0.02, 0.003}}};
  errors.beams_meet_m = {0.04, 0.004};
  EXPECT_TRUE(errors == RangeErrors(errors));
  const std::vector<std::function<void(RangeErrors*)>> changes = {
      [](RangeErrors* e) { e->offset_m.value = 0; },
      [](RangeErrors* e) { e->offset_m.sigma = 0; },
      [](RangeErrors* e) { e->rings[0].ring = 2; },
      [](RangeErrors* e) { e->rings[0].offset_m.value = 0; },
      [](RangeErrors* e) {
        e->rings.push_back({3, {}});
      },
      [](RangeErrors* e) { e->intensities[0].log2_intensity = -2; },
      [](RangeErrors* e) { e->intensities[0].offset_m.sigma = 0; },
      [](RangeErrors* e) { e->intensities.clear(); },
      [](RangeErrors* e) { e->beams_meet_m.value = 0; }};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    RangeErrors other = errors;
    changes[i](&other);
    EXPECT_FALSE(other == errors) << "change " << i;
    EXPECT_FALSE(errors == other) << "change " << i;
  }
}

}  // namespace
}  // namespace rgbdt
