#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "octree/cache/format.h"
#include "octree/cache/writer.h"
#include "octree/convert/sampling/node_sampler.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

/// Receives the progress of a build, so that finished parts can be shown. Calls come one at a time, except
/// advanced() and stopped(), which any thread may call.
class BuildListener {
 public:
    virtual ~BuildListener() = default;
    /// Points of the inputs, in their order, while they are read for the first time: records of the unified
    /// schema. Not called by a build that is resumed after that.
    virtual void read(std::span<const std::byte> records) = 0;
    /// All points have been read: bounds, root cube and count are those of the cache. The header's schema is
    /// still that of the inputs; `records` is that of the nodes.
    virtual void scanned(const SourceHeader& header, const io::Schema& records) = 0;
    /// Nodes follow from here on, with records of this schema.
    virtual void building(const io::Schema& records) = 0;
    /// These nodes are in the file in their final form: children before parents, along the Morton curve.
    virtual void settled(std::span<const format::Entry> entries) = 0;
    /// A node whose descendants are all final, and the points it shows until its parent has taken some of
    /// them: whole records in Morton order. It replaces its children, if those were shown before.
    virtual void pending(const Pending& node, std::span<const std::byte> sample,
                         const CacheWriter& writer) = 0;
    /// `done` of `total` points of a stage are finished.
    virtual void advanced(std::string_view stage, uint64_t done, uint64_t total) = 0;
    /// Returning true ends the build with an error at its next step; nothing is left behind.
    virtual bool stopped() const = 0;
};

}  // namespace lucarne::octree
