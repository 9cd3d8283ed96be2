#include "calib/simulate/internal/marker_bits.h"

#include <opencv2/aruco/dictionary.hpp>

namespace rgbdt::simulate {

MarkerBits::MarkerBits(const Markers& markers)
    : border_(markers.border_bits),
      inner_(FindMarkerFamily(markers.family)->cells),
      cells_(inner_ + 2 * border_) {
  const auto family = cv::aruco::getPredefinedDictionary(FindMarkerFamily(markers.family)->number);
  for (int id = 0; id < family->bytesList.rows; ++id) {
    const cv::Mat bits =
        cv::aruco::Dictionary::getBitsFromByteList(family->bytesList.row(id), inner_);
    auto& white = white_.emplace_back();
    for (int row = 0; row < inner_; ++row) {
      for (int column = 0; column < inner_; ++column) {
        white.push_back(bits.at<unsigned char>(row, column) != 0);
      }
    }
  }
}

bool MarkerBits::IsWhite(int id, int column, int row) const {
  const int x = column - border_;
  const int y = row - border_;
  if (x < 0 || y < 0 || x >= inner_ || y >= inner_) return false;
  return white_[static_cast<std::size_t>(id)][static_cast<std::size_t>(y * inner_ + x)];
}

}  // namespace rgbdt::simulate
