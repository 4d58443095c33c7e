#include "octree/open.h"

#include "io/files/file.h"
#include "io/formats/copc/copc.h"
#include "octree/cache/cache.h"
#include "octree/copc/copc.h"

namespace lucarne::octree {

OctreeKind octree_kind(const ByteSource& file) {
    if (is_cache(file)) return OctreeKind::cache;
    return io::copc::is_copc(file) ? OctreeKind::copc : OctreeKind::none;
}

bool is_octree(const std::filesystem::path& path) {
    const auto file = InputFile::open(path);
    return file && octree_kind(*file) != OctreeKind::none;
}

Result<std::unique_ptr<NodeSource>> open_octree(std::shared_ptr<const ByteSource> file) {
    return octree_kind(*file) == OctreeKind::copc ? open_copc(std::move(file)) : open_cache(std::move(file));
}

Result<std::unique_ptr<NodeSource>> open_octree(const std::filesystem::path& path) {
    LUCARNE_ASSIGN(auto file, InputFile::open_shared(path));
    return open_octree(std::move(file));
}

}  // namespace lucarne::octree
