// Writes a section as files: a table of points for other programs, and a drawing.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/files/file.h"
#include "octree/tree/stored_names.h"
#include "viewer/measure/file.h"
#include "viewer/measure/section/section.h"
#include "viewer/overlay/axis_marks.h"

namespace lucarne::viewer {
namespace {

constexpr double kWidth = 1200, kMargin = 70, kMostHeight = 1200;  ///< of a drawing, pixels
constexpr size_t kPiece = size_t{1} << 20;                         ///< bytes of a table written at once
constexpr size_t kMostDots = 50'000;  ///< of a drawing: browsers get slow with more

/// Returns the names of all parts' attributes, in the order of their first appearance.
std::vector<std::string> columns_of(const octree::NodeSource& source) {
    std::vector<std::string> names;
    for (const uint32_t root : source.roots())
        for (const io::Attribute& attribute : source.part_of(root).header.schema.attributes) {
            const bool estimated = attribute.name == io::names::normal_oct;
            if (octree::is_estimate(attribute.name) && !estimated) continue;
            if (estimated && !octree::replaces_normals(source.part_of(root).header.schema)) continue;
            const std::string name = estimated ? std::string(kEstimatedNormal) : attribute.name;
            if (std::ranges::find(names, name) == names.end()) names.push_back(name);
        }
    return names;
}

std::string escaped(std::string_view text) {
    std::string xml;
    for (const char c : text) {
        if (c == '<')
            xml += "&lt;";
        else if (c == '&')
            xml += "&amp;";
        else if (static_cast<unsigned char>(c) >= ' ')
            xml += c;
    }
    return xml;
}

Result<void> write_csv(OutputFile& file, const Section& section, NodeCache& cache) {
    const octree::NodeSource& source = *cache.source();
    const auto columns = columns_of(source);
    std::string csv = "along,across,height,x,y,z";
    for (const std::string& name : columns) csv.append(",").append(csv_field(name));
    csv += "\n";
    for (const SectionPoint& p : section.points) {
        LUCARNE_ASSIGN(const auto data, cache.node(p.place.node));
        if (p.place.index >= data->count) return failed("section", "a node has changed since it was read");
        const size_t stride = source.part_of(p.place.node).header.schema.stride;
        const ExactPoint point = exact_point(source, p.place.node, &data->records[p.place.index * stride]);
        const auto& [x, y, z] = point.coordinates;
        csv += fmt::format("{},{},{},{},{},{}", p.along, p.across, p.height, x, y, z);
        for (const std::string& name : columns) {
            const auto field = std::ranges::find(point.fields, name, &PointField::name);
            csv += ",";
            if (field != point.fields.end()) csv += csv_field(field->value);
        }
        csv += "\n";
        if (csv.size() < kPiece) continue;
        LUCARNE_TRY(file.append(std::string_view(csv)));
        csv.clear();
    }
    return file.append(std::string_view(csv));
}

std::string section_svg(const Section& section, const std::string& title, const UnitChoice& units) {
    const auto& [from, to, thickness] = section.slice;
    const double unit = units.convert(1, Dimension::length);
    const double length = std::hypot(to.x - from.x, to.y - from.y) * unit;
    const double low = section.lowest * unit,
                 range = std::max((section.highest - section.lowest) * unit, 1e-6 * length);
    const double scale = std::min((kWidth - 2 * kMargin) / length, kMostHeight / range);
    const double height = range * scale + 2 * kMargin, base = height - kMargin;
    const std::string name = units.name(Dimension::length);
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
        "font-family=\"sans-serif\" "
        "font-size=\"13\" fill=\"#ddd\">\n<rect width=\"100%\" height=\"100%\" fill=\"#202020\"/>\n<text "
        "x=\"{2}\" "
        "y=\"25\">{3}: {4} "
        "points{5}, {6} thick</text>\n",
        length * scale + 2 * kMargin, height, kMargin, escaped(title), section.points.size(),
        section.complete ? "" : " (a sample)", units.text(thickness, Dimension::length));
    const double step_x = axis_step(length, 10), step_y = axis_step(range, 6);
    for (const double x : axis_marks(0, length * (1 + 1e-9), step_x))
        svg += fmt::format(
            "<path d=\"M{0:.1f} {1:.1f}V{2:.1f}\" stroke=\"#505050\"/><text x=\"{0:.1f}\" y=\"{3:.1f}\" "
            "text-anchor=\"middle\">{4}</text>\n",
            kMargin + x * scale, kMargin, base, base + 18, axis_text(x, step_x));
    for (const double y : axis_marks(low, low + range, step_y))
        svg += fmt::format(
            "<path d=\"M{0} {1:.1f}H{2:.1f}\" stroke=\"#505050\"/><text x=\"{3}\" y=\"{4:.1f}\" "
            "text-anchor=\"end\">{5}</text>\n",
            kMargin, base - (y - low) * scale, kMargin + length * scale, kMargin - 6,
            base - (y - low) * scale + 4, axis_text(y, step_y));
    svg += fmt::format("<text x=\"{}\" y=\"{:.1f}\">along, {}</text>\n", kMargin, base + 38, name);
    const size_t every = section.points.size() / kMostDots + 1;
    for (size_t i = 0; i < section.points.size(); i += every) {
        const SectionPoint& p = section.points[i];
        svg += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"1\" fill=\"#{:02x}{:02x}{:02x}\"/>\n",
                           kMargin + p.along * unit * scale, base - (p.height * unit - low) * scale,
                           p.color[0], p.color[1], p.color[2]);
    }
    return svg + "</svg>\n";
}

}  // namespace

Result<void> write_section(const std::filesystem::path& base, const Section& section,
                           const std::string& title, const UnitChoice& units, NodeCache& cache,
                           bool overwrite) {
    LUCARNE_ASSIGN(auto table, OutputFile::create(base.string() + ".csv", overwrite));
    LUCARNE_ASSIGN(auto drawing, OutputFile::create(base.string() + ".svg", overwrite));
    LUCARNE_TRY(write_csv(table, section, cache));
    LUCARNE_TRY(drawing.append(std::string_view(section_svg(section, title, units))));
    LUCARNE_TRY(table.commit());
    return drawing.commit();
}

}  // namespace lucarne::viewer
