// All surfels that the renderer makes of a scan or cache.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gi/surfels/surfel_pool.h"
#include "octree/stream/cut.h"
#include "viewer/inputs/input.h"

namespace lucarne::bench {

/// An input at full detail on the device, surfels that fill holes included.
struct WholeCut {
    gi::SurfelPool pool;
    gi::DeviceCut cut;  ///< positions in metres from the origin
    explicit WholeCut(gi::SurfelPool made) : pool(std::move(made)) {}
};
inline Result<std::unique_ptr<WholeCut>> whole_cut(gi::Device& device, const std::string& input) {
    LUCARNE_ASSIGN(const auto source, viewer::open_input(input));
    const octree::Cut cut = octree::full_cut(*source);
    uint64_t room = 0;
    for (const auto& node : cut.nodes) room += node.count + gi::SurfelPool::kPageSurfels;
    LUCARNE_ASSIGN(const auto fillings, source->fillings());
    for (const octree::Filling& filling : fillings)
        for (const auto& node : filling.nodes) room += node.count + gi::SurfelPool::kPageSurfels;
    if (room > 100'000'000) return failed(input, "is too large to be held whole");
    LUCARNE_ASSIGN(auto pool, gi::SurfelPool::create(device, static_cast<uint32_t>(room)));
    auto whole = std::make_unique<WholeCut>(std::move(pool));  // the cut refers to its pool
    gi::Scene scene;
    scene.materials.resize(1);
    std::vector<gi::CutEntry> entries;
    for (const auto& node : cut.nodes) {
        LUCARNE_ASSIGN(const auto data, source->load(node.node));
        LUCARNE_ASSIGN(
            const bool fits,
            whole->pool.load(node.node,
                             gi::pack_surfels(source->header(), source->nodes()[node.node], data, scene)));
        if (!fits) return failed(input, "does not fit the pool");
        entries.push_back({node.node, node.count});
    }
    uint32_t number = gi::kFirstFilled;
    for (const octree::Filling& filling : fillings)
        for (size_t i = 0; i < filling.nodes.size(); ++i) {
            LUCARNE_ASSIGN(const bool fits,
                           whole->pool.load(number++, gi::pack_surfels(filling.header, filling.nodes[i],
                                                                       filling.records[i], scene)));
            if (!fits) return failed(input, "does not fit the pool");
        }
    LUCARNE_TRY(whole->pool.make_cut(device, *source, entries, glm::dvec3(0.0), whole->cut, {}, fillings));
    return whole;
}

/// Returns the surfels of an input at full detail, those that fill holes included; positions in metres from
/// the origin.
inline Result<std::vector<gi::Surfel>> all_surfels(gi::Device& device, const std::string& input) {
    LUCARNE_ASSIGN(const auto whole, whole_cut(device, input));
    return whole->pool.download(whole->cut);
}

}  // namespace lucarne::bench
