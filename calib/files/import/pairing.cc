#include "calib/files/import/pairing.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "calib/files/name_keys.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

std::vector<std::string> StemsOf(const FileList& files) {
  std::vector<std::string> stems;
  stems.reserve(files.names.size());
  for (const std::string& name : files.names) stems.push_back(StemOf(name));
  return stems;
}

Pairs NoPairs(PairedBy by, const FileList& images, const FileList& clouds) {
  Pairs pairs;
  pairs.by = by;
  pairs.cloud_of.resize(images.names.size());
  pairs.image_utime.resize(images.names.size());
  pairs.cloud_utime.resize(clouds.names.size());
  return pairs;
}

// The first of several images with one key has the cloud; an empty key has none.
void PairByKeys(const std::vector<std::string>& images, const std::vector<std::string>& clouds,
                Pairs* pairs) {
  std::map<std::string, std::size_t> free;
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    if (!clouds[i].empty()) free.emplace(clouds[i], i);
  }
  for (std::size_t i = 0; i < images.size(); ++i) {
    const auto found = free.find(images[i]);
    if (found == free.end()) continue;
    pairs->cloud_of[i] = found->second;
    ++pairs->count;
    free.erase(found);
  }
}

Pairs PairByName(const FileList& images, const FileList& clouds) {
  Pairs pairs = NoPairs(PairedBy::kName, images, clouds);
  PairByKeys(StemsOf(images), StemsOf(clouds), &pairs);
  pairs.why_not = "of the same name";
  return pairs;
}

Pairs PairByNumber(const FileList& images, const FileList& clouds) {
  Pairs pairs = NoPairs(PairedBy::kNumber, images, clouds);
  const NameNumbers of_images = NumbersInNames(StemsOf(images));
  const NameNumbers of_clouds = NumbersInNames(StemsOf(clouds));
  PairByKeys(of_images.numbers, of_clouds.numbers, &pairs);
  // Where several numbers change, as hour and minute do, few that agree do so by chance.
  const std::size_t fewer = std::min(images.names.size(), clouds.names.size());
  if (!(of_images.sole && of_clouds.sole) && 2 * pairs.count < fewer) {
    pairs = NoPairs(PairedBy::kNumber, images, clouds);
  }
  pairs.why_not = "of the same number";
  return pairs;
}

Pairs PairInOrder(const FileList& images, const FileList& clouds) {
  if (images.names.size() != clouds.names.size()) {
    throw InputError("--in-order: " + images.folder.string() + " holds " +
                     std::to_string(images.names.size()) + " " + images.what + "s and " +
                     clouds.folder.string() + " " + std::to_string(clouds.names.size()) +
                     " clouds; expected as many of both: take out those that have no partner");
  }
  Pairs pairs = NoPairs(PairedBy::kOrder, images, clouds);
  for (std::size_t i = 0; i < pairs.cloud_of.size(); ++i) pairs.cloud_of[i] = i;
  pairs.count = pairs.cloud_of.size();
  return pairs;
}

// Names that hold a time, in its order; equal times once.
struct Timed {
  Utime utime;
  std::size_t index;
};

std::vector<Timed> TimesOf(const FileList& files, std::vector<Utime>* utimes) {
  std::vector<Timed> times;
  const std::vector<std::string> stems = StemsOf(files);
  for (std::size_t i = 0; i < stems.size(); ++i) {
    const std::optional<Utime> time = TimeInName(stems[i]);
    if (!time) continue;
    times.push_back({*time, i});
    (*utimes)[i] = *time;
  }
  std::stable_sort(times.begin(), times.end(),
                   [](const Timed& a, const Timed& b) { return a.utime < b.utime; });
  times.erase(std::unique(times.begin(), times.end(),
                          [](const Timed& a, const Timed& b) { return a.utime == b.utime; }),
              times.end());
  return times;
}

std::size_t Nearest(const std::vector<Timed>& times, Utime to) {
  const auto after =
      std::lower_bound(times.begin(), times.end(), to,
                       [](const Timed& timed, Utime utime) { return timed.utime < utime; });
  const auto index = static_cast<std::size_t>(after - times.begin());
  if (index == times.size()) return index - 1;
  if (index == 0 || times[index].utime - to < to - times[index - 1].utime) return index;
  return index - 1;
}

// Pairing by time, and what is known of it besides.
struct ByTime {
  Pairs pairs;
  bool are_times = false;      // most names of both folders are times, and different ones
  std::optional<Utime> apart;  // how far the nearest two are from each other
};

// Each the other's nearest: so each once, and pairs never cross.
ByTime PairByTime(const FileList& images, const FileList& clouds, double max_apart_s) {
  ByTime result{NoPairs(PairedBy::kTime, images, clouds), false, {}};
  Pairs& pairs = result.pairs;
  const std::vector<Timed> of_images = TimesOf(images, &pairs.image_utime);
  const std::vector<Timed> of_clouds = TimesOf(clouds, &pairs.cloud_utime);
  pairs.why_not = "within " + Format("%g", max_apart_s) + " s (--max-apart)";
  if (of_images.empty() || of_clouds.empty()) return result;
  result.are_times =
      2 * of_images.size() > images.names.size() && 2 * of_clouds.size() > clouds.names.size();
  for (std::size_t i = 0; i < of_images.size(); ++i) {
    const Timed& cloud = of_clouds[Nearest(of_clouds, of_images[i].utime)];
    const Utime between = std::abs(cloud.utime - of_images[i].utime);
    if (!result.apart || between < *result.apart) result.apart = between;
    if (Nearest(of_images, cloud.utime) != i || ToSeconds(between) > max_apart_s) continue;
    pairs.cloud_of[of_images[i].index] = cloud.index;
    ++pairs.count;
  }
  return result;
}

std::string Described(const FileList& files) {
  return std::to_string(files.names.size()) + " " + files.what + "s of " + files.folder.string() +
         " (" + files.names.front() + (files.names.size() > 1 ? ", ..." : "") + ")";
}

[[noreturn]] void RefuseAll(const FileList& images, const FileList& clouds, const ByTime& by_time) {
  const std::string what =
      "none of the " + Described(images) + " belongs to one of the " + Described(clouds) + ": ";
  if (by_time.are_times) {
    throw InputError(what + "their names are times, of which the nearest two are " +
                     Format("%.3g", ToSeconds(*by_time.apart)) +
                     " s apart; let --max-apart be more, or set the clocks right");
  }
  throw InputError(what + "give " +
                   (images.what == "image" ? "an image and its cloud" : "clouds of one moment") +
                   " the same name or number, or say --in-order where "
                   "the first belongs to the first and so on");
}

}  // namespace

Pairs PairFiles(const FileList& images, const FileList& clouds, const PairOptions& options) {
  if (options.in_order) return PairInOrder(images, clouds);
  ByTime by_time = PairByTime(images, clouds, options.max_apart_s);
  Pairs best = by_time.pairs;
  if (!by_time.are_times) {  // seconds, or fractions of them, are no numbers to go by
    best = PairByName(images, clouds);
    Pairs by_number = PairByNumber(images, clouds);
    if (by_number.count > best.count) best = std::move(by_number);
  }
  if (best.count == 0) RefuseAll(images, clouds, by_time);
  return best;
}

std::string NameOf(PairedBy by) {
  switch (by) {
    case PairedBy::kName:
      return "by name";
    case PairedBy::kNumber:
      return "by number";
    case PairedBy::kTime:
      return "by time";
    case PairedBy::kOrder:
      return "in order";
  }
  return "";
}

}  // namespace rgbdt
