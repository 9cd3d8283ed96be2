#include "services/drivers/pcap/pcap_reader.h"

#include <pcap/pcap.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>

#include "calib/model/errors.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

constexpr int kIpv4 = 0x0800;
constexpr int kUdp = 17;

int Word(const std::uint8_t* bytes) { return bytes[0] << 8 | bytes[1]; }

struct Bytes {
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
  bool Skip(std::size_t count) {
    if (count > size) return false;
    data += count;
    size -= count;
    return true;
  }
};

// Takes an Ethernet-like header off whose type is its last two bytes, and VLAN tags after it.
bool SkipToType(std::size_t header, Bytes* bytes, int* type) {
  constexpr int kVlan = 0x8100, kOuterVlan = 0x88a8;
  if (bytes->size < header) return false;
  *type = Word(bytes->data + header - 2);
  bytes->Skip(header);
  while (*type == kVlan || *type == kOuterVlan) {
    if (bytes->size < 4) return false;
    *type = Word(bytes->data + 2);
    bytes->Skip(4);
  }
  return true;
}

// Leaves the IP packet; false where there is none.
bool SkipLink(int link, Bytes* bytes) {
  int type = kIpv4;
  switch (link) {
    case DLT_EN10MB:
      return SkipToType(14, bytes, &type) && type == kIpv4;
    case DLT_LINUX_SLL:
      return SkipToType(16, bytes, &type) && type == kIpv4;
    case DLT_LINUX_SLL2:
      return bytes->size >= 20 && Word(bytes->data) == kIpv4 && bytes->Skip(20);
    case DLT_NULL:
    case DLT_LOOP:
      return bytes->Skip(4);
    default:  // raw IP
      return true;
  }
}

bool IsKnownLink(int link) {
  return link == DLT_EN10MB || link == DLT_LINUX_SLL || link == DLT_LINUX_SLL2 ||
         link == DLT_NULL || link == DLT_LOOP || link == DLT_RAW || link == DLT_IPV4;
}

constexpr std::size_t kMostFragmented = 32;  // packets at once
constexpr std::size_t kMostFragments = 1000;
constexpr Utime kMostApart = kMicrosecondsPerSecond;  // later, a number may be another packet's
constexpr int kMore = 0x2000, kOffset = 0x1fff;

// Of an IPv4 packet that carries UDP, its header's length; 0: something else.
std::size_t IpHeader(const Bytes& bytes) {
  if (bytes.size < 20 || bytes.data[0] >> 4 != 4 || bytes.data[9] != kUdp) return 0;
  const std::size_t header = 4 * static_cast<std::size_t>(bytes.data[0] & 15);
  return header < 20 || header > bytes.size ? 0 : header;
}

std::string Address(const std::uint8_t* bytes) {
  return Format("%d.%d.%d.%d", bytes[0], bytes[1], bytes[2], bytes[3]);
}

}  // namespace

PcapReader::PcapReader(const std::string& path) : path_(path) {
  struct stat status {};
  // libpcap opens a folder, too, and then fails to read it, and waits for a pipe; and "-" would be
  // standard input.
  if (stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
    throw InputError(path + (S_ISDIR(status.st_mode) ? ": is a folder" : ": is no regular file") +
                     "; expected a recording (pcap)");
  }
  char error[PCAP_ERRBUF_SIZE] = "";
  const std::string file = path == "-" ? "./-" : path;
  pcap_ = pcap_open_offline(file.c_str(), error);
  if (pcap_ == nullptr) {
    const std::string why = error;
    throw InputError((why.find(path) == std::string::npos ? path + ": " + why : why) +
                     "; expected a recording of the LIDAR's packets (pcap)");
  }
  const int link = pcap_datalink(pcap_);
  if (IsKnownLink(link)) return;
  pcap_close(pcap_);
  throw InputError(path + ": was recorded on a link of type " + std::to_string(link) +
                   "; expected Ethernet, Linux \"any\" or raw IP");
}

PcapReader::~PcapReader() { pcap_close(pcap_); }

