// LAS 1.0-1.5, point formats 0-10 (wave packets are skipped). Source: see header.h.
#include "io/formats/las/laz/reader.h"

#include <algorithm>
#include <atomic>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/formats/common/buffered_input.h"
#include "io/formats/common/color_depth.h"
#include "io/formats/common/divisible.h"
#include "io/formats/common/format.h"
#include "io/formats/common/pick.h"
#include "io/formats/common/stations.h"
#include "io/formats/crs/frame.h"
#include "io/formats/las/bounds.h"
#include "io/formats/las/crs.h"
#include "io/formats/las/layout.h"
#include "io/formats/las/writer.h"

namespace lucarne::io {
namespace {

class LasReader final : public PointReader {
 public:
    /// Reads the points [first, end).
    LasReader(std::shared_ptr<const ByteSource> file, const las::Header& header, const Schema& schema,
              uint64_t first, uint64_t end)
        : input_(std::move(file), header.points_offset + first * header.record_length,
                 header.points_offset + end * header.record_length),
          header_(header),
          schema_(schema),
          left_(end - first),
          behind_(header.points - end) {}

    Result<size_t> read(PointBatch& batch, size_t most) override {
        const auto wanted = static_cast<size_t>(std::min<uint64_t>(batch_limit(schema_, most), left_));
        batch.bytes.resize(wanted * schema_.stride);
        batch.count = 0;
        while (batch.count < wanted) {
            LUCARNE_ASSIGN(const auto bytes, input_.peek(header_.record_length));
            const size_t count = std::min(bytes.size() / header_.record_length, wanted - batch.count);
            if (count == 0)
                return rejected(input_.path(),
                                fmt::format("ends early: {} points are missing", left_ + behind_));
            las::decode(header_, bytes.data(), count, batch.bytes.data() + batch.count * schema_.stride,
                        schema_.stride);
            input_.skip(count * header_.record_length);
            batch.count += count;
            left_ -= count;
        }
        return batch.count;
    }
    uint64_t dropped() const override { return 0; }  // integers are finite, and so are scale and offset

 private:
    BufferedInput input_;
    const las::Header& header_;
    const Schema& schema_;
    uint64_t left_, behind_;  ///< points of this pass, and after it
};

/// Passes on the points of a reader, and warns once per source about points far outside the box that the
/// header states. It checks every eighth point, because damage comes in longer runs.
class WatchedReader final : public PointReader {
 public:
    WatchedReader(std::unique_ptr<PointReader> reader, const std::string& name,
                  const las::StatedBounds& bounds, const Schema& schema, std::atomic<bool>& warned)
        : reader_(std::move(reader)), name_(name), bounds_(bounds), schema_(schema), warned_(warned) {}

    Result<size_t> read(PointBatch& batch, size_t most) override {
        LUCARNE_ASSIGN(const size_t got, reader_->read(batch, most));
        if (warned_) return got;
        const auto found = bounds_.outside(batch.bytes.data(), got, schema_.stride, 8);
        if (!found || warned_.exchange(true)) return got;
        const glm::dvec3 at = position_of(schema_, &batch.bytes[*found * schema_.stride]);
        log::warn(
            "{}: has points far outside the bounds that its header states, one at {:.6g} {:.6g} {:.6g}; it "
            "may be damaged",
            name_, at.x, at.y, at.z);
        return got;
    }
    uint64_t dropped() const override { return reader_->dropped(); }
    Losses losses() const override { return reader_->losses(); }

 private:
    std::unique_ptr<PointReader> reader_;
    const std::string& name_;
    const las::StatedBounds& bounds_;
    const Schema& schema_;
    std::atomic<bool>& warned_;
};

class LasSource final : public PointSource, public DivisibleSource {
 public:
    LasSource(std::shared_ptr<const ByteSource> file, las::Header header)
        : file_(std::move(file)),
          header_(std::move(header)),
          bounds_(header_),
          schema_(las::make_schema(header_)) {}

