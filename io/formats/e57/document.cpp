#include "io/formats/e57/document.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "io/formats/common/format.h"
#include "io/formats/common/text.h"

namespace lucarne::io::e57 {
namespace {

constexpr size_t kLongestText = 1024;  ///< of a name or GUID
constexpr size_t kLongestCrs = 65536;

std::string_view trimmed(std::string_view text) {
    const auto space = [](char c) { return is_blank(c) || c == '\n'; };
    while (!text.empty() && space(text.front())) text.remove_prefix(1);
    while (!text.empty() && space(text.back())) text.remove_suffix(1);
    return text;
}

std::string text_of(pugi::xml_node node, size_t longest = kLongestText) {
    return std::string(trimmed(std::string_view(node.text().get())).substr(0, longest));
}

/// Parses the number in an element's text or an attribute. An empty text gives `missing`.
template <class T>
Result<T> number(const std::string& file, std::string_view text, T missing, const std::string& what) {
    text = trimmed(text);
    if (text.empty()) return missing;
    const auto value = parse_number<T>(text);
    bool good = value.has_value();
    if constexpr (std::is_floating_point_v<T>) good = good && std::isfinite(*value);
    if (!good) return rejected(file, fmt::format("has '{}' as {}", text.substr(0, 40), what));
    return *value;
}

Result<double> child_number(const std::string& file, pugi::xml_node node, const char* name) {
    return number(file, node.child(name).text().get(), 0.0, fmt::format("{}", name));
}

Result<void> parse_integer(const std::string& file, pugi::xml_node node, Field& field) {
    constexpr auto kLow = std::numeric_limits<int64_t>::min(), kHigh = std::numeric_limits<int64_t>::max();
    const auto read = [&](const char* name, int64_t missing) {
        return number(file, node.attribute(name).value(), missing, fmt::format("{} of {}", name, field.name));
    };
    LUCARNE_ASSIGN(field.minimum, read("minimum", kLow));
    LUCARNE_ASSIGN(field.maximum, read("maximum", kHigh));
    if (field.minimum > field.maximum)
        return rejected(file, fmt::format("has a field {} with a minimum above its maximum", field.name));
    field.bits = static_cast<unsigned>(
        std::bit_width(static_cast<uint64_t>(field.maximum) - static_cast<uint64_t>(field.minimum)));
    return {};
}

Result<Field> parse_field(const std::string& file, pugi::xml_node node) {
    Field field;
    field.name = std::string_view(node.name()).substr(0, kLongestText);
    const std::string_view type = node.attribute("type").value();
    if (type == "Float") {
        const std::string_view precision = node.attribute("precision").value();
        if (!precision.empty() && precision != "single" && precision != "double")
            return rejected(file, fmt::format("has a field {} of unknown precision", field.name));
        field.kind = precision == "single" ? Field::Kind::f32 : Field::Kind::f64;
        field.bits = field.kind == Field::Kind::f32 ? 32 : 64;
    } else if (type == "Integer") {
        field.kind = Field::Kind::integer;
        LUCARNE_TRY(parse_integer(file, node, field));
    } else if (type == "ScaledInteger") {
        field.kind = Field::Kind::scaled;
        LUCARNE_TRY(parse_integer(file, node, field));
        LUCARNE_ASSIGN(field.scale,
                       number(file, node.attribute("scale").value(), 1.0, "scale of " + field.name));
        LUCARNE_ASSIGN(field.offset,
                       number(file, node.attribute("offset").value(), 0.0, "offset of " + field.name));
        if (!usable(field.scale) || !usable(field.offset) || field.scale == 0)
            return rejected(file, fmt::format("has a field {} with a scale of {} and an offset of {}",
                                              field.name, field.scale, field.offset));
    } else if (type == "String") {
        field.kind = Field::Kind::text;
    } else {
        return rejected(file, fmt::format("has a field {} of the type '{}', which cannot be read",
                                          printable(field.name), printable(type)));
    }
    return field;
}

Result<Pose> parse_pose(const std::string& file, pugi::xml_node node) {
    Pose pose;
    const pugi::xml_node rotation = node.child("rotation"), translation = node.child("translation");
    constexpr std::array kAxes = {"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
        LUCARNE_ASSIGN(pose.translation[axis],
                       child_number(file, translation, kAxes[static_cast<size_t>(axis)]));
        if (!usable(pose.translation[axis])) return rejected(file, "has a pose that is too far away");
    }
    if (!rotation) return pose;
    LUCARNE_ASSIGN(double w, child_number(file, rotation, "w"));
    LUCARNE_ASSIGN(double x, child_number(file, rotation, "x"));
    LUCARNE_ASSIGN(double y, child_number(file, rotation, "y"));
    LUCARNE_ASSIGN(double z, child_number(file, rotation, "z"));
    const double squared = w * w + x * x + y * y + z * z;
    pose.unturned = !(squared > 1e-12 && squared < 1e12);
    if (pose.unturned) return pose;  // it cannot be normalised; some writers leave it 0
    // The matrix of a quaternion (Shoemake 1985), column by column; 2 / |q|^2 normalises it.
    const double s = 2.0 / squared;
    pose.rotation = {{1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)},
                     {s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)},
                     {s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)}};
    return pose;
}

