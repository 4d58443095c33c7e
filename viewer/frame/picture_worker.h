#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "viewer/frame/pipeline.h"

namespace lucarne::viewer {

inline constexpr uint32_t kMostAccumulated = 256;  ///< pictures in an average

/// What a picture is wanted of.
struct PictureRequest {
    FrameRequest frame;
    std::string engine;
    gi::EngineSettings settings;
    CutBudgets budgets;
    gi::Scene scene;
    uint64_t scene_version = 0;            ///< another number: the scene is another
    uint64_t shader_version = 0;           ///< another number: shader files are read again
    bool moving = false;                   ///< one picture does: the next request is on its way
    uint32_t pictures = kMostAccumulated;  ///< averaged at rest, before the worker rests too
};

/// A finished picture, on the host.
struct Picture {
    uint64_t number = 0;   ///< 1 for the first that the worker made
    uint64_t request = 0;  ///< the request it is of
    std::shared_ptr<const octree::NodeSource> source;
    bool moving = false;
    ImageSize size;
    std::vector<std::byte> rgba;  ///< row 0 on top
    std::vector<float> depth;     ///< m along the camera's forward axis; 0: nothing
    std::vector<uint32_t> ids;    ///< of the surfels that are seen, gi::kNoSurfel where nothing is
    std::shared_ptr<const gi::CutPoints> points;  ///< which points of the source they are
    gi::CameraView camera{};
    glm::dvec3 local_origin{0.0};
    double metres_per_unit = 1, exposure_ev = 0;
    FrameStats stats;
    gi::ShownValues values;      ///< what the colours stand for
    uint64_t device_memory = 0;  ///< bytes of the device's buffers
    std::string shader_problem;  ///< gi::Device::shader_problem()

    /// The world point seen at a place, shares of the width and height from the top left; the nearest within
    /// a few pixels where the place itself is empty.
    std::optional<glm::dvec3> pick(const glm::dvec2& place) const;
};

/// The device a worker draws with; both are called on its thread, `release` also where `make` failed.
struct WorkerDevice {
    std::function<Result<std::unique_ptr<gi::Device>>()> make;
    std::function<void()> release;
};

/// A thread that owns device and pipeline and makes pictures of the newest request, so that the window
/// answers at once however long a picture takes. It goes on making pictures of the same request while nodes
/// are on their way or samples are being averaged, and then rests.
class PictureWorker {
 public:
    /// `published` is called on the worker's thread after each picture, each error and a loss of the device.
    /// Without a `source` there is nothing to make pictures of yet. Errors: no device.
    static Result<std::unique_ptr<PictureWorker>> start(WorkerDevice device,
                                                        std::shared_ptr<const octree::NodeSource> source,
                                                        const PipelineOptions& options,
                                                        std::function<void()> published);
    ~PictureWorker();  ///< after the picture being made
    PictureWorker(const PictureWorker&) = delete;
    PictureWorker& operator=(const PictureWorker&) = delete;

    /// Replaces the request before; returns its number.
    uint64_t request(PictureRequest request);
    /// Pictures are of this source from the next one on; null: there are none until there is another.
    void set_source(std::shared_ptr<const octree::NodeSource> source);
    std::shared_ptr<const Picture> latest() const;  ///< null before the first, and without a source
    /// The newest request's error, if making its picture failed; it is not tried again.
    Result<void> error() const;
    /// Why the device was lost, while the worker waits for another: device, pipeline and all they held are
    /// gone by then, sources and the request are not. The last picture stays.
    std::optional<Error> lost_device() const;
    /// In place of the lost one: the worker goes on with it where it was. If it cannot be made it counts as
    /// lost.
    void set_device(WorkerDevice device);
    const gi::DeviceInfo& device() const;  ///< of the first

 private:
    PictureWorker();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace lucarne::viewer
