#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "patches/ids.hpp"
#include "server/engine/input/event.hpp"
#include "server/engine/map/reason.hpp"
#include "server/engine/sightings/verdict.hpp"

namespace isthmus {

/// A sighting and what became of it.
struct SightingRecord {
  SightingEvent sighting;
  Verdict verdict = Verdict::waiting;
  Reason reason = Reason::none;
  ClosureId closure;
};

/// All sightings, in the order they came. They are the one thing of a map that grows with time and not with
/// area: a row takes 40 bytes (names are kept once, and what a camera says of its noise once for
/// many rows), and gives back the very numbers that came.
///
/// A value: full chunks are immutable and shared between copies, so a copy costs a pointer a chunk. Reading
/// one log from several threads is safe.
class SightingLog {
 public:
  /// Records by value, in order.
  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = SightingRecord;
    using difference_type = std::ptrdiff_t;
    using pointer = void;
    using reference = SightingRecord;

    Iterator(const SightingLog& log, std::size_t at) : log_(&log), at_(at) {}
    SightingRecord operator*() const { return (*log_)[at_]; }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    Iterator operator++(int) {
      Iterator before = *this;
      ++at_;
      return before;
    }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }

   private:
    const SightingLog* log_;
    std::size_t at_;
  };

  SightingLog() = default;
  SightingLog(std::initializer_list<SightingRecord> records);

  void append(const SightingRecord& record);
  void set_verdict(std::size_t i, Verdict verdict, Reason reason, ClosureId closure);

  std::size_t size() const { return full_.size() * chunk_rows + newest_.rows.size(); }
  bool empty() const { return size() == 0; }
  SightingRecord operator[](std::size_t i) const;
  Verdict verdict(std::size_t i) const { return row(i).verdict; }
  /// How many have this verdict.
  std::int64_t count(Verdict verdict) const;
  Iterator begin() const { return {*this, 0}; }
  Iterator end() const { return {*this, size()}; }

  /// Whether the functions above could have made it: checks a log that was read from a file.
  bool is_sound() const;

  auto members() { return std::tie(robots_, full_, newest_); }

 private:
  /// What a sighting says of its own noise, in metres and radians. As bits: equal ones are the very same.
  struct Sigmas {
    std::uint64_t range = 0;
    std::uint64_t bearing = 0;

    bool operator==(const Sigmas&) const = default;
    auto members() { return std::tie(range, bearing); }
  };
  struct Row {
    std::int64_t utime = 0;
    double range_m = 0;
    double bearing_rad = 0;
    std::int32_t barcode = -1;
    ClosureId closure;
    std::uint32_t robot = 0;   ///< among the robots
    std::uint16_t sigmas = 0;  ///< among those of the chunk
    Verdict verdict = Verdict::waiting;
    Reason reason = Reason::none;

    auto members() {
      return std::tie(utime, range_m, bearing_rad, barcode, closure, robot, sigmas, verdict, reason);
    }
  };
  struct Chunk {
    std::vector<Row> rows;
    std::vector<Sigmas> sigmas;

    auto members() { return std::tie(rows, sigmas); }
  };
  using Full = std::vector<std::shared_ptr<const Chunk>>;

  /// So large that pointers to chunks cost little, so small that a full chunk is copied quickly when a
  /// verdict in it changes.
  static constexpr std::size_t chunk_rows = 256;

  const Chunk& chunk(std::size_t i) const {
    return i / chunk_rows < full_.size() ? *full_[i / chunk_rows] : newest_;
  }
  const Row& row(std::size_t i) const { return chunk(i).rows[i % chunk_rows]; }
  bool is_sound(const Chunk& chunk) const;

  std::vector<std::string> robots_;
  Full full_;     ///< chunks of `chunk_rows`
  Chunk newest_;  ///< of fewer
};

}  // namespace isthmus
