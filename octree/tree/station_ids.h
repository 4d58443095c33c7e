#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <vector>

#include "io/points.h"
#include "octree/tree/scan_number.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

/// Tells which of the inputs' stations saw a point. The point's point_source_id decides; the only station of
/// an input saw all of its points, as does an estimated station of which this is known.
class StationIds {
 public:
    /// `schema` is that of the records and outlives this object.
    StationIds(const std::vector<io::ScanInfo>& scans, const io::Schema& schema,
               std::span<const EstimatedStation> estimated = {})
        : by_id_(scans.size()) {
        for (size_t scan = 0; scan < scans.size(); ++scan)
            for (const auto& station : scans[scan].stations) {
                by_id_[scan].try_emplace(station.id, static_cast<int32_t>(stations_.size()));
                stations_.push_back(station.position);
            }
        stated_ = stations_.size();
        for (const EstimatedStation& station : estimated) {
            if (station.saw_all && station.scan < scans.size() && by_id_[station.scan].empty())
                by_id_[station.scan].emplace(0, static_cast<int32_t>(stations_.size()));
            stations_.push_back(station.position);
        }
        if (by_id_.size() > 1) scan_.emplace(schema);
        source_ = schema.find(io::names::point_source_id);
    }

    /// The stated stations, and after them the estimated ones.
    const std::vector<glm::dvec3>& stations() const { return stations_; }
    size_t stated() const { return stated_; }
    /// Returns the index into stations(), -1 if unknown.
    int32_t of(const std::byte* record) const {
        const size_t scan = scan_ ? scan_->of(record) : 0;
        if (scan >= by_id_.size()) return -1;
        const auto& ids = by_id_[scan];
        if (ids.size() == 1) return ids.begin()->second;
        if (ids.size() < 2 || !source_) return -1;
        // Some files store the id as a float, which may be fractional, too large or NaN.
        const double id = io::scalar_at(source_->type, record + source_->offset);
        if (!(id >= 0 && id <= std::numeric_limits<uint32_t>::max())) return -1;
        const auto found = ids.find(static_cast<uint32_t>(id));
        return found == ids.end() || found->first != id ? -1 : found->second;
    }

 private:
    std::vector<std::map<uint32_t, int32_t>> by_id_;  ///< of each scan: station id to index
    std::vector<glm::dvec3> stations_;
    size_t stated_ = 0;
    std::optional<ScanNumber> scan_;  ///< empty: all records are of one scan
    const io::Attribute* source_ = nullptr;
};

}  // namespace lucarne::octree
