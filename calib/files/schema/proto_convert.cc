#include "calib/files/schema/proto_convert.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

namespace rgbdt::text {
namespace {

Eigen::Quaterniond ToQuaternion(const Numbers& wxyz, const Place& place) {
  RequireNumbers(wxyz, 4, place, "quaternion_wxyz");
  const Eigen::Quaterniond q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (std::abs(q.norm() - 1) > 1e-3) {
    place.Fail("quaternion_wxyz", "has the norm " + std::to_string(q.norm()) +
                                      "; expected 1: four numbers in the order w, x, y, z");
  }
  return Normalised(q);
}

Eigen::Quaterniond ToQuaternionFromAngles(const Numbers& degrees, const Place& place) {
  RequireNumbers(degrees, 3, place, "roll_pitch_yaw_deg");
  const auto about = [](double angle_deg, const Eigen::Vector3d& axis) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle_deg * M_PI / 180.0, axis));
  };
  return (about(degrees[2], Eigen::Vector3d::UnitZ()) *
          about(degrees[1], Eigen::Vector3d::UnitY()) * about(degrees[0], Eigen::Vector3d::UnitX()))
      .normalized();
}

Eigen::Vector3d ToTranslation(const Numbers& xyz, const Place& place) {
  RequireNumbers(xyz, 3, place, "translation_m");
  return {xyz[0], xyz[1], xyz[2]};
}

template <typename Pose>
void Fill(const Rigid3& pose, Pose* out) {
  const Eigen::Quaterniond q = Normalised(pose.rotation);
  out->clear_quaternion_wxyz();
  for (const double number : {q.w(), q.x(), q.y(), q.z()}) out->add_quaternion_wxyz(number);
  out->clear_translation_m();
  for (const double number : pose.translation) out->add_translation_m(number);
}

// Symmetric, and of no direction's variance below zero; what digits leave of either does not count.
bool IsCovariance(const Matrix6d& matrix) {
  constexpr double kRounding = 1e-6;
  const Vector6d diagonal = matrix.diagonal();
  if (!(diagonal.minCoeff() >= 0)) return false;
  const Vector6d scale =
      diagonal.cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  const Matrix6d correlation = scale.asDiagonal() * matrix * scale.asDiagonal();
  if ((correlation - correlation.transpose()).cwiseAbs().maxCoeff() > kRounding) return false;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(correlation, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().minCoeff() > -kRounding;
}

}  // namespace

SolveStatus ToStatus(proto::SolveStatus status, const Place& place) {
  if (!proto::SolveStatus_IsValid(status)) {
    place.Fail("status", "is " + std::to_string(status) + "; expected a status's name");
  }
  return static_cast<SolveStatus>(status);
}

proto::SolveStatus FromStatus(SolveStatus status) {
  static_assert(static_cast<int>(SolveStatus::kDegenerate) == proto::DEGENERATE &&
                static_cast<int>(SolveStatus::kConverged) == proto::CONVERGED);
  return static_cast<proto::SolveStatus>(status);
}

void RequireFinite(double number, const Place& place, const std::string& field) {
  if (!std::isfinite(number)) {
    place.Fail(field, "is " + std::to_string(number) + "; expected a finite number");
  }
}

void RequireNumbers(const Numbers& numbers, int count, const Place& place,
                    const std::string& field) {
  if (numbers.size() != count) {
    place.Fail(field, "has " + std::to_string(numbers.size()) + " numbers; expected " +
                          std::to_string(count));
  }
  for (const double number : numbers) RequireFinite(number, place, field);
}

Eigen::Quaterniond Normalised(const Eigen::Quaterniond& q) {
  return std::abs(q.squaredNorm() - 1) < 1e-15 ? q : q.normalized();
}

Rigid3 ToRigid3(const proto::Pose& pose, const Place& place) {
  const bool angles = pose.roll_pitch_yaw_deg_size() > 0;
  if (angles && pose.quaternion_wxyz_size() > 0) {
    place.Fail("roll_pitch_yaw_deg", "stands beside quaternion_wxyz; give one of the two");
  }
  if (!angles && pose.quaternion_wxyz_size() == 0) {
    place.Fail("quaternion_wxyz", "is missing; give it or roll_pitch_yaw_deg");
  }
  return {angles ? ToQuaternionFromAngles(pose.roll_pitch_yaw_deg(), place)
                 : ToQuaternion(pose.quaternion_wxyz(), place),
          ToTranslation(pose.translation_m(), place)};
}

Rigid3 ToRigid3(const proto::RigidMotion& pose, const Place& place) {
  return {ToQuaternion(pose.quaternion_wxyz(), place), ToTranslation(pose.translation_m(), place)};
}

Matrix6d ToMatrix(const proto::Covariance& covariance, const Place& place) {
  RequireNumbers(covariance.row_by_row(), 36, place, "row_by_row");
  Matrix6d matrix;
  for (int i = 0; i < 36; ++i) matrix(i / 6, i % 6) = covariance.row_by_row(i);
  if (!IsCovariance(matrix)) {
    place.Fail("row_by_row",
               "is no covariance; expected a symmetric matrix without negative eigenvalues");
  }
  return matrix;
}

void FromRigid3(const Rigid3& pose, proto::Pose* out) { Fill(pose, out); }
void FromRigid3(const Rigid3& pose, proto::RigidMotion* out) { Fill(pose, out); }

void FromMatrix(const Matrix6d& covariance, proto::Covariance* out) {
  out->clear_row_by_row();
  for (int i = 0; i < 36; ++i) out->add_row_by_row(covariance(i / 6, i % 6));
}

Radiometry ToRadiometry(const proto::LinearRadiometry& linear, const Place& place) {
  RequireFinite(linear.gain_k_per_count(), place, "gain_k_per_count");
  RequireFinite(linear.offset_k(), place, "offset_k");
  if (linear.gain_k_per_count() == 0) {
    place.Fail("gain_k_per_count", "is 0; expected the kelvin that one count stands for");
  }
  Radiometry radiometry;
  radiometry.kind = Radiometry::Kind::kLinear;
  radiometry.gain = linear.gain_k_per_count();
  radiometry.offset = linear.offset_k();
  return radiometry;
}

Radiometry ToRadiometry(const proto::PlanckRadiometry& planck, const Place& place) {
  RequireFinite(planck.f(), place, "f");
  RequireFinite(planck.o(), place, "o");
  if (!(planck.r() > 0) || !std::isfinite(planck.r())) {
    place.Fail("r", "is " + std::to_string(planck.r()) + "; expected a positive number");
  }
  if (!(planck.b() > 0) || !std::isfinite(planck.b())) {
    place.Fail("b", "is " + std::to_string(planck.b()) + "; expected a positive number");
  }
  Radiometry radiometry;
  radiometry.kind = Radiometry::Kind::kPlanck;
  radiometry.r = planck.r();
  radiometry.b = planck.b();
  radiometry.f = planck.f();
  radiometry.o = planck.o();
  return radiometry;
}

void FromLinear(const Radiometry& radiometry, proto::LinearRadiometry* out) {
  out->set_gain_k_per_count(radiometry.gain);
  out->set_offset_k(radiometry.offset);
}

void FromPlanck(const Radiometry& radiometry, proto::PlanckRadiometry* out) {
  out->set_r(radiometry.r);
  out->set_b(radiometry.b);
  out->set_f(radiometry.f);
  out->set_o(radiometry.o);
}

}  // namespace rgbdt::text
