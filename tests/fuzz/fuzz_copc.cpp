// Fuzzes COPC as an octree: info record, pages, chunks, and the code that trusts them. The input is the whole
// file. Its magic is corrected, so that every input gets past it.
#include <cstring>
#include <string>

#include "octree/copc/copc.h"
#include "octree/stream/cut.h"
#include "tests/fuzz/fuzz.h"

bool lucarne::fuzz::run(const uint8_t* data, size_t size) {
    constexpr size_t kFront = 589;
    if (size < kFront) return false;
    std::string bytes(reinterpret_cast<const char*>(data), size);
    std::memcpy(&bytes[0], "LASF", 4);
    std::memcpy(&bytes[24], "\x01\x04", 2);
    std::memcpy(&bytes[94], "\x77\x01", 2);  // a header of 375 bytes
    std::memcpy(&bytes[377], "copc\0\0\0\0\0\0\0\0\0\0\0\0\x01\0\xa0\0", 20);
    const auto opened = octree::open_copc(memory_source(bytes));
    if (!opened) return true;
    const octree::NodeSource& source = **opened;
    for (uint32_t node = 0; node < source.nodes().size(); ++node) (void)source.load(node);
    octree::View view;
    view.position = source.header().max;
    view.width = view.height = 64;
    (void)octree::view_cut(source, view, 1000);
    (void)octree::light_view_cut(source, view, 1000);
    (void)octree::light_cut(source, source.header().min, 1000);
    return true;
}
