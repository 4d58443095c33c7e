#pragma once

#include <span>
#include <string>
#include <vector>

#include "octree/cache/record_map.h"

namespace lucarne::octree {

/// Defines one schema for the points of several inputs and converts their records into it. Nothing is lost.
/// Integer positions stay integers if all inputs share scale and offset, and become doubles otherwise. An
/// attribute gets the narrowest type that can represent those of all inputs (8-bit colour becomes 16-bit
/// colour), and is zero for points of inputs without it. With several inputs, `scan` tells which one a point
/// came from. Attributes of the inputs are named by octree/tree/stored_names.h.
class Unifier {
 public:
    /// `sources` must outlive the unifier. `replace_normals`: estimated normals will replace the inputs' own.
    /// Errors: attributes that no common type can represent, too many inputs.
    static Result<Unifier> create(std::vector<const io::PointSource*> sources, bool replace_normals = false);

    const io::Schema& schema() const { return schema_; }
    size_t inputs() const { return sources_.size(); }
    const io::PointSource& source(size_t input) const { return *sources_[input]; }
    /// Points of all inputs, as far as their headers tell.
    uint64_t declared_points() const;
    /// Whether the input's points have normals of their own.
    bool has_normals(size_t input) const;
    /// Returns the records of `batch` in the unified schema: either its own bytes or `storage`, which is
    /// overwritten.
    std::span<const std::byte> convert(size_t input, const io::PointBatch& batch,
                                       std::vector<std::byte>& storage) const;

 private:
    Result<void> unify_attributes();
    void unify_positions();

    std::vector<const io::PointSource*> sources_;
    bool replace_normals_ = false;
    io::Schema schema_;
    std::vector<RecordMap> maps_;
};

}  // namespace lucarne::octree
