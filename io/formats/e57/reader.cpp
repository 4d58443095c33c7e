// E57 (ASTM E2807-11), read only: several scans become one stream of points. See e57/*.h.
#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "io/core/counted.h"
#include "io/core/log.h"
#include "io/formats/common/format.h"
#include "io/formats/common/value_range.h"
#include "io/formats/crs/frame.h"
#include "io/formats/crs/wkt.h"
#include "io/formats/e57/layout.h"

namespace lucarne::io {
namespace {

/// Everything that is read of a file except its points.
struct E57 {
    std::shared_ptr<const ByteSource> file;
    e57::Document document;
    std::vector<e57::Section> sections;  ///< one per scan; empty for a scan without records
    e57::Layout layout;
    bool salvage = false;
    Losses losses;
};

class E57Reader final : public PointReader {
 public:
    explicit E57Reader(const E57& e57) : E57Reader(e57, 0, e57.document.scans.size()) {}
    /// Reads only the scans [first, last).
    E57Reader(const E57& e57, size_t first, size_t last) : e57_(e57), next_(first), last_(last) {}

    Result<size_t> read(PointBatch& batch, size_t most) override {
        const Schema& schema = e57_.layout.schema;
        const size_t wanted = batch_limit(schema, most);
        batch.bytes.clear();
        batch.count = 0;
        while (batch.count < wanted) {
            if (!records_ && !open_next()) break;
            const size_t block = std::min(wanted - batch.count, e57::kBlockRecords);
            LUCARNE_ASSIGN(const size_t count, records_->read(block));
            if (count == 0) {
                add_loss(lost_, lost::damaged, records_->missing());
                records_.reset();
                continue;
            }
            batch.bytes.resize((batch.count + count) * schema.stride);
            const auto done =
                e57::convert_block(schema, e57_.document.scans[scan_], e57_.layout.scans[scan_], *records_,
                                   count, batch.bytes.data() + batch.count * schema.stride);
            batch.count += done.kept;
            dropped_ += count - done.kept;
            invalid_ += done.invalid;
            missed_ += done.missed;
        }
        batch.bytes.resize(batch.count * schema.stride);
        return batch.count;
    }
    uint64_t dropped() const override { return dropped_; }
    Losses losses() const override {
        Losses losses;
        add_loss(losses, "points whose state is invalid", invalid_);
        add_loss(losses, "rays that met nothing", missed_);
        add_loss(losses, lost::no_number, dropped_ - invalid_ - missed_);
        add_losses(losses, lost_);
        return losses;
    }

 private:
    bool open_next() {
        const auto& scans = e57_.document.scans;
        while (next_ < last_ && scans[next_].records == 0) ++next_;
        if (next_ >= last_) return false;
        scan_ = next_++;
        records_.emplace(e57_.file, e57_.sections[scan_], scans[scan_], e57_.salvage);
        return true;
    }

    const E57& e57_;
    std::optional<e57::RecordReader> records_;
    size_t scan_ = 0, next_, last_;
    uint64_t dropped_ = 0, invalid_ = 0, missed_ = 0;
    Losses lost_;
};

class E57Source final : public PointSource {
 public:
    E57Source(E57 e57, const ReadOptions& options) : e57_(std::move(e57)) {
        const auto& document = e57_.document;
        info_.path = e57_.file->path().string();
        info_.format = fmt::format("E57 1.0, {}, {}", counted(document.scans.size(), "scans"),
                                   counted(document.images.size(), "images"));
        info_.file_bytes = e57_.file->size();
        info_.modified = e57_.file->modified();
        set_unit(info_, options, 1.0);  // E57 is in metres by definition
        info_.color_bits = e57_.layout.color_bits;
        info_.losses = e57_.losses;
        add_loss(info_.losses, "images ignored", document.images.size());
        const auto system = wkt_system(document.coordinate_system);
        info_.coordinate_system = system.name;
        info_.epsg = system.epsg;
        for (size_t i = 0; i < document.scans.size(); ++i) {
            const e57::Scan& scan = document.scans[i];
            info_.declared_points += scan.records;
            for (const e57::Field& field : scan.fields)
                if (field.kind == e57::Field::Kind::text)
                    add_loss(info_.losses, "texts of points, which are not read", scan.records);
            // Spherical coordinates are relative to the scanner. Others without a pose may be relative to
            // anything.
            if (scan.records > 0 && (scan.pose || e57_.layout.scans[i].spherical))
                info_.stations.push_back(
                    {e57_.layout.scans[i].station, scan.pose ? scan.pose->translation : glm::dvec3(0.0)});
        }
        info_.notes.e57 = e57::notes_of(document);
        info_.notes.color_bits = info_.color_bits;
        info_.notes.intensity_limits = intensity_limits();
        info_.stated_box = stated_box();
    }

