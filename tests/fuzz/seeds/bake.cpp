// Makes bake files without, with one and with several sections.
#include <stdexcept>

#include "gi/bake/bake_file.h"
#include "tests/fuzz/seeds/seeds.h"

void lucarne::fuzz::bake_seeds(const Seeds& seeds) {
    gi::BakeFile bake{{"paths", 3, 0x1234567890abcdef, .5}, {}};
    for (const size_t sections : {0u, 1u, 4u}) {
        while (bake.sections.size() < sections)
            bake.sections["section" + std::to_string(bake.sections.size())] =
                std::vector<std::byte>(100 * bake.sections.size(), std::byte{42});
        const std::filesystem::path file = seeds.folder() / "seed.bake";
        if (const auto written = gi::write_bake(file, bake); !written)
            throw std::runtime_error(written.error().line());
        seeds.add("sections-" + std::to_string(sections), Seeds::taken(file));
    }
}
