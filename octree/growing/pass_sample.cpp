#include "octree/growing/pass_sample.h"

#include <algorithm>
#include <utility>

#include "io/core/random.h"

namespace lucarne::octree {
namespace {

constexpr uint64_t kAll = uint64_t{1} << 32;

/// Returns the limit that about `wanted` of `all` points' numbers are below.
uint64_t limit_for(uint64_t wanted, uint64_t all) {
    if (wanted >= all) return kAll;
    return static_cast<uint64_t>(static_cast<double>(kAll) * static_cast<double>(wanted) /
                                 static_cast<double>(all));
}

}  // namespace

PassSample::PassSample(uint32_t stride, uint64_t most, uint64_t expected)
    : stride_(stride), most_(most), expected_(expected), limit_(kAll) {
    // 1 % less, so that the number that is kept, which varies by its square root, is rarely over `most`.
    if (expected > most) limit_ = limit_for(most - most / 100, expected);
    records_.reserve(std::min(most, expected) * stride);
}

void PassSample::add(std::span<const std::byte> records) {
    const std::lock_guard lock(mutex_);
    for (size_t at = 0; at < records.size(); at += stride_) {
        const auto number = static_cast<uint32_t>(mix64(seen_++) >> 32);
        if (number >= limit_) continue;
        if (numbers_.size() == most_) {
            thin_out();
            if (number >= limit_) continue;
        }
        numbers_.push_back(number);
        const auto record = records.subspan(at, stride_);
        records_.insert(records_.end(), record.begin(), record.end());
    }
}

void PassSample::thin_out() {
    while (numbers_.size() == most_ && limit_ > 0) {
        limit_ /= 2;
        size_t kept = 0;
        for (size_t i = 0; i < numbers_.size(); ++i) {
            if (numbers_[i] >= limit_) continue;
            numbers_[kept] = numbers_[i];
            std::copy_n(&records_[i * stride_], stride_, &records_[kept * stride_]);
            ++kept;
        }
        numbers_.resize(kept);
        records_.resize(kept * stride_);
    }
}

std::vector<std::byte> PassSample::some(uint64_t of_all) const {
    const std::lock_guard lock(mutex_);
    const uint64_t limit = limit_for(of_all, expected_ > 0 ? expected_ : seen_);
    std::vector<std::byte> records;
    for (size_t i = 0; i < numbers_.size(); ++i) {
        if (numbers_[i] >= limit) continue;
        const auto record = std::span(records_).subspan(i * stride_, stride_);
        records.insert(records.end(), record.begin(), record.end());
    }
    return records;
}

std::vector<std::byte> PassSample::take() {
    const std::lock_guard lock(mutex_);
    numbers_ = {};
    return std::exchange(records_, {});
}

}  // namespace lucarne::octree
