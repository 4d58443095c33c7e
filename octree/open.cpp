#include "octree/open.h"

#include "io/formats/copc/copc.h"
#include "octree/cache/cache.h"
#include "octree/copc/copc.h"

namespace lucarne::octree {

bool is_octree(const std::filesystem::path& path) {
    return is_cache(path) || io::copc::is_copc(path);
}

Result<std::unique_ptr<NodeSource>> open_octree(const std::filesystem::path& path,
                                                std::shared_ptr<HandlePool> handles) {
    return io::copc::is_copc(path) ? open_copc(path, std::move(handles))
                                   : open_cache(path, std::move(handles));
}

}  // namespace lucarne::octree
