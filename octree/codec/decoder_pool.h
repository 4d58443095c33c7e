#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "octree/codec/payload.h"

namespace lucarne::octree::codec {

/// Decoders for any number of threads. They are kept together with their buffers, because making new ones for
/// each node would take as long as decoding it. The pool keeps as many as have ever worked at once.
class DecoderPool {
 public:
    explicit DecoderPool(const io::Schema& schema) : columns_(columns_of(schema)), stride_(schema.stride) {}
    DecoderPool(const DecoderPool&) = delete;
    DecoderPool& operator=(const DecoderPool&) = delete;

    /// Does what PayloadDecoder::decode does. Thread-safe.
    bool decode(std::span<const std::byte> payload, std::span<std::byte> records) {
        auto decoder = take();
        const bool whole = decoder->decode(payload, records);
        const std::lock_guard lock(mutex_);
        idle_.push_back(std::move(decoder));
        return whole;
    }

 private:
    std::unique_ptr<PayloadDecoder> take() {
        {
            const std::lock_guard lock(mutex_);
            if (!idle_.empty()) {
                auto decoder = std::move(idle_.back());
                idle_.pop_back();
                return decoder;
            }
        }
        return std::make_unique<PayloadDecoder>(columns_, stride_);
    }

    std::vector<Column> columns_;
    uint32_t stride_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<PayloadDecoder>> idle_;
};

}  // namespace lucarne::octree::codec
