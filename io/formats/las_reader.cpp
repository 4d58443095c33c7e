// LAS 1.0-1.4, point formats 0-10 (wave packets are skipped). Source: see las_header.h.
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/core/log.h"
#include "io/formats/buffered_input.h"
#include "io/formats/format.h"
#include "io/formats/las_crs.h"
#include "io/formats/las_layout.h"
#include "io/formats/las_writer.h"
#include "io/formats/laz/reader.h"
#include "io/formats/pick.h"
#include "io/formats/stations.h"

namespace lucarne::io {
namespace {

class LasReader final : public PointReader {
 public:
    LasReader(std::shared_ptr<const InputFile> file, const las::Header& header, const Schema& schema)
        : input_(std::move(file), header.points_offset,
                 header.points_offset + header.points * header.record_length),
          header_(header),
          schema_(schema),
          left_(header.points) {}

    Result<size_t> read(PointBatch& batch, size_t most) override {
        const auto wanted = static_cast<size_t>(std::min<uint64_t>(batch_limit(schema_, most), left_));
        batch.bytes.resize(wanted * schema_.stride);
        batch.count = 0;
        while (batch.count < wanted) {
            LUCARNE_ASSIGN(const auto bytes, input_.peek(header_.record_length));
            const size_t count = std::min(bytes.size() / header_.record_length, wanted - batch.count);
            if (count == 0)
                return rejected(input_.path(), fmt::format("ends early: {} points are missing", left_));
            las::decode(header_, bytes.data(), count, batch.bytes.data() + batch.count * schema_.stride,
                        schema_.stride);
            input_.skip(count * header_.record_length);
            batch.count += count;
            left_ -= count;
        }
        return batch.count;
    }
    uint64_t dropped() const override { return 0; }  // integers with a finite scale and offset

 private:
    BufferedInput input_;
    const las::Header& header_;
    const Schema& schema_;
    uint64_t left_;
};

class LasSource final : public PointSource {
 public:
    LasSource(std::shared_ptr<const InputFile> file, las::Header header)
        : file_(std::move(file)), header_(std::move(header)), schema_(las::make_schema(header_)) {}

    Result<void> describe(const ReadOptions& options) {
        const std::string name = file_->path().string();
        if (header_.compressed) LUCARNE_TRY(find_chunks(options.salvage));
        info_.path = name;
        info_.format =
            fmt::format("{} 1.{}, point format {}", compressed_ ? "LAZ" : "LAS", header_.minor,
                        header_.wave_bytes ? las::with_waves(header_.point_format) : header_.point_format);
        if (header_.wave_bytes) skip_waves();
        info_.declared_points = header_.points;
        info_.file_bytes = file_->size();
        info_.modified = file_->modified();
        info_.metres_per_unit = las::metres_per_unit(name, header_);
        if (options.metres_per_unit) info_.metres_per_unit = *options.metres_per_unit;
        const auto system = las::coordinate_system(header_);
        info_.coordinate_system = system.name;
        info_.epsg = system.epsg;
        info_.losses = header_.losses;
        if (const las::Vlr* poses = header_.find(las::kOurUser, las::kStationsRecord)) {
            LUCARNE_ASSIGN(info_.stations, stations_from_json(name, poses->text()));
        }
        if (const Attribute* color = schema_.find(names::color)) {
            LUCARNE_ASSIGN(info_.color_bits, sample_color_bits(*color, options.salvage));
        }
        las::Header kept = header_;
        kept.record_length = static_cast<uint16_t>(kept.record_length - kept.wave_bytes);
        nlohmann::json details = las::to_details(kept);
        details["color_bits"] = info_.color_bits;
        info_.details = details.dump();
        return {};
    }

