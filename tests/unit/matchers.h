#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <random>
#include <string>

#include "calib/model/errors.h"
#include "calib/model/rigid3.h"

namespace rgbdt {

/// A pose within `rotation` [rad] and `translation` [m] of `expected`.
MATCHER_P3(Rigid3Near, expected, rotation, translation,
           std::string(negation ? "isn't" : "is") + " within " + testing::PrintToString(rotation) +
               " rad and " + testing::PrintToString(translation) + " m of the expected pose") {
  const double angle = RotationDistance(arg, expected);
  const double shift = (arg.translation - expected.translation).norm();
  *result_listener << "which is " << angle << " rad and " << shift << " m off";
  return angle <= rotation && shift <= translation;
}

/// A vector or matrix whose difference from `expected` has a norm of at most `tolerance`.
MATCHER_P2(EigenNear, expected, tolerance,
           std::string(negation ? "isn't" : "is") + " within " + testing::PrintToString(tolerance) +
               " of the expected vector") {
  const double difference = (arg - expected).norm();
  *result_listener << "which is " << difference << " off";
  return difference <= tolerance;
}

/// The message of the InputError that `call` throws; empty where it throws none.
template <typename Call>
std::string InputErrorOf(Call call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// Seeded numbers; the same on every machine (the standard's distributions are not).
class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}

  double Uniform(double from, double to) { return from + (to - from) * (engine_() / 4294967296.0); }

  Eigen::Vector3d Direction() {
    Eigen::Vector3d v;
    do {
      v = {Uniform(-1, 1), Uniform(-1, 1), Uniform(-1, 1)};
    } while (v.norm() > 1 || v.norm() < 0.1);
    return v.normalized();
  }

  Rigid3 Pose() {
    Rigid3 pose = RotationAbout(Direction(), Uniform(-3.1, 3.1));
    pose.translation = Uniform(0, 5) * Direction();
    return pose;
  }

 private:
  std::mt19937 engine_;
};

}  // namespace rgbdt