std::optional<PcapReader::Datagram> PcapReader::Next() {
  const int link = pcap_datalink(pcap_);
  while (true) {
    pcap_pkthdr* header = nullptr;
    const std::uint8_t* data = nullptr;
    const int got = pcap_next_ex(pcap_, &header, &data);
    if (got == PCAP_ERROR_BREAK) return std::nullopt;
    if (got < 0) throw InputError(path_ + ": is damaged or cut short: " + pcap_geterr(pcap_));
    if (got == 0) continue;
    // Holes of a file that only claims to be large.
    if (header->caplen == 0) throw InputError(path_ + ": is damaged: a packet of no bytes");
    const Utime utime = Utime{header->ts.tv_sec} * kMicrosecondsPerSecond + header->ts.tv_usec;
    Bytes bytes{data, header->caplen};
    if (!SkipLink(link, &bytes)) continue;
    const std::size_t ip = IpHeader(bytes);
    if (ip == 0) continue;
    std::string from = Address(bytes.data + 12);
    std::optional<std::vector<std::uint8_t>> joined;
    if ((Word(bytes.data + 6) & (kMore | kOffset)) != 0) {
      // What follows the packet pads the Ethernet frame.
      const auto whole = static_cast<std::size_t>(Word(bytes.data + 2));
      if (whole < ip || whole > bytes.size) continue;
      joined = Join(utime, bytes.data, bytes.data + ip, whole - ip);
      if (!joined) continue;
      bytes = {joined->data(), joined->size()};
    } else {
      bytes.Skip(ip);
    }
    if (bytes.size < 8) continue;
    Datagram datagram;
    datagram.utime = utime;
    datagram.from = std::move(from);
    datagram.port = Word(bytes.data + 2);
    const auto length = static_cast<std::size_t>(std::max(8, Word(bytes.data + 4)));
    datagram.cut = bytes.size < length;
    const std::size_t size = std::min(length, bytes.size);
    datagram.payload.assign(bytes.data + 8, bytes.data + size);
    return datagram;
  }
}

// The whole packet's bytes once its last fragment has come.
std::optional<std::vector<std::uint8_t>> PcapReader::Join(Utime utime, const std::uint8_t* header,
                                                          const std::uint8_t* data,
                                                          std::size_t size) {
  fragments_.erase(
      std::remove_if(fragments_.begin(), fragments_.end(),
                     [&](const Fragments& f) { return std::abs(utime - f.utime) > kMostApart; }),
      fragments_.end());
  std::vector<std::uint8_t> key(header + 12, header + 20);  // addresses
  key.insert(key.end(), header + 4, header + 6);            // number
  const int place = Word(header + 6);
  const std::size_t begin = 8 * static_cast<std::size_t>(place & kOffset), end = begin + size;
  auto found = std::find_if(fragments_.begin(), fragments_.end(),
                            [&](const Fragments& f) { return f.key == key; });
  if (found == fragments_.end()) {
    if (fragments_.size() == kMostFragmented) fragments_.pop_front();
    found = fragments_.insert(fragments_.end(), {key, {}, {}, 0, utime});
  }
  if ((place & kMore) == 0) found->size = end;
  found->bytes.resize(std::max(found->bytes.size(), end));  // 128 KiB at most, by its place
  std::copy(data, data + size, found->bytes.begin() + static_cast<std::ptrdiff_t>(begin));
  found->have.emplace_back(begin, end);
  std::sort(found->have.begin(), found->have.end());
  std::size_t reach = 0;
  for (const auto& [from, to] : found->have) {
    if (from > reach) break;  // a hole
    reach = std::max(reach, to);
  }
  const bool whole = found->size != 0 && reach == found->size;
  const bool hopeless = found->have.size() > kMostFragments;
  std::vector<std::uint8_t> bytes = std::move(found->bytes);
  if (!whole && !hopeless) {
    found->bytes = std::move(bytes);
    return std::nullopt;
  }
  fragments_.erase(found);
  bytes.resize(reach);  // one that lies may have been sent from beyond the end
  return whole ? std::optional(std::move(bytes)) : std::nullopt;
}

}  // namespace rgbdt
