#pragma once

#include <bit>
#include <cereal/cereal.hpp>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "patches/patch.hpp"
#include "server/engine/input/engine_options.hpp"

namespace isthmus {

static_assert(std::endian::native == std::endian::little, "snapshots hold values as they lie in memory");

/// Shared objects (patches, options): each is written where it is first met, and as a reference
/// after that.
struct SnapshotContext {
  std::vector<PatchPtr> patches;  ///< by id
  EngineOptions options;          ///< of the configuration
};

/// Appends values to bytes.
class SnapshotWriter : public cereal::OutputArchive<SnapshotWriter, cereal::AllowEmptyClassElision> {
 public:
  SnapshotWriter() : OutputArchive(this) {}

  void write(const void* value, std::size_t size) {
    if (size == 0) return;
    const std::size_t end = bytes_.size();
    bytes_.resize(end + size);
    std::memcpy(bytes_.data() + end, value, size);
  }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

  SnapshotContext context;

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Takes values from bytes. Throws std::runtime_error where they end too early, or claim more than follows.
class SnapshotReader : public cereal::InputArchive<SnapshotReader, cereal::AllowEmptyClassElision> {
 public:
  explicit SnapshotReader(std::span<const std::uint8_t> bytes) : InputArchive(this), left_(bytes) {}

  void read(void* value, std::size_t size) {
    if (size > left_.size()) throw std::runtime_error("it ends too early");
    if (size > 0) std::memcpy(value, left_.data(), size);
    left_ = left_.subspan(size);
  }
  std::size_t bytes_left() const { return left_.size(); }

  SnapshotContext context;

 private:
  std::span<const std::uint8_t> left_;
};

template <class Value>
concept PlainNumber = std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>;

template <PlainNumber Value>
void save(SnapshotWriter& writer, const Value& value) {
  writer.write(&value, sizeof value);
}

template <PlainNumber Value>
void load(SnapshotReader& reader, Value& value) {
  reader.read(&value, sizeof value);
}

inline void save(SnapshotWriter& writer, const bool& value) {
  const std::uint8_t byte = value ? 1 : 0;
  writer.write(&byte, 1);
}

inline void load(SnapshotReader& reader, bool& value) {
  std::uint8_t byte = 0;
  reader.read(&byte, 1);
  value = byte != 0;
}

template <class Value>
void save(SnapshotWriter& writer, const cereal::BinaryData<Value>& data) {
  writer.write(data.data, static_cast<std::size_t>(data.size));
}

template <class Value>
void load(SnapshotReader& reader, cereal::BinaryData<Value>& data) {
  reader.read(data.data, static_cast<std::size_t>(data.size));
}

template <class Value>
void save(SnapshotWriter& writer, const cereal::NameValuePair<Value>& pair) {
  writer(pair.value);
}

template <class Value>
void load(SnapshotReader& reader, cereal::NameValuePair<Value>& pair) {
  reader(pair.value);
}

template <class Size>
void save(SnapshotWriter& writer, const cereal::SizeTag<Size>& count) {
  writer(static_cast<std::uint64_t>(count.size));
}

/// Each element takes at least a byte, so no count can make the reader allocate without bound.
template <class Size>
void load(SnapshotReader& reader, cereal::SizeTag<Size>& count) {
  std::uint64_t size = 0;
  reader(size);
  if (size > reader.bytes_left()) throw std::runtime_error("it counts more than it holds");
  count.size = static_cast<std::decay_t<Size>>(size);
}

}  // namespace isthmus

CEREAL_SETUP_ARCHIVE_TRAITS(isthmus::SnapshotReader, isthmus::SnapshotWriter)