Result<void> parse_limits(const std::string& file, pugi::xml_node node, Scan& scan) {
    const pugi::xml_node intensity = node.child("intensityLimits"), color = node.child("colorLimits");
    // A limit may be a ScaledInteger. Its text is then the unscaled integer.
    const auto limit = [&](pugi::xml_node parent, const char* name) -> Result<double> {
        const pugi::xml_node element = parent.child(name);
        LUCARNE_ASSIGN(const double value, number(file, element.text().get(), 0.0, std::string(name)));
        LUCARNE_ASSIGN(const double scale, number(file, element.attribute("scale").value(), 1.0, "a scale"));
        LUCARNE_ASSIGN(const double offset,
                       number(file, element.attribute("offset").value(), 0.0, "an offset"));
        return value * scale + offset;
    };
    if (intensity.child("intensityMaximum")) {
        LUCARNE_ASSIGN(const double low, limit(intensity, "intensityMinimum"));
        LUCARNE_ASSIGN(const double high, limit(intensity, "intensityMaximum"));
        scan.intensity_limits = {low, high};
    }
    for (const char* name : {"colorRedMaximum", "colorGreenMaximum", "colorBlueMaximum"}) {
        if (!color.child(name)) continue;
        LUCARNE_ASSIGN(const double high, limit(color, name));
        scan.color_maximum = std::max(high, scan.color_maximum.value_or(high));
    }
    return {};
}

/// Returns nothing if a side is missing or is no number: the box is not needed.
std::optional<std::array<glm::dvec3, 2>> parse_bounds(pugi::xml_node node) {
    std::array<glm::dvec3, 2> bounds{};
    for (int axis = 0; axis < 3; ++axis)
        for (size_t end = 0; end < 2; ++end) {
            const std::string name = fmt::format("{}{}", "xyz"[axis], end == 0 ? "Minimum" : "Maximum");
            const auto side = parse_number<double>(node.child(name.c_str()).text().get());
            if (!side || !usable(*side)) return std::nullopt;
            bounds[end][axis] = *side;
        }
    return bounds;
}

Result<Scan> parse_scan(const std::string& file, pugi::xml_node node) {
    Scan scan;
    scan.name = text_of(node.child("name"));
    scan.guid = text_of(node.child("guid"));
    const pugi::xml_node points = node.child("points");
    if (std::string_view(points.attribute("type").value()) != "CompressedVector")
        return rejected(file, "has a scan without points");
    constexpr auto kNone = std::numeric_limits<uint64_t>::max();
    LUCARNE_ASSIGN(scan.section,
                   number(file, points.attribute("fileOffset").value(), kNone, "a file offset"));
    LUCARNE_ASSIGN(scan.records,
                   number(file, points.attribute("recordCount").value(), kNone, "a count of records"));
    if (scan.section == kNone || scan.records == kNone)
        return rejected(file, "has a scan whose points have no offset or count");
    for (const pugi::xml_node codec : points.child("codecs").children())
        if (codec.type() == pugi::node_element && !codec.child("bitPackCodec"))
            return rejected(file, "has points compressed by a codec that is not known");
    for (const pugi::xml_node element : points.child("prototype").children()) {
        if (element.type() != pugi::node_element) continue;
        if (scan.fields.size() == kMostFields)
            return rejected(file, fmt::format("has points with more than {} fields", kMostFields));
        LUCARNE_ASSIGN(auto field, parse_field(file, element));
        scan.fields.push_back(std::move(field));
    }
    if (const pugi::xml_node pose = node.child("pose")) {
        LUCARNE_ASSIGN(scan.pose, parse_pose(file, pose));
    }
    LUCARNE_TRY(parse_limits(file, node, scan));
    scan.bounds = parse_bounds(node.child("cartesianBounds"));
    return scan;
}

