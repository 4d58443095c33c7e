#include "io/formats/las/laz/gps_time.h"

#include <algorithm>
#include <cmath>

namespace lucarne::io::laz {
namespace {

// Contexts of the difference from the predicted time.
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

int32_t times(int32_t step, int32_t count) {  // wraps, as in the format
    return static_cast<int32_t>(static_cast<uint32_t>(step) * static_cast<uint32_t>(count));
}

}  // namespace

uint64_t GpsTimeModel::decode(Decoder& decoder) {
    for (size_t i = 0; i <= trains_.size(); ++i) {  // an encoder changes to another train at most once
        uint32_t skipped = 0;                       // number of trains
        if (trains_[current_].step == 0) {
            const uint32_t symbol = decoder.symbol(first_) + 1 - unchanged_;
            if (symbol == 1)
                first_step(decoder, 0);
            else if (symbol == 2)
                new_train(decoder, 0);
            else if (symbol > 2)
                skipped = symbol - 2;
        } else {
            const uint32_t symbol = decoder.symbol(steps_);
            const uint32_t full = kFull + unchanged_;
            if (symbol < kFull)
                steps(decoder, symbol, 0);
            else if (symbol == full)
                new_train(decoder, 0);
            else if (symbol > full)
                skipped = symbol - full;
        }
        if (skipped == 0 || decoder.failed()) return trains_[current_].time;
        current_ = (current_ + skipped) & 3;
    }
    decoder.fail();
    return trains_[current_].time;
}

void GpsTimeModel::encode(Encoder& encoder, uint64_t time) {
    for (;;) {
        const int32_t step = trains_[current_].step;
        const uint32_t ahead = trains_ahead(time);
        SymbolModel& model = step == 0 ? first_ : steps_;
        if (unchanged_ && time == trains_[current_].time) {
            encoder.symbol(model, step == 0 ? 0 : kFull);
            return;
        }
        const uint32_t full = unchanged_ + (step == 0 ? 1 : kFull);
        if (ahead == trains_.size()) {
            encoder.symbol(model, full);
            return new_train(encoder, time);
        }
        if (ahead == 0) {
            const int32_t by = *step_between(trains_[current_].time, time);
            if (step == 0) {
                encoder.symbol(model, unchanged_);
                return first_step(encoder, by);
            }
            const uint32_t symbol = steps_symbol(by, step);
            encoder.symbol(model, symbol);
            return steps(encoder, symbol, by);
        }
        encoder.symbol(model, full + ahead);
        current_ = (current_ + ahead) & 3;
    }
}

uint32_t GpsTimeModel::steps_symbol(int32_t by, int32_t step) {
    // In single precision like LASzip, so that the bytes are the same.
    const float steps = static_cast<float>(by) / static_cast<float>(step);
    const float count =
        std::trunc(std::clamp(steps + (steps < 0 ? -0.5f : 0.5f), -float{kMostBackward}, float{kMostSteps}));
    return count < 0 ? kMostSteps + static_cast<uint32_t>(-count) : static_cast<uint32_t>(count);
}

std::optional<int32_t> GpsTimeModel::step_between(uint64_t from, uint64_t to) {
    const auto by = static_cast<int64_t>(to - from);
    if (by < INT32_MIN || by > INT32_MAX) return std::nullopt;
    return static_cast<int32_t>(by);
}

uint32_t GpsTimeModel::trains_ahead(uint64_t time) const {
    uint32_t ahead = 0;
    while (ahead < trains_.size() && !step_between(trains_[(current_ + ahead) & 3].time, time)) ++ahead;
    return ahead;
}

template <class Coder>
void GpsTimeModel::first_step(Coder& coder, int32_t by) {
    Train& train = trains_[current_];
    train.step = off_.code(coder, 0, by, kFirstStep);
    train.exceptions = 0;
    advance(train.step);
}

template <class Coder>
void GpsTimeModel::new_train(Coder& coder, uint64_t time) {
    newest_ = (newest_ + 1) & 3;
    const auto upper =
        static_cast<uint32_t>(off_.code(coder, static_cast<int32_t>(trains_[current_].time >> 32),
                                        static_cast<int32_t>(time >> 32), kUpperHalf));
    trains_[newest_] = {uint64_t{upper} << 32 | coder.bits(32, static_cast<uint32_t>(time)), 0, 0};
    current_ = newest_;
}

template <class Coder>
void GpsTimeModel::steps(Coder& coder, uint32_t count, int32_t by) {
    Train& train = trains_[current_];
    if (count == 1) {
        advance(off_.code(coder, train.step, by, kOneStep));
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
    by = off_.code(coder, times(train.step, whole), by, context);
    if (context == kNoStep || context == kMostStepsAhead || context == kFarBack)
        if (++train.exceptions > kPatience) {
            train.step = by;
            train.exceptions = 0;
        }
    advance(by);
}

}  // namespace lucarne::io::laz
