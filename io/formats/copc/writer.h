#pragma once

#include "io/formats/copc/copc.h"
#include "io/formats/las/writer.h"

namespace lucarne::io::copc {

/// Writes a COPC file node by node. It appears when `finish` succeeds.
class NodeWriter {
 public:
    /// The records of `schema` as in create_scan's LAZ. Of `cube` the centre, half size and spacing count.
    static Result<std::unique_ptr<NodeWriter>> create(const std::filesystem::path& path, const Schema& schema,
                                                      const ScanInfo& info, const WriteOptions& options,
                                                      const Info& cube);

    /// Parents before their children, each once; a node may be without points. Errors: nodes over
    /// kMostNodeBytes; the disk.
    Result<void> write(const VoxelKey& key, std::span<const std::byte> records);
    Result<void> finish();

 private:
    NodeWriter(OutputFile file, const std::string& path, las::Target target, uint32_t stride,
               const Info& info)
        : writer_(std::move(file), path, std::move(target), stride), info_(info) {}

    las::Writer writer_;
    Info info_;
    struct Written {
        VoxelKey key;
        bool empty;
    };
    std::vector<Written> nodes_;
};

}  // namespace lucarne::io::copc
