#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "server/output/format/atomic_file.hpp"

namespace isthmus {

/// Writes an MCAP file (mcap.dev/spec): messages in chunks compressed by zstd, each with its index and CRC,
/// and a summary with schemas, channels, chunk indexes and statistics, so that players jump to any time
/// without reading all of it. Complete or absent, as every output file; errors are std::runtime_error naming
/// the file.
class McapWriter {
 public:
  explicit McapWriter(const std::string& path);

  /// A topic whose messages are JSON by a JSON schema; its id. The same schema is stored once.
  std::uint16_t add_channel(const std::string& topic, const std::string& schema_name,
                            const std::string& schema);
  /// Stamps in nanoseconds. In any order, but a file is read faster where they are about in order.
  void write(std::uint16_t channel, std::uint64_t log_time_ns, std::string_view json);
  /// Writes what follows the last message; nothing can be written after it.
  void finish();

  std::uint64_t messages() const { return statistics_.messages; }

 private:
  struct IndexEntry {
    std::uint64_t time_ns;
    std::uint64_t offset;
  };
  struct Times {
    std::uint64_t first_ns = 0;
    std::uint64_t last_ns = 0;
    bool any = false;
    void include(std::uint64_t time_ns);
  };
  struct Statistics {
    std::uint64_t messages = 0;
    std::uint32_t chunks = 0;
    Times times;
    std::map<std::uint16_t, std::uint64_t> of_channel;
  };

  void put(std::string_view bytes);
  void end_chunk();
  std::string statistics_record() const;
  std::string summary(std::uint64_t start) const;

  AtomicFile file_;
  std::uint64_t offset_ = 0;
  std::uint32_t data_crc_ = 0;
  std::string chunk_;
  Times chunk_times_;
  std::map<std::uint16_t, std::vector<IndexEntry>> chunk_index_;
  std::map<std::string, std::uint16_t> schema_ids_;
  std::string schemas_;        ///< their records, for the summary
  std::string channels_;       ///< the same
  std::string chunk_indexes_;  ///< the same
  std::map<std::uint16_t, std::uint32_t> sequences_;
  Statistics statistics_;
};

}  // namespace isthmus
