#include "io/formats/common/buffered_input.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "io/formats/common/text.h"

namespace lucarne::io {

BufferedInput::BufferedInput(std::shared_ptr<const ByteSource> file, uint64_t offset, uint64_t end,
                             uint64_t buffer)
    : file_(std::move(file)), next_(offset), end_(std::max(offset, end)) {
    buffer_.resize(static_cast<size_t>(std::min(buffer, end_ - next_)));
}

Result<std::span<const std::byte>> BufferedInput::peek(size_t bytes) {
    if (last_ - first_ < bytes && next_ < end_) {
        std::memmove(buffer_.data(), buffer_.data() + first_, last_ - first_);
        last_ -= first_;
        first_ = 0;
        const auto room = std::span(buffer_).subspan(last_);
        const auto wanted = static_cast<size_t>(std::min<uint64_t>(room.size(), end_ - next_));
        LUCARNE_ASSIGN(const size_t got, file_->read_some(next_, room.first(wanted)));
        if (got < wanted) end_ = next_ + got;  // the file shrank while it was being read
        next_ += got;
        last_ += got;
    }
    return std::span<const std::byte>(buffer_).subspan(first_, last_ - first_);
}

Result<void> BufferedInput::skip_mark() {
    LUCARNE_ASSIGN(const auto bytes, peek(3));
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    skip(text.size() - without_mark(text).size());
    return {};
}

Result<void> BufferedInput::skip_far(uint64_t bytes) {
    const uint64_t buffered = last_ - first_;
    if (bytes <= buffered) {
        first_ += static_cast<size_t>(bytes);
        return {};
    }
    if (bytes - buffered > end_ - next_)
        return rejected(path(), fmt::format("ends early, at {} bytes", end_));
    next_ += bytes - buffered;
    first_ = last_ = 0;
    return {};
}

Result<std::optional<std::string_view>> BufferedInput::line(char terminator) {
    for (const size_t wanted : {size_t{1}, kLargestPeek}) {
        LUCARNE_ASSIGN(const auto bytes, peek(wanted));
        if (bytes.empty()) return std::nullopt;
        const auto* text = reinterpret_cast<const char*>(bytes.data());
        const auto* end = static_cast<const char*>(std::memchr(text, terminator, bytes.size()));
        if (!end && bytes.size() >= wanted) continue;  // the range may go on: read more
        const size_t length = end ? static_cast<size_t>(end - text) : bytes.size();
        skip(length + (end ? 1 : 0));
        open_line_ = !end;
        return std::string_view(text, length);
    }
    return rejected(path(), "has a line of more than 1 MiB");
}

}  // namespace lucarne::io
