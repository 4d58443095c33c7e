#pragma once

#include <filesystem>

#include "octree/cache/file.h"
#include "octree/cache/writer.h"

namespace lucarne::test {

/// Writes the directory of a cache again, as one that can be read in pages of so many nodes.
inline Result<void> give_pages(const std::filesystem::path& path, uint32_t page_nodes) {
    LUCARNE_ASSIGN(const auto cache, octree::CacheFile::open(path, octree::kWholeDirectory));
    LUCARNE_ASSIGN(auto file, UpdateFile::open(path, "is open"));
    LUCARNE_ASSIGN(auto writer,
                   octree::CacheWriter::update(std::move(file), cache->superblock(), 0, path.parent_path()));
    for (uint32_t node = 0; node < cache->nodes().size(); ++node) LUCARNE_TRY(writer.add(cache->entry(node)));
    return writer.finish(cache->header(), {page_nodes, 1});
}

}  // namespace lucarne::test
