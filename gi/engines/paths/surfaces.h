#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/paths/sides.h"
#include "gi/tracing/surfel_tracer.h"

namespace lucarne::gi::paths {

/// A part of one side of a disc that something cuts off from its centre. Discs stick out through the surfaces
/// at which theirs ends: the rim of one that is lit from outside is seen in a dark room. Light meets that
/// part as if it were a surface of its own.
struct CutOffPart {
    Side side = kNone;         ///< of the disc
    glm::vec3 position{0.0f};  ///< a place on the part
    bool operator==(const CutOffPart&) const = default;
};

/// The surfels of discs and, after them, one for each part: its disc, moved to a place on the part, with the
/// normal of its side. Those of parts are made when they are asked for: few ever are.
class SideSurfels {
 public:
    SideSurfels(std::span<const Surfel> discs, std::span<const CutOffPart> parts)
        : discs_(discs), parts_(parts) {}
    size_t size() const { return discs_.size() + parts_.size(); }
    bool empty() const { return size() == 0; }
    Surfel operator[](size_t i) const {
        if (i < discs_.size()) return discs_[i];
        const CutOffPart& part = parts_[i - discs_.size()];
        Surfel surfel = discs_[part.side / 2];
        surfel.position = part.position;
        surfel.normal = normal_of(discs_, part.side);
        return surfel;
    }

 private:
    std::span<const Surfel> discs_;
    std::span<const CutOffPart> parts_;
};
inline glm::vec3 normal_of(const SideSurfels& surfels, Side side) {
    const glm::vec3 normal = surfels[side / 2].normal;
    return side % 2 ? -normal : normal;
}

/// The sides that light paths meet: those of discs, and after them the parts that are cut off from these. A
/// part has one side, the front of a surfel of its own. Thread-safe once all parts are found.
class Surfaces {
 public:
    explicit Surfaces(std::unique_ptr<tracing::SurfelTracer> tracer);
    /// Finds the parts of some discs. Returns whether any are left. There are at most kMostParts a disc in
    /// the mean: if there were more, sides with the most parts would have none. In foliage all discs cut each
    /// other, and no part of them is a surface.
    bool find_parts();
    static constexpr size_t kMostParts = 2;
    /// A hash that tells which sides have parts, and how many: sides of parts have other numbers if it
    /// differs.
    uint64_t parts_key() const;

    const tracing::SurfelTracer& tracer() const { return *tracer_; }
    /// The surfels of sides. Areas are those of whole discs; see area_of().
    SideSurfels surfels() const { return {tracer_->surfels(), parts_}; }
    /// The parts, in the order of the sides to which they belong.
    std::span<const CutOffPart> parts() const { return parts_; }
    size_t discs() const { return tracer_->surfels().size(); }
    bool is_part(Side side) const { return side / 2 >= discs(); }
    /// The back of a part does not exist.
    bool exists(Side side) const { return side % 2 == 0 || !is_part(side); }
    /// The parts of a disc's side.
    std::span<const CutOffPart> parts_of(Side side) const;
    Side side_of_part(const CutOffPart& part) const {
        return static_cast<Side>(2 * (discs() + static_cast<size_t>(&part - parts_.data())));
    }
    /// Returns a side's share of the surface, m^2. Those of a disc's side and of its parts add up to the
    /// disc's.
    float area_of(Side side) const;
    /// Returns the side that a ray meets at `place`.
    Side side_of(const tracing::SurfelTracer::Hit& hit, const glm::vec3& place) const;
    /// Whether nothing is between two sides, each seen from a radius above it.
    bool see_each_other(Side one, Side other) const;

 private:
    std::vector<CutOffPart> parts_cut_off(Side side, float& share) const;
    void keep_sides_with(size_t parts);
    glm::vec3 above(Side side, const glm::vec3& place) const;

    std::unique_ptr<tracing::SurfelTracer> tracer_;
    size_t next_ = 0;  ///< side whose parts are not known yet
    size_t most_;      ///< parts that a side has; it has none if there were more
    std::vector<CutOffPart> parts_;
    std::vector<float> shares_;    ///< of each part, of its disc's area
    std::vector<uint32_t> first_;  ///< of each side of a disc: its parts; and their end
    std::vector<bool> is_cut_;     ///< the same as bits, which stay in a cache: whether it has parts
};

}  // namespace lucarne::gi::paths
