#include "viewer/frame/picture_worker.h"

#include <atomic>
#include <condition_variable>
#include <future>
#include <mutex>
#include <thread>

#include "io/core/guarded.h"
#include "io/core/log.h"

namespace lucarne::viewer {
namespace {

constexpr int kPickRadius = 4;  ///< pixels

/// The settings that the pipeline has, so that only changes are passed on: each change starts the average
/// again.
struct Told {
    uint64_t request = 0;
    uint64_t scene_version = UINT64_MAX, shader_version = 0;
};

}  // namespace

struct PictureWorker::State {
    std::mutex mutex;
    std::condition_variable changed;
    std::shared_ptr<const PictureRequest> wanted;
    uint64_t wanted_number = 0;
    std::optional<std::shared_ptr<const octree::NodeSource>>
        next_source;  ///< the source to draw next (may be null), if set_source() was called
    std::shared_ptr<const Picture> latest;
    Result<void> error;
    std::optional<Error> lost;  ///< why the device was lost; no pictures are made until there is another
    std::optional<WorkerDevice> next_device;
    gi::DeviceInfo device;
    bool stop = false;
    bool prepared = false;  ///< the engine's precomputation has news for another picture
    BakeProgress preparing;
    std::atomic<bool> give_up = false;  ///< the picture that is being made
    bool may_give_up = false;           ///< whether it may be, for one of a motion
    std::function<void()> published;
    std::thread thread;

    // Used only by the worker's thread:
    PipelineOptions options;
    std::unique_ptr<Pipeline> pipeline;  ///< null without a source
    std::shared_ptr<const octree::NodeSource> shown;
    std::shared_ptr<const octree::NodeSource> last_source;  ///< the newest source, even if setting it failed
    Told told;
    uint64_t pictures_made = 0;

    std::optional<std::promise<Result<void>>> started;  ///< set until the first device has been made

