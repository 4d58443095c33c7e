#include "io/formats/laz/gps_time.h"

namespace lucarne::io::laz {
namespace {

// Contexts of the difference from what is expected.
enum : uint32_t {
    kFirstStep,
    kOneStep,
    kFewSteps,
    kManySteps,
    kMostStepsAhead,
    kBack,
    kFarBack,
    kNoStep,
    kUpperHalf
};

constexpr uint32_t kFew = 10;

int32_t times(int32_t step, int32_t count) {  // wraps, as the format does
    return static_cast<int32_t>(static_cast<uint32_t>(step) * static_cast<uint32_t>(count));
}

}  // namespace

uint64_t GpsTimeModel::decode(Decoder& decoder) {
    for (;;) {
        Train& train = trains_[current_];
        uint32_t skipped = 0;  // trains, plus one
        if (train.step == 0) {
            const uint32_t symbol = decoder.symbol(first_) + 1 - unchanged_;
            if (symbol == 1) {
                train.step = off_.code(decoder, 0, 0, kFirstStep);
                train.exceptions = 0;
                advance(train.step);
            } else if (symbol == 2) {
                new_train(decoder);
            } else if (symbol > 2) {
                skipped = symbol - 2;
            }
        } else {
            const uint32_t symbol = decoder.symbol(steps_);
            const uint32_t full = kFull + unchanged_;
            if (symbol < kFull)
                steps(decoder, symbol);
            else if (symbol == full)
                new_train(decoder);
            else if (symbol > full)
                skipped = symbol - full;
        }
        if (skipped == 0 || decoder.failed()) return trains_[current_].time;
        current_ = (current_ + skipped) & 3;
    }
}

void GpsTimeModel::new_train(Decoder& decoder) {
    newest_ = (newest_ + 1) & 3;
    const auto upper = static_cast<uint32_t>(
        off_.code(decoder, static_cast<int32_t>(trains_[current_].time >> 32), 0, kUpperHalf));
    trains_[newest_] = {uint64_t{upper} << 32 | decoder.bits(32), 0, 0};
    current_ = newest_;
}

void GpsTimeModel::steps(Decoder& decoder, uint32_t count) {
    Train& train = trains_[current_];
    if (count == 1) {
        advance(off_.code(decoder, train.step, 0, kOneStep));
        train.exceptions = 0;
        return;
    }
    int32_t whole = static_cast<int32_t>(count);
    uint32_t context = kManySteps;
    if (count == 0)
        context = kNoStep;
    else if (count < kFew)
        context = kFewSteps;
    else if (count == kMostSteps)
        context = kMostStepsAhead;
    else if (count > kMostSteps) {
        whole = static_cast<int32_t>(kMostSteps) - whole;
        context = count < kMostSteps + kMostBackward ? kBack : kFarBack;
    }
    const int32_t by = off_.code(decoder, times(train.step, whole), 0, context);
    if (context == kNoStep || context == kMostStepsAhead || context == kFarBack)
        if (++train.exceptions > kPatience) {
            train.step = by;
            train.exceptions = 0;
        }
    advance(by);
}

}  // namespace lucarne::io::laz
