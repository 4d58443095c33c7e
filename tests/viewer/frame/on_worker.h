#pragma once

#include <memory>
#include <optional>
#include <semaphore>

#include <gtest/gtest.h>

#include "tests/viewer/program.h"
#include "viewer/frame/picture_worker.h"

namespace lucarne::test {

/// A test with a picture worker, which asks for pictures of 96 x 64.
class OnWorker : public testing::Test {
 protected:
    /// Starts the worker, and prepares a request for the default scene of `source`.
    void start(viewer::WorkerDevice device, const std::shared_ptr<const octree::NodeSource>& source) {
        auto worker =
            viewer::PictureWorker::start(std::move(device), source, {}, [this] { published_.release(); });
        ASSERT_TRUE(worker) << worker.error().line();
        worker_ = std::move(*worker);
        request_.scene = gi::default_scene(source->header().min, source->header().max);
        request_.frame.camera = request_.scene.cameras.front();
        request_.frame.size = {96, 64};
    }
    /// Returns the next loss that the worker reports; none if another error comes first.
    std::optional<Error> loss() {
        for (;;) {
            if (auto lost = worker_->lost_device()) return lost;
            if (!worker_->error()) return std::nullopt;
            published_.acquire();
        }
    }
    /// Returns the first picture of a request that has all its nodes.
    std::shared_ptr<const viewer::Picture> whole(uint64_t number) {
        for (;;) {
            published_.acquire();
            if (!worker_->error()) return nullptr;
            const auto picture = worker_->latest();
            if (picture && picture->request == number && picture->stats.nodes_pending == 0) return picture;
        }
    }

    TemporaryFolder folder_;
    std::counting_semaphore<> published_{0};
    std::unique_ptr<viewer::PictureWorker> worker_;
    viewer::PictureRequest request_;
};

}  // namespace lucarne::test
