#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gi/device/gl/device.h"
#include "gi/scene/scene.h"
#include "gi/surfels/baked_light.h"
#include "gi/surfels/colouring.h"
#include "gi/surfels/preparation.h"
#include "gi/surfels/surfel_pool.h"
#include "octree/stream/residency.h"
#include "octree/tree/source.h"
#include "viewer/frame/cut_choice.h"
#include "viewer/frame/device_cuts.h"

namespace lucarne::viewer {

/// Memory caps and threads of a stream.
struct StreamCaps {
    uint64_t memory = 0;         ///< bytes of the host: the octree's directory and nodes on their way
    uint64_t device_memory = 0;  ///< bytes of the device, of which a share holds surfels
    unsigned load_threads = 1;
};

/// Keeps the surfels of chosen cuts on the device: it loads nodes of a source, packs them on the loading
/// threads, and evicts others. It tells `cuts` which nodes have come and gone.
class SurfelStream {
 public:
    /// `device` and `cuts` must outlive the stream.
    SurfelStream(gi::Device& device, const StreamCaps& caps, DeviceCuts& cuts)
        : device_(device), caps_(caps), cuts_(cuts) {}

    /// Starts with another source and nothing resident. `scene` determines materials and colours. Errors: the
    /// directory is larger than the cap; no device memory.
    Result<void> set_source(std::shared_ptr<const octree::NodeSource> source, const gi::Scene& scene);
    /// All surfels are to be packed again: the scene's materials or colours have changed.
    void make_stale() { stale_ = true; }
    /// Packs stale surfels again. Resident nodes are replaced one by one while the old ones are drawn.
    /// Errors: no device memory; a node that the measuring of baked light needs cannot be read.
    Result<void> renew(const gi::Scene& scene);

    /// Begins to load nodes of these cuts, then of those that may be wanted `later`, and takes those that
    /// have arrived, for about so many seconds: two milliseconds are enough for a hundred nodes. Waits
    /// `patience` seconds at most for nodes that are on their way. Errors: device memory.
    Result<void> load(const std::vector<const octree::Cut*>& wanted,
                      const std::vector<const octree::Cut*>& later, double seconds, double patience);
    /// Loads all nodes of these cuts that the caps allow. Errors likewise.
    Result<void> load_all(const std::vector<const octree::Cut*>& wanted);
    /// Returns why a node could not be read, once. It is left out with its descendants.
    Result<void> take_error() { return residency_->take_error(); }

    /// Frees a quarter of the device memory and starts again with nothing resident. Returns false if little
    /// is left.
    bool shrink(const gi::Scene& scene);

    /// The room for nodes of all cuts together.
    CutRoom room() const;
    const gi::SurfelPool& pool() const { return pool_; }
    /// The synthetic surfels of the source. They are always resident, or left out.
    std::span<const octree::Filling> fillings() const { return fillings_; }
    /// Meaning of the surfels' colours.
    const gi::ShownValues& values() const { return values_; }
    /// Packs nodes as they are shown now. Thread-safe.
    std::shared_ptr<const gi::SurfelPreparation> preparation() const { return preparation_; }
    /// Grows when surfels are packed in another way.
    uint64_t packing() const { return packing_; }
    uint64_t bytes_loaded() const { return bytes_loaded_; }
    octree::ResidencyStats stats() const { return residency_->stats(); }

 private:
    using Stream = octree::Residency<gi::PackedNode>;

    uint64_t pool_surfels() const;
    uint64_t filled_bytes() const;
    void empty_pool();
    void start(const gi::Scene& scene);
    void take_fillings();
    Result<void> load_fillings();
    Result<void> apply(std::span<const Stream::Event> events);
    Result<void> take_arrivals(double seconds);

    gi::Device& device_;
    const StreamCaps caps_;
    DeviceCuts& cuts_;
    std::shared_ptr<const octree::NodeSource> source_;
    std::shared_ptr<gi::SurfelPreparation> preparation_;
    std::unique_ptr<Stream> residency_;
    bool stale_ = true;
    uint64_t packing_ = 0;
    gi::ShownValues values_;
    std::optional<gi::BakedLight> baked_;  ///< of the source, once it was needed
    gi::SurfelPool pool_;
    std::vector<octree::Filling> fillings_;
    uint64_t bytes_loaded_ = 0;
};

}  // namespace lucarne::viewer
