#include "octree/convert/chunks/point_stations.h"

#include <map>

#include "octree/tree/scan_number.h"

namespace lucarne::octree {
namespace {

/// Tells the station of points that come one after the other, each scan's in its order.
class StationCounter {
 public:
    StationCounter(const ScanNumber& scan, const std::vector<StationSpan>& spans, ScanPlace begin)
        : scan_(scan) {
        for (const StationSpan& span : spans) of_scan_[span.scan].spans.push_back(span);
        of_scan_[begin.scan].points = begin.point;
    }

    /// Returns what is stored for the next record: 1 + the index of its station, 0 if unknown.
    uint16_t next(const std::byte* record) {
        const uint32_t scan = scan_.of(record);
        if (!last_ || scan != last_scan_) {
            const auto found = of_scan_.find(scan);
            last_ = found == of_scan_.end() ? &none_ : &found->second;
            last_scan_ = scan;
        }
        const uint64_t index = last_->points++;
        while (last_->span < last_->spans.size() && last_->spans[last_->span].end <= index) ++last_->span;
        if (last_->span == last_->spans.size()) return 0;
        const StationSpan& span = last_->spans[last_->span];
        return index < span.first ? uint16_t{0} : static_cast<uint16_t>(1 + span.station);
    }

 private:
    struct Progress {
        std::vector<StationSpan> spans;
        uint64_t points = 0;
        size_t span = 0;  ///< the first that has not ended
    };
    ScanNumber scan_;
    std::map<uint32_t, Progress> of_scan_;
    Progress none_;
    Progress* last_ = nullptr;
    uint32_t last_scan_ = 0;
};

}  // namespace

Pass with_point_stations(Pass pass, const io::Schema& schema, const std::vector<StationSpan>& spans,
                         ScanPlace begin) {
    return [pass = std::move(pass), schema, spans, begin](const Visit& visit) -> Result<void> {
        StationCounter counter(ScanNumber(schema), spans, begin);
        std::vector<std::byte> wider;
        return pass([&](std::span<const std::byte> records) -> Result<void> {
            const size_t from = schema.stride, to = from + kStationBytes;
            wider.resize(records.size() / from * to);
            for (size_t at = 0, out = 0; at < records.size(); at += from, out += to) {
                std::memcpy(&wider[out], &records[at], from);
                io::store(&wider[out + from], counter.next(&records[at]));
            }
            return visit(wider);
        });
    };
}

}  // namespace lucarne::octree
