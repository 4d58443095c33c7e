#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <glm/vec2.hpp>

#include "viewer/frame/pipeline.h"

namespace lucarne::viewer {

inline constexpr uint32_t kMostAccumulated = 256;  ///< pictures in an average

/// A request for pictures.
struct PictureRequest {
    FrameRequest frame;
    Method method;
    gi::Scene scene;
    uint64_t scene_version = 0;            ///< changes when the scene changes
    uint64_t shader_version = 0;           ///< changes when the shader files are to be read again
    bool moving = false;                   ///< one picture is enough, since the next request will follow
    bool sketch = false;                   ///< a large picture between motion and rest
    bool small = false;                    ///< a small picture of new light, before the one at full size
    uint32_t pictures = kMostAccumulated;  ///< number to average at rest; then the worker sleeps

    /// What makes another picture of it, for comparisons. `scene_version` stands for the scene.
    auto content() const {
        return std::tie(frame.camera, frame.size, frame.most_pixels, frame.front_only, frame.accumulate,
                        frame.stand_in, frame.prepares, frame.prepares_again, frame.at_rest,
                        frame.colours_only, method, scene_version, shader_version, moving, sketch);
    }
};

/// A finished picture, on the host.
struct Picture {
    uint64_t number = 0;   ///< 1 for the first that the worker made
    uint64_t request = 0;  ///< number of its request
    std::shared_ptr<const octree::NodeSource> source;
    bool moving = false, sketch = false;  ///< as in the request
    ImageSize size;
    std::vector<std::byte> rgba;  ///< row 0 on top
    std::vector<float> depth;     ///< m along the camera's forward axis; 0: nothing
    std::vector<uint32_t> ids;    ///< ids of the visible surfels, gi::kNoSurfel where there is none
    std::shared_ptr<const gi::CutPoints> points;  ///< maps the ids to points of the source
    gi::CameraView camera{};
    glm::dvec3 local_origin{0.0};
    double metres_per_unit = 1, exposure_ev = 0;
    FrameStats stats;
    gi::ShownValues values;      ///< meaning of the colours, for legends
    uint64_t device_memory = 0;  ///< bytes of the device's buffers
    std::string shader_problem;  ///< gi::Device::shader_problem()

    /// Returns the world point that a pixel shows. The pixel must show one.
    glm::dvec3 seen_at(const glm::ivec2& pixel) const;
    /// Returns the visible world point at a place (shares of the width and height from the top left). If
    /// nothing is visible there, returns the nearest one within a few pixels.
    std::optional<glm::dvec3> pick(const glm::dvec2& place) const;
};

/// Makes and releases a worker's device. Both functions are called on the worker's thread, `release` also if
/// `make` failed.
struct WorkerDevice {
    std::function<Result<std::unique_ptr<gi::Device>>()> make;
    std::function<void()> release;
};

/// How far a precomputation is.
struct BakeProgress {
    double share = 0;  ///< the finished share, 0..1
    std::string step;  ///< that is being taken; empty at the end
    bool ended = false;
};

/// A thread that owns a device and a pipeline and makes pictures of the newest request, so that the window
/// responds at once however long a picture takes. It repeats the same request while nodes are on their way or
/// pictures are being averaged, and then sleeps.
class PictureWorker {
 public:
    /// Starts the worker. `published` is called after each picture, each error and each loss of the
    /// device, and when preparing() has changed; also on another thread. `source` may be null; then no
    /// pictures are made until set_source(). Errors: no device.
    static Result<std::unique_ptr<PictureWorker>> start(WorkerDevice device,
                                                        std::shared_ptr<const octree::NodeSource> source,
                                                        const PipelineOptions& options,
                                                        std::function<void()> published);
    ~PictureWorker();  ///< gives up the current picture
    PictureWorker(const PictureWorker&) = delete;
    PictureWorker& operator=(const PictureWorker&) = delete;

    /// Replaces the previous request. Returns the new request's number. If the new one is of a motion, a
    /// picture that is not (or a sketch) is given up; pictures of a motion are always finished, so that there
    /// are some.
    uint64_t request(PictureRequest request);
    /// Sets the source of the next pictures. Null: no pictures until there is another source.
    void set_source(std::shared_ptr<const octree::NodeSource> source);
    std::shared_ptr<const Picture> latest() const;  ///< null before the first picture, and without a source
    /// Returns the error if making the newest request's picture failed. It is not tried again.
    Result<void> error() const;
    /// Returns how far the present precomputation is, also once it has ended; nothing of earlier ones. It is
    /// newer than that of the last picture, since other shares alone are no reason for another one.
    BakeProgress preparing() const;
    /// Returns why the device was lost, while the worker waits for a new one. Device and pipeline have been
    /// destroyed by then; the source, the request and the last picture stay.
    std::optional<Error> lost_device() const;
    /// Replaces a lost device; the worker continues with the same request. A device that cannot be made
    /// counts as lost.
    void set_device(WorkerDevice device);
    const gi::DeviceInfo& device() const;  ///< information about the first device

 private:
    PictureWorker();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace lucarne::viewer