    const Schema& schema() const override { return schema_; }
    const ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<PointReader>> open() const override {
        if (compressed_) return laz::open_points(*compressed_, schema_);
        return std::make_unique<LasReader>(file_, header_, schema_);
    }
    bool seekable() const override { return !compressed_; }
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
    void skip_waves() {
        add_loss(header_.losses, "wave packets of points, which are not read", header_.points);
        // Descriptors (100 to 354) and packets (65535) that nothing points to any more.
        std::erase_if(header_.vlrs, [](const las::Vlr& vlr) {
            const bool wave = (vlr.record_id >= 100 && vlr.record_id < 355) || vlr.record_id == 65535;
            return vlr.user_id == las::kSpecUser && wave;
        });
        constexpr uint16_t kWaveBits = 6;  // packets inside the file, or in another
        header_.global_encoding &= static_cast<uint16_t>(~kWaveBits);
    }

    Result<void> find_chunks(bool salvage) {
        LUCARNE_ASSIGN(auto compression, laz::read_compression(file_->path().string(), header_));
        LUCARNE_ASSIGN(auto chunks, laz::read_chunks(*file_, header_, compression, salvage));
        if (salvage) {
            uint64_t there = 0;
            for (const auto& chunk : chunks) there += chunk.points;
            add_loss(header_.losses, lost::cut_off, header_.points - there);
            header_.points = there;
        }
        compressed_ = laz::Points{file_, header_, std::move(compression), std::move(chunks), salvage};
        // What a writer of plain LAS must not repeat.
        std::erase_if(header_.vlrs,
                      [](const las::Vlr& vlr) { return vlr.user_id == laz::kUser || vlr.user_id == "copc"; });
        return {};
    }

    /// `count` records from point `first` on, or of the chunk where that is, fewer at its end.
    Result<std::vector<std::byte>> raw_records(uint64_t first, uint64_t count) const {
        if (compressed_) {
            size_t chunk = 0;
            for (uint64_t seen = compressed_->chunks[0].points; seen <= first;)
                seen += compressed_->chunks[++chunk].points;
            return laz::decode_chunk(*compressed_, chunk, count);
        }
        std::vector<std::byte> raw(static_cast<size_t>(count * header_.record_length));
        LUCARNE_TRY(file_->read_at(header_.points_offset + first * header_.record_length, raw));
        return raw;
    }

    /// The specification wants colour spread over 16 bits, many writers store 0-255: told by blocks of points
    /// spread evenly over the file. Nothing is converted, so a wrong guess loses nothing.
    Result<uint32_t> sample_color_bits(const Attribute& color, bool salvage) const {
        constexpr uint64_t kBlocks = 64, kBlockPoints = 256;
        const uint64_t step = std::max<uint64_t>(kBlockPoints, header_.points / kBlocks);
        std::vector<std::byte> record(schema_.stride);
        for (uint64_t first = 0; first < header_.points; first += step) {
            const uint64_t count = std::min(kBlockPoints, header_.points - first);
            auto records = raw_records(first, count);
            if (!records && salvage) continue;
            LUCARNE_ASSIGN(const auto raw, std::move(records));
            for (size_t at = 0; at < raw.size(); at += header_.record_length) {
                las::decode(header_, &raw[at], 1, record.data(), schema_.stride);
                for (size_t c = 0; c < 3; ++c)
                    if (load<uint16_t>(&record[color.offset + 2 * c]) > 255) return 16u;
            }
        }
        return 8u;
    }

    std::shared_ptr<const InputFile> file_;
    las::Header header_;
    std::optional<laz::Points> compressed_;
    Schema schema_;
    ScanInfo info_;
};

Result<std::unique_ptr<PointSource>> open_las(std::shared_ptr<const InputFile> file, const ReadOptions& options) {
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
laz_format() {  // opened as LAS: the header tells them apart, further back than `recognises` looks
    static constexpr Format kFormat{"LAZ", ".laz", [](std::string_view) { return false; }, open_las,
                                    las::create_compressed};
    return kFormat;
}

}  // namespace lucarne::io
