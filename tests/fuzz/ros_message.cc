// A message of a bag. The first byte says which, the second how it is laid out.
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/read_bag.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  constexpr BagData kKinds[] = {BagData::kImage,   BagData::kCompressedImage, BagData::kCameraInfo,
                                BagData::kCloud,   BagData::kOther,           BagData::kPackets,
                                BagData::kMetadata};
  fuzz::Input input(data, size);
  const BagData kind = kKinds[input.Byte() % 7];
  BagTopic topic;
  switch (const int layout = input.Byte(); layout) {
    case 2:
      topic.encoding = BagEncoding::kProtobuf;
      topic.type = kind == BagData::kImage             ? "foxglove.RawImage"
                   : kind == BagData::kCompressedImage ? "foxglove.CompressedImage"
                                                       : "foxglove.PointCloud";
      break;
    default:
      topic.encoding = layout % 2 == 0 ? BagEncoding::kRos1 : BagEncoding::kCdr;
  }
  const std::string bytes = input.Rest();
  BagMessage message;
  message.data = fuzz::Data(bytes);
  message.size = bytes.size();
  fuzz::Try([&] { ros::DecodeHeader(message, topic); });
  fuzz::Try([&] { fuzz::Convert(message, kind, topic.encoding); });
  return 0;
}
