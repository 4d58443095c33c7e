// Surfels made by hand, as an octree that a SurfelPool can load.
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "gi/scene/surfel_pool.h"
#include "gi/shared/camera.h"
#include "gi/shared/surfel_code.h"
#include "io/core/random.h"
#include "octree/source.h"

namespace lucarne::gi {

/// A surfel for the device; `cube` is its node's. The area is kept to 9 % (see PackedSurfel).
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
    return packed;
}

/// An additive octree over surfels: a node keeps a random `keep` of the surfels in its cube and hands the
/// others to its children; up to 4 * keep stay whole in a leaf. The floor of a node is the mean area of all
/// surfels in its cube times `floor_scale`.
class SurfelCloud : public octree::NodeSource {
 public:
    explicit SurfelCloud(std::vector<Surfel> surfels, const octree::Cube& root = {{-8, -8, -8}, 16},
                         uint32_t keep = 1024, float floor_scale = 1.0f)
        : keep_(keep), floor_scale_(floor_scale) {
        header_.root = root;
        header_.min = root.min;
        header_.max = root.min + root.size;
        header_.points = surfels.size();
        nodes_.push_back({});
        contents_.push_back(std::move(surfels));
        for (size_t i = 0; i < nodes_.size(); ++i) split(i);
        for (size_t i = 0; i < nodes_.size(); ++i) {
            const octree::Cube cube = root.of(nodes_[i].key);
            packed_.emplace_back();
            for (const Surfel& s : contents_[i]) packed_.back().push_back(pack(s, cube));
        }
        contents_.clear();
    }

    const octree::SourceHeader& header() const override { return header_; }
    std::span<const octree::NodeInfo> nodes() const override { return nodes_; }
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
        double area = 0;
        for (const Surfel& s : all) area += s.area;
        const float mean = all.empty() ? 0.0f : static_cast<float>(area / static_cast<double>(all.size()));
        for (size_t step = 0; step < octree::kPrefixSteps; ++step)
            nodes_[index].area_floor[step] = floor_scale_ * mean * static_cast<float>(1u << step);
        nodes_[index].subtree_count = all.size();
        const octree::NodeKey key = nodes_[index].key;
        std::vector<Surfel> children[8];
        if (all.size() > 4 * keep_ && key.level < 15) {
            // The kept ones are drawn at random; the rest keeps its order.
            Random random(1, index);
            for (size_t i = 0; i < keep_; ++i) std::swap(all[i], all[i + random.next() % (all.size() - i)]);
            const octree::Cube cube = header_.root.of(key);
            const glm::dvec3 middle = cube.min + cube.size / 2;
            for (size_t i = keep_; i < all.size(); ++i) {
                const glm::dvec3 p(all[i].position);
                children[(p.x >= middle.x) | (p.y >= middle.y) << 1 | (p.z >= middle.z) << 2].push_back(
                    all[i]);
            }
            all.resize(keep_);
        }
        nodes_[index].count = static_cast<uint32_t>(all.size());
        contents_[index] = std::move(all);
        for (uint32_t octant = 0; octant < 8; ++octant) {
            if (children[octant].empty()) continue;
            if (!nodes_[index].child_mask) nodes_[index].first_child = static_cast<uint32_t>(nodes_.size());
            nodes_[index].child_mask |= static_cast<uint8_t>(1u << octant);
            octree::NodeInfo child;
            child.key = key.child(octant);
            child.parent = static_cast<uint32_t>(index);
            nodes_.push_back(child);
            contents_.push_back(std::move(children[octant]));
        }
    }

    uint32_t keep_;
    float floor_scale_;
    octree::SourceHeader header_;
    std::vector<octree::NodeInfo> nodes_;
    std::vector<std::vector<Surfel>> contents_;
    std::vector<std::vector<PackedSurfel>> packed_;
};

/// Everything of a cloud on the device.
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

/// A camera at `from` that looks at `to`, z up.
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
