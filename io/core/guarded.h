#pragma once

#include <string_view>
#include <type_traits>

#include "io/core/error.h"

namespace lucarne {

/// Returns the exception that is being handled as an error about `what`. Call it inside a catch block. When
/// memory has run out, it allocates none.
Error caught(std::string_view what);

/// Calls `work` and returns its Result; `work` may also return nothing. An exception becomes an error about
/// `what`. Every function at the top of a thread must run through this, because an exception that leaves a
/// thread ends the program.
template <class Work>
auto guarded(std::string_view what, Work&& work) {
    using Returned = std::invoke_result_t<Work&>;
    if constexpr (std::is_void_v<Returned>) {
        try {
            work();
            return Result<void>();
        } catch (...) {
            return Result<void>(tl::make_unexpected(caught(what)));
        }
    } else {
        try {
            return Returned(work());
        } catch (...) {
            return Returned(tl::make_unexpected(caught(what)));
        }
    }
}

}  // namespace lucarne
