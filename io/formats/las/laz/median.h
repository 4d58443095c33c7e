#pragma once

#include <array>
#include <cstdint>

namespace lucarne::io::laz {

/// Keeps an approximate median of the last values. It is not the median of the last five: new values drive
/// out the largest and the smallest in turns, and that is part of the format.
class Median5 {
 public:
    int32_t get() const { return sorted_[2]; }
    void add(int32_t value) {
        auto& s = sorted_;
        if (drop_largest_) {
            if (value < s[2]) {
                s[4] = s[3];
                s[3] = s[2];
                s[2] = value < s[1] ? s[1] : value;
                if (value < s[0]) {
                    s[1] = s[0];
                    s[0] = value;
                } else if (value < s[1]) {
                    s[1] = value;
                }
            } else {
                s[4] = value < s[3] ? s[3] : value;
                if (value < s[3]) s[3] = value;
                drop_largest_ = false;
            }
        } else {
            if (s[2] < value) {
                s[0] = s[1];
                s[1] = s[2];
                s[2] = s[3] < value ? s[3] : value;
                if (s[4] < value) {
                    s[3] = s[4];
                    s[4] = value;
                } else if (s[3] < value) {
                    s[3] = value;
                }
            } else {
                s[0] = s[1] < value ? s[1] : value;
                if (s[1] < value) s[1] = value;
                drop_largest_ = true;
            }
        }
    }

 private:
    std::array<int32_t, 5> sorted_{};
    bool drop_largest_ = true;
};

}  // namespace lucarne::io::laz
