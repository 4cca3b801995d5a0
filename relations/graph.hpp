#pragma once

#include <cstddef>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "relations/chunked_vector.hpp"
#include "relations/relation.hpp"

namespace isthmus {

/// The relations between patches, and the islands they make: patches are on one island if and only if some
/// sequence of relations connects them (Howard et al. 2006, IV-C).
///
/// A value: a copy is a version of the graph of its own. Copies share what neither changes, so one costs
/// little more than a number a patch. Reading one graph from several threads is safe.
class RelationGraph {
  using Stored = ChunkedVector<std::shared_ptr<const Relation>>;  // by id; null where taken away

 public:
  /// Pairs (id, relation) in order of their ids.
  class Relations {
   public:
    class Iterator {
     public:
      using iterator_category = std::input_iterator_tag;
      using value_type = std::pair<RelationId, const Relation&>;
      using difference_type = std::ptrdiff_t;
      using pointer = void;
      using reference = value_type;

      Iterator(const Stored& stored, std::size_t at) : stored_(&stored), at_(at) { skip_absent(); }
      value_type operator*() const {
        const Relation& relation = *(*stored_)[at_];
        return {relation.id, relation};
      }
      Iterator& operator++() {
        ++at_;
        skip_absent();
        return *this;
      }
      bool operator==(const Iterator& other) const { return at_ == other.at_; }

     private:
      void skip_absent() {
        while (at_ < stored_->size() && !(*stored_)[at_]) ++at_;
      }
      const Stored* stored_;
      std::size_t at_;
    };

    Relations(const Stored& stored, std::size_t size) : stored_(&stored), size_(size) {}
    Iterator begin() const { return {*stored_, 0}; }
    Iterator end() const { return {*stored_, stored_->size()}; }
    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }

   private:
    const Stored* stored_;
    std::size_t size_;
  };

  /// Patches come with dense ids 0, 1, 2, ...; throws std::invalid_argument otherwise.
  void add_patch(PatchId id);
  std::size_t patch_count() const { return of_.size(); }

  /// Gives the relation its id (and Correspondences their minimum) and stores it. Both patches must have
  /// been added and differ; throws std::invalid_argument otherwise.
  RelationId add(Relation relation);
  void remove(RelationId id);
  /// All at once: islands are found anew only once.
  void remove(std::span<const RelationId> ids);

  /// nullptr where there is no such relation (any more).
  const Relation* find(RelationId id) const;
  Relations relations() const { return {stored_, relation_count_}; }
  /// Relations that touch a patch, by id.
  std::span<const RelationId> of(PatchId id) const;
  /// Relations between two patches, whichever is a, by id.
  std::vector<RelationId> between(PatchId a, PatchId b) const;
  /// Patches that share a relation with this one, by id, each once.
  std::vector<PatchId> neighbours(PatchId id) const;

  /// The lowest patch id on the patch's island.
  IslandId island(PatchId id) const;
  /// Each island's patches by id; islands in order of their ids.
  std::vector<std::vector<PatchId>> islands() const;
  std::vector<PatchId> patches_of(IslandId island) const;

  /// At most `max_patches` patches nearest to `from` by number of relations, `from` first; ties by id.
  std::vector<PatchId> nearest_in_graph(PatchId from, std::size_t max_patches) const;
  /// The patches at most so many relations away, by id, `from` among them. Only relations that `along` says
  /// yes to count.
  std::vector<PatchId> within_hops(PatchId from, int limit,
                                   const std::function<bool(const Relation&)>& along) const;
  /// Number of relations on the shortest way; nothing beyond `limit` or on another island.
  std::optional<int> hops(PatchId a, PatchId b, int limit) const;

  /// Whether it is one that the functions above could have made: of what comes from elsewhere.
  bool is_sound() const;

  auto members() { return std::tie(stored_, relation_count_, of_, island_parent_); }

 private:
  const Relation& stored(RelationId id) const { return *stored_[static_cast<std::size_t>(id.value)]; }
  void check_ends(const Relation& relation) const;
  bool take_away(RelationId id);
  void find_islands();

  Stored stored_;
  std::size_t relation_count_ = 0;
  ChunkedVector<std::vector<RelationId>> of_;  // by patch id
  // Disjoint sets, joined by lowest id as relations are added and found anew where a removal may part them.
  std::vector<PatchId> island_parent_;
};

}  // namespace isthmus