    /// Returns limits that hold for the intensities of all scans.
    std::optional<IntensityLimits> intensity_limits() const {
        std::optional<IntensityLimits> all;
        for (const e57::Scan& scan : e57_.document.scans) {
            if (scan.records == 0 || !scan.find(names::intensity)) continue;
            if (!scan.intensity_limits) return std::nullopt;
            const auto [low, high] = *scan.intensity_limits;
            all = all ? IntensityLimits{std::min(all->low, low), std::max(all->high, high)}
                      : IntensityLimits{low, high};
        }
        return all;
    }
    /// Returns the box of the boxes that the scans state, in the file's frame. Empty if a scan states none or
    /// is turned: the box of its turned box would be larger than that of its points.
    std::optional<std::array<glm::dvec3, 2>> stated_box() const {
        std::optional<std::array<glm::dvec3, 2>> all;
        for (const e57::Scan& scan : e57_.document.scans) {
            if (scan.records == 0) continue;
            const e57::Pose pose = scan.pose.value_or(e57::Pose{});
            if (!scan.bounds || pose.rotation != glm::dmat3(1.0)) return std::nullopt;
            const glm::dvec3 low = scan.bounds->front() + pose.translation,
                             high = scan.bounds->back() + pose.translation;
            if (!glm::all(glm::lessThanEqual(low, high))) return std::nullopt;
            all = all ? std::array{glm::min(all->front(), low), glm::max(all->back(), high)}
                      : std::array{low, high};
        }
        return all;
    }
    const Schema& schema() const override { return e57_.layout.schema; }
    const ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<PointReader>> open() const override { return std::make_unique<E57Reader>(e57_); }
    size_t parts() const override { return std::max<size_t>(1, e57_.document.scans.size()); }
    Result<void> front(size_t part, size_t most, PointBatch& batch) const override {
        E57Reader reader(e57_, part, std::min(part + 1, e57_.document.scans.size()));
        batch.bytes.clear();
        batch.count = 0;
        return read_up_to(reader, schema(), batch_limit(schema(), most), batch);
    }

