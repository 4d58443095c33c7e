#pragma once

#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace lucarne {

/// How the program handles errors:
///  - A broken invariant of its own code: `assert`, or std::logic_error where a release build must stop as
///    well.
///  - Bad input, a full disk, a missing device: a function returns a `Result` that carries an `Error`.
///  - Only viewer/program prints an `Error` and turns it into an exit code.
/// The enumerators are the exit codes of `lucarne`.
enum class ErrorKind { failed = 1, arguments = 2, input_rejected = 3 };

struct Error {
    ErrorKind kind = ErrorKind::failed;
    std::string what;  ///< what the error concerns: a file, an option, a device
    std::string why;   ///< what is wrong with it
    std::string todo;  ///< what the user can do about it; may be empty

    /// Returns "<what>: <why>; <todo>" on one line. Control characters, as hostile file names hold, are
    /// replaced.
    std::string line() const;
};

template <class T>
using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> failure(ErrorKind kind, std::string what, std::string why,
                                     std::string todo = {}) {
    return tl::make_unexpected(Error{kind, std::move(what), std::move(why), std::move(todo)});
}
/// An error of the machine or the disk: it cannot do what was asked (exit 1).
inline auto failed(std::string what, std::string why, std::string todo = {}) {
    return failure(ErrorKind::failed, std::move(what), std::move(why), std::move(todo));
}
/// An error in the user's arguments: they contradict each other (exit 2).
inline auto bad_arguments(std::string what, std::string why, std::string todo = {}) {
    return failure(ErrorKind::arguments, std::move(what), std::move(why), std::move(todo));
}
/// An error in a file: its bytes are not what they claim to be (exit 3).
inline auto rejected(std::string what, std::string why, std::string todo = {}) {
    return failure(ErrorKind::input_rejected, std::move(what), std::move(why), std::move(todo));
}

}  // namespace lucarne

#define LUCARNE_JOIN_(a, b) a##b
#define LUCARNE_JOIN(a, b) LUCARNE_JOIN_(a, b)

/// Returns the error of a `Result<void>` expression from the enclosing function.
#define LUCARNE_TRY(expression)                                            \
    do {                                                                   \
        if (auto lucarne_result = (expression); !lucarne_result)           \
            return tl::make_unexpected(std::move(lucarne_result).error()); \
    } while (false)

/// `LUCARNE_ASSIGN(auto file, InputFile::open(path))`: declares or assigns the value, or returns the error.
#define LUCARNE_ASSIGN(target, expression)                                                      \
    auto LUCARNE_JOIN(lucarne_result_, __LINE__) = (expression);                                \
    if (!LUCARNE_JOIN(lucarne_result_, __LINE__))                                               \
        return tl::make_unexpected(std::move(LUCARNE_JOIN(lucarne_result_, __LINE__)).error()); \
    target = std::move(*LUCARNE_JOIN(lucarne_result_, __LINE__))
