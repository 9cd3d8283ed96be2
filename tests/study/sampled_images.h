#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/model/rig.h"
#include "calib/model/view_detection.h"
#include "calib/simulate/internal/noise.h"
#include "calib/simulate/options.h"
#include "tests/study/true_board.h"

namespace rgbdt::study {

/// A detected corner's error along x or y [px], with the simulator's default cameras: what sampled
/// corners are given. It hardly changes with the range; study_corner_noise holds it against
/// rendering.
double CornerSigma(CameraKind kind);

/// The camera as the rig file would have it.
CameraSpec SpecOf(const simulate::CameraOptions& camera);

/// The true inner corners [px]; nothing where one of the board's is outside the image.
std::optional<std::vector<Eigen::Vector2d>> TrueCorners(const CameraSpec& spec,
                                                        const TrueBoard& board,
                                                        const Rigid3& camera_from_target);

/// Of all corners' x and y, one after the other [px^2]: each has a noise of its own, and an affine
/// part is common to the image's.
Eigen::MatrixXd CornerCovariance(const std::vector<Eigen::Vector2d>& corners, double sigma_px);

/// Corners with that noise, in the target's order or turned by half a turn, as the noise draws.
std::vector<Eigen::Vector2d> SampledCorners(const std::vector<Eigen::Vector2d>& corners,
                                            double sigma_px, const simulate::Noise& noise);

/// All that a detector would make of the board in one image, which thinks that the lens is `given`
/// and the board flat, its pattern as large as its squares say, its corners with the noise of
/// SampledCorners: pose, outline, edge pixels along it, and in colour the sides, each end off by
/// some 0.1 px. What a thermal image does not tell, the half turn and the sides, stays unknown.
/// Nothing where the board is not wholly in the image.
std::optional<ImageEdges> SampledEdges(const CameraSpec& spec, const Lens& given,
                                       const TrueBoard& board, const Rigid3& camera_from_target,
                                       const simulate::Noise& noise);

/// How far detected corners are off, up to half a turn: root mean square along x or y [px].
double CornerRms(const std::vector<Eigen::Vector2d>& corners,
                 const std::vector<Eigen::Vector2d>& truth);

}  // namespace rgbdt::study
