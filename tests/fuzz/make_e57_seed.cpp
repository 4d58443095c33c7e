// Writes small E57 files without checksums, one of each kind, for fuzz_e57.
#include <filesystem>
#include <fstream>

#include "tests/io/e57_builder.h"

using namespace lucarne::io::testing;

namespace {

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

}  // namespace

int main(int count, char** arguments) {
    if (count != 2) return 2;
    const std::filesystem::path folder(arguments[1]);
    int number = 0;
    for (const BuiltFile& file : {coloured(), posed(), spherical(), BuiltFile{}})
        std::ofstream(folder / fmt::format("seed{}", number++), std::ios::binary) << file.logical();
}
