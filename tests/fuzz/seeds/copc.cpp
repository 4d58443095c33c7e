// Makes COPC with Lucarne's own writer: six levels of one octant, so deep that the hierarchy has a second
// page.
#include <stdexcept>

#include "io/formats/copc/writer.h"
#include "tests/fuzz/seeds/seeds.h"

namespace lucarne::fuzz {
namespace {

using namespace io;

Result<void> write(const std::filesystem::path& path, bool color) {
    Schema schema;
    schema.position = PositionType::i32_scaled;
    schema.scale = glm::dvec3(0.01);
    schema.stride = position_bytes(PositionType::i32_scaled);
    schema.add(std::string(names::intensity), ScalarType::u16);
    if (color) schema.add(std::string(names::color), ScalarType::u16, 3);
    copc::Info cube;
    cube.centre = glm::dvec3(8);
    cube.half_size = 8;
    cube.spacing = 0.125;
    LUCARNE_ASSIGN(const auto writer, copc::NodeWriter::create(path, schema, {}, {.overwrite = true}, cube));
    for (uint32_t level = 0; level < 6; ++level) {
        std::vector<std::byte> records((level == 2 ? 0 : 10 + level) *
                                       size_t{schema.stride});  // one without points
        for (size_t i = 0; i < records.size() / schema.stride; ++i)
            for (size_t axis = 0; axis < 3; ++axis)
                store(&records[i * schema.stride + 4 * axis], static_cast<int32_t>((i * 7 + axis) % 40));
        LUCARNE_TRY(writer->write({level, 0, 0, 0}, records));
    }
    return writer->finish();
}

}  // namespace

void copc_seeds(const Seeds& seeds) {
    for (const bool color : {false, true}) {
        const auto path = seeds.folder() / "written.copc.laz";
        if (const auto written = write(path, color); !written)
            throw std::runtime_error(written.error().line());
        seeds.add_scan(color ? "color" : "plain", Seeds::taken(path));
    }
}

}  // namespace lucarne::fuzz
