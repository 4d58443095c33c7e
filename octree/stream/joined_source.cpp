#include "octree/stream/joined_source.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include <glm/common.hpp>

#include "io/core/log.h"
#include "io/core/random.h"
#include "io/formats/far_apart.h"
#include "octree/tree/area_floor.h"

namespace lucarne::octree {
namespace {

using Sources = std::vector<std::shared_ptr<const NodeSource>>;

class JoinedSource final : public NodeSource, private NodePages {
 public:
    explicit JoinedSource(Sources sources) {
        header_.metres_per_unit = common_unit(sources);
        for (auto& source : sources) add(std::move(source));
        const glm::dvec3 extent = header_.max - header_.min;
        // Like a cache's root cube: a little larger than the box, so that its upper faces are inside.
        const double side = std::max({extent.x, extent.y, extent.z, 1e-9}) * (1 + 0x1p-20);
        header_.root = {(header_.min + header_.max - side) / 2.0, side};
    }

    const SourceHeader& header() const override { return header_; }
    NodeTable nodes() const override { return {*this, nodes_}; }
    Result<void> directory_state() const override {
        for (const Part& part : parts_) LUCARNE_TRY(part.source->directory_state());
        return {};
    }
    std::vector<uint32_t> roots() const override {
        std::vector<uint32_t> roots;
        for (const Part& part : parts_) roots.push_back(part.first_node);
        return roots;
    }
    uint32_t parts() const override { return static_cast<uint32_t>(parts_.size()); }
    SourcePart part_of(uint32_t node) const override {
        const Part& part = part_with(node);
        return {part.source->header(), static_cast<uint32_t>(&part - parts_.data()), part.scale,
                part.first_scan};
    }
    uint64_t directory_bytes() const override {
        uint64_t bytes = 0;
        for (const Part& part : parts_) bytes += part.source->directory_bytes();
        return bytes;
    }
    Result<NodeData> load(uint32_t node) const override {
        const Part& part = part_with(node);
        return part.source->load(node - part.first_node);
    }
    std::optional<SourceIdentity> identity() const override {
        std::optional<SourceIdentity> all;
        for (const Part& part : parts_) {
            auto own = part.source->identity();
            if (!own) return std::nullopt;
            if (!all) all = SourceIdentity{0, own->file};
            all->content = mix64(all->content, own->content);
        }
        return all;
    }
    Result<std::vector<Filling>> fillings() const override {
        std::vector<Filling> all;
        for (const Part& part : parts_) {
            LUCARNE_ASSIGN(auto own, part.source->fillings());
            for (Filling& filling : own) {
                filling.part = static_cast<uint32_t>(&part - parts_.data());
                filling.scale = part.scale;
                all.push_back(std::move(filling));
            }
        }
        return all;
    }

 private:
    struct Part {
        std::shared_ptr<const NodeSource> source;
        uint32_t first_node = 0, first_scan = 0;
        double scale = 1;
    };

    static double common_unit(const Sources& sources) {
        const double first = sources.front()->header().metres_per_unit;
        const bool same = std::ranges::all_of(
            sources, [&](const auto& source) { return source->header().metres_per_unit == first; });
        return same ? first : 1.0;
    }

    void add(std::shared_ptr<const NodeSource> source) {
        const SourceHeader& own = source->header();
        if (source->nodes().empty()) return;
        const Part part{source, nodes_, static_cast<uint32_t>(header_.scans.size()),
                        own.metres_per_unit / header_.metres_per_unit};
        nodes_ += static_cast<uint32_t>(source->nodes().size());
        if (parts_.empty()) header_.schema = own.schema;
        header_.min = parts_.empty() ? own.min * part.scale : glm::min(header_.min, own.min * part.scale);
        header_.max = parts_.empty() ? own.max * part.scale : glm::max(header_.max, own.max * part.scale);
        header_.points += own.points;
        header_.has_gaps |= own.has_gaps;
        header_.scans.insert(header_.scans.end(), own.scans.begin(), own.scans.end());
        parts_.push_back(part);
    }

    /// Returns a node of a part with the numbers and the unit of all.
    NodeInfo node(uint32_t index) const override {
        const Part& part = part_with(index);
        NodeInfo node = part.source->nodes()[index - part.first_node];
        if (node.parent != kNoNode) node.parent += part.first_node;
        if (node.first_child != kNoNode) node.first_child += part.first_node;
        node.area_floor = stored_floors(node.area_floor, part.scale);
        return node;
    }

    const Part& part_with(uint32_t node) const {
        assert(node < nodes_);
        return *(std::ranges::upper_bound(parts_, node, {}, &Part::first_node) - 1);
    }

    SourceHeader header_;
    uint32_t nodes_ = 0;
    std::vector<Part> parts_;  ///< sorted by first_node
};

/// Returns where the sources lie, m.
std::vector<io::PlacedScan> placed(const Sources& sources) {
    std::vector<io::PlacedScan> all;
    for (const auto& source : sources) {
        const SourceHeader& header = source->header();
        if (header.points == 0) continue;
        all.push_back({header.scans.empty() ? "a scan" : header.scans.front().path,
                       {header.min * header.metres_per_unit, header.max * header.metres_per_unit}});
    }
    return all;
}

}  // namespace

Result<std::shared_ptr<const NodeSource>> join_sources(Sources sources) {
    if (sources.empty()) return rejected("sources", "there is none to join");
    if (sources.size() == 1) return std::move(sources.front());
    size_t nodes = 0;
    for (const auto& source : sources) nodes += source->nodes().size();
    if (nodes >= kNoNode) return rejected("sources", "they have more nodes together than can be numbered");
    if (const std::string far = io::far_apart(placed(sources)); !far.empty()) log::warn("{}", far);
    return std::make_shared<const JoinedSource>(std::move(sources));
}

}  // namespace lucarne::octree
