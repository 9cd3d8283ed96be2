#include "calib/model/linear_algebra.h"

#include <Eigen/Dense>
#include <algorithm>
#include <limits>

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

// By the definitions. Sizes with an instance of their own, and others.
template <typename Size>
class OfSize : public testing::Test {
 protected:
  static constexpr int kSize = Size::value;
  static constexpr int kRows = kSize == Eigen::Dynamic ? 11 : kSize;
  using Square = Eigen::Matrix<double, kSize, kSize>;
  using Column = Eigen::Matrix<double, kSize, 1>;

  template <typename Check>
  static void ForAnyPositive(Check check) {
    std::srand(kRows);  // Random() is the C library's
    for (int trial = 0; trial < 20; ++trial) {
      const Square any = Square::Random(kRows, kRows);
      check(Square(any * any.transpose() + 0.1 * Square::Identity(kRows, kRows)));
    }
  }
};
using Sizes =
    testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>,
                   std::integral_constant<int, 4>, std::integral_constant<int, 6>,
                   std::integral_constant<int, 7>, std::integral_constant<int, Eigen::Dynamic>>;
TYPED_TEST_SUITE(OfSize, Sizes);

TYPED_TEST(OfSize, SolveSymmetricSolves) {
  TestFixture::ForAnyPositive([](const typename TestFixture::Square& a) {
    const typename TestFixture::Column x = TestFixture::Column::Random(a.rows());
    const typename TestFixture::Column b = a * x;
    EXPECT_THAT(SolveSymmetric(a, b), EigenNear(x, 1e-12));
    const typename TestFixture::Square many = a * a;
    EXPECT_THAT(SolveSymmetric(a, many), EigenNear(a, 1e-12));
  });
}

TYPED_TEST(OfSize, InversesAreInverse) {
  using Square = typename TestFixture::Square;
  TestFixture::ForAnyPositive([](const Square& a) {
    const Square one = Square::Identity(a.rows(), a.rows());
    EXPECT_THAT(Square(InverseOfSymmetric(a) * a), EigenNear(one, 1e-12));
    EXPECT_THAT(Square(InverseOfPositive(a).value() * a), EigenNear(one, 1e-12));
  });
}

TYPED_TEST(OfSize, EigenvaluesRiseAndTheirVectorsAreOrthonormal) {
  using Square = typename TestFixture::Square;
  TestFixture::ForAnyPositive([](const Square& a) {
    const auto system = EigensystemOf(a);
    EXPECT_TRUE(std::is_sorted(system.values.begin(), system.values.end()));
    const Square& v = system.vectors;
    EXPECT_THAT(Square(v * system.values.asDiagonal() * v.transpose()), EigenNear(a, 1e-12));
    EXPECT_THAT(Square(v.transpose() * v), EigenNear(Square::Identity(a.rows(), a.rows()), 1e-12));
  });
}

TEST(SolveSymmetric, OfASemidefiniteMatrixFindsASolution) {
  const Eigen::Matrix3d a = Eigen::Vector3d(4, 0, 1).asDiagonal();
  const Eigen::Vector3d x = SolveSymmetric(a, Eigen::Vector3d(8, 0, 3));
  EXPECT_EQ(x.x(), 2);
  EXPECT_EQ(x.z(), 3);
}

TEST(InverseOfPositive, OfWhatIsNotPositiveDefiniteThereIsNone) {
  Eigen::Matrix2d a;
  a << 1, 2, 2, 1;  // eigenvalues 3 and -1
  EXPECT_FALSE(InverseOfPositive(a).has_value());
  EXPECT_FALSE(InverseOfPositive(Eigen::Matrix2d::Zero()).has_value());
  a << 1, 1, 1, 1;
  EXPECT_FALSE(InverseOfPositive(a).has_value());
  a(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(InverseOfPositive(a).has_value());
}

TEST(NearestOrthogonal, TakesOffAStretch) {
  const Eigen::Matrix3d rotation = RotationAbout({1, -2, 3}, 1.2).rotation.toRotationMatrix();
  Eigen::Matrix3d stretch;  // symmetric, positive definite: a polar decomposition's
  stretch << 2, 0.3, 0.1, 0.3, 1, -0.2, 0.1, -0.2, 0.5;
  EXPECT_THAT(NearestOrthogonal(rotation * stretch), EigenNear(rotation, 1e-14));
  EXPECT_THAT(NearestOrthogonal(-rotation * stretch), EigenNear(-rotation, 1e-14));
}

}  // namespace
}  // namespace rgbdt
