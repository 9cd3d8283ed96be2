#include "calib/solve/internal/lidar_reports.h"

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "calib/model/linear_algebra.h"
#include "calib/model/pose_sigma.h"
#include "calib/model/text.h"
#include "calib/solve/internal/degenerate.h"
#include "calib/solve/internal/edges_planes.h"
#include "calib/solve/internal/further_lidars.h"
#include "calib/solve/internal/nuisances.h"
#include "calib/solve/internal/scatter_sigmas.h"
#include "calib/solve/internal/view_scatter.h"

namespace rgbdt {
namespace {

using Index = Eigen::Index;

// A cloud that contradicts the others, and had to stay, as too few would be left.
const Contradiction* WorstLeft(const std::vector<Contradiction>& contradictions, double factor,
                               std::size_t lidar) {
  const Contradiction* worst = nullptr;
  for (const Contradiction& c : contradictions) {
    if (c.lidar != lidar || !(c.chi2 > kContradictionChi2 * factor)) continue;
    if (worst == nullptr || c.chi2 > worst->chi2) worst = &c;
  }
  return worst;
}

// By how much larger a further LIDAR has the distances between the boards than the reference: a
// similarity with the rotation that was found (Umeyama 1991).
Estimate ScaleOf(const JointResult& result, std::size_t lidar) {
  const BoardProblem& problem = result.joint.problem;
  const Eigen::Quaterniond turn = result.solution.state.lidars[lidar].reference_from_lidar.rotation;
  std::vector<Eigen::Vector3d> here, there;
  Eigen::Vector3d mean_here = Eigen::Vector3d::Zero(), mean_there = Eigen::Vector3d::Zero();
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    if (!HasCloud(problem, lidar, v)) continue;
    const auto& pose = problem.lidars[lidar].views[v].cloud.pose;
    if (!pose || !problem.views[v].cloud.pose) continue;
    here.push_back(problem.views[v].cloud.pose->sensor_from_target.translation);
    there.emplace_back(turn * pose->sensor_from_target.translation);
    mean_here += here.back();
    mean_there += there.back();
  }
  const auto count = static_cast<double>(here.size());
  if (count < 4) return {1, std::numeric_limits<double>::infinity()};
  double product = 0, square = 0;
  for (std::size_t i = 0; i < here.size(); ++i) {
    here[i] -= mean_here / count;
    there[i] -= mean_there / count;
    product += here[i].dot(there[i]);
    square += here[i].squaredNorm();
  }
  const double scale = product / square;
  double off = 0;
  for (std::size_t i = 0; i < here.size(); ++i) off += (there[i] - scale * here[i]).squaredNorm();
  return {scale, std::sqrt(off / (3 * count - 7) / square)};
}

// What its clouds do that those of a LIDAR on the rig, before this board, do not; empty: nothing.
std::string WhyNotOfThisRig(const JointResult& result, std::size_t lidar, std::size_t used) {
  constexpr double kLeastScale = 0.01, kSigmas = 4;
  constexpr double kMostSideScatter = 4e-3;  // [rad]; recorded boards have 2e-3
  const Estimate scale = ScaleOf(result, lidar);
  if (std::abs(scale.value - 1) > kLeastScale + kSigmas * scale.sigma) {
    return Format(
        "this LIDAR has the boards %.1f +- %.1f %% farther from each other than the reference; are "
        "the clouds of both in metres, and do they belong to the same views?",
        100 * (scale.value - 1), 100 * scale.sigma);
  }
  const std::size_t contradict = result.joint.lidars[lidar].contradicting;
  if (4 * contradict > used + contradict) {
    return Format("%d of %d views contradict the others; do clouds and views belong together?",
                  static_cast<int>(contradict), static_cast<int>(used + contradict));
  }
  const double scatter = result.joint.problem.lidars[lidar].priors.side_sigma_rad;
  if (scatter > kMostSideScatter) {
    return Format(
        "the board's sides in its clouds lie %.1f mrad from where they should, each other way; is "
        "it the rig file's board, and did it stand still?",
        1000 * scatter);
  }
  return "";
}

// With its covariance, as far as the views tell it.
LidarReport WithPose(const JointResult& result, std::size_t index,
                     const std::vector<Rigid3>& boards, LidarReport report) {
  const Index at = SharedPlaces(result.joint.problem).LidarPose(index);
  LidarCalibration& calibration = report.calibration;
  calibration.reference_from_lidar = result.solution.state.lidars[index].reference_from_lidar;
  Matrix6d covariance = result.lidar_factors[index] * result.placements.factor *
                        result.solution.covariance.block<6, 6>(at, at);
  if (result.encoder_delay) {
    const Vector6d move = result.encoder_delay->unknown_move.segment<6>(at);
    covariance += move * move.transpose();
  }
  std::string why = WhyDegenerate(boards, PoseOf::kLidar);
  if (why.empty()) why = WhyLoose(covariance, PoseOf::kLidar);
  if (!why.empty()) {
    calibration.status = SolveStatus::kDegenerate;
    calibration.detail = std::move(why);
    return report;
  }
  const auto& differ = result.lidars_edges_planes;
  if (index < differ.size() && differ[index]) {
    const double factor = FactorWhereTheyDiffer(*differ[index]);
    covariance *= factor;
    if (factor > 1) report.warnings.push_back(EnlargedWords(differ[index]->chi2, factor));
  }
  calibration.covariance = 0.5 * (covariance + covariance.transpose());
  report.sigma = SigmaOf(calibration);
  return report;
}

LidarReport ReportOf(const JointResult& result, const std::vector<Contradiction>& contradictions,
                     int min_views, std::size_t index) {
  constexpr int kFewViews = 5;
  const BoardProblem& problem = result.joint.problem;
  LidarReport report = result.joint.lidars[index].report;
  std::vector<Rigid3> boards;
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    if (!HasCloud(problem, index, v)) continue;
    report.used.push_back(problem.views[v].name);
    boards.push_back(result.solution.state.lidar_from_target[v]);
  }
  const auto count = static_cast<int>(boards.size());
  LidarCalibration& calibration = report.calibration;
  report.nuisance = NuisancesOfLidar(result, index);
  for (const RefutedOffset& refuted : result.refuted_offsets) {
    if (refuted.lidar == index) {
      report.warnings.push_back(RangesAreOff(RangeOffsetOfLidar(result, index), refuted.known_m));
    }
  }
  if (count < kFewViews) {
    report.warnings.push_back(Format(
        "only %d views; take %d or more in which this LIDAR sees the board", count, kFewViews));
  }
  calibration.status = SolveStatus::kConverged;
  report = WithPose(result, index, boards, std::move(report));
  if (calibration.status != SolveStatus::kConverged) return report;
  const double factor = result.lidar_factors[index];
  if (std::string why = WhyNotOfThisRig(result, index, boards.size()); !why.empty()) {
    calibration.status = SolveStatus::kContradicted;
    calibration.detail = std::move(why);
  } else if (count < min_views) {
    calibration.status = SolveStatus::kDegenerate;
    calibration.detail = TooFewClouds(count, min_views);
  } else if (const Contradiction* left = WorstLeft(contradictions, factor, index)) {
    calibration.status = SolveStatus::kContradicted;
    calibration.detail = Format(
        "the clouds contradict each other, and too few are left to tell which is wrong: "
        "view %s by itself would put this LIDAR %.2f deg and %.0f mm elsewhere. Add views, "
        "or take this one out",
        problem.views[left->view].name.c_str(), left->rotation_deg, left->centre_mm);
  }
  return report;
}

}  // namespace

