// The loops of tile.cpp over sectors about a point. They are included after tile_loops.inl, once for each kind
// of processor.

/// The sector of each direction (u, v), counted around the circle.
LUCARNE_INLINE Words sectors_of(const Lanes& u, const Lanes& v) {
    constexpr float kEighth = 0.41421356f;  // tan 22.5 degrees
    const Lanes none{}, a = u < none ? -u : u, b = v < none ? -v : v;
    const Words half = -(lesser(a, b) > kEighth * greater(a, b));
    Words sector = b > a ? 3 - half : half;  // 0 .. 3 in the first quarter
    sector = u < none ? 7 - sector : sector;
    return v < none ? 15 - sector : sector;
}

/// Sums over the points of each sector, one array a quantity. The first kRun - 1 sectors follow again after
/// the last one, so that a run can be summed without a wrap.
struct SectorSums {
    enum Quantity { kX, kY, kZ, kXX, kYY, kZZ, kXY, kXZ, kYZ, kCount, kQuantities };
    float of[kQuantities][kSectors + kRun - 1];

    LUCARNE_INLINE SectorSums(const Patch& patch, const TangentFrame& frame) {
        // With p = (x, y, z, 1): the products of p with itself, two rows a vector, so that a point costs two
        // additions of vectors. The last row takes what belongs to no sector.
        float products[kSectors + 1][2][kLanes] = {};
        for (size_t i = 0; i < patch.count; i += kLanes) {
            const Lanes x = load<Lanes>(&patch.x[i]), y = load<Lanes>(&patch.y[i]),
                        z = load<Lanes>(&patch.z[i]);
            const Words none = (load<Lanes>(&patch.distance2[i]) == 0.0f) |
                               (kLane >= static_cast<int32_t>(patch.count - i)),
                        sector = sectors_of(along(frame.x, x, y, z), along(frame.y, x, y, z));
            int32_t at[kLanes];
            store(at, none ? static_cast<int32_t>(kSectors) - Words{} : sector);
            for (size_t lane = 0; lane < kLanes; ++lane) {
                const float px = patch.x[i + lane], py = patch.y[i + lane], pz = patch.z[i + lane];
                const Lanes p{px, py, pz, 1, px, py, pz, 1},
                    xy = __builtin_shufflevector(p, p, 0, 0, 0, 0, 5, 5, 5, 5),
                    z1 = __builtin_shufflevector(p, p, 2, 2, 2, 2, 7, 7, 7, 7);
                auto& sums = products[at[lane]];
                store(sums[0], load<Lanes>(sums[0]) + p * xy);
                store(sums[1], load<Lanes>(sums[1]) + p * z1);
            }
        }
        for (size_t s = 0; s < kSectors + kRun - 1; ++s) {
            const auto& [xy, z1] = products[s % kSectors];
            of[kXX][s] = xy[0], of[kXY][s] = xy[1], of[kXZ][s] = xy[2], of[kX][s] = xy[3];
            of[kYY][s] = xy[5], of[kYZ][s] = xy[6], of[kY][s] = xy[7];
            of[kZZ][s] = z1[2], of[kZ][s] = z1[3], of[kCount][s] = z1[7];
        }
    }
    /// The sums over the eight runs that begin with sector `first` and the seven after it.
    LUCARNE_INLINE Lanes runs(Quantity q, size_t first) const {
        static_assert(kRun == 5);
        const float* from = &of[q][first];
        return load<Lanes>(from) + load<Lanes>(from + 1) + load<Lanes>(from + 2) + load<Lanes>(from + 3) +
               load<Lanes>(from + 4);
    }
};

/// How badly planes fit to eight runs and the centre. The least eigenvalue of a covariance is close to its
/// determinant divided by the sum of its principal minors, if the others are much larger, and the normal is
/// close to the largest column of the adjugate matrix.
LUCARNE_INLINE Lanes misfits(const SectorSums& sums, size_t first, float least) {
    using S = SectorSums;
    const Lanes n = sums.runs(S::kCount, first), x = sums.runs(S::kX, first) / n,
                y = sums.runs(S::kY, first) / n, z = sums.runs(S::kZ, first) / n;
    const Lanes raw_xx = sums.runs(S::kXX, first) / n - x * x, raw_yy = sums.runs(S::kYY, first) / n - y * y,
                raw_zz = sums.runs(S::kZZ, first) / n - z * z, trace = raw_xx + raw_yy + raw_zz;
    // In units of the trace, because floats cannot represent the products of any three variances.
    const Lanes scale = 1.0f / trace, xx = raw_xx * scale, yy = raw_yy * scale, zz = raw_zz * scale,
                xy = (sums.runs(S::kXY, first) / n - x * y) * scale,
                xz = (sums.runs(S::kXZ, first) / n - x * z) * scale,
                yz = (sums.runs(S::kYZ, first) / n - y * z) * scale;
    const Lanes a = yy * zz - yz * yz, b = xx * zz - xz * xz, c = xx * yy - xy * xy, minors = a + b + c;
    const Lanes ab = xz * yz - xy * zz, ac = xy * yz - xz * yy, bc = xy * xz - yz * xx, none{};
    const Lanes variance = greater((xx * a + xy * ab + xz * ac) / minors, none);
    const Words by_a = (a >= b) & (a >= c), by_b = b >= c;
    const Lanes u = by_a ? a : by_b ? ab : ac, v = by_a ? ab : by_b ? b : bc, w = by_a ? ac : by_b ? bc : c;
    const Lanes height = u * x + v * y + w * z;
    const Lanes misfit = trace * variance * n / (n - 3.0f) + height * height / (u * u + v * v + w * w);
    const Words known = (n >= least) & (trace > none) & (minors > none) & (misfit >= none);
    return known ? misfit : std::numeric_limits<float>::max() - none;
}

[[gnu::noinline]] SectorRun flattest(const Patch& patch, const TangentFrame& frame, size_t least) {
    using S = SectorSums;
    const SectorSums sums(patch, frame);
    float off[kSectors];
    for (size_t first = 0; first < kSectors; first += kLanes)
        store(&off[first], misfits(sums, first, static_cast<float>(least)));
    const size_t best = static_cast<size_t>(std::min_element(off, off + kSectors) - off);
    SectorRun run;
    run.misfit = off[best];
    if (run.misfit == std::numeric_limits<float>::max()) return run;
    const auto sum = [&](S::Quantity q) {
        float all = 0;
        for (size_t s = best; s < best + kRun; ++s) all += sums.of[q][s];
        return all;
    };
    run.moments = {static_cast<size_t>(sum(S::kCount)),
                   {sum(S::kX), sum(S::kY), sum(S::kZ)},
                   {sum(S::kXX), sum(S::kYY), sum(S::kZZ), sum(S::kXY), sum(S::kXZ), sum(S::kYZ)}};
    return run;
}
