#pragma once

#include <span>
#include <string>
#include <vector>

#include "octree/cache/record_map.h"

namespace lucarne::octree {

/// One schema for the points of several inputs, and the conversion of their records into it. Nothing is lost:
/// integer positions stay so where all inputs share scale and offset and become doubles otherwise; an
/// attribute takes the narrowest type that holds those of all inputs (8-bit colour becomes 16-bit colour) and
/// is zero for points of inputs without it. With several inputs, `scan` says which one a point came from.
/// Attributes of the inputs are called as octree/tree/stored_names.h says.
class Unifier {
 public:
    /// `sources` must outlive the unifier. `replace_normals`: estimated normals will stand in place of the
    /// inputs' own. Errors: attributes that no common type can hold, too many inputs.
    static Result<Unifier> create(std::vector<const io::PointSource*> sources, bool replace_normals = false);

    const io::Schema& schema() const { return schema_; }
    size_t inputs() const { return sources_.size(); }
    const io::PointSource& source(size_t input) const { return *sources_[input]; }
    /// Whether the input's points come with normals of their own.
    bool has_normals(size_t input) const;
    /// The records of `batch` in the unified schema: either its own bytes or `storage`, refilled.
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
