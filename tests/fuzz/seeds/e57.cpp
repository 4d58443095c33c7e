// Makes small E57 files of each kind without checksums, as fuzz_e57 takes them.
#include "tests/fuzz/seeds/seeds.h"
#include "tests/io/formats/e57/e57_builder.h"

namespace lucarne::fuzz {
namespace {

using namespace io::testing;

std::string three(const std::string& name) {
    return integer_field(name + 'X', -1000, 1000) + integer_field(name + 'Y', 0, 1000) +
           integer_field(name + 'Z', -5, 1000);
}

BuiltFile coloured() {
    const std::string byte(2, '\x7f');
    BuiltScan scan{kXyzFields + integer_field("colorRed", 0, 255) + integer_field("colorGreen", 0, 255) +
                       integer_field("colorBlue", 0, 255) + integer_field("isColorInvalid", 0, 1) +
                       integer_field("cartesianInvalidState", 0, 2) + float_field("intensity", "single"),
                   2,
                   xyz_packet({{1, 2, 3}, {4, 5, 6}}, {byte, byte, byte, "\2", "\1", std::string(8, '?')})};
    scan.more = "<colorLimits><colorRedMaximum>255</colorRedMaximum></colorLimits>";
    return {{scan}};
}

BuiltFile posed() {
    BuiltScan whole{
        three("cartesian") + three("nor:normal"), 8,
        data_packet(std::vector<std::string>(6, std::string(11, '\x35'))) + other_packet('\0', 16)};
    whole.more =
        "<pose><rotation><w>0.5</w><x>0.5</x><y>0.5</y><z>-0.5</z></rotation>"
        "<translation><x>10</x><y>20.5</y><z>-3</z></translation></pose>";
    BuiltScan scaled{scaled_field("cartesianX", -9, 9, "0.001", "6e5") +
                         scaled_field("cartesianY", 0, 0, "1") + scaled_field("cartesianZ", 0, 1, "1"),
                     3, data_packet({"ab", "", "\5"})};
    return {{whole, scaled}};
}

BuiltFile spherical() {
    BuiltScan scan{float_field("sphericalRange") + float_field("sphericalAzimuth") +
                       scaled_field("sphericalElevation", -500, 500, "1e-3") +
                       integer_field("sphericalInvalidState", 0, 2) + "<label type=\"String\"/>",
                   2,
                   data_packet({std::string(16, '\x3f'), std::string(16, '\x3f'), "abc", "\1", "\6\0abc"})};
    return {{scan}};
}

/// Every width of integers, with so many values that they cross byte borders, in packets of uneven lengths.
BuiltFile widths() {
    BuiltScan scan{kXyzFields, 6, ""};
    std::vector<std::string> streams(3, std::string(48, '\x3f'));
    for (const int bits : {0, 1, 3, 7, 8, 12, 16, 17, 31, 32, 48, 62}) {
        scan.prototype += integer_field(fmt::format("width{}", bits), -1, -1 + ((int64_t{1} << bits) - 1));
        streams.push_back(std::string(static_cast<size_t>(6 * bits + 7) / 8, '\x5b'));
    }
    scan.packets = other_packet('\2', 8) + data_packet(streams);
    return {{scan}};
}

/// Points that take no bits, and a pose whose quaternion is 0.
BuiltFile constants() {
    BuiltScan scan{integer_field("cartesianX", 1, 1) + integer_field("cartesianY", 2, 2) +
                       integer_field("cartesianZ", 3, 3),
                   40, data_packet({"", "", ""})};
    BuiltScan posed = scan;
    posed.more = "<pose><rotation><w>0</w></rotation><translation><x>1</x></translation></pose>";
    return {{scan, posed}};
}

}  // namespace

void e57_seeds(const Seeds& seeds) {
    const auto add = [&](const std::string& name, const BuiltFile& file) {
        seeds.add_scan(name, file.bytes());
        seeds.add(name, file.logical());
    };
    add("coloured", coloured());
    add("posed", posed());
    add("spherical", spherical());
    add("widths", widths());
    add("constants", constants());
    add("empty", {});
}

}  // namespace lucarne::fuzz
