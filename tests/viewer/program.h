#pragma once

#include <string>

#include <gtest/gtest.h>

#include "tests/processes.h"
#include "tests/temporary_folder.h"

namespace lucarne::test {

/// Returns names of its files as text for commands.
class TemporaryFolder : public Folder {
 public:
    std::string operator/(const std::string& name) const { return (path() / name).string(); }
};

/// Runs the program under test.
inline Outcome lucarne(const std::string& arguments) {
    return shell(LUCARNE_BINARY " " + arguments);
}

/// A small Cornell box as a cache, made by the program itself.
inline std::string make_cornell(const TemporaryFolder& folder, const std::string& points = "60k") {
    const std::string scan = folder / "cornell.las", cache = folder / "cornell.luc";
    const Outcome generated = lucarne("generate cornell --points " + points + " -o " + scan);
    EXPECT_EQ(generated.code, 0) << generated.output;
    const Outcome converted = lucarne("convert " + scan + " -o " + cache);
    EXPECT_EQ(converted.code, 0) << converted.output;
    return cache;
}

}  // namespace lucarne::test
