#include "calib/monitor/mount_odds.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// log of the density of a normal vector about 0.
double LogNormal(const VectorXd& x, const MatrixXd& covariance) {
  const double log_size = EigensystemOf(covariance).values.array().log().sum();
  return -0.5 * (x.dot(SolveSymmetric(covariance, x)) + log_size);
}

MatrixXd RandomCovariance(int size, std::mt19937_64* random) {
  std::normal_distribution<double> normal;
  MatrixXd root(size, size);
  for (double& x : root.reshaped()) x = normal(*random);
  return root * root.transpose() + 0.1 * MatrixXd::Identity(size, size);
}

// What a measurement of all numbers, z with noise R, leaves of a prior.
BeforeAndAfter Measured(const MatrixXd& prior, const VectorXd& z, const MatrixXd& noise) {
  const MatrixXd gain = prior * InverseOfSymmetric(MatrixXd(prior + noise));
  return {prior, gain * z, prior - gain * prior};
}

TEST(LogOdds, IsThatOfTheMeasurementItself) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 50; ++round) {
    const MatrixXd prior = RandomCovariance(4, &random), noise = RandomCovariance(4, &random),
                   other = 0.2 * RandomCovariance(4, &random);
    VectorXd z(4);
    for (double& x : z) x = 2 * normal(random);
    const double wanted = LogNormal(z, other + noise) - LogNormal(z, prior + noise);
    EXPECT_NEAR(LogOdds(Measured(prior, z, noise), other), wanted, 1e-6 * (1 + std::abs(wanted)));
  }
}

TEST(LogOdds, UnitsDoNotMatterAndExactNumbersSayNothing) {
  std::mt19937_64 random(4);
  const MatrixXd prior = RandomCovariance(3, &random), noise = RandomCovariance(3, &random);
  const VectorXd z = VectorXd::LinSpaced(3, -1, 2);
  const double wanted = LogOdds(Measured(prior, z, noise), 0.1 * prior);
  const VectorXd unit = Eigen::Vector3d(1e-3, 1e3, 20);  // rad, px, mm
  BeforeAndAfter scaled = Measured(prior, z, noise);
  BeforeAndAfter larger{MatrixXd::Zero(4, 4), VectorXd::Zero(4), MatrixXd::Zero(4, 4)};
  larger.prior.topLeftCorner(3, 3) = unit.asDiagonal() * scaled.prior * unit.asDiagonal();
  larger.covariance.topLeftCorner(3, 3) = unit.asDiagonal() * scaled.covariance * unit.asDiagonal();
  larger.mean.head(3) = unit.cwiseProduct(scaled.mean);
  EXPECT_NEAR(LogOdds(larger, 0.1 * larger.prior), wanted, 1e-6);
}

TEST(LogOdds, WhatIsNotToldIsNoEvidence) {
  const MatrixXd prior = VectorXd(Eigen::Vector2d(1, 4)).asDiagonal();
  // Of the second number more is unknown than before, as an inflated covariance may say.
  BeforeAndAfter found{prior, Eigen::Vector2d(0, 1.5),
                       VectorXd(Eigen::Vector2d(1.2, 5)).asDiagonal()};
  EXPECT_NEAR(LogOdds(found, MatrixXd(0.01 * prior)), 0, 1e-12);
}

// A probability of 0.9 is right nine times in ten: of mounts of which one in five has moved.
TEST(HoldsProbability, IsRightAsOftenAsItSays) {
  constexpr double kShare = 0.2;
  const std::vector<double> sizes = {1, 3, 9};
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> even;
  const MatrixXd known = 0.3 * MatrixXd::Identity(2, 2), noise = MatrixXd::Identity(2, 2);
  const auto moved_by = [&](double size) {
    return MatrixXd(known + size * size * MatrixXd::Identity(2, 2));
  };
  constexpr int kBins = 5, kTrials = 40000;
  std::array<double, kBins> said{}, held{}, count{};
  for (int i = 0; i < kTrials; ++i) {
    const bool moves = even(random) < kShare;
    const double size = sizes[random() % sizes.size()];
    const MatrixXd truth = moves ? moved_by(size) : known;
    VectorXd z(2);
    for (double& x : z) x = std::sqrt(truth(0, 0) + noise(0, 0)) * normal(random);
    const BeforeAndAfter found = Measured(moved_by(9), z, noise);
    std::vector<double> moved;
    for (const double one : sizes) moved.push_back(LogOdds(found, moved_by(one)));
    const double holds = HoldsProbability(LogOdds(found, known), moved, kShare);
    const auto bin = std::min<std::size_t>(kBins - 1, static_cast<std::size_t>(holds * kBins));
    said[bin] += holds;
    held[bin] += moves ? 0 : 1;
    count[bin] += 1;
  }
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    ASSERT_GT(count[bin], 300);
    const double p = said[bin] / count[bin];
    EXPECT_NEAR(held[bin] / count[bin], p, 4 * std::sqrt(p * (1 - p) / count[bin]) + 1e-3) << bin;
  }
}

TEST(HoldsProbability, DoesNotOverflow) {
  EXPECT_NEAR(HoldsProbability(-2000, {-1, -1000}, 0.01), 0, 1e-12);
  EXPECT_NEAR(HoldsProbability(2000, {-1, -1000}, 0.01), 1, 1e-12);
}

}  // namespace
}  // namespace rgbdt
