#pragma once

#include <array>
#include <optional>

#include "io/formats/las/laz/decoder.h"
#include "io/formats/las/laz/encoder.h"
#include "io/formats/las/laz/integers.h"

namespace lucarne::io::laz {

/// Codes times as 64-bit integers, for up to four pulse trains at once. A time is predicted to come a whole
/// number of the train's steps after its last time. (LASzip items GPSTIME11 version 2 and the time of
/// POINT14.)
class GpsTimeModel {
 public:
    /// With GPSTIME11 every point says whether its time changed. POINT14 codes a time only where it changed.
    explicit GpsTimeModel(bool tells_unchanged)
        : unchanged_(tells_unchanged ? 1 : 0), first_(5 + unchanged_), steps_(kFull + 4 + unchanged_) {}

    void start(uint64_t time) { trains_[0].time = time; }
    /// Codes the next time. The decoder ignores its second argument. POINT14 may only encode times that
    /// change.
    uint64_t code(Decoder& decoder, uint64_t = 0) { return decode(decoder); }
    uint64_t code(Encoder& encoder, uint64_t time) {
        encode(encoder, time);
        return time;
    }

 private:
    /// The symbols for the number of steps: 0 means anything else, 1 to 500 that many, 501 to 510 as many
    /// backward. Then follow (GPSTIME11 only) unchanged, a new train, and the next, second next and third
    /// next train.
    static constexpr uint32_t kMostSteps = 500, kMostBackward = 10, kFull = kMostSteps + kMostBackward + 1;
    static constexpr uint32_t kPatience = 3;  ///< after so many exceptions a train takes a new step

    struct Train {
        uint64_t time = 0;
        int32_t step = 0;
        uint32_t exceptions = 0;
    };
    uint64_t decode(Decoder& decoder);
    void encode(Encoder& encoder, uint64_t time);
    void advance(int32_t by) {
        Train& train = trains_[current_];
        train.time += static_cast<uint64_t>(int64_t{by});
    }
    /// Returns the difference of two times, if it fits 32 bits.
    static std::optional<int32_t> step_between(uint64_t from, uint64_t to);
    /// Returns the train that a time continues best: how many after the current one, 4 for a new one.
    uint32_t trains_ahead(uint64_t time) const;
    template <class Coder>
    void new_train(Coder& coder, uint64_t time);
    template <class Coder>
    void first_step(Coder& coder, int32_t by);
    template <class Coder>
    void steps(Coder& coder, uint32_t count, int32_t by);
    /// Returns the symbol for the number of steps that is nearest to `by`.
    static uint32_t steps_symbol(int32_t by, int32_t step);

    uint32_t unchanged_;
    std::array<Train, 4> trains_{};
    uint32_t current_ = 0, newest_ = 0;
    SymbolModel first_, steps_;
    IntegerModel off_{32, 9};
};

}  // namespace lucarne::io::laz
