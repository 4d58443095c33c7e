#include "io/formats/common/surplus.h"

#include "io/core/counted.h"
#include "io/core/log.h"

namespace lucarne::io {

void warn_of_surplus(const std::string& file, uint64_t bytes, std::string_view more) {
    log::warn("{}: {} the points, more than its header promises{}{}", file,
              bytes == 1 ? "1 byte follows" : counted(bytes, "bytes follow"), more.empty() ? "" : "; ", more);
}

}  // namespace lucarne::io
