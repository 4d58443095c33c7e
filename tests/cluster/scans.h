#pragma once

#include <algorithm>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/viewer/program.h"

namespace lucarne::test {

inline void generate(const TemporaryFolder& folder, const std::string& scene, const std::string& points,
                     const std::string& name, const std::string& more = {}) {
    const Outcome made =
        lucarne("generate " + scene + " --points " + points + " -o " + folder / name + " " + more);
    ASSERT_EQ(made.code, 0) << made.output;
}

/// The scans that conversions and appends on several ranks have in common.
inline void make_scans(const TemporaryFolder& folder) {
    generate(folder, "survey", "90k", "survey.las");
    generate(folder, "two-rooms", "5k", "rooms.las", "--normals");
    generate(folder, "cornell", "3k", "cornell.las");
    generate(folder, "statue", "700", "statue.ply");
    std::ofstream rows(folder / "rows.xyz");
    for (int i = 0; i < 4000; ++i) rows << i % 80 * .11 << ' ' << i / 80 * .13 << ' ' << i % 7 * .01 << '\n';
    // A place with so many points that it fills chunks of its own.
    std::ofstream heap(folder / "heap.xyz");
    for (int i = 0; i < 70000; ++i) heap << "1 2 3\n";
    for (int i = 0; i < 3000; ++i) heap << i % 60 * .1 << ' ' << i / 60 * .1 << " 0\n";
}

/// Makes a scan whose stations a conversion has to find: the record that states them gets another name.
inline void make_silent(const TemporaryFolder& folder, const std::string& name, const std::string& points) {
    const Outcome made = lucarne("generate two-rooms --points " + points + " -o " + folder / name);
    ASSERT_EQ(made.code, 0) << made.output;
    std::string bytes = test::bytes_of(folder / name);
    const std::string user("lucarne\0", 8), other("nobody1\0", 8);
    size_t found = 0;
    for (size_t at = 0; (at = bytes.find(user, at)) != std::string::npos; ++found)
        std::ranges::copy(other, bytes.begin() + static_cast<ptrdiff_t>(at));
    ASSERT_GT(found, 0u);
    std::ofstream(folder / name, std::ios::binary) << bytes;
}

}  // namespace lucarne::test
