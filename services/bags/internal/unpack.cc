#include "services/bags/internal/unpack.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <memory>

#include "calib/model/errors.h"
#include "services/bags/bag_reader.h"
#include "services/bags/printable.h"

namespace rgbdt::bags {
namespace {

// How many bytes came out.
std::size_t FromZstd(const std::uint8_t* packed, std::size_t size, std::vector<std::uint8_t>* out) {
  const std::size_t got = ZSTD_decompress(out->data(), out->size(), packed, size);
  if (ZSTD_isError(got) != 0) {
    throw InputError(std::string("zstd: ") + ZSTD_getErrorName(got));
  }
  return got;
}

std::size_t FromLz4(const std::uint8_t* packed, std::size_t size, std::vector<std::uint8_t>* out) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) {
    throw InputError("lz4: no memory");
  }
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> owner(
      context, LZ4F_freeDecompressionContext);
  std::size_t read = 0, written = 0;
  while (read < size) {
    std::size_t in = size - read, room = out->size() - written;
    const std::size_t left =
        LZ4F_decompress(context, out->data() + written, &room, packed + read, &in, nullptr);
    if (LZ4F_isError(left) != 0) throw InputError(std::string("lz4: ") + LZ4F_getErrorName(left));
    read += in;
    written += room;
    if (left == 0) break;
    if (in == 0 && room == 0) throw InputError("lz4: it is longer than the chunk says");
  }
  return written;
}

std::size_t FromBz2(const std::uint8_t* packed, std::size_t size, std::vector<std::uint8_t>* out) {
  unsigned room = static_cast<unsigned>(out->size());
  const int code = BZ2_bzBuffToBuffDecompress(
      reinterpret_cast<char*>(out->data()), &room,
      const_cast<char*>(reinterpret_cast<const char*>(packed)), static_cast<unsigned>(size), 0, 0);
  if (code != BZ_OK) throw InputError("bz2: damaged (code " + std::to_string(code) + ")");
  return room;
}

}  // namespace

void Unpack(const std::string& compression, const std::uint8_t* packed, std::size_t size,
            std::uint64_t unpacked, std::vector<std::uint8_t>* out) {
  if (unpacked > kMostBagBytes || size > kMostBagBytes) {
    throw InputError("it unpacks to " + std::to_string(unpacked) + " bytes; at most " +
                     std::to_string(kMostBagBytes) + " are read at once");
  }
  std::size_t got = 0;
  if (compression.empty() || compression == "none") {
    out->assign(packed, packed + size);
    got = size;
  } else {
    out->resize(unpacked);
    if (compression == "zstd") {
      got = FromZstd(packed, size, out);
    } else if (compression == "lz4") {
      got = FromLz4(packed, size, out);
    } else if (compression == "bz2") {
      got = FromBz2(packed, size, out);
    } else {
      throw InputError("its compression is \"" + Printable(compression) +
                       "\"; expected none, zstd, lz4 or bz2");
    }
  }
  if (got == unpacked) return;
  throw InputError("it unpacks to " + std::to_string(got) + " bytes where " +
                   std::to_string(unpacked) + " are announced");
}

UnpackBudget::UnpackBudget(std::int64_t file_bytes)
    : left_((std::uint64_t{1} << 30) + 1000 * static_cast<std::uint64_t>(file_bytes)) {}

void UnpackBudget::Spend(std::uint64_t bytes) {
  if (bytes > kMostBagBytes) return;  // Unpack refuses it
  if (bytes > left_) {
    throw InputError(
        "with it the bag would unpack to more than a thousand times its size; it is left out");
  }
  left_ -= bytes;
}

bool IsZstd(const std::uint8_t* bytes, std::size_t size) {
  return size >= 4 && bytes[0] == 0x28 && bytes[1] == 0xb5 && bytes[2] == 0x2f && bytes[3] == 0xfd;
}

std::uint64_t ZstdSize(const std::uint8_t* bytes, std::size_t size) {
  const unsigned long long unpacked = ZSTD_getFrameContentSize(bytes, size);
  if (unpacked == ZSTD_CONTENTSIZE_ERROR || unpacked == ZSTD_CONTENTSIZE_UNKNOWN) {
    throw InputError("zstd: it does not say how long it unpacks to");
  }
  return unpacked;
}

}  // namespace rgbdt::bags
