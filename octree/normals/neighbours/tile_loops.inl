// The loops of tile.cpp, included once for each kind of processor, inside a namespace that defines Packer,
// which keeps the chosen lanes.

template <class Vector, class T>
LUCARNE_INLINE Vector load(const T* from) {
    Vector v;
    std::memcpy(&v, from, sizeof v);
    return v;
}
template <class Vector, class T>
LUCARNE_INLINE void store(T* to, const Vector& v) {
    std::memcpy(to, &v, sizeof v);
}
LUCARNE_INLINE Lanes greater(const Lanes& a, const Lanes& b) {
    return a > b ? a : b;
}
LUCARNE_INLINE Lanes lesser(const Lanes& a, const Lanes& b) {
    return a < b ? a : b;
}

#ifdef LUCARNE_WIDE
struct Packer {
    LUCARNE_INLINE explicit Packer(const Words& chosen) {
        mask = static_cast<uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps((__m256i)chosen)));
        const __m256i packed = _mm256_set1_epi32(static_cast<int>(kPacking[mask]));
        order = _mm256_srlv_epi32(packed, _mm256_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28));
    }
    template <class T, class Vector>
    LUCARNE_INLINE void put(const Vector& values, T* to) const {
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                            _mm256_permutevar8x32_epi32((__m256i)values, order));
    }
    LUCARNE_INLINE size_t count() const { return static_cast<size_t>(__builtin_popcount(mask)); }
    uint32_t mask;
    __m256i order;
};
#else
/// Packs the chosen lanes of up to five arrays: appends them and returns their number. It handles one lane
/// after the other, without a branch.
struct Packer {
    LUCARNE_INLINE explicit Packer(const Words& chosen) { store(flags, chosen); }
    template <class T, class Vector>
    LUCARNE_INLINE void put(const Vector& values, T* to) const {
        T lanes[kLanes];
        store(lanes, values);
        size_t at = 0;
        for (size_t i = 0; i < kLanes; ++i) {
            to[at] = lanes[i];
            at += flags[i] != 0;
        }
    }
    LUCARNE_INLINE size_t count() const {
        size_t sum = 0;
        for (const int32_t flag : flags) sum += flag != 0;
        return sum;
    }
    int32_t flags[kLanes];
};
#endif

LUCARNE_INLINE Lanes relative(const std::vector<double>& values, size_t at, double origin) {
    return __builtin_convertvector(load<Doubles>(&values[at]) - origin, Lanes);
}

LUCARNE_INLINE Lanes beyond(const Lanes& v, float low, float high) {
    const Lanes none{};
    return greater(greater(low - v, v - high), none);
}

LUCARNE_INLINE void append_lanes(Tile& tile, const Lanes& x, const Lanes& y, const Lanes& z,
                                 const Words& index, size_t lanes, const glm::vec3& low,
                                 const glm::vec3& high, float limit2) {
    const Lanes dx = beyond(x, low.x, high.x), dy = beyond(y, low.y, high.y), dz = beyond(z, low.z, high.z);
    const Words chosen = (dx * dx + dy * dy + dz * dz <= limit2) & (kLane < static_cast<int32_t>(lanes));
    const Packer packer(chosen);
    packer.put(x, &tile.x[tile.count]);
    packer.put(y, &tile.y[tile.count]);
    packer.put(z, &tile.z[tile.count]);
    packer.put(index, &tile.index[tile.count]);
    tile.count += packer.count();
}

[[gnu::noinline]] void append(Tile& tile, const PointArrays& points, size_t first, size_t last,
                              uint32_t offset, const glm::vec3& low, const glm::vec3& high, float limit2) {
    size_t i = first;
    for (; i < last && i + kLanes <= points.size(); i += kLanes)
        append_lanes(tile, relative(points.x, i, tile.origin.x), relative(points.y, i, tile.origin.y),
                     relative(points.z, i, tile.origin.z), kLane + static_cast<int32_t>(i + offset), last - i,
                     low, high, limit2);
    for (; i < last; ++i) {  // the rest of the arrays
        const glm::vec3 p(points[i] - tile.origin);
        append_lanes(tile, p.x - Lanes{}, p.y - Lanes{}, p.z - Lanes{},
                     kLane + static_cast<int32_t>(i + offset), 1, low, high, limit2);
    }
}

