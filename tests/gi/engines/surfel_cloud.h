// Surfels made by hand, as an octree that a SurfelPool can load.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "gi/shared/camera.h"
#include "gi/shared/surfel_code.h"
#include "gi/surfels/surfel_edge.h"
#include "gi/surfels/surfel_pool.h"
#include "octree/tree/source.h"
#include "tests/gi/engines/even_order.h"

namespace lucarne::gi {

/// Packs a surfel for the device; `cube` is that of its node. The area is exact to 9 % (see PackedSurfel).
inline PackedSurfel pack(const Surfel& s, const octree::Cube& cube) {
    const glm::dvec3 at = (glm::dvec3(s.position) - cube.min) / cube.size * 65536.0;
    const auto step = [](double v) { return static_cast<uint32_t>(std::clamp(v, 0.0, 65535.0)); };
    const double octaves = s.area > 0 ? std::log2(cube.size * cube.size / s.area) : 255.0 / 8;
    const auto area = static_cast<uint32_t>(std::clamp(std::lround(octaves * 8), 0l, 255l));
    PackedSurfel packed;
    packed.a = step(at.x) | step(at.y) << 16;
    packed.b = step(at.z) | area << 16 | s.material << 24;
    const bool has_normal = glm::dot(s.normal, s.normal) > 0;
    packed.c = has_normal ? encode_octahedral(s.normal) : 0u;
    packed.d = has_normal ? kSurfelHasNormal : 0u;
    for (int i = 0; i < 3; ++i)
        packed.d |= static_cast<uint32_t>(std::lround(linear_to_srgb(s.albedo[i]) * 1023)) << 10 * i;
    if (const float near = glm::length(s.edge); near > 0)
        pack_edge(s.edge / near, static_cast<float>(1 / (near * cube.size)), packed);
    return packed;
}

/// An additive octree over surfels. A node keeps an even subset of `keep` of the surfels in its cube and
/// hands the others to its children; up to 4 * keep surfels stay together in a leaf. The floor of a node is
/// the area of the surfels in its cube over the number of those drawn down to it, times `floor_scale`.
class SurfelCloud : public octree::NodeSource {
 public:
    explicit SurfelCloud(std::vector<Surfel> surfels, const octree::Cube& root = {{-8, -8, -8}, 16},
                         uint32_t keep = 1024, float floor_scale = 1.0f)
        : keep_(keep), floor_scale_(floor_scale) {
        header_.root = root;
        header_.min = root.min;
        header_.max = root.min + root.size;
        header_.points = surfels.size();
        header_.schema.add(std::string(io::names::area), io::ScalarType::u16);
        nodes_.push_back({});
        contents_.push_back(std::move(surfels));
        inherited_.emplace_back();
        for (size_t i = 0; i < nodes_.size(); ++i) split(i);
        for (size_t i = 0; i < nodes_.size(); ++i) {
            const octree::Cube cube = root.of(nodes_[i].key);
            packed_.emplace_back();
            for (const Surfel& s : contents_[i]) packed_.back().push_back(pack(s, cube));
        }
        contents_.clear();
    }

    const octree::SourceHeader& header() const override { return header_; }
    octree::NodeTable nodes() const override { return nodes_; }
    Result<octree::NodeData> load(uint32_t) const override { return failed("cloud", "has no records"); }

    const std::vector<PackedSurfel>& packed(uint32_t node) const { return packed_[node]; }
    std::vector<CutEntry> whole() const {
        std::vector<CutEntry> entries;
        for (uint32_t i = 0; i < nodes_.size(); ++i) entries.push_back({i, nodes_[i].count});
        return entries;
    }
    uint32_t pages() const {
        uint32_t pages = 0;
        for (const auto& node : packed_)
            pages += static_cast<uint32_t>((node.size() + SurfelPool::kPageSurfels - 1) /
                                           SurfelPool::kPageSurfels);
        return pages;
    }

