#include "calib/fuse/point_samples.h"

#include <algorithm>
#include <cstring>

#include "calib/fuse/internal/sample_kernel.h"

namespace rgbdt {
namespace {

// Points of a block that lie in an image, and what it shows there: brought together here, in the
// processor's nearest memory, and then added at once.
struct Inside {
  std::size_t size = 0;
  std::uint32_t point[PixelBlock::kSize];
  float u[PixelBlock::kSize], v[PixelBlock::kSize], inverse_range[PixelBlock::kSize];
  std::uint32_t sample[PixelBlock::kSize];
};

void FindInside(const PixelBlock& block, std::size_t first_point, std::size_t count,
                const cv::Mat& pixels, Inside* in) {
  const auto most_u = static_cast<float>(pixels.cols - 1);
  const auto most_v = static_cast<float>(pixels.rows - 1);
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float u = block.u[i];
    const float v = block.v[i];
    const float w = block.inverse_range[i];
    in->point[found] = static_cast<std::uint32_t>(first_point + i);
    in->u[found] = u;
    in->v[found] = v;
    in->inverse_range[found] = w;
    found +=
        static_cast<std::size_t>((w > 0) & (u >= 0) & (v >= 0) & (u <= most_u) & (v <= most_v));
  }
  in->size = found;
}

template <typename T>
void Append(const T* from, std::size_t count, std::vector<T>* to) {
  to->insert(to->end(), from, from + count);
}

}  // namespace

std::size_t PointSamples::FirstFrom(std::size_t point_number, std::size_t begin) const {
  if (begin == size() || point[begin] >= point_number) return begin;
  // Each point has a number of its own, so that it cannot lie further on than this.
  const std::size_t end = std::min(size(), begin + point_number - point[begin]);
  const auto first = point.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto last = point.begin() + static_cast<std::ptrdiff_t>(end);
  return static_cast<std::size_t>(std::lower_bound(first, last, point_number) - point.begin());
}

void PointSamples::CutBack(std::size_t size) {
  point.resize(size);
  u.resize(size);
  v.resize(size);
  inverse_range.resize(size);
  sample.resize(size);
  occluded.resize(std::min(size, occluded.size()));
  while (!runs.empty() && runs.back().first >= size) runs.pop_back();
}

void SampleImage(const FusionCamera& camera, const PreparedImage& image, const PixelBlock& block,
                 std::size_t first_point, std::size_t count, PointSamples* samples) {
  const cv::Mat& pixels = image.pixels;
  Inside in;
  FindInside(block, first_point, count, pixels, &in);
  if (in.size == 0) return;
  const ImageRows rows{pixels.data, pixels.step[0], pixels.cols, pixels.rows};
  if (camera.spec().kind == CameraKind::kThermal) {
    float counts[PixelBlock::kSize];
    SampleFloats(rows, in.u, in.v, in.size, counts);
    std::memcpy(in.sample, counts, in.size * sizeof *counts);
  } else {
    SampleColours(rows, in.u, in.v, in.size, in.sample);
  }
  std::vector<PointSamples::Run>& runs = samples->runs;
  if (runs.empty() || runs.back().temperatures != image.temperatures) {
    runs.push_back({samples->size(), image.temperatures});
  }
  Append(in.point, in.size, &samples->point);
  Append(in.u, in.size, &samples->u);
  Append(in.v, in.size, &samples->v);
  Append(in.inverse_range, in.size, &samples->inverse_range);
  Append(in.sample, in.size, &samples->sample);
}

void TestOcclusion(const DepthBuffer& now, const DepthBuffer* past, std::size_t first,
                   PointSamples* samples) {
  samples->occluded.resize(first);
  while (first < samples->size()) {
    std::uint8_t occluded[PixelBlock::kSize];
    const std::size_t count = std::min(PixelBlock::kSize, samples->size() - first);
    const PixelColumns points{&samples->u[first], &samples->v[first],
                              &samples->inverse_range[first]};
    now.FindOccluded(past != nullptr ? *past : now, points, count, occluded);
    Append(occluded, count, &samples->occluded);
    first += count;
  }
}

}  // namespace rgbdt
