#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

namespace isthmus {

/// A vector of which a copy costs a pointer a chunk: both share all chunks, and a chunk is copied when one of
/// them changes it. As with std::vector, copies may be read and changed by several threads, each by one.
/// (std::shared_ptr does not tell in a way that orders memory whether it is the only owner.)
template <class T, std::size_t chunk_size = 64>
class ChunkedVector {
 public:
  ChunkedVector() = default;
  ChunkedVector(const ChunkedVector& other) : chunks_(other.chunks_), size_(other.size_) {
    for (Chunk* chunk : chunks_) chunk->owners.fetch_add(1, std::memory_order_relaxed);
  }
  ChunkedVector(ChunkedVector&& other) noexcept { swap(other); }
  ChunkedVector& operator=(ChunkedVector other) noexcept {
    swap(other);
    return *this;
  }
  ~ChunkedVector() {
    for (Chunk* chunk : chunks_) let_go(chunk);
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const T& operator[](std::size_t at) const { return chunks_[at / chunk_size]->values[at % chunk_size]; }
  /// To change it.
  T& own(std::size_t at) { return own_chunk(at / chunk_size).values[at % chunk_size]; }
  void push_back(T value) {
    if (size_ % chunk_size == 0) {
      auto chunk = std::make_unique<Chunk>();
      chunks_.push_back(chunk.get());
      std::ignore = chunk.release();
    }
    own(size_) = std::move(value);
    ++size_;
  }

 private:
  struct Chunk {
    std::array<T, chunk_size> values{};
    std::atomic<std::size_t> owners = 1;
  };

  void swap(ChunkedVector& other) noexcept {
    chunks_.swap(other.chunks_);
    std::swap(size_, other.size_);
  }

  // What others did with the chunk comes before what its last owner does.
  static void let_go(Chunk* chunk) {
    if (chunk->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete chunk;
  }

  Chunk& own_chunk(std::size_t number) {
    Chunk*& chunk = chunks_[number];
    if (chunk->owners.load(std::memory_order_acquire) > 1) {
      auto* copy = new Chunk{chunk->values};
      let_go(std::exchange(chunk, copy));
    }
    return *chunk;
  }

  std::vector<Chunk*> chunks_;
  std::size_t size_ = 0;
};

}  // namespace isthmus
