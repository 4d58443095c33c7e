// How fast one core decodes scan files. The files are generated here, because the real ones of the shared
// test data are too small.
#pragma once

#include <ctime>
#include <fstream>
#include <functional>

#include "io/formats/scan.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/rows.h"
#include "tests/io/formats/e57/e57_builder.h"

namespace lucarne::bench {

inline Result<uint64_t> read_whole(const std::filesystem::path& path) {
    LUCARNE_ASSIGN(const auto source, io::open_scan(path, {"", true}));
    LUCARNE_ASSIGN(const auto reader, source->open());
    io::PointBatch batch;
    for (uint64_t points = 0;; points += batch.count) {
        LUCARNE_ASSIGN(const size_t got, reader->read(batch, 100'000));
        if (got == 0) return points;
    }
}

/// Measures millions of points for each second of one core, from the time of all cores; the best of three
/// runs.
inline Result<void> bench_reading(const std::string& what, const std::filesystem::path& path,
                                  const char* unit, double target) {
    double best = 0;
    for (int round = 0; round < 3; ++round) {
        const std::clock_t start = std::clock();
        LUCARNE_ASSIGN(const uint64_t points, read_whole(path));
        const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        best = std::max(best, 1e-6 * static_cast<double>(points) / seconds);
    }
    row_at_least("decoded by a core: " + what, best, unit, target);
    std::filesystem::remove(path);
    return {};
}

/// Passes every record of a scan to `take`.
inline Result<void> for_each_record(const io::PointSource& source,
                                    const std::function<void(const std::byte*)>& take) {
    LUCARNE_ASSIGN(const auto reader, source.open());
    io::PointBatch batch;
    for (;;) {
        LUCARNE_ASSIGN(const size_t got, reader->read(batch, 100'000));
        if (got == 0) return {};
        for (size_t i = 0; i < got; ++i) take(&batch.bytes[i * source.schema().stride]);
    }
}

/// Writes `header` and rows of position and colour.
inline Result<void> write_text(const io::PointSource& source, const std::filesystem::path& path,
                               const std::string& header, bool normals) {
    const io::Attribute* color = source.schema().find(io::names::color);
    if (!color) return failed(path.string(), "the scan has no colour");
    std::ofstream out(path);
    out << header;
    LUCARNE_TRY(for_each_record(source, [&](const std::byte* record) {
        const auto p = io::position_of(source.schema(), record);
        const auto part = [&](size_t i) {
            const size_t bytes = io::scalar_bytes(color->type);
            return static_cast<int>(io::scalar_at(color->type, record + color->offset + i * bytes)) & 255;
        };
        out << fmt::format("{:.4f} {:.4f} {:.4f} {} {} {}", p.x, p.y, p.z, part(0), part(1), part(2))
            << (normals ? " 0.267261 -0.534522 0.801784\n" : "\n");
    }));
    return out.flush() ? Result<void>() : failed(path.string(), "cannot be written");
}

/// Writes coordinates as scaled integers of 24 bits and colours as bytes, in packets of the largest size.
inline Result<void> write_e57(const io::PointSource& source, const std::filesystem::path& path) {
    namespace e57 = io::testing;
    constexpr size_t kPacketPoints = 4000;
    e57::BuiltScan scan;
    for (const char axis : {'X', 'Y', 'Z'})
        scan.prototype +=
            e57::scaled_field(fmt::format("cartesian{}", axis), -(1 << 23), (1 << 23) - 1, "0.001");
    for (const char* part : {"Red", "Green", "Blue"})
        scan.prototype += e57::integer_field(fmt::format("color{}", part), 0, 255);
    std::vector<e57::BitStream> axes;
    std::vector<std::string> colors;
    const auto begin = [&] {
        axes.assign(3, e57::BitStream{24});
        colors.assign(3, "");
    };
    const auto end = [&] {
        std::vector<std::string> streams;
        for (const auto& axis : axes) streams.push_back(axis.bytes);
        streams.insert(streams.end(), colors.begin(), colors.end());
        if (!axes[0].bytes.empty()) scan.packets += e57::data_packet(streams);
        begin();
    };
    begin();
    LUCARNE_TRY(for_each_record(source, [&](const std::byte* record) {
        const auto p = io::position_of(source.schema(), record);
        for (int axis = 0; axis < 3; ++axis)
            axes[static_cast<size_t>(axis)].add(
                static_cast<uint64_t>(static_cast<int64_t>(1000 * p[axis]) + (1 << 23)));
        for (std::string& color : colors) color += static_cast<char>(scan.records % 251);
        if (++scan.records % kPacketPoints == 0) end();
    }));
    end();
    std::ofstream out(path, std::ios::binary);
    out << e57::BuiltFile{{scan}}.bytes();
    return out.flush() ? Result<void>() : failed(path.string(), "cannot be written");
}

/// Reads 4M points of the nave in every format that has a target. The files are in the page cache, so only
/// the processor matters.
inline Result<void> bench_formats(const BenchRun& run) {
    const std::string scan = run.folder / "formats.las";
    LUCARNE_TRY(run_lucarne(
        {"generate", "nave", "-o", scan, "--points", std::to_string(run.points(4'000'000)), "--overwrite"}));
    LUCARNE_ASSIGN(const auto source, io::open_scan(scan));
    const auto path = [&](const char* name) { return run.folder / name; };
    LUCARNE_ASSIGN(const auto laz, io::create_scan(path("formats.laz"), source->schema(), source->info(),
                                                   {.overwrite = true}));
    const uint32_t stride = source->schema().stride;
    Result<void> written;
    LUCARNE_TRY(for_each_record(*source, [&](const std::byte* record) {
        if (written) written = laz->write({record, stride});
    }));
    LUCARNE_TRY(written);
    LUCARNE_TRY(laz->finish());
    LUCARNE_TRY(bench_reading("LAZ, point format 7 in layers", path("formats.laz"), "M/s", 2.5));
    LUCARNE_TRY(write_e57(*source, path("formats.e57")));
    LUCARNE_TRY(bench_reading("E57, scaled integers and colour", path("formats.e57"), "M/s", 3));
    LUCARNE_TRY(write_text(*source, path("formats.xyz"), "", false));
    LUCARNE_TRY(bench_reading("text, six columns", path("formats.xyz"), "M/s", 4));
    const std::string header = fmt::format(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float "
        "z\nproperty "
        "uchar red\nproperty uchar green\nproperty uchar blue\nproperty float nx\nproperty float "
        "ny\nproperty float "
        "nz\nend_header\n",
        source->info().declared_points);
    LUCARNE_TRY(write_text(*source, path("formats.ply"), header, true));
    LUCARNE_TRY(bench_reading("ASCII PLY, nine columns", path("formats.ply"), "M/s", 4));
    return bench_reading("LAS (as fast as a disk of 2 GB/s gives)", scan, "M/s", 2000.0 / 36);
}

}  // namespace lucarne::bench
