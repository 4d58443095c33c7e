#pragma once

#include <algorithm>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/viewer/program.h"

namespace lucarne::test {

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
