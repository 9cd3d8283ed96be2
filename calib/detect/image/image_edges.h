#pragma once

#include <optional>
#include <string>

#include "calib/camera/camera.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// Edges or the reason why there are none.
struct ImageEdgesResult {
  std::optional<ImageEdges> edges;
  std::string why;
};

/// Whether a camera of that kind may see the board and none of its markers: its outline tells then.
bool MarkersMayHide(const Target& target, CameraKind kind);

/// The target's edges in an image (paper II-A.1): Sobel edges within a 5x5 window of the four lines
/// that join the outline corners. The corners are a person's picks, or, without any, follow from
/// the detected inner corners and the board's known size. A line is straight in space: it bends in
/// the image as the lens bends it (the paper assumes no distortion). Without picks the result also
/// has the target's pose and the board's sides. Of a board with holes whose markers a thermal
/// camera does not see, these follow from the outline, as a plain board's do, without corners.
/// `kind`: in a colour image black is dark, which may
/// tell the target's top from its bottom; in a thermal one that is not known.
ImageEdgesResult DetectImageEdges(const Image& image, const Camera& camera, const Target& target,
                                  const CornerSelection* picks,
                                  CameraKind kind = CameraKind::kThermal);

/// The same of a checkerboard that DetectImageEdges does not find and OpenCV's detector does: it
/// says where to look, nine of ten corners or more are measured from there (FindPickedBoard). `why`
/// is empty where it does not see it either.
ImageEdgesResult MeasureWhereOpenCvSees(const Image& image, const Camera& camera,
                                        const Target& target, CameraKind kind);

/// The same of a board that is not found without picks, most often as a part of it is hidden: the
/// picks say where to look, corners are measured from there (FindPickedBoard). The result has pose
/// and sides; inner corners that were not seen are NaN.
ImageEdgesResult MeasurePickedBoard(const Image& image, const Camera& camera, const Target& target,
                                    const CornerSelection& picks, CameraKind kind);

}  // namespace rgbdt