    void work(WorkerDevice device_of);
    Result<void> work_with(const WorkerDevice& device_of);
    std::optional<WorkerDevice> another_device(Error why);
    Result<void> take_source(gi::Device& gl, std::shared_ptr<const octree::NodeSource> other);
    Result<void> make_pictures(gi::Device& gl);
    void publish(Result<std::shared_ptr<Picture>> made, uint64_t request);
};

namespace {

constexpr double kExposureSeconds = .3;

Result<void> tell(gi::Device& device, Pipeline& pipeline, const PictureRequest& request, uint64_t number,
                  Told& told) {
    if (told.request == number) return {};
    if (told.shader_version != request.shader_version) {
        device.reload_shaders();
        LUCARNE_TRY(pipeline.set_engine(request.method.engine));  // starts the average again
    }
    told.shader_version = request.shader_version;
    if (told.scene_version != request.scene_version) LUCARNE_TRY(pipeline.set_scene(request.scene));
    told.scene_version = request.scene_version;
    LUCARNE_TRY(pipeline.set_method(request.method));
    told.request = number;
    return {};
}

/// Returns null if the picture was given up.
Result<std::shared_ptr<Picture>> make_picture(gi::Device& device, Pipeline& pipeline,
                                              const PictureRequest& request,
                                              const std::atomic<bool>& give_up) {
    auto picture = std::make_shared<Picture>();
    FrameRequest frame = request.frame;
    frame.stop = &give_up;
    // At rest the exposure is exact at once, because the last picture of a view stays.
    if (request.moving) frame.exposure_seconds = kExposureSeconds;
    LUCARNE_ASSIGN(picture->stats, pipeline.render(frame));
    if (picture->stats.given_up) return nullptr;
    const gi::GBuffer& gbuffer = pipeline.gbuffer();
    const size_t pixels = size_t{gbuffer.width} * gbuffer.height;
    picture->moving = request.moving;
    picture->sketch = request.sketch;
    picture->size = {gbuffer.width, gbuffer.height};
    picture->rgba = pipeline.picture().download_all<std::byte>(pixels * 4);
    picture->depth.reserve(pixels);
    for (const gi::GBufferTexel& texel : gbuffer.texels.download_all<gi::GBufferTexel>(pixels))
        picture->depth.push_back(texel.depth);
    picture->ids = gbuffer.ids.download_all<uint32_t>(pixels);
    picture->points = pipeline.points();
    picture->camera = pipeline.camera();
    picture->local_origin = pipeline.local_origin();
    picture->metres_per_unit = pipeline.source().header().metres_per_unit;
    picture->exposure_ev = pipeline.exposure_ev();
    picture->values = pipeline.values();
    picture->device_memory = device.memory_used();
    picture->shader_problem = device.shader_problem();
    return picture;
}

bool worth_another(const PictureRequest& request, const FrameStats& stats) {
    if (stats.nodes_pending > 0) return true;
    return !request.moving && request.frame.accumulate && stats.accumulated < request.pictures;
}

}  // namespace

glm::dvec3 Picture::seen_at(const glm::ivec2& pixel) const {
    const auto wide = [](const glm::vec3& vector) { return glm::dvec3(vector.x, vector.y, vector.z); };
    const float along = depth[static_cast<size_t>(pixel.y) * size.width + static_cast<size_t>(pixel.x)];
    const glm::dvec3 offset = wide(gi::view_offset(camera, glm::vec2(pixel) + 0.5f, along));
    return local_origin + (wide(camera.origin) + offset) / metres_per_unit;
}

std::optional<glm::dvec3> Picture::pick(const glm::dvec2& place) const {
    const int width = static_cast<int>(size.width), height = static_cast<int>(size.height);
    const int x = static_cast<int>(place.x * width), y = static_cast<int>(place.y * height);
    std::optional<glm::ivec2> best;
    int nearest = kPickRadius * kPickRadius + 1;
    for (int dy = -kPickRadius; dy <= kPickRadius; ++dy)
        for (int dx = -kPickRadius; dx <= kPickRadius; ++dx) {
            const glm::ivec2 at(x + dx, y + dy);
            if (at.x < 0 || at.y < 0 || at.x >= width || at.y >= height) continue;
            if (dx * dx + dy * dy >= nearest || !(depth[static_cast<size_t>(at.y) * size.width + at.x] > 0))
                continue;
            nearest = dx * dx + dy * dy;
            best = at;
        }
    if (!best) return std::nullopt;
    return seen_at(*best);
}

void PictureWorker::State::publish(Result<std::shared_ptr<Picture>> made, uint64_t request) {
    {
        const std::lock_guard lock(mutex);
        if (made) {
            latest = std::move(*made);
            error = {};
        } else if (request == wanted_number) {
            error = tl::make_unexpected(std::move(made).error());
        }
    }
    published();
}

/// Draws from another source from now on, or from none.
Result<void> PictureWorker::State::take_source(gi::Device& gl,
                                               std::shared_ptr<const octree::NodeSource> other) {
    const std::shared_ptr<const octree::NodeSource> source = std::exchange(shown, nullptr);
    if (!other) pipeline.reset();
    {
        const std::lock_guard lock(mutex);
        preparing = {};
        if (!other) latest = nullptr;
    }
    if (!other) return {};
    if (pipeline) {
        if (auto taken = pipeline->set_source(other); !taken) {
            pipeline.reset();  // the pipeline may have lost parts of its state by then
            return taken;
        }
    } else {
        told = {};
        LUCARNE_ASSIGN(pipeline, Pipeline::open(gl, other, options));
        pipeline->on_prepared([this, version = uint64_t{0}](const gi::BakeJob::Status& status) mutable {
            const bool worth_a_picture = status.ended || (status.bake && status.version != version);
            version = status.version;
            {
                const std::lock_guard lock(mutex);
                preparing = {status.share, status.step, status.ended};
                prepared |= worth_a_picture;
            }
            changed.notify_all();
            published();
        });
    }
    shown = std::move(other);
    return {};
}

/// Makes pictures until the worker is stopped, or the device is lost (an error).
Result<void> PictureWorker::State::make_pictures(gi::Device& gl) {
    uint64_t made_of = 0;
    bool again = false;
    log::Operation warnings;  // the warnings of one source
    for (;;) {
        std::shared_ptr<const PictureRequest> request;
        uint64_t request_number = 0;
        std::optional<std::shared_ptr<const octree::NodeSource>> other;
        {
            std::unique_lock lock(mutex);
            changed.wait(lock, [&] {
                return stop || next_source || (shown && (again || prepared || wanted_number != made_of));
            });
            if (stop) return {};
            prepared = false;
            other = std::exchange(next_source, std::nullopt);
            if (other) last_source = *other;
            request = wanted;
            request_number = wanted_number;
            give_up = false;
            may_give_up = request && (!request->moving || request->sketch);
        }
        if (other) warnings = {};
        const log::Operation::Scope scope(warnings);
        auto picture = guarded("picture", [&]() -> Result<std::shared_ptr<Picture>> {
            if (other) LUCARNE_TRY(take_source(gl, std::move(*other)));
            if (!shown || request_number == 0) return nullptr;
            LUCARNE_TRY(tell(gl, *pipeline, *request, request_number, told));
            return make_picture(gl, *pipeline, *request, give_up);
        });
        if (!picture) LUCARNE_TRY(gl.check());
        if (picture && !*picture && !give_up) continue;
        made_of = request_number;
        if (picture && !*picture) continue;
        again = picture && worth_another(*request, (*picture)->stats);
        if (picture) {
            (*picture)->number = ++pictures_made;
            (*picture)->request = request_number;
            (*picture)->source = shown;
        }
        publish(std::move(picture), request_number);
    }
}

/// Makes a device and works with it. Errors: the device is lost, or cannot be made.
Result<void> PictureWorker::State::work_with(const WorkerDevice& device_of) {
    Result<void> ended;
    {
        auto gl = guarded("graphics device", device_of.make);
        if (!gl) ended = tl::make_unexpected(std::move(gl).error());
        if (ended && started) {
            device = (*gl)->info();
            std::exchange(started, std::nullopt)->set_value({});
        }
        if (ended) ended = guarded("pictures", [&] { return make_pictures(**gl); });
        pipeline.reset();  // destroyed before its device
    }
    device_of.release();
    return ended;
}

/// Waits for another device. Returns nothing if the worker has to stop.
std::optional<WorkerDevice> PictureWorker::State::another_device(Error why) {
    {
        const std::lock_guard lock(mutex);
        if (!next_source) next_source = last_source;
        lost = std::move(why);
    }
    shown.reset();
    published();
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return stop || next_device; });
    if (stop) return std::nullopt;
    return std::exchange(next_device, std::nullopt);
}

