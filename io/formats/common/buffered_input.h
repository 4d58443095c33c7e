#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "io/files/file.h"

namespace lucarne::io {

/// Reads [offset, end) of a file sequentially through one buffer: large system calls, bounded memory.
class BufferedInput {
 public:
    static constexpr size_t kLargestPeek = size_t{1} << 20;

    /// `buffer` is the size of the buffer in bytes. Lines and long peeks need the default size.
    BufferedInput(std::shared_ptr<const ByteSource> file, uint64_t offset, uint64_t end,
                  uint64_t buffer = 2 * kLargestPeek);

    /// Returns the buffered bytes: at least `bytes` of them (at most half the buffer), unless the range ends
    /// before. Valid until the next call.
    Result<std::span<const std::byte>> peek(size_t bytes);
    void skip(size_t bytes) { first_ += bytes; }  ///< part of what `peek` returned
    Result<void> skip_mark();                     ///< skips the byte order mark of UTF-8, if it comes next
    Result<void> skip_far(uint64_t bytes);        ///< skips any number of bytes; past the end is an error
    /// Returns the next line without its terminator; nothing at the end of the range. A line over 1 MiB is
    /// rejected.
    Result<std::optional<std::string_view>> line(char terminator);

    /// Returns whether the last line has no terminator because the range ends with it.
    bool open_line() const { return open_line_; }
    bool at_end() const { return first_ == last_ && next_ >= end_; }

    uint64_t position() const { return next_ - (last_ - first_); }  ///< in the file
    std::string path() const { return file_->path().string(); }

 private:
    std::shared_ptr<const ByteSource> file_;
    uint64_t next_, end_;  ///< where the next system call reads; end of the range
    std::vector<std::byte> buffer_;
    size_t first_ = 0, last_ = 0;  ///< the buffered bytes that are not consumed yet
    bool open_line_ = false;
};

}  // namespace lucarne::io
