#include "octree/export/export.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include <glm/common.hpp>

#include "io/core/progress.h"
#include "io/formats/copc/writer.h"
#include "io/formats/merged_info.h"
#include "octree/convert/sampling/node_sampler.h"
#include "octree/tree/stored_names.h"

namespace lucarne::octree {
namespace {

constexpr size_t kBatchPoints = 1 << 16;  // so that an overfull node is not copied as a whole

/// Returns the common lattice of the integer positions that the scans had in their files; empty unless all
/// were LAS files.
std::optional<io::Lattice> lattice_of(const SourceHeader& header) {
    std::vector<io::Lattice> lattices;
    for (const auto& scan : header.scans) {
        const auto lattice = io::las::lattice_of(scan);
        if (!lattice) return std::nullopt;
        lattices.push_back(*lattice);
    }
    return io::common_lattice(lattices, {header.min, header.max});
}

}  // namespace

Result<void> check_precision(const SourceHeader& header, double precision) {
    const glm::dvec3 half = (header.max - header.min) / 2.0;
    if (header.points == 0 || std::max({half.x, half.y, half.z}) / precision < 2e9) return {};
    return bad_arguments("--precision", "positions so fine do not fit 32-bit integers", "give a larger one");
}

Exporter::Exporter(const NodeSource& source, const ExportOptions& options)
    : source_(source), options_(options), normals_(source.header().schema) {
    const auto& header = source.header();
    const auto chosen = [&](std::string_view name) {
        return options.attributes.empty() ||
               std::ranges::find(options.attributes, name) != options.attributes.end();
    };
    const bool estimated = header.schema.find(io::names::normal_oct) && chosen(io::names::normal) &&
                           (options.normals || replaces_normals(header.schema));
    // Where another attribute is written under a name, the input's attribute keeps its stored name, and so do
    // longer names made from it.
    const auto taken = [&](std::string_view name) {
        const bool normal = name == io::names::normal;
        const bool written =
            (normal && estimated) || ((normal || name == io::names::scan) && header.schema.find(name));
        return written && header.schema.find(std::string(name).append(kForeign)) != nullptr;
    };
    schema_.position = header.schema.position;
    schema_.scale = header.schema.scale;
    schema_.offset = header.schema.offset;
    if (options.precision > 0) {
        schema_.position = io::PositionType::i32_scaled;
        schema_.scale = glm::dvec3(options.precision);
        const glm::dvec3 middle = header.points ? (header.min + header.max) / 2.0 : glm::dvec3(0.0);
        schema_.offset = glm::round(middle / options.precision) * options.precision;
    }
    schema_.stride = static_cast<uint32_t>(io::position_bytes(schema_.position));
    if (!(options.precision > 0)) copies_.push_back({0, 0, schema_.stride});
    for (const auto& attribute : header.schema.attributes) {
        if (is_estimate(attribute.name)) continue;
        const bool keeps = taken(reserved_name(attribute.name));
        const std::string name = keeps ? attribute.name : name_in_file(attribute.name);
        if (!chosen(name)) continue;
        schema_.add(name, attribute.type, attribute.components);
        copies_.push_back(
            {attribute.offset, schema_.attributes.back().offset, static_cast<uint32_t>(attribute.bytes())});
    }
    if (estimated && !schema_.find(io::names::normal))
        schema_.add(std::string(io::names::normal), io::ScalarType::f32, 3);
    if (estimated) normal_ = *schema_.find(io::names::normal);

    info_ = io::merged_info(header.scans);
    info_.declared_points = header.points;
    info_.metres_per_unit = header.metres_per_unit;
    find_narrow_colours();
}

void Exporter::find_narrow_colours() {
    const auto& header = source_.header();
    const auto* color = schema_.find(io::names::color);
    if (!color || color->type != io::ScalarType::u16 || color->components != 3) return;
    const ScanNumber scan(header.schema);
    if (!scan) return;
    std::vector<bool> narrow;
    for (const auto& each : header.scans) narrow.push_back(each.color_bits <= 8);
    if (std::ranges::adjacent_find(narrow, std::not_equal_to{}) == narrow.end()) return;  // all are alike
    spread_ = {std::move(narrow), scan, color->offset};
    info_.color_bits = 16;
}

uint32_t Exporter::wanted(uint32_t node) const {
    const NodeInfo& info = source_.nodes()[node];
    if (options_.meets && !options_.meets(source_.header().root.of(info.key))) return 0;
    const double least = options_.spacing * options_.spacing;
    for (size_t step = 0; step < kPrefixSteps; ++step)
        if (info.area_floor[step] >= least) return info.count >> step;
    if (info.parent != kNoNode) return 0;  // coarser nodes are dense enough
    const double share = info.area_floor.back() / least / (1 << (kPrefixSteps - 1));
    return static_cast<uint32_t>(std::ceil(info.count * share));
}

void Exporter::append(const NodeData& data, size_t first, size_t count, uint64_t& passed,
                      std::vector<std::byte>& records) const {
    const io::Schema& schema = source_.header().schema;
    records.reserve(records.size() + count * schema_.stride);
    for (size_t i = 0; i < count; ++i) {
        const std::byte* in = &data.records[(first + i) * schema.stride];
        if (options_.keeps && !options_.keeps(io::position_of(schema, in), in)) continue;
        if (passed++ % options_.every != 0) continue;
        records.resize(records.size() + schema_.stride);
        std::byte* out = &records[records.size() - schema_.stride];
        for (const Copy& copy : copies_) std::memcpy(out + copy.to, in + copy.from, copy.bytes);
        if (options_.precision > 0) {
            const glm::dvec3 steps =
                glm::round((io::position_of(schema, in) - schema_.offset) / options_.precision);
            for (int axis = 0; axis < 3; ++axis) io::store(out + 4 * axis, static_cast<int32_t>(steps[axis]));
        }
        if (!spread_.narrow.empty()) spread_colour(in, out);
        if (!normal_) continue;
        const glm::vec3 normal = normals_.of(in);
        for (int axis = 0; axis < 3; ++axis)
            io::store_scalar(
                normal_->type,
                out + normal_->offset + static_cast<size_t>(axis) * io::scalar_bytes(normal_->type),
                normal[axis]);
    }
}

void Exporter::spread_colour(const std::byte* in, std::byte* out) const {
    constexpr uint32_t kFactor = 65535 / 255;
    const uint32_t scan = spread_.scan.of(in);
    if (scan >= spread_.narrow.size() || !spread_.narrow[scan]) return;
    for (std::byte* color = out + spread_.color; color < out + spread_.color + 6; color += 2)
        io::store(color, static_cast<uint16_t>(std::min(io::load<uint16_t>(color) * kFactor, 65535u)));
}

io::WriteOptions Exporter::write_options(bool overwrite) const {
    const SourceHeader& header = source_.header();
    io::WriteOptions options{.overwrite = overwrite, .expected_points = header.points};
    options.bounds = {header.min, header.max};
    options.lattice = lattice_of(header);
    options.preview = [this](const auto& visit) -> Result<void> {
        Progress progress("looking at all values", source_.header().points, "points");
        return visit_batches([&](std::span<const std::byte> records, uint64_t points) -> Result<bool> {
            progress.add(points);
            return visit(records);
        });
    };
    return options;
}

Result<void> Exporter::check_cancelled() const {
    return options_.cancelled && options_.cancelled() ? failed("export", "was cancelled") : Result<void>();
}

Result<void> Exporter::visit_batches(
    const std::function<Result<bool>(std::span<const std::byte>, uint64_t)>& visit) const {
    std::vector<std::byte> records;
    uint64_t passed = 0;
    for (uint32_t node = 0; node < source_.nodes().size(); ++node) {
        const uint32_t count = wanted(node);
        uint64_t left = source_.nodes()[node].count;  // points of the node that are not yet done
        if (count == 0) {
            LUCARNE_ASSIGN(const bool more, visit({}, left));
            if (!more) return {};
            continue;
        }
        LUCARNE_ASSIGN(const NodeData data, source_.load(node));
        for (size_t first = 0; first < count; first += kBatchPoints) {
            const size_t batch = std::min(kBatchPoints, count - first);
            LUCARNE_TRY(check_cancelled());
            records.clear();
            append(data, first, batch, passed, records);
            const uint64_t done = first + batch < count ? batch : left;
            left -= done;
            LUCARNE_ASSIGN(const bool more, visit(records, done));
            if (!more) return {};
        }
    }
    return source_.directory_state();
}

Result<uint64_t> Exporter::write(io::PointWriter& writer,
                                 const std::function<void(uint64_t)>& progress) const {
    uint64_t written = 0;
    const auto write_batch = [&](std::span<const std::byte> records, uint64_t points) -> Result<bool> {
        LUCARNE_TRY(writer.write(records));
        written += records.size() / schema_.stride;
        progress(points);
        return true;
    };
    LUCARNE_TRY(visit_batches(write_batch));
    LUCARNE_TRY(writer.finish());
    return written;
}

Result<void> Exporter::append_node(uint32_t node, bool below, uint64_t& passed,
                                   std::vector<std::byte>& records) const {
    if (const uint32_t count = wanted(node); count > 0) {
        LUCARNE_ASSIGN(const NodeData data, source_.load(node));
        append(data, 0, count, passed, records);
    }
    const NodeInfo& info = source_.nodes()[node];
    for (uint32_t octant = 0; below && octant < 8; ++octant)
        if (const uint32_t child = info.child(octant); child != kNoNode)
            LUCARNE_TRY(append_node(child, true, passed, records));
    return {};
}

Result<uint64_t> Exporter::write_copc(const std::filesystem::path& path, bool overwrite,
                                      const std::function<void(uint64_t)>& progress) const {
    const SourceHeader& header = source_.header();
    io::copc::Info cube;
    cube.half_size = header.root.size / 2;
    cube.centre = header.root.min + cube.half_size;
    cube.spacing = header.root.size * kNodeSpacing;
    LUCARNE_ASSIGN(const auto writer,
                   io::copc::NodeWriter::create(path, schema_, info_, write_options(overwrite), cube));
    const auto nodes = source_.nodes();
    std::vector<std::byte> records;
    uint64_t passed = 0, written = 0;
    for (uint32_t node = 0; node < nodes.size(); ++node) {
        const NodeKey& key = nodes[node].key;
        if (key.level > kMaxLevel) continue;
        LUCARNE_TRY(check_cancelled());
        records.clear();
        LUCARNE_TRY(append_node(node, key.level == kMaxLevel, passed, records));
        LUCARNE_TRY(writer->write({key.level, key.x, key.y, key.z}, records));
        written += records.size() / schema_.stride;
        progress(key.level == kMaxLevel ? nodes[node].subtree_count : nodes[node].count);
    }
    LUCARNE_TRY(source_.directory_state());
    LUCARNE_TRY(writer->finish());
    return written;
}

}  // namespace lucarne::octree