[[gnu::noinline]] void within(Patch& patch, const Tile& tile, const glm::vec3& centre, float limit2) {
    patch.count = 0;
    for (size_t i = 0; i < tile.count; i += kLanes) {
        const Lanes x = load<Lanes>(&tile.x[i]) - centre.x, y = load<Lanes>(&tile.y[i]) - centre.y,
                    z = load<Lanes>(&tile.z[i]) - centre.z;
        const Lanes d2 = x * x + y * y + z * z;
        const Packer packer((d2 <= limit2) & (kLane < static_cast<int32_t>(tile.count - i)));
        packer.put(x, &patch.x[patch.count]);
        packer.put(y, &patch.y[patch.count]);
        packer.put(z, &patch.z[patch.count]);
        packer.put(d2, &patch.distance2[patch.count]);
        packer.put(load<Words>(&tile.index[i]), &patch.index[patch.count]);
        patch.count += packer.count();
    }
}

/// Computes the rank of each value among all. Equal values keep their order.
[[gnu::noinline]] void rank(const float* values, size_t count, int32_t* ranks) {
    for (size_t block = 0; block < count; block += kLanes) {
        const Lanes own = load<Lanes>(&values[block]);
        const size_t end = std::min(count, block + kLanes);
        Words rank{};
        size_t j = 0;
        for (; j < block; ++j) rank -= values[j] <= own;
        for (; j < end; ++j)
            rank -= (values[j] < own) | ((values[j] == own) & (kLane > static_cast<int32_t>(j - block)));
        for (; j < count; ++j) rank -= values[j] < own;
        store(&ranks[block], rank);
    }
}

