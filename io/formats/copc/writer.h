#pragma once

#include "io/formats/copc/copc.h"
#include "io/formats/las/writer.h"

namespace lucarne::io::copc {

/// Writes a COPC file node by node. The file appears when `finish` succeeds.
class NodeWriter {
 public:
    /// Creates a writer for records of `schema`, which are converted as in create_scan's LAZ. Only the
    /// centre, half size and spacing of `cube` are used.
    static Result<std::unique_ptr<NodeWriter>> create(const std::filesystem::path& path, const Schema& schema,
                                                      const ScanInfo& info, const WriteOptions& options,
                                                      const Info& cube);

    /// Writes a node. Parents must come before their children, and each node only once; a node may have no
    /// points. Errors: nodes over kMostNodeBytes; the disk.
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