void PictureWorker::State::work(WorkerDevice device_of) {
    for (;;) {
        auto ended = work_with(device_of);
        if (ended) break;
        if (started) return started->set_value(std::move(ended));
        auto next = another_device(std::move(ended).error());
        if (!next) break;
        device_of = std::move(*next);
    }
    shown.reset();
}

PictureWorker::PictureWorker() : state_(std::make_unique<State>()) {}

Result<std::unique_ptr<PictureWorker>> PictureWorker::start(WorkerDevice device,
                                                            std::shared_ptr<const octree::NodeSource> source,
                                                            const PipelineOptions& options,
                                                            std::function<void()> published) {
    std::unique_ptr<PictureWorker> worker(new PictureWorker);
    std::promise<Result<void>> promise;
    auto started = promise.get_future();
    worker->state_->published = std::move(published);
    worker->state_->options = options;
    worker->state_->started = std::move(promise);
    if (source) worker->state_->next_source = std::move(source);
    worker->state_->thread =
        std::thread([state = worker->state_.get(), device = std::move(device)]() mutable {
            state->work(std::move(device));
        });
    LUCARNE_TRY(started.get());
    return worker;
}

PictureWorker::~PictureWorker() {
    {
        const std::lock_guard lock(state_->mutex);
        state_->stop = true;
        state_->give_up = true;
    }
    state_->changed.notify_all();
    if (state_->thread.joinable()) state_->thread.join();
}

uint64_t PictureWorker::request(PictureRequest request) {
    auto wanted = std::make_shared<const PictureRequest>(std::move(request));
    uint64_t number = 0;
    {
        const std::lock_guard lock(state_->mutex);
        if (state_->may_give_up && wanted->moving && !wanted->sketch) state_->give_up = true;
        state_->wanted = std::move(wanted);
        number = ++state_->wanted_number;
        state_->error = {};
    }
    state_->changed.notify_all();
    return number;
}

void PictureWorker::set_source(std::shared_ptr<const octree::NodeSource> source) {
    {
        const std::lock_guard lock(state_->mutex);
        state_->next_source = std::move(source);
    }
    state_->changed.notify_all();
}

std::optional<Error> PictureWorker::lost_device() const {
    const std::lock_guard lock(state_->mutex);
    return state_->lost;
}

void PictureWorker::set_device(WorkerDevice device) {
    {
        const std::lock_guard lock(state_->mutex);
        state_->next_device = std::move(device);
        state_->lost.reset();
    }
    state_->changed.notify_all();
}

std::shared_ptr<const Picture> PictureWorker::latest() const {
    const std::lock_guard lock(state_->mutex);
    return state_->latest;
}

Result<void> PictureWorker::error() const {
    const std::lock_guard lock(state_->mutex);
    return state_->error;
}

BakeProgress PictureWorker::preparing() const {
    const std::lock_guard lock(state_->mutex);
    return state_->preparing;
}

const gi::DeviceInfo& PictureWorker::device() const {
    return state_->device;
}

}  // namespace lucarne::viewer
