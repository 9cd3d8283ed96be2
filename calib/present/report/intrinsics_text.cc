#include "calib/present/report/intrinsics_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/present/report/internal/degrees.h"

namespace rgbdt {
namespace {

constexpr double kContrastInNetd = 6;  // what detection needs between squares

std::string HeadText(const CameraSpec& before, const CameraCorners& corners,
                     const IntrinsicsResult& result) {
  return fmt::format(
      "camera {}: {}, {}x{} px: {}\n"
      "  board found in {} of {} images, used in {}; {} corners, RMS {:.3f} px\n",
      before.name, NameOf(result.choice), before.width, before.height,
      result.converged ? "converged" : "NOT CONVERGED: " + result.detail, corners.views.size(),
      corners.images, result.ViewsUsed(), result.corners_used, result.rms_px);
}

// What the rig file says, where it has a lens of this model.
std::optional<double> Before(const Lens& lens, const IntrinsicsResult& result, std::size_t i) {
  if (!lens.known() || lens.model != result.lens.model) return std::nullopt;
  const double first[4] = {lens.fx, lens.fy, lens.cx, lens.cy};
  return i < 4 ? first[i] : lens.distortion[i - 4];
}

std::string ParametersText(const CameraSpec& before, const IntrinsicsResult& result) {
  std::string text;
  for (std::size_t i = 0; i < result.values.size(); ++i) {
    const int digits = i < 4 ? 3 : 6;
    text += fmt::format("  {:<3}{:>12.{}f} +- {:.{}f}{}", result.names[i], result.values[i], digits,
                        result.Sigma(static_cast<int>(i)), digits, i < 4 ? " px" : "");
    if (const auto old = Before(before.lens, result, i)) {
      text += fmt::format("  (rig file: {:.{}f}", *old, digits);
      if (i < 2) text += fmt::format(", {:+.3f}%", 100 * (result.values[i] / *old - 1));
      text += ")";
    }
    text += "\n";
  }
  if (const auto& board = result.board) {
    const auto mm = [](const Estimate& of) {
      return fmt::format("{:+.2f} +- {:.2f} mm", 1e3 * of.value, 1e3 * of.sigma);
    };
    text += fmt::format(
        "  the printed squares' height over their width: {:+.2f} +- {:.2f}%\n"
        "  the board's bulge towards the camera: along its width {}, along its height {}; twist "
        "{}\n",
        100 * board->aspect.value, 100 * board->aspect.sigma, mm(board->bow_x), mm(board->bow_y),
        mm(board->twist));
  }
  return text;
}

double TiltOf(const IntrinsicsViewFit& view) {
  const Eigen::Vector3d normal = view.camera_from_target.rotation * Eigen::Vector3d::UnitZ();
  return std::acos(std::clamp(normal.z(), -1.0, 1.0)) * kDegreesPerRadian;
}

std::string ContrastText(const CameraSpec& camera, double contrast) {
  if (camera.radiometry.kind != Radiometry::Kind::kLinear) return fmt::format("{:.0f}", contrast);
  const double kelvin = contrast * camera.radiometry.gain;
  const bool weak = camera.netd_k > 0 && kelvin < kContrastInNetd * camera.netd_k;
  return fmt::format("{:.2f} K{}", kelvin, weak ? " (weak)" : "");
}

std::string ViewsText(const CameraSpec& camera, const CameraCorners& corners,
                      const IntrinsicsResult& result) {
  const bool thermal = camera.kind == CameraKind::kThermal;
  std::string text = fmt::format("  {:<12}{:>9}{:>11}{:>9}{:>9}{}\n", "view", "RMS [px]",
                                 "worst [px]", "at [m]", "tilt", thermal ? "  contrast" : "");
  for (std::size_t i = 0; i < result.views.size(); ++i) {
    const IntrinsicsViewFit& view = result.views[i];
    if (!view.rejected.empty()) {
      text += fmt::format("  {:<12} rejected: {}\n", view.name, view.rejected);
      continue;
    }
    text += fmt::format("  {:<12}{:>9.3f}{:>11.2f}{:>9.2f}{:>5.0f} deg", view.name, view.rms_px,
                        view.worst_px, view.camera_from_target.translation.norm(), TiltOf(view));
    if (thermal) text += fmt::format("{:>10}", ContrastText(camera, corners.contrasts[i]));
    if (view.corners_left_out > 0) {
      text += fmt::format("  {} corner{} left out", view.corners_left_out,
                          view.corners_left_out == 1 ? "" : "s");
    }
    text += "\n";
  }
  for (const std::string& name : corners.not_found) {
    text += fmt::format("  {:<12} no board found\n", name);
  }
  for (const std::string& name : corners.copies) {
    text += fmt::format("  {:<12} a copy of another image: it counts once\n", name);
  }
  return text;
}

std::string CoverageText(const ImageCoverage& coverage) {
  std::string text = fmt::format("  covered {:.0f}% of the image (# corners were here, . none)\n",
                                 100 * coverage.fraction);
  for (int row = 0; row < coverage.rows; ++row) {
    text += "    ";
    for (int column = 0; column < coverage.columns; ++column) {
      text += coverage.Holds(column, row) ? "# " : ". ";
    }
    text.back() = '\n';
  }
  std::string parts;
  for (const std::string& part : coverage.EmptyParts()) parts += (parts.empty() ? "" : ", ") + part;
  if (!parts.empty()) {
    text += "  hint: take more views with the board, tilted, at the image's " + parts +
            ": the lens is extrapolated there\n";
  }
  return text;
}

}  // namespace

std::string IntrinsicsText(const CameraIntrinsics& camera) {
  const auto& [before, corners, result] = camera;
  std::string text = HeadText(before, corners, result);
  if (result.converged) text += ParametersText(before, result);
  return text + ViewsText(before, corners, result) + CoverageText(result.coverage);
}

std::string LensComparisonText(const LensComparison& comparison) {
  if (comparison.better) {
    const auto& [choice, converged, rms_px, asked_rms_px, bic] = *comparison.better;
    const bool fewer = comparison.asked == LensChoice::kPinhole8 && choice == LensChoice::kPinhole5;
    return fmt::format(
        "  {} fits these images {}: RMS {:.3f} px against {:.3f} px; give --model {}\n",
        NameOf(choice), fewer ? "as well, with fewer numbers" : "better", rms_px, asked_rms_px,
        NameOf(choice));
  }
  std::string others;
  for (const LensAlternative& other : comparison.others) {
    others +=
        (others.empty() ? "" : ", ") + NameOf(other.choice) +
        (other.converged ? fmt::format(" RMS {:.3f} px", other.rms_px) : " does not converge");
  }
  return "  no other lens model fits these images better: " + others + "\n";
}

std::string NameOf(LensChoice choice) {
  switch (choice) {
    case LensChoice::kPinhole8:
      return "pinhole8";
    case LensChoice::kFisheye:
      return "fisheye";
    case LensChoice::kPinhole5:
      break;
  }
  return "pinhole5";
}

}  // namespace rgbdt