/// Images are listed but never read, so a malformed image is not an error.
Image parse_image(pugi::xml_node node) {
    Image image;
    image.name = text_of(node.child("name"));
    constexpr std::string_view kSuffix = "Representation";
    for (const pugi::xml_node element : node.children()) {
        std::string_view name = element.name();
        if (!name.ends_with(kSuffix)) continue;
        name.remove_suffix(kSuffix.size());
        image.representation = name.substr(0, kLongestText);
        image.width = element.child("imageWidth").text().as_ullong();
        image.height = element.child("imageHeight").text().as_ullong();
        for (const char* encoding : {"jpeg", "png"}) {
            const pugi::xml_node blob = element.child(fmt::format("{}Image", encoding).c_str());
            if (!blob) continue;
            image.encoding = encoding;
            image.bytes = blob.attribute("length").as_ullong();
        }
    }
    return image;
}

E57Notes::Scan notes_of(const Scan& scan) {
    E57Notes::Scan notes{scan.name, scan.guid, scan.records};
    for (const Field& field : scan.fields) notes.fields.push_back(field.name);
    if (scan.pose) {
        const auto& r = scan.pose->rotation;
        notes.position = scan.pose->translation;
        notes.rotation.emplace();
        for (int row = 0; row < 3; ++row)
            (*notes.rotation)[static_cast<size_t>(row)] = {r[0][row], r[1][row], r[2][row]};
    }
    notes.intensity_limits = scan.intensity_limits;
    notes.color_maximum = scan.color_maximum;
    if (scan.bounds) {
        notes.stated_min = scan.bounds->front();
        notes.stated_max = scan.bounds->back();
    }
    return notes;
}

}  // namespace

int64_t Field::largest() const {
    if (bits >= 64) return std::numeric_limits<int64_t>::max();
    const auto range = static_cast<int64_t>((uint64_t{1} << bits) - 1);
    const bool overflows = minimum > std::numeric_limits<int64_t>::max() - range;
    return overflows ? std::numeric_limits<int64_t>::max() : minimum + range;
}

std::optional<size_t> Scan::find(std::string_view wanted) const {
    const auto found = std::find_if(fields.begin(), fields.end(), [&](const Field& field) {
        return field.name == wanted && field.kind != Field::Kind::text;
    });
    if (found == fields.end()) return std::nullopt;
    return static_cast<size_t>(found - fields.begin());
}

std::optional<std::array<size_t, 3>> Scan::find(const std::array<std::string_view, 3>& names) const {
    std::array<size_t, 3> found{};
    for (size_t i = 0; i < 3; ++i) {
        const auto index = find(names[i]);
        if (!index) return std::nullopt;
        found[i] = *index;
    }
    return found;
}

Result<Document> parse_document(const std::string& file, std::string& xml) {
    if (std::count(xml.begin(), xml.end(), '<') > static_cast<std::ptrdiff_t>(kMostTags))
        return rejected(file, fmt::format("has more than {} tags in its XML section", kMostTags));
    // pugixml knows only the five entities of XML itself and skips document types, so nothing can expand.
    pugi::xml_document tree;
    const auto parsed =
        tree.load_buffer_inplace(xml.data(), xml.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!parsed)
        return rejected(file, fmt::format("has an XML section that is not well-formed: {} at byte {}",
                                          parsed.description(), parsed.offset));
    const pugi::xml_node root = tree.child("e57Root");
    if (!root) return rejected(file, "has an XML section without e57Root");
    Document document;
    document.guid = text_of(root.child("guid"));
    document.library = text_of(root.child("e57LibraryVersion"));
    document.coordinate_system = text_of(root.child("coordinateMetadata"), kLongestCrs);
    for (const pugi::xml_node node : root.child("data3D").children()) {
        if (node.type() != pugi::node_element) continue;
        if (document.scans.size() == kMostScans)
            return rejected(file, fmt::format("has more than {} scans", kMostScans));
        LUCARNE_ASSIGN(auto scan, parse_scan(file, node));
        document.scans.push_back(std::move(scan));
    }
    for (const pugi::xml_node node : root.child("images2D").children())
        if (node.type() == pugi::node_element) document.images.push_back(parse_image(node));
    return document;
}

E57Notes notes_of(const Document& document) {
    E57Notes notes{document.guid,         document.library, document.coordinate_system, {}, {},
                   document.images.size()};
    for (size_t i = 0; i < std::min(document.scans.size(), kMostListed); ++i)
        notes.scans.push_back(notes_of(document.scans[i]));
    for (size_t i = 0; i < std::min(document.images.size(), kMostListed); ++i)
        notes.images.push_back(document.images[i]);
    return notes;
}

}  // namespace lucarne::io::e57
