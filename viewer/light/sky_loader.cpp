#include "viewer/light/sky_loader.h"

#include <utility>

namespace lucarne::viewer {
namespace {

SkyLoader::Sky read(const std::string& path) {
    LUCARNE_ASSIGN(gi::Environment sky, gi::load_environment(path, glm::dvec3(1), 0));
    return std::make_shared<const gi::Environment>(std::move(sky));
}

}  // namespace

void SkyLoader::load(std::string path) {
    uint64_t request = 0;
    {
        const std::lock_guard lock(shared_->mutex);
        shared_->wanted = path;
        request = ++shared_->request;
        shared_->sky.reset();
    }
    const auto newest = [shared = shared_, request] {
        const std::lock_guard lock(shared->mutex);
        return request == shared->request;
    };
    jobs_.push(
        path, [newest, path] { return newest() ? read(path) : Sky(nullptr); },
        [shared = shared_, request, done = done_](Sky sky) {
            {
                const std::lock_guard lock(shared->mutex);
                if (request != shared->request) return;
                shared->sky = std::move(sky);
                shared->wanted.clear();
            }
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
