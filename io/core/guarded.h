#pragma once

#include <string_view>
#include <type_traits>

#include "io/core/error.h"

namespace lucarne {

/// The exception that is being handled as an error about `what`; to be called inside a catch block. Needs no
/// memory where there is none left.
Error caught(std::string_view what);

/// Returns what `work` returns, a Result or nothing, and an error about `what` for anything it throws.
/// Whatever runs at the top of a thread goes through this: an exception that leaves a thread ends the
/// program.
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
