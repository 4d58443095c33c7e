#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace lucarne::octree {

/// Appends numbers as they are in memory: for journals that only this machine reads.
class ByteWriter {
 public:
    template <class T>
    void put(const T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        const auto bytes = std::as_bytes(std::span(&value, 1));
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }
    template <class T>
    void put_all(const std::vector<T>& values) {
        put(uint64_t{values.size()});
        const auto bytes = std::as_bytes(std::span(values));
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }
    std::vector<std::byte> take() { return std::move(bytes_); }

 private:
    std::vector<std::byte> bytes_;
};

/// Reads the numbers back. Missing bytes read as zeros and make `sound()` false.
class ByteReader {
 public:
    explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}

    template <class T>
    T get() {
        T value{};
        read(&value, sizeof value);
        return value;
    }
    template <class T>
    std::vector<T> get_all() {
        const auto count = get<uint64_t>();
        if (count > rest_.size() / sizeof(T)) sound_ = false;
        std::vector<T> values(sound_ ? count : 0);
        read(values.data(), values.size() * sizeof(T));
        return values;
    }
    bool sound() const { return sound_; }
    size_t left() const { return sound_ ? rest_.size() : 0; }  ///< bytes

 private:
    void read(void* to, size_t bytes) {
        if (bytes > rest_.size()) sound_ = false;
        if (!sound_ || bytes == 0) return;
        std::memcpy(to, rest_.data(), bytes);
        rest_ = rest_.subspan(bytes);
    }

    std::span<const std::byte> rest_;
    bool sound_ = true;
};

}  // namespace lucarne::octree