std::string WhyLidarsDoNotFit(const JointResult& result) {
  const BoardProblem& problem = result.joint.problem;
  if (problem.lidars.empty()) return "";
  if (!result.solution.converged || !result.solution.covariance.allFinite()) {
    return "with its clouds the joint solve did not settle";
  }
  const JointResult cameras = WithoutLidars(result);
  if (!cameras.solution.converged) return "";
  for (std::size_t c = 0; c < problem.cameras.size(); ++c) {
    const Rigid3& with = result.solution.state.camera_from_lidar[c];
    const Rigid3& without = cameras.solution.state.camera_from_lidar[c];
    const Index at = SharedPlaces::Pose(c);
    const Matrix6d covariance =
        result.variance_factor * cameras.solution.covariance.block<6, 6>(at, at);
    const Vector6d moved = Log(with * without.Inverse());
    if (!(moved.dot(SolveSymmetric(covariance, moved)) > kContradictionChi2)) continue;
    const PoseError by = ErrorOf(with, without);
    return Format(
        "its clouds contradict the cameras' views: they would move camera %s by %.2f deg and %.0f "
        "mm, more than it can be off. Do clouds and views belong together, and are they in metres?",
        result.joint.cameras[c].views.spec->name.c_str(), by.rotation_deg, by.translation_mm);
  }
  return "";
}

std::vector<LidarViews> LeftOut(std::vector<LidarViews> lidars, const std::string& why) {
  for (LidarViews& lidar : lidars) {
    lidar.report.calibration.status = SolveStatus::kNotSolved;
    lidar.report.calibration.detail = why;
  }
  return lidars;
}

std::vector<LidarReport> ReportsOfLidars(const JointResult& result, int min_views) {
  std::vector<LidarReport> reports;
  std::vector<Contradiction> contradictions;
  if (!result.joint.lidars.empty()) {
    contradictions = Contradictions(result.joint.problem, result.solution);
  }
  for (std::size_t l = 0; l < result.joint.lidars.size(); ++l) {
    reports.push_back(ReportOf(result, contradictions, min_views, l));
  }
  for (const LidarViews& lidar : result.joint.lidars_left) reports.push_back(lidar.report);
  return reports;
}

}  // namespace rgbdt
