#pragma once

#include <functional>

#include "octree/source.h"

namespace lucarne::octree {

struct ExportOptions {
    bool normals = false;  ///< write the estimated normals as `normal`, f32 x3
};

/// What of a cache goes back into a scan file: the inputs' attributes without those that the build added.
class Exporter {
 public:
    Exporter(const NodeSource& source, const ExportOptions& options);

    const io::Schema& schema() const { return schema_; }
    /// What the writer needs to know; the details of the format where all inputs had the same.
    const io::ScanInfo& info() const { return info_; }
    /// Writes every point, node by node, and finishes the file. `progress` is told the points of each node.
    Result<void> write(io::PointWriter& writer, const std::function<void(uint64_t)>& progress) const;

 private:
    struct Copy {
        uint32_t from = 0, to = 0, bytes = 0;
    };
    const NodeSource& source_;
    io::Schema schema_;
    io::ScanInfo info_;
    std::vector<Copy> copies_;
    const io::Attribute* estimated_ = nullptr;  ///< in the cache's schema, where normals are wanted
};

}  // namespace lucarne::octree
