#include "octree/convert/chunks/surface_store.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <mutex>

#include <fmt/format.h>

#include "octree/cache/format.h"
#include "octree/convert/chunks/chunk_points.h"
#include "octree/convert/chunks/record_bytes.h"

namespace lucarne::octree {
namespace {

constexpr float kAreaBins = 4;  ///< bins per octave
/// Largest area of a point without a plane, as a share of the median area. A few points in the air together
/// have no plane, and their estimated area is that of the empty space around them. They must not be drawn
/// larger than usual surfels.
constexpr float kMostStray = 0.5f;

}  // namespace

Result<SurfaceStore> SurfaceStore::estimate(const ChunkStore& chunks, const std::vector<io::ScanInfo>& scans,
                                            ScratchFile file, const Settings& settings) {
    SurfaceStore store(std::move(file), chunks);
    const ChunkPoints access(chunks, scans, settings.estimated_stations, settings.ranks);
    NormalOptions options;
    options.neighbours = settings.neighbours;
    options.search = settings.search;
    options.stations = access.all_stations();
    options.memory = settings.memory;
    options.threads = settings.threads;
    options.normals = settings.normals;
    options.area_unit = chunks.root().first_size();
    std::mutex mutex;
    const auto keep = [&](size_t chunk, ChunkNormals&& found) -> Result<void> {
        const std::lock_guard lock(mutex);
        const uint64_t count = chunks.chunks()[chunk].count;
        LUCARNE_TRY(store.keep(chunk, count, found));
        return settings.step ? settings.step(count) : Result<void>();
    };
    if (settings.ranks) {
        const Serving answers(*settings.ranks,
                              [&](std::span<const std::byte> question) { return access.answer(question); });
        LUCARNE_TRY(store.estimate_together(chunks, access, options, keep, settings));
    } else {
        LUCARNE_ASSIGN(store.signs_, estimate_normals(access, options, keep));
    }
    if (settings.normals) store.limit_strays();
    return store;
}

void SurfaceStore::turn(size_t chunk, uint32_t component) {
    if (chunk < signs_.size() && component < signs_[chunk].size())
        signs_[chunk][component] = -signs_[chunk][component];
}

uint32_t SurfaceStore::surface(size_t chunk, uint32_t component) const {
    if (chunk >= signs_.size() || component >= signs_[chunk].size()) return 0;
    return static_cast<uint32_t>(std::abs(signs_[chunk][component]));
}

void SurfaceStore::limit_strays() {
    uint64_t known = 0, below = 0;
    for (const auto& [bin, count] : areas_) known += count;
    for (const auto& [bin, count] : areas_) {
        below += count;
        if (2 * below < known) continue;
        // The limit is kMostStray of the median.
        most_stray_area_ = kMostStray * std::exp2(static_cast<float>(bin) / kAreaBins);
        return;
    }
}

Result<void> SurfaceStore::keep(size_t chunk, uint64_t count, const ChunkNormals& found) {
    std::vector<Point> points(count);
    for (size_t i = 0; i < count; ++i) {
        if (i < found.normals.size()) points[i].normal = found.normals[i];
        if (i < found.areas.size()) points[i].area = found.areas[i];
        if (points[i].area > kStrayArea)
            ++areas_[static_cast<int>(std::floor(kAreaBins * std::log2(points[i].area)))];
        if (i < found.components.size()) points[i].component = found.components[i];
        if (i < found.edges.size()) points[i].edge = found.edges[i];
    }
    const auto bytes = std::as_bytes(std::span(points));
    sums_[chunk] = format::checksum(bytes);
    return file_.write_at(first_[chunk] * sizeof(Point), bytes);
}

std::vector<std::byte> SurfaceStore::save() const {
    ByteWriter writer;
    writer.put_all(sums_);
    writer.put(most_stray_area_);
    writer.put(uint64_t{signs_.size()});
    for (const auto& signs : signs_) writer.put_all(signs);
    return writer.take();
}

Result<SurfaceStore> SurfaceStore::restore(const ChunkStore& chunks, ScratchFile file,
                                           std::span<const std::byte> record) {
    SurfaceStore store(std::move(file), chunks);
    ByteReader reader(record);
    const auto sums = reader.get_all<uint64_t>();
    store.most_stray_area_ = reader.get<float>();
    const auto signed_chunks = reader.get<uint64_t>();
    for (uint64_t i = 0; i < signed_chunks && reader.sound(); ++i)
        store.signs_.push_back(reader.get_all<int32_t>());
    if (!reader.sound() || sums.size() != store.sums_.size())
        return failed("normals", "have an incomplete record");
    store.sums_ = sums;
    for (size_t chunk = chunks.own().first; chunk < chunks.own().end; ++chunk) {
        LUCARNE_ASSIGN(const auto points, store.read(chunk, 0, store.count(chunk)));
        if (format::checksum(std::as_bytes(std::span(points))) != sums[chunk])
            return failed("normals", "have changed since they were written");
    }
    return store;
}

Result<std::vector<SurfaceStore::Point>> SurfaceStore::read(size_t chunk, uint64_t first,
                                                            uint64_t count) const {
    std::vector<Point> points(count);
    LUCARNE_TRY(
        file_.read_at((first_[chunk] + first) * sizeof(Point), std::as_writable_bytes(std::span(points))));
    return points;
}

Result<std::vector<SurfaceStore::Point>> SurfaceStore::load(size_t chunk, uint64_t first,
                                                            uint64_t count) const {
    LUCARNE_ASSIGN(auto points, read(chunk, first, count));
    if (most_stray_area_ > 0)
        for (auto& point : points)
            if (point.normal == glm::vec3(0.0f)) point.area = std::min(point.area, most_stray_area_);
    if (chunk >= signs_.size()) return points;
    for (auto& point : points)
        if (point.component < signs_[chunk].size() && signs_[chunk][point.component] < 0) {
            point.normal = -point.normal;
            point.edge.beyond = turned(point.edge.beyond);
        }
    return points;
}

}  // namespace lucarne::octree