LUCARNE_INLINE float total(const Lanes& v) {
    return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

/// Sums over points, lane by lane.
struct MomentLanes {
    Lanes sx{}, sy{}, sz{}, xx{}, yy{}, zz{}, xy{}, xz{}, yz{};

    LUCARNE_INLINE void add(const Lanes& x, const Lanes& y, const Lanes& z) {
        sx += x;
        sy += y;
        sz += z;
        xx += x * x;
        yy += y * y;
        zz += z * z;
        xy += x * y;
        xz += x * z;
        yz += y * z;
    }
    LUCARNE_INLINE Moments sums(size_t count) const {
        return {count,
                {total(sx), total(sy), total(sz)},
                {total(xx), total(yy), total(zz), total(xy), total(xz), total(yz)}};
    }
};

[[gnu::noinline]] Moments moments(const Patch& patch) {
    MomentLanes lanes;
    for (size_t i = 0; i < patch.count; i += kLanes)
        lanes.add(load<Lanes>(&patch.x[i]), load<Lanes>(&patch.y[i]), load<Lanes>(&patch.z[i]));
    return lanes.sums(patch.count);
}

LUCARNE_INLINE size_t total(const Words& v) {
    size_t sum = 0;
    for (size_t i = 0; i < kLanes; ++i) sum += static_cast<size_t>(v[i]);
    return sum;
}

[[gnu::noinline]] size_t slab_count(const Patch& patch, const Slab& slab) {
    Words counts{};
    for (size_t i = 0; i < patch.count; i += kLanes) {
        const Lanes off = load<Lanes>(&patch.x[i]) * slab.normal.x + load<Lanes>(&patch.y[i]) * slab.normal.y +
                          load<Lanes>(&patch.z[i]) * slab.normal.z - slab.level;
        counts -= (off <= slab.limit) & (off >= -slab.limit) & (kLane < static_cast<int32_t>(patch.count - i));
    }
    return total(counts);
}

[[gnu::noinline]] Moments slab_moments(const Patch& patch, const Slab& slab, bool others) {
    MomentLanes lanes;
    Words counts{};
    const Lanes none{};
    const Words outside = (others ? -1 : 0) - Words{};
    for (size_t i = 0; i < patch.count; i += kLanes) {
        const Lanes x = load<Lanes>(&patch.x[i]), y = load<Lanes>(&patch.y[i]), z = load<Lanes>(&patch.z[i]);
        const Lanes off = x * slab.normal.x + y * slab.normal.y + z * slab.normal.z - slab.level;
        const Words in = ((off <= slab.limit) & (off >= -slab.limit)) | (load<Lanes>(&patch.distance2[i]) == 0.0f),
                    chosen = (in ^ outside) & (kLane < static_cast<int32_t>(patch.count - i));
        lanes.add(chosen ? x : none, chosen ? y : none, chosen ? z : none);
        counts -= chosen;
    }
    return lanes.sums(total(counts));
}

[[gnu::noinline]] std::array<int32_t, kLanes> near_counts(const Patch& patch, size_t first, size_t step,
                                                          float limit2) {
    Lanes x{}, y{}, z{};
    const size_t some = std::min(kLanes, (patch.count - first + step - 1) / step);
    for (size_t lane = 0; lane < some; ++lane) {
        const size_t i = first + lane * step;
        x[lane] = patch.x[i], y[lane] = patch.y[i], z[lane] = patch.z[i];
    }
    Words counts{};
    for (size_t i = 0; i < patch.count; ++i) {
        const Lanes dx = x - patch.x[i], dy = y - patch.y[i], dz = z - patch.z[i];
        counts -= dx * dx + dy * dy + dz * dz < limit2;
    }
    std::array<int32_t, kLanes> found;
    store(found.data(), kLane < static_cast<int32_t>(some) ? counts : Words{});
    return found;
}

[[gnu::noinline]] void second_least(const Patch& patch, float* distance2) {
    const Lanes most = std::numeric_limits<float>::max() - Lanes{};
    for (size_t block = 1; block < patch.count; block += kLanes) {
        const Lanes x = load<Lanes>(&patch.x[block]), y = load<Lanes>(&patch.y[block]),
                    z = load<Lanes>(&patch.z[block]);
        Lanes first = most, second = most;
        for (size_t i = 1; i < patch.count; ++i) {
            const Lanes dx = x - patch.x[i], dy = y - patch.y[i], dz = z - patch.z[i];
            const Lanes all = dx * dx + dy * dy + dz * dz;
            const Lanes d2 = kLane == static_cast<int32_t>(i) - static_cast<int32_t>(block) ? most : all;
            second = lesser(second, greater(first, d2));
            first = lesser(first, d2);
        }
        store(&distance2[block - 1], second);
    }
}

[[gnu::noinline]] Range heights(const Patch& patch, const glm::vec3& normal, float* heights) {
    Lanes low{}, high{};
    for (size_t i = 0; i < patch.count; i += kLanes) {
        const Lanes h = load<Lanes>(&patch.x[i]) * normal.x + load<Lanes>(&patch.y[i]) * normal.y +
                        load<Lanes>(&patch.z[i]) * normal.z;
        low = lesser(low, h);
        high = greater(high, h);
        store(&heights[i], h);
    }
    Range range{0, 0};
    for (size_t i = 0; i < kLanes; ++i) range = {std::min(range.low, low[i]), std::max(range.high, high[i])};
    return range;
}

[[gnu::noinline]] Gap gap(const float* heights, size_t count, const Range& range, float middle) {
    Lanes below = range.low - Lanes{}, above = range.high - Lanes{};
    Words lower{};
    for (size_t i = 0; i < count; i += kLanes) {
        const Lanes h = load<Lanes>(&heights[i]);
        const Words inside = kLane < static_cast<int32_t>(count - i), is_lower = (h < middle) & inside;
        below = is_lower ? greater(below, h) : below;
        above = (~is_lower & inside) ? lesser(above, h) : above;
        lower -= is_lower;
    }
    Gap gap{range.low, range.high, 0};
    for (size_t i = 0; i < kLanes; ++i) {
        gap.below = std::max(gap.below, below[i]);
        gap.above = std::min(gap.above, above[i]);
        gap.lower += static_cast<size_t>(lower[i]);
    }
    return gap;
}

/// Collects the neighbours that cut a cell until there are many.
struct Cuts {
    static constexpr size_t kMost = 256;
    float x[kMost + kLanes], y[kMost + kLanes];
    size_t count = 0;

    LUCARNE_INLINE void take(const Words& chosen, const Lanes& u, const Lanes& v, const Lanes& length2,
                             Nearness& nearness) {
        if (count + kLanes > kMost) apply(nearness);
        const Lanes scale = 2.0f / length2;  // infinite only in lanes that are not chosen
        const Packer packer(chosen);
        packer.put(scale * u, &x[count]);
        packer.put(scale * v, &y[count]);
        count += packer.count();
    }
    LUCARNE_INLINE void apply(Nearness& nearness) {
        constexpr size_t kVectors = kDirections / kLanes;
        const Directions& to = directions();
        Lanes near[kVectors];
        for (size_t v = 0; v < kVectors; ++v) near[v] = load<Lanes>(&nearness[v * kLanes]);
        for (size_t i = 0; i < count; ++i)
            for (size_t v = 0; v < kVectors; ++v)
                near[v] = greater(
                    near[v], load<Lanes>(&to.x[v * kLanes]) * x[i] + load<Lanes>(&to.y[v * kLanes]) * y[i]);
        for (size_t v = 0; v < kVectors; ++v) store(&nearness[v * kLanes], near[v]);
        count = 0;
    }
};

LUCARNE_INLINE Lanes along(const glm::vec3& axis, const Lanes& x, const Lanes& y, const Lanes& z) {
    return x * axis.x + y * axis.y + z * axis.z;
}

[[gnu::noinline]] size_t cut_layer(const Patch& patch, const float* heights, const Range& layer,
                                   const TangentFrame& frame, float coincident2, bool others,
                                   Nearness& nearness) {
    Cuts cuts;
    Words here{};
    const Words all = (others ? -1 : 0) - Words{};
    for (size_t i = 0; i < patch.count; i += kLanes) {
        const Lanes x = load<Lanes>(&patch.x[i]), y = load<Lanes>(&patch.y[i]), z = load<Lanes>(&patch.z[i]),
                    h = load<Lanes>(&heights[i]);
        const Lanes u = along(frame.x, x, y, z), v = along(frame.y, x, y, z), length2 = u * u + v * v;
        const Words valid = kLane < static_cast<int32_t>(patch.count - i),
                    in = (h >= layer.low) & (h <= layer.high) & valid, apart = length2 > coincident2;
        here -= in & ~apart;
        cuts.take((in | (all & valid)) & apart, u, v, in ? length2 : length2 + h * h, nearness);
    }
    cuts.apply(nearness);
    return total(here);
}

/// Returns the slot of the least value of all lanes; among equal ones, the first slot.
LUCARNE_INLINE size_t slot_of_least(const Lanes& least, const Words& slot) {
    size_t best = 0;
    for (size_t i = 1; i < kLanes; ++i)
        if (least[i] < least[best] || (least[i] == least[best] && slot[i] < slot[best])) best = i;
    return static_cast<size_t>(slot[best]);
}

[[gnu::noinline]] size_t cut_slope(const Tile& tile, const Slope& slope, const TangentFrame& frame,
                                   float beyond2, Nearness& nearness) {
    Cuts cuts;
    Lanes least = std::numeric_limits<float>::max() - Lanes{};
    Words slot = static_cast<int32_t>(tile.count) - Words{};
    for (size_t i = 0; i < tile.count; i += kLanes) {
        const Lanes x = load<Lanes>(&tile.x[i]) - slope.centre.x,
                    y = load<Lanes>(&tile.y[i]) - slope.centre.y,
                    z = load<Lanes>(&tile.z[i]) - slope.centre.z;
        const Lanes d2 = x * x + y * y + z * z, h = along(frame.normal, x, y, z), u = along(frame.x, x, y, z),
                    v = along(frame.y, x, y, z), length2 = u * u + v * v;
        const Words chosen = (d2 <= slope.limit2) & (h * h <= slope.slope2 * length2) &
                             (length2 > slope.coincident2) & (kLane < static_cast<int32_t>(tile.count - i));
        const Words nearer = chosen & (d2 > beyond2) & (d2 < least);
        least = nearer ? d2 : least;
        slot = nearer ? kLane + static_cast<int32_t>(i) : slot;
        cuts.take(chosen, u, v, length2, nearness);
    }
    cuts.apply(nearness);
    return slot_of_least(least, slot);
}

[[gnu::noinline]] std::array<size_t, 4> nearest_in_quarters(const Patch& patch, const TangentFrame& frame,
                                                            float slope2) {
    constexpr size_t kQuarters = 4;
    Lanes least[kQuarters];
    Words slot[kQuarters];
    for (size_t q = 0; q < kQuarters; ++q) {
        least[q] = std::numeric_limits<float>::max() - Lanes{};
        slot[q] = static_cast<int32_t>(patch.count) - Words{};
    }
    for (size_t i = 0; i < patch.count; i += kLanes) {
        const Lanes x = load<Lanes>(&patch.x[i]), y = load<Lanes>(&patch.y[i]), z = load<Lanes>(&patch.z[i]),
                    d2 = load<Lanes>(&patch.distance2[i]);
        const Lanes h = along(frame.normal, x, y, z);
        const Words low =
            (h * h <= slope2 * (d2 - h * h)) & (d2 > 0.0f) & (kLane < static_cast<int32_t>(patch.count - i));
        const Words right = along(frame.x, x, y, z) > 0.0f, up = along(frame.y, x, y, z) > 0.0f;
        for (size_t q = 0; q < kQuarters; ++q) {
            const Words nearer = low & (q & 1 ? right : ~right) & (q & 2 ? up : ~up) & (d2 < least[q]);
            least[q] = nearer ? d2 : least[q];
            slot[q] = nearer ? kLane + static_cast<int32_t>(i) : slot[q];
        }
    }
    std::array<size_t, kQuarters> slots;
    for (size_t q = 0; q < kQuarters; ++q) slots[q] = slot_of_least(least[q], slot[q]);
    return slots;
}

/// The squared distances of boxes from a box.
LUCARNE_INLINE Lanes apart(const Boxes& boxes, const glm::vec3& low, const glm::vec3& high) {
    Lanes sum{};
    const Lanes none{};
    for (size_t axis = 0; axis < 3; ++axis) {
        const Lanes under = load<Lanes>(boxes.low[axis].data()) - high[static_cast<int>(axis)],
                    over = low[static_cast<int>(axis)] - load<Lanes>(boxes.high[axis].data());
        const Lanes gap = greater(greater(under, over), none);
        sum += gap * gap;
    }
    return sum;
}

[[gnu::noinline]] void box_distances(const Boxes& boxes, const glm::vec3& low, const glm::vec3& high,
                                     std::array<float, kBoxes>& distance2) {
    store(distance2.data(), apart(boxes, low, high));
}

[[gnu::noinline]] size_t near_children(const std::vector<Boxes>& level, const uint32_t* nodes, size_t count,
                                       const Vicinity& vicinity, uint32_t* children) {
    static_assert(kBoxes == kLanes);
    size_t found = 0;
    for (size_t i = 0; i < count; ++i) {
        const Lanes distance2 = apart(level[nodes[i]], vicinity.low, vicinity.high);
        const Packer packer(distance2 <= vicinity.limit2);
        packer.put(kLane + static_cast<int32_t>(nodes[i] * kBoxes), &children[found]);
        found += packer.count();
    }
    return found;
}

[[gnu::noinline]] float least(const Nearness& nearness) {
    Lanes least = load<Lanes>(nearness.data());
    for (size_t d = kLanes; d < kDirections; d += kLanes) least = lesser(least, load<Lanes>(&nearness[d]));
    float all = least[0];
    for (size_t i = 1; i < kLanes; ++i) all = std::min(all, least[i]);
    return all;
}

[[gnu::noinline]] float mean_square(const Nearness& nearness, float radius) {
    Lanes sum{}, count{};
    const Lanes none{}, one = 1 - none;
    for (size_t d = 0; d < kDirections; d += kLanes) {
        const Lanes n = load<Lanes>(&nearness[d]);
        const Words within = n * radius > 1.0f;
        sum += within ? 1.0f / (n * n) : none;
        count += within ? one : none;
    }
    const float all = total(count);
    return all > 0 ? total(sum) / all : 0.0f;
}

#include "octree/normals/neighbours/sector_loops.inl"
