#include "gi/engines/environment/kept_caches.h"

#include <algorithm>

#include "gi/bounce_options.h"
#include "gi/engines/environment/glossy_caches.h"

namespace lucarne::gi::environment {
namespace {

bool in_picture(const CameraView& camera, const Cache& cache) {
    float depth = 0;
    const glm::vec2 at = view_place(camera, cache.position, depth);
    return (depth > 0 || is_parallel(camera)) && at.x >= 0 && at.y >= 0 &&
           at.x < static_cast<float>(camera.width) && at.y < static_cast<float>(camera.height);
}

}  // namespace

bool KeptCaches::hold(const EngineSettings& settings, uint64_t content) const {
    return any_ && content == content_ && bounces_ == settings[kBounces] &&
           only_bounce_ == settings[kOnlyBounce];
}

void KeptCaches::take(const CameraView& camera, const EngineSettings& settings, uint64_t content,
                      std::span<const Cache> caches) {
    if (hold(settings, content))
        std::erase_if(caches_, [&](const Cache& cache) { return in_picture(camera, cache); });
    else
        caches_.clear();
    const size_t room = kMostKept - std::min(kMostKept, caches.size());
    if (caches_.size() > room) caches_.erase(caches_.begin(), caches_.end() - static_cast<ptrdiff_t>(room));
    add(caches);
    any_ = true;
    content_ = content;
    bounces_ = settings[kBounces];
    only_bounce_ = settings[kOnlyBounce];
}

void KeptCaches::add(std::span<const Cache> caches) {
    const size_t room = kMostKept - caches_.size();
    const auto some = caches.first(std::min(room, caches.size()));
    caches_.insert(caches_.end(), some.begin(), some.end());
    drop_oldest_directions();
}

void KeptCaches::drop_oldest_directions() {
    size_t kept = 0;
    for (auto cache = caches_.rbegin(); cache != caches_.rend(); ++cache)
        if (cache->by_direction && ++kept > kMostGlossyCaches) cache->by_direction.reset();
}

}  // namespace lucarne::gi::environment
