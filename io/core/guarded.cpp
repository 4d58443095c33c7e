#include "io/core/guarded.h"

#include <exception>
#include <new>

namespace lucarne {
namespace {

Error described(std::string_view what) {
    std::string subject(what);
    try {
        throw;
    } catch (const std::bad_alloc&) {
        return {ErrorKind::failed, std::move(subject), "there is not enough memory",
                "close something and try again"};
    } catch (const std::exception& problem) {
        return {ErrorKind::failed, std::move(subject), problem.what(), ""};
    } catch (...) {
        return {ErrorKind::failed, std::move(subject), "failed for an unknown reason", ""};
    }
}

}  // namespace

Error caught(std::string_view what) {
    try {
        return described(what);
    } catch (const std::bad_alloc&) {
        return {ErrorKind::failed, "", "out of memory",
                ""};  // short enough for std::string to store without allocating
    }
}

}  // namespace lucarne
