#include "io/formats/copc/copc.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "io/formats/common/format.h"
#include "io/formats/copc/hierarchy.h"

namespace lucarne::io::copc {
namespace {

constexpr uint64_t kBoxOffset = 179;  ///< in a LAS header: max x, min x, max y, min y, max z, min z

Result<Info> read_info(const std::string& file, const las::Header& header) {
    const las::Vlr* record = header.find(kUser, kInfoRecord);
    if (!record || record->data.size() < kInfoBytes) return rejected(file, "has no COPC info record");
    const Info info = Info::load(record->data);
    const auto far = [&](double centre) { return std::abs(centre) + info.half_size; };
    if (!(info.half_size > 0) || !usable(far(info.centre.x)) || !usable(far(info.centre.y)) ||
        !usable(far(info.centre.z)))
        return rejected(file, "has a COPC root cube that is no cube");
    return info;
}

}  // namespace

Info Info::load(std::span<const std::byte> data) {
    const auto number = [&](size_t at) { return io::load<double>(&data[8 * at]); };
    const auto offset = [&](size_t at) { return io::load<uint64_t>(&data[8 * at]); };
    return {
        {number(0), number(1), number(2)}, number(3), number(4), offset(5), offset(6), number(7), number(8)};
}

std::vector<std::byte> Info::bytes() const {
    std::vector<std::byte> data(kInfoBytes);
    const auto put = [&](size_t at, auto value) { store(&data[8 * at], value); };
    for (int axis = 0; axis < 3; ++axis) put(static_cast<size_t>(axis), centre[axis]);
    put(3, half_size);
    put(4, spacing);
    put(5, page_offset);
    put(6, page_bytes);
    put(7, gps_low);
    put(8, gps_high);
    return data;
}

bool is_copc(const ByteSource& file) {
    std::array<std::byte, las::header_bytes(4) + 54> bytes{};
    if (file.size() < bytes.size() || !file.read_at(0, bytes)) return false;
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const size_t record = las::header_bytes(4);  // the info record must come first, at this place
    return text.starts_with("LASF") && load<uint8_t>(&bytes[25]) == 4 &&
           load<uint16_t>(&bytes[94]) == record &&
           text.substr(record + 2, kUser.size() + 1) == std::string_view("copc\0", 5) &&
           load<uint16_t>(&bytes[record + 18]) == kInfoRecord &&
           load<uint16_t>(&bytes[record + 20]) >= kInfoBytes;
}

bool is_name(const std::filesystem::path& path) {
    std::string name = path.filename().string();
    std::transform(name.begin(), name.end(), name.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return name.ends_with(".copc.laz");
}

Result<File> File::open(std::shared_ptr<const ByteSource> input) {
    const std::string name = input->path().string();
    if (!is_copc(*input)) return rejected(name, "is no COPC file");
    File file;
    LUCARNE_ASSIGN(auto header, las::read_header(*input));
    LUCARNE_ASSIGN(file.info_, read_info(name, header));
    LUCARNE_ASSIGN(auto compression, laz::read_compression(name, header));
    if (!compression.layered) return rejected(name, "is COPC of a point format other than 6 to 8");
    LUCARNE_ASSIGN(file.nodes_, read_hierarchy(*input, header, file.info_));
    LUCARNE_ASSIGN(file.scan_, las_format().open(input, {}));
    std::vector<laz::ChunkPlace> chunks;
    for (const Node& node : file.nodes_) chunks.push_back(node.chunk);
    header.vlrs.clear();  // scan_ keeps a copy of those that are needed
    file.points_ = {input, std::move(header), std::move(compression), std::move(chunks)};
    LUCARNE_TRY(file.read_box());
    return file;
}

Result<void> File::read_box() {
    std::array<std::byte, 48> bytes{};
    LUCARNE_TRY(points_.file->read_at(kBoxOffset, bytes));
    const glm::dvec3 low = info_.centre - info_.half_size, high = info_.centre + info_.half_size;
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = [&](int i) { return load<double>(&bytes[static_cast<size_t>(16 * axis + 8 * i)]); };
        const double top = at(0), bottom = at(1);
        const bool sound = bottom <= top && top >= low[axis] && bottom <= high[axis];  // NaN: false
        min_[axis] = sound ? std::max(bottom, low[axis]) : low[axis];
        max_[axis] = sound ? std::min(top, high[axis]) : high[axis];
    }
    return {};
}

Result<std::vector<std::byte>> File::read(size_t node) const {
    if (nodes_[node].chunk.points == 0) return std::vector<std::byte>();
    auto records = laz::read_chunk(points_, node, scan_->schema());
    if (!records && records.error().kind == ErrorKind::input_rejected)
        records.error().why += "; only convert can read the rest, as LAZ";
    return records;
}

}  // namespace lucarne::io::copc