 private:
    E57 e57_;
    ScanInfo info_;
};

/// The text of the XML section.
struct Xml {
    std::string text;
    std::set<uint64_t> wrong_pages;  ///< with `salvage`
};
Result<Xml> read_xml(const std::shared_ptr<const ByteSource>& file, const e57::FileHeader& header,
                     bool salvage) {
    if (header.xml_end - header.xml_begin > e57::kMostXmlBytes)
        return rejected(file->path().string(),
                        fmt::format("has an XML section of more than {} MiB", e57::kMostXmlBytes >> 20));
    Xml xml;
    if (header.wrong) xml.wrong_pages.insert(0);
    e57::PageInput input(file, header.xml_begin, header.xml_end, salvage);
    while (input.left() > 0) {
        LUCARNE_ASSIGN(const auto bytes, input.peek(1));
        xml.text.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        xml.wrong_pages.insert(input.wrong_pages().begin(), input.wrong_pages().end());
        input.skip(bytes.size());
    }
    return xml;
}

/// Checks that no two scans share bytes with each other or with the XML section.
Result<void> check_apart(const std::string& name, const e57::FileHeader& header, const E57& e57) {
    std::vector<std::pair<uint64_t, uint64_t>> ranges = {{header.xml_begin, header.xml_end}};
    for (size_t i = 0; i < e57.sections.size(); ++i)
        if (e57.document.scans[i].records > 0)
            ranges.emplace_back(e57.sections[i].begin, e57.sections[i].end);
    std::sort(ranges.begin(), ranges.end());
    for (size_t i = 1; i < ranges.size(); ++i)
        if (ranges[i].first < ranges[i - 1].second) return rejected(name, "has sections that overlap");
    return {};
}

/// Reads the section of a scan. `constant` counts the points of all scans that take no bytes: a file may have
/// kMostConstant of them, or one per byte of the file.
Result<e57::Section> checked_section(const std::shared_ptr<const ByteSource>& file,
                                     const e57::FileHeader& header, const e57::Scan& scan, bool salvage,
                                     uint64_t& constant) {
    LUCARNE_ASSIGN(auto section, e57::read_section(file, header, scan, salvage));
    if (e57::record_bits(scan) > 0) return section;
    const uint64_t most = std::max(e57::kMostConstant, file->size());
    if (constant + scan.records > most)
        return rejected(file->path().string(),
                        fmt::format("promises {} points that take no bytes, at most {} are accepted",
                                    constant + scan.records, most));
    constant += scan.records;
    return section;
}

void warn_of_poses(const std::string& name, const e57::Document& document) {
    const auto unturned =
        std::count_if(document.scans.begin(), document.scans.end(),
                      [](const e57::Scan& scan) { return scan.pose && scan.pose->unturned; });
    if (unturned > 0)
        log::warn("{}: the rotation of {} of its {} scans has no length and is ignored", name, unturned,
                  document.scans.size());
}

/// Finds out whether a scan has rays that hit nothing and are neither left out nor marked as invalid: many
/// points exactly at its origin, where the scanner stood and can measure nothing. Looks at the first records
/// of the scan. Points on a lattice may be there by chance, unless they form a grid of rays.
Result<bool> has_missed_rays(const E57& e57, size_t index) {
    constexpr size_t kBlocks = 16, kFew = 8;
    const e57::Scan& scan = e57.document.scans[index];
    const e57::ScanLayout& layout = e57.layout.scans[index];
    if (scan.records == 0) return false;  // it may have no coordinates
    const bool grid = layout.spherical || scan.find("rowIndex") || scan.find("columnIndex");
    const bool lattice =
        std::ranges::any_of(layout.coordinates, [&](size_t field) { return scan.fields[field].whole(); });
    if (e57::record_bits(scan) == 0 || layout.invalid || (lattice && !grid)) return false;
    e57::RecordReader reader(e57.file, e57.sections[index], scan, true);
    size_t seen = 0, zero = 0;
    for (size_t block = 0; block < kBlocks; ++block) {
        auto count = reader.read(e57::kBlockRecords);
        if (!count && count.error().kind != ErrorKind::input_rejected)
            return tl::unexpected(std::move(count).error());
        if (!count || *count == 0) break;
        seen += *count;
        zero += e57::count_at_origin(scan, layout, reader, *count);
    }
    return zero > kFew && zero < seen;
}

/// E57 is in metres by definition, whatever unit its coordinate system uses.
void warn_of_unit(const std::string& name, const e57::Document& document) {
    const SystemUnits units = wkt_units(document.coordinate_system);
    if (units.degrees)
        log::warn("{}: its coordinate system is in degrees, but E57 is in metres; metres are assumed", name);
    else if (units.horizontal.value_or(1.0) != 1.0)
        log::warn(
            "{}: its coordinate system is in units of {:.9g} m, but E57 is in metres; metres are assumed; "
            "use --unit if that is wrong",
            name, *units.horizontal);
    const auto whole = [](const e57::Scan& scan) {
        const auto fields = scan.find({"cartesianX", "cartesianY", "cartesianZ"});
        return fields && std::ranges::all_of(*fields, [&](size_t field) {
                   return scan.fields[field].kind == e57::Field::Kind::integer;
               });
    };
    if (std::ranges::any_of(document.scans, whole))
        log::warn("{}: its coordinates are whole numbers of metres; if they are millimetres, use --unit mm",
                  name);
}

Result<std::unique_ptr<PointSource>> open_e57(std::shared_ptr<const ByteSource> file,
                                              const ReadOptions& options) {
    const std::string name = file->path().string();
    LUCARNE_ASSIGN(const auto header, e57::read_file_header(file, options.salvage));
    LUCARNE_ASSIGN(Xml xml, read_xml(file, header, options.salvage));
    E57 e57;
    LUCARNE_ASSIGN(e57.document, e57::parse_document(name, xml.text));
    add_loss(e57.losses, e57::kWrongPages, xml.wrong_pages.size());
    add_loss(e57.losses, e57::kCutChecksums, header.cut);
    e57.salvage = options.salvage;
    if (!options.quiet) warn_of_poses(name, e57.document);
    if (!options.quiet && !options.metres_per_unit) warn_of_unit(name, e57.document);
    uint64_t constant = 0;
    for (e57::Scan& scan : e57.document.scans) {
        Result<e57::Section> section;
        if (scan.records > 0) section = checked_section(file, header, scan, options.salvage, constant);
        if (!section && (!options.salvage || section.error().kind != ErrorKind::input_rejected))
            return tl::unexpected(std::move(section).error());
        if (!section) {
            add_loss(e57.losses, lost::damaged, scan.records);
            scan.records = 0;
        }
        e57.sections.push_back(section.value_or(e57::Section{}));
    }
    LUCARNE_TRY(check_apart(name, header, e57));
    // All records of most scans. Files of many scans share the number, so that they open as quickly.
    constexpr uint64_t kSampled = uint64_t{1} << 18;
    const uint64_t each = std::max(kSampled / std::max<size_t>(1, e57.sections.size()), e57::kBlockRecords);
    for (size_t i = 0; i < e57.sections.size(); ++i) {
        e57::Scan& scan = e57.document.scans[i];
        if (scan.records == 0 || scan.states_color() || !scan.find(e57::kColorFields)) continue;
        e57::RecordReader records(file, e57.sections[i], scan, options.salvage);
        scan.largest_color = e57::largest_color(scan, records, each);
    }
    LUCARNE_ASSIGN(e57.layout, e57::make_layout(name, e57.document));
    if (file->size() / e57::kPageBytes * e57::kPageContent > header.bytes)
        log::warn("{}: it has more bytes than its header promises; they are ignored", name);
    e57.file = std::move(file);
    for (size_t i = 0; i < e57.document.scans.size(); ++i) {
        LUCARNE_ASSIGN(e57.layout.scans[i].zero_is_missed, has_missed_rays(e57, i));
    }
    auto source = std::make_unique<E57Source>(std::move(e57), options);
    if (!options.quiet) warn_of_earth_centre(name, source->info().stated_box);
    return source;
}

}  // namespace

const Format& e57_format() {
    static constexpr Format kFormat{
        "E57", ".e57", [](std::string_view head) { return head.starts_with("ASTM-E57"); }, open_e57, nullptr};
    return kFormat;
}

}  // namespace lucarne::io
