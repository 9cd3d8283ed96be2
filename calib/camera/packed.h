#pragma once

#include "calib/model/image.h"

namespace rgbdt {

/// An image that is to travel as this format, kJpeg or kPng: its pixels are what Encode compresses.
/// Grey values and counts stay what they are in a PNG; all else is a colour picture (ToBgr).
/// Throws InputError for pixels that are compressed already.
Image Packed(Image image, PixelFormat format);

/// As PNG, which loses nothing, of grey values and counts; as JPEG of colours.
Image Packed(Image image);

}  // namespace rgbdt
