#include "viewer/lights/sky_loader.h"

#include <exception>
#include <utility>

namespace lucarne::viewer {
namespace {

SkyLoader::Sky read(const std::string& path) {
    try {
        LUCARNE_ASSIGN(gi::Environment sky, gi::load_environment(path, glm::dvec3(1), 0));
        return std::make_shared<const gi::Environment>(std::move(sky));
    } catch (const std::exception& problem) {  // out of memory
        return failed(path, problem.what());
    }
}

}  // namespace

/// Until the newest wish is read.
void SkyLoader::work(Shared& shared) {
    for (;;) {
        std::string path;
        uint64_t wish = 0;
        {
            const std::lock_guard lock(shared.mutex);
            path = shared.wanted;
            wish = shared.wish;
        }
        Sky sky = read(path);
        const std::lock_guard lock(shared.mutex);
        if (wish != shared.wish) continue;
        shared.sky = std::move(sky);
        shared.wanted.clear();
        shared.working = false;
        return;
    }
}

void SkyLoader::load(std::string path) {
    const std::lock_guard lock(shared_->mutex);
    shared_->wanted = std::move(path);
    ++shared_->wish;
    shared_->sky.reset();
    if (std::exchange(shared_->working, true)) return;
    jobs_.push([shared = shared_, done = done_] {
        work(*shared);
        done();
    });
}

std::string SkyLoader::reading() const {
    const std::lock_guard lock(shared_->mutex);
    return shared_->wanted;
}

std::optional<SkyLoader::Sky> SkyLoader::take() {
    const std::lock_guard lock(shared_->mutex);
    return std::exchange(shared_->sky, std::nullopt);
}

}  // namespace lucarne::viewer