    Result<void> describe(const ReadOptions& options) {
        const std::string name = file_->path().string();
        if (header_.compressed) LUCARNE_TRY(find_chunks(options));
        info_.path = name;
        info_.format =
            fmt::format("{} 1.{}, point format {}", compressed_ ? "LAZ" : "LAS", header_.minor,
                        header_.wave_bytes ? las::with_waves(header_.point_format) : header_.point_format);
        if (header_.wave_bytes) skip_waves();
        if (!options.quiet) warn_of_mirrors(name);
        if (header_.find("lascompatible", 22204))
            log::warn(
                "{}: is LAS 1.4 stored as an older version (LASzip's compatibility mode); classes, returns "
                "and angles that do not fit the older version are only in extra bytes",
                name);
        info_.declared_points = header_.points;
        info_.file_bytes = file_->size();
        info_.modified = file_->modified();
        const las::Units units = las::units_of(header_);
        las::warn_of_units(name, units, options.metres_per_unit.has_value());
        const auto system = las::coordinate_system(header_);
        info_.stated_box = las::stated_box(header_);
        const bool placed = !system.name.empty() || system.epsg != 0;
        if (units.degrees || (!placed && like_degrees(info_.stated_box, header_.scale)))
            warn_of_degrees(name, info_.stated_box, units.degrees);
        warn_of_earth_centre(name, info_.stated_box);
        auto unit = units.horizontal;
        if (!unit && placed) unit = 1.0;  // a system has a unit: metres are assumed
        set_unit(info_, options, unit);
        info_.coordinate_system = system.name;
        info_.epsg = system.epsg;
        info_.losses = header_.losses;
        if (const las::Vlr* poses = header_.find(las::kOurUser, las::kStationsRecord)) {
            LUCARNE_ASSIGN(info_.stations, stations_from_json(name, poses->text()));
        }
        info_.color_bits = sampled_color_bits(*this);
        LasNotes kept = header_;
        kept.minor = std::min<uint8_t>(kept.minor, 4);  // LAS 1.5 is not written
        kept.record_length = static_cast<uint16_t>(kept.record_length - header_.wave_bytes);
        info_.notes.las = std::move(kept);
        info_.notes.color_bits = info_.color_bits;
        return {};
    }

    const Schema& schema() const override { return schema_; }
    const ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<PointReader>> open() const override {
        return watched(compressed_ ? laz::open_points(*compressed_, schema_)
                                   : std::make_unique<LasReader>(file_, header_, schema_, 0, header_.points));
    }
    Result<uint64_t> cut(uint64_t point) const override {
        point = std::min(point, header_.points);
        return compressed_ ? laz::chunk_begin(*compressed_, point).point : point;
    }
    Result<std::unique_ptr<PointReader>> open_part(uint64_t first, uint64_t end) const override {
        end = std::min(end, header_.points);
        if (first > end) return failed(info_.path, "has no such points");
        if (!compressed_) return watched(std::make_unique<LasReader>(file_, header_, schema_, first, end));
        const auto from = laz::chunk_begin(*compressed_, first), to = laz::chunk_begin(*compressed_, end);
        if (from.point != first || to.point != end) return failed(info_.path, "cannot be divided there");
        return watched(laz::open_points(*compressed_, schema_, from.chunk, to.chunk));
    }
    bool seekable() const override { return !compressed_; }
    size_t parts() const override {
        return compressed_ ? std::max<size_t>(1, compressed_->chunks.size()) : 1;
    }
    Result<void> front(size_t part, size_t most, PointBatch& batch) const override {
        if (!compressed_ || compressed_->chunks.empty()) return PointSource::front(part, most, batch);
        LUCARNE_ASSIGN(const auto raw, laz::decode_chunk(*compressed_, part, batch_limit(schema_, most)));
        batch.count = raw.size() / header_.record_length;
        batch.bytes.resize(batch.count * schema_.stride);
        las::decode(header_, raw.data(), batch.count, batch.bytes.data(), schema_.stride);
        return {};
    }
    Result<void> pick(std::span<const uint64_t> indices, PointBatch& batch) const override {
        if (compressed_) return PointSource::pick(indices, batch);
        batch.bytes.resize(indices.size() * schema_.stride);
        batch.count = 0;
        return for_picked(
            *file_, header_.points_offset, header_.record_length, indices, [&](const std::byte* at) {
                las::decode(header_, at, 1, &batch.bytes[batch.count++ * schema_.stride], schema_.stride);
            });
    }

