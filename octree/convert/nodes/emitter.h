#pragma once

#include <cassert>
#include <vector>

#include "octree/codec/payload.h"
#include "octree/convert/chunks/record_loader.h"
#include "octree/convert/nodes/surface_rounding.h"
#include "octree/convert/sampling/node_sampler.h"

namespace lucarne::octree {

/// Converts settled children to payloads and directory entries.
class Emitter {
 public:
    explicit Emitter(const RecordLoader& loader)
        : stride_(loader.schema().stride), rounding_(loader.schema()), encoder_(loader.schema()) {}

    /// Appends the settled child's payload and its entry, whose offset is relative to the start of `payload`.
    /// `record(i)` returns the i-th record of the child's sample.
    template <class Record>
    void emit(NodeSampler& sampler, size_t child, const Record& record, std::vector<std::byte>& payload,
              std::vector<format::Entry>& entries) {
        format::Entry entry = sampler.settle(child, order_);
        if (entry.subtree_count == 0) return;  // its parent took every point
        entry.payload_offset = payload.size();
        sampler.kept(child, curve_, passes_);
        assert(curve_.size() == entry.count && order_.size() == entry.count);
        collect(curve_, record);
        if (!compress(entry, payload)) {  // compression gains nothing: store the records raw
            collect(order_, record);
            payload.insert(payload.end(), records_.begin(), records_.end());
        }
        assert(payload.size() - entry.payload_offset <= UINT32_MAX);
        entry.payload_bytes = static_cast<uint32_t>(payload.size() - entry.payload_offset);
        entry.checksum = format::checksum(std::span(payload).subspan(entry.payload_offset));
        entries.push_back(entry);
    }

    /// CPU time spent on rounding and compression so far.
    double encode_seconds() const { return seconds_; }

 private:
    template <class Record>
    void collect(const std::vector<uint32_t>& indices, const Record& record) {
        records_.resize(indices.size() * stride_);
        std::byte* to = records_.data();
        for (const uint32_t i : indices) {
            std::memcpy(to, record(i), stride_);
            to += stride_;
        }
    }
    /// Rounds the records' surface estimates and appends the records compressed. Returns false, and appends
    /// nothing, if compression gains nothing.
    bool compress(format::Entry& entry, std::vector<std::byte>& payload);

    uint32_t stride_;
    SurfaceRounding rounding_;
    codec::PayloadEncoder encoder_;
    double seconds_ = 0;
    std::vector<uint32_t> order_, curve_;
    std::vector<uint8_t> passes_;
    std::vector<std::byte> records_;
};

}  // namespace lucarne::octree
