#include "server/engine/sightings/sighting_log.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace isthmus {
namespace {

/// The value's place in a short list; it is added where it is missing.
template <class Value>
std::size_t place_of(std::vector<Value>& values, const Value& value) {
  const auto found = std::ranges::find(values, value);
  if (found != values.end()) return static_cast<std::size_t>(found - values.begin());
  values.push_back(value);
  return values.size() - 1;
}

}  // namespace

SightingLog::SightingLog(std::initializer_list<SightingRecord> records) {
  for (const SightingRecord& record : records) append(record);
}

void SightingLog::append(const SightingRecord& record) {
  const SightingEvent& sighting = record.sighting;
  Row row;
  row.utime = sighting.utime;
  row.range_m = sighting.range_m;
  row.bearing_rad = sighting.bearing_rad;
  row.barcode = sighting.barcode;
  row.closure = record.closure;
  row.robot = static_cast<std::uint32_t>(place_of(robots_, sighting.robot));
  row.sigmas = static_cast<std::uint16_t>(
      place_of(newest_.sigmas, {std::bit_cast<std::uint64_t>(sighting.range_sigma_m),
                                std::bit_cast<std::uint64_t>(sighting.bearing_sigma_rad)}));
  row.verdict = record.verdict;
  row.reason = record.reason;
  newest_.rows.push_back(row);
  if (newest_.rows.size() < chunk_rows) return;
  newest_.sigmas.shrink_to_fit();
  full_.push_back(std::make_shared<const Chunk>(std::exchange(newest_, {})));
}

void SightingLog::set_verdict(std::size_t i, Verdict verdict, Reason reason, ClosureId closure) {
  Row changed = row(i);
  changed.verdict = verdict;
  changed.reason = reason;
  changed.closure = closure;
  const Row& old = row(i);
  if (changed.verdict == old.verdict && changed.reason == old.reason && changed.closure == old.closure)
    return;
  if (i / chunk_rows >= full_.size()) {
    newest_.rows[i % chunk_rows] = changed;
    return;
  }
  Chunk copy = chunk(i);
  copy.rows[i % chunk_rows] = changed;
  full_[i / chunk_rows] = std::make_shared<const Chunk>(std::move(copy));
}

SightingRecord SightingLog::operator[](std::size_t i) const {
  const Row& row = this->row(i);
  const Sigmas& sigmas = chunk(i).sigmas[row.sigmas];
  return {{robots_[row.robot], row.utime, row.barcode, row.range_m, std::bit_cast<double>(sigmas.range),
           row.bearing_rad, std::bit_cast<double>(sigmas.bearing)},
          row.verdict,
          row.reason,
          row.closure};
}

std::int64_t SightingLog::count(Verdict verdict) const {
  const auto count_in = [&](const Chunk& chunk) {
    return std::ranges::count_if(chunk.rows, [&](const Row& row) { return row.verdict == verdict; });
  };
  std::int64_t count = count_in(newest_);
  for (const auto& chunk : full_) count += count_in(*chunk);
  return count;
}

bool SightingLog::is_sound(const Chunk& chunk) const {
  return std::ranges::all_of(chunk.rows, [&](const Row& row) {
    return row.robot < robots_.size() && row.sigmas < chunk.sigmas.size();
  });
}

bool SightingLog::is_sound() const {
  return newest_.rows.size() < chunk_rows && is_sound(newest_) &&
         std::ranges::all_of(full_, [&](const std::shared_ptr<const Chunk>& chunk) {
           return chunk && chunk->rows.size() == chunk_rows && is_sound(*chunk);
         });
}

}  // namespace isthmus
