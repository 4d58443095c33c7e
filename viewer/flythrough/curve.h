#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace lucarne::viewer {

/// A value at a time, s.
template <class Value>
struct Timed {
    double time = 0;
    Value value{};
    bool operator==(const Timed&) const = default;
};

/// Returns the last key that is not later than `time`, or the first one. `keys`: at least one, times
/// increasing.
template <class Key>
size_t key_before(const std::vector<Key>& keys, double time) {
    const auto next = std::ranges::upper_bound(keys, time, {}, &Key::time);
    return next == keys.begin() ? 0 : static_cast<size_t>(next - keys.begin()) - 1;
}

/// Evaluates the curve of the quantity `get(key)`, which must be a scalar or a vector of doubles: cubic
/// Hermite curves with the tangents of Catmull & Rom ("A class of local interpolating splines", 1974) for
/// uneven times, one-sided at both ends. They pass through every key, and the speed is continuous there.
/// Between two keys that agree the quantity stays as it is, to the last bit, so that frames in which nothing
/// moves are the same. `keys`: at least one, times strictly increasing; `time` is clamped to them.
template <class Key, class Get>
auto curve_at(const std::vector<Key>& keys, double time, const Get& get) {
    const size_t i = key_before(keys, time);
    if (time <= keys[i].time || i + 1 == keys.size()) return get(keys[i]);
    const auto slope = [&](size_t a, size_t b) {
        return (get(keys[b]) - get(keys[a])) / (keys[b].time - keys[a].time);
    };
    const auto rests = [&](size_t k) {
        return (k > 0 && get(keys[k - 1]) == get(keys[k])) ||
               (k + 1 < keys.size() && get(keys[k + 1]) == get(keys[k]));
    };
    // The slope of the parabola through three keys at the middle key.
    const auto tangent = [&](size_t k) {
        if (rests(k)) return get(keys[k]) - get(keys[k]);  // zero, of its type
        if (k == 0) return slope(0, 1);
        if (k + 1 == keys.size()) return slope(k - 1, k);
        const double before = keys[k].time - keys[k - 1].time, after = keys[k + 1].time - keys[k].time;
        return (slope(k - 1, k) * after + slope(k, k + 1) * before) / (before + after);
    };
    const double span = keys[i + 1].time - keys[i].time;
    const double t = (time - keys[i].time) / span, t2 = t * t, t3 = t2 * t;
    return get(keys[i]) + (get(keys[i + 1]) - get(keys[i])) * (3 * t2 - 2 * t3) +
           tangent(i) * ((t3 - 2 * t2 + t) * span) + tangent(i + 1) * ((t3 - t2) * span);
}

/// The same for keys that are values.
template <class Value>
Value curve_at(const std::vector<Timed<Value>>& keys, double time) {
    return curve_at(keys, time, [](const Timed<Value>& key) { return key.value; });
}

}  // namespace lucarne::viewer
