#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/detect/image/internal/pattern_match.h"

namespace rgbdt {

/// How many of the pattern's corners lie so far inside the image that they can be measured.
int CornersInside(const cv::Size& image, const GridModel& model, const PatternMatch& match,
                  const Target& target);

/// Why a pattern of which a part lies outside the image is not certainly where `match` has it;
/// empty: it is; nothing where there is no such pattern at all. Corners alone do not tell, a grid
/// is like itself two squares farther on:
///   - all squares that are seen alternate between light and dark as they should
///   - along columns and along rows one end is seen: its outermost squares alternate, and what
///     lies beyond, seen as well, does not. The known size tells the other end
///   - an end that is not seen lies outside the image
/// A target of another size that ends outside the image as well looks the same.
/// `grey` is CV_32FC1; `model` is extended by what is not seen.
std::optional<std::string> WhyNotPartial(const cv::Mat& grey, const GridModel& model,
                                         const PatternMatch& match, const Target& target);

/// Where in a grid a pattern may lie of which a part is outside the image: at least three quarters
/// of its corners lie inside and nothing that is seen speaks against it. More than one: doubtful.
std::vector<PatternMatch> PartialCandidates(const cv::Mat& grey, const GridModel& model,
                                            const CornerGrid& grid, const Target& target,
                                            std::string* why);

}  // namespace rgbdt
