#include "io/formats/common/surplus.h"

#include "io/core/log.h"

namespace lucarne::io {

void warn_of_surplus(const std::string& file, uint64_t bytes, uint64_t records) {
    const std::string what = bytes == 1 ? "1 byte follows" : fmt::format("{} bytes follow", bytes);
    const std::string advice =
        records == 0   ? ""
        : records == 1 ? "; 1 record takes as many, and --salvage reads it"
                       : fmt::format("; {} records take as many, and --salvage reads them", records);
    log::warn("{}: {} the points, more than its header promises{}", file, what, advice);
}

}  // namespace lucarne::io