 private:
    std::unique_ptr<PointReader> watched(std::unique_ptr<PointReader> reader) const {
        return std::make_unique<WatchedReader>(std::move(reader), info_.path, bounds_, schema_, warned_);
    }
    /// A negative scale is valid, but hardly ever intended.
    void warn_of_mirrors(const std::string& name) const {
        for (int axis = 0; axis < 3; ++axis)
            if (header_.scale[axis] < 0)
                log::warn(
                    "{}: its scale for {} is negative ({}): the scan is mirrored unless this is intended",
                    name, "xyz"[axis], header_.scale[axis]);
    }

    void skip_waves() {
        add_loss(header_.losses, "wave packets of points, which are not read", header_.points);
        // Descriptors (100 to 354) and packets (65535), to which nothing refers any more.
        std::erase_if(header_.vlrs, [](const las::Vlr& vlr) {
            const bool wave = (vlr.record_id >= 100 && vlr.record_id < 355) || vlr.record_id == 65535;
            return vlr.user_id == las::kSpecUser && wave;
        });
        constexpr uint16_t kWaveBits = 6;  // packets inside the file, or in another file
        header_.global_encoding &= static_cast<uint16_t>(~kWaveBits);
    }

    Result<void> find_chunks(const ReadOptions& options) {
        LUCARNE_ASSIGN(auto compression, laz::read_compression(file_->path().string(), header_));
        LUCARNE_ASSIGN(auto chunks, laz::read_chunks(*file_, header_, compression, options.salvage));
        uint64_t there = 0, left_out = 0;
        for (const auto& chunk : chunks) {
            there += chunk.taken();
            left_out += chunk.left_out;
        }
        add_loss(header_.losses, lost::cut_off, header_.points - std::min(there, header_.points));
        add_loss(header_.losses, lost::uncounted, left_out);
        if (left_out > 0 && !options.quiet)
            log::warn("{}: its header counts {} points, {} more follow; --salvage reads them",
                      file_->path().string(), there, left_out);
        header_.points = there;
        compressed_ = laz::Points{file_, header_, std::move(compression), std::move(chunks), options.salvage};
        // Records that a writer of plain LAS must not repeat.
        std::erase_if(header_.vlrs,
                      [](const las::Vlr& vlr) { return vlr.user_id == laz::kUser || vlr.user_id == "copc"; });
        return {};
    }

    std::shared_ptr<const ByteSource> file_;
    las::Header header_;
    las::StatedBounds bounds_;
    std::optional<laz::Points> compressed_;
    Schema schema_;
    ScanInfo info_;
    mutable std::atomic<bool> warned_ = false;
};

Result<std::unique_ptr<PointSource>> open_las(std::shared_ptr<const ByteSource> file,
                                              const ReadOptions& options) {
    LUCARNE_ASSIGN(auto header, las::read_header(*file, options.salvage));
    auto source = std::make_unique<LasSource>(std::move(file), std::move(header));
    LUCARNE_TRY(source->describe(options));
    return source;
}

}  // namespace

const Format& las_format() {
    static constexpr Format kFormat{
        "LAS", ".las", [](std::string_view head) { return head.starts_with("LASF"); }, open_las, las::create};
    return kFormat;
}

const Format&
laz_format() {  // opened like LAS: only the header, beyond what `recognises` sees, tells them apart
    static constexpr Format kFormat{"LAZ", ".laz", [](std::string_view) { return false; }, open_las,
                                    las::create_compressed};
    return kFormat;
}

}  // namespace lucarne::io