 private:
    void split(size_t index) {
        std::vector<Surfel> all = std::move(contents_[index]);
        const std::vector<Surfel> above = std::move(inherited_[index]);
        const octree::NodeKey key = nodes_[index].key;
        const octree::Cube cube = header_.root.of(key);
        order_evenly(all);
        double area = 0;
        for (const std::vector<Surfel>* surfels : {&std::as_const(all), &above})
            for (const Surfel& s : *surfels) area += s.area;
        nodes_[index].subtree_count = all.size();
        std::vector<Surfel> children[8], inherited[8];
        const auto octant = [&](const Surfel& s) {
            const glm::dvec3 p(s.position), middle = cube.min + cube.size / 2;
            return (p.x >= middle.x) | (p.y >= middle.y) << 1 | (p.z >= middle.z) << 2;
        };
        if (all.size() > 4 * keep_ && key.level < 15) {
            for (size_t i = keep_; i < all.size(); ++i) children[octant(all[i])].push_back(all[i]);
            all.resize(keep_);
            for (const std::vector<Surfel>* surfels : {&std::as_const(all), &above})
                for (const Surfel& s : *surfels) inherited[octant(s)].push_back(s);
        }
        for (size_t step = 0; step < octree::kPrefixSteps; ++step) {
            const double points = static_cast<double>(above.size()) +
                                  static_cast<double>(all.size()) / static_cast<double>(1u << step);
            nodes_[index].area_floor[step] =
                points > 0 ? floor_scale_ * static_cast<float>(area / points) : 0.0f;
        }
        nodes_[index].count = static_cast<uint32_t>(all.size());
        contents_[index] = std::move(all);
        for (uint32_t o = 0; o < 8; ++o) {
            if (children[o].empty()) continue;
            if (!nodes_[index].child_mask) nodes_[index].first_child = static_cast<uint32_t>(nodes_.size());
            nodes_[index].child_mask |= static_cast<uint8_t>(1u << o);
            octree::NodeInfo child;
            child.key = key.child(o);
            child.parent = static_cast<uint32_t>(index);
            nodes_.push_back(child);
            contents_.push_back(std::move(children[o]));
            inherited_.push_back(std::move(inherited[o]));
        }
    }

    uint32_t keep_;
    float floor_scale_;
    octree::SourceHeader header_;
    std::vector<octree::NodeInfo> nodes_;
    std::vector<std::vector<Surfel>> contents_, inherited_;  ///< of a node; of its ancestors, within its cube
    std::vector<std::vector<PackedSurfel>> packed_;
};

/// A whole cloud on the device.
struct LoadedCloud {
    SurfelPool pool;
    DeviceCut cut;
};
inline Result<std::unique_ptr<LoadedCloud>> load_cloud(Device& device, const SurfelCloud& cloud) {
    auto loaded = std::make_unique<LoadedCloud>();
    LUCARNE_ASSIGN(loaded->pool, SurfelPool::create(device, cloud.pages() * SurfelPool::kPageSurfels));
    for (uint32_t node = 0; node < cloud.nodes().size(); ++node) {
        LUCARNE_ASSIGN(const bool room, loaded->pool.load(node, cloud.packed(node)));
        if (!room) return failed("cloud", "does not fit");
    }
    LUCARNE_TRY(loaded->pool.make_cut(device, cloud, cloud.whole(), glm::dvec3(0.0), loaded->cut));
    return loaded;
}

/// Returns a camera at `from` that looks at `to`, z up.
inline CameraView look(const glm::vec3& from, const glm::vec3& to, uint32_t width, uint32_t height,
                       float vertical_field = 1.0f) {
    const glm::vec3 forward = glm::normalize(to - from);
    const glm::vec3 helper = std::abs(forward.z) < 0.99f ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
    const glm::vec3 right = glm::normalize(glm::cross(forward, helper));
    const glm::vec3 up = glm::cross(right, forward);
    const float tan_y = std::tan(vertical_field / 2);
    const float tan_x = tan_y * static_cast<float>(width) / static_cast<float>(height);
    CameraView view{};
    view.origin = {from.x, from.y, from.z, 0.01f};
    view.forward = {forward.x, forward.y, forward.z, 0};
    view.right = {right.x * tan_x, right.y * tan_x, right.z * tan_x, 0};
    view.up = {up.x * tan_y, up.y * tan_y, up.z * tan_y, 0};
    view.width = width;
    view.height = height;
    return view;
}

}  // namespace lucarne::gi
