// PTX: scans as grids, each with the pose of its scanner. Source: Leica Geosystems, "Cyclone PTX format":
// number of columns, number of rows, scanner position, its three axes, a 4x4 matrix for row vectors; then a
// line for each point: x y z intensity [r g b] in the scanner's coordinates, zeros where a ray hit nothing.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "io/formats/common/format.h"
#include "io/formats/common/value_range.h"
#include "io/formats/text/ptx_scans.h"
#include "io/formats/text/row_fronts.h"
#include "io/formats/text/sample.h"

namespace lucarne::io {
namespace {

using namespace text;

using ptx::Scan;

class PtxSource final : public PointSource {
 public:
    PtxSource(std::shared_ptr<const ByteSource> file, const ptx::Scans& found, char line_end,
              const ReadOptions& options)
        : file_(std::move(file)), salvage_(options.salvage) {
        const std::vector<Scan>& scans = found.scans;
        info_.losses = found.losses;
        info_.path = file_->path().string();
        info_.format = fmt::format("PTX, {} {}", scans.size(), scans.size() == 1 ? "scan" : "scans");
        info_.file_bytes = file_->size();
        info_.modified = file_->modified();
        set_unit(info_, options, 1.0);  // the format is in metres
        info_.notes.color_bits = info_.color_bits;
        info_.notes.intensity_limits = {0, 1, true};
        size_t values = 3;
        for (const Scan& scan : scans) values = std::max(values, scan.values);
        if (values >= 4) schema_.add(std::string(names::intensity), ScalarType::f32);
        if (values == 7) schema_.add(std::string(names::color), ScalarType::u8, 3);
        if (scans.size() > 1) schema_.add(std::string(names::point_source_id), ScalarType::u16);
        for (const Scan& scan : scans) {
            const auto id = static_cast<uint32_t>(info_.stations.size() + 1);
            info_.stations.push_back({id, scan.station});
            info_.declared_points += scan.rows;
            if (scan.promised > 0 || scan.rows > 0) sections_.push_back(section_of(scan, id, line_end));
        }
    }

    const Schema& schema() const override { return schema_; }
    const ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<PointReader>> open() const override { return read_rows(file_, sections_); }
    size_t parts() const override { return row_parts(sections_); }
    Result<void> front(size_t part, size_t most, PointBatch& batch) const override {
        return read_row_front(*file_, sections_, part, most, batch);
    }

 private:
    Section section_of(const Scan& scan, uint32_t id, char line_end) const {
        RowLayout layout;
        layout.schema = schema_;
        layout.line_end = line_end;
        layout.zero_is_missed = true;
        layout.salvage = salvage_;
        layout.pose = scan.pose;
        layout.blank.resize(schema_.stride);
        if (const Attribute* source = schema_.find(names::point_source_id))
            store(&layout.blank[source->offset], static_cast<uint16_t>(id));
        constexpr std::array kNames = {"x", "y", "z", "intensity", "red", "green", "blue"};
        for (uint32_t i = 0; i < scan.values; ++i) {
            Field field{Field::Kind::scalar, ScalarType::u8, i, kNames[i]};
            if (i < 3) {
                field.kind = Field::Kind::position;
                field.type = ScalarType::f64;
            } else if (i == 3) {
                field.type = ScalarType::f32;
                field.to = schema_.find(names::intensity)->offset;
            } else {
                field.to = schema_.find(names::color)->offset + i - 4;
            }
            layout.fields.push_back(field);
        }
        return {scan.begin, scan.end, std::move(layout), scan.promised, scan.first_line};
    }

    std::shared_ptr<const ByteSource> file_;
    bool salvage_;
    Schema schema_;
    std::vector<Section> sections_;
    ScanInfo info_;
};

Result<std::unique_ptr<PointSource>> open_ptx(std::shared_ptr<const ByteSource> file,
                                              const ReadOptions& options) {
    std::array<std::byte, 4096> bytes{};
    LUCARNE_ASSIGN(const size_t got, file->read_some(0, bytes));
    const char line_end = line_end_of({reinterpret_cast<const char*>(bytes.data()), got});
    LUCARNE_ASSIGN(const auto found, ptx::find_scans(file, line_end, options.salvage));
    return std::make_unique<PtxSource>(std::move(file), found, line_end, options);
}

}  // namespace

const Format& ptx_format() {
    static constexpr Format kFormat{"PTX", ".ptx", ptx::begins_scan, open_ptx, nullptr, true};
    return kFormat;
}

}  // namespace lucarne::io
