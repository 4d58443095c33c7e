#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include "io/formats/scan.h"
#include "tests/temporary_folder.h"

// Shared by the tests of io: the folder of shared scans, a temporary folder, whole scans in memory.
namespace lucarne::io::testing {

/// Returns the folder of the shared test data; empty if there is none.
inline std::filesystem::path shared_data() {
    const char* given = std::getenv("LUCARNE_SHARED");
    const auto folder =
        given ? std::filesystem::path(given) : std::filesystem::path(LUCARNE_SOURCE_DIR) / ".." / "shared";
    return std::filesystem::exists(folder / "data") ? folder / "data" : std::filesystem::path();
}

using TemporaryFolder = lucarne::test::Folder;

inline void write_bytes(const std::filesystem::path& path, std::string_view bytes) {
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}
inline std::string read_bytes(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// A file in memory, for tests that change a file thousands of times.
class MemoryFile {
 public:
    MemoryFile() : fd_(memfd_create("lucarne-test", MFD_CLOEXEC)) {}
    ~MemoryFile() { close(fd_); }
    MemoryFile(const MemoryFile&) = delete;
    void set(std::string_view bytes) const {
        ASSERT_EQ(ftruncate(fd_, 0), 0);
        ASSERT_EQ(pwrite(fd_, bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
    }
    std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
    int fd_;
};

/// All records of one pass.
struct Records {
    std::vector<std::byte> bytes;
    size_t count = 0;
    uint64_t dropped = 0;
};

inline Result<Records> read_all(const PointSource& source, size_t batch_points = 1000) {
    Records all;
    LUCARNE_ASSIGN(const auto reader, source.open());
    PointBatch batch;
    for (;;) {
        LUCARNE_ASSIGN(const size_t got, reader->read(batch, batch_points));
        if (got == 0) break;
        all.bytes.insert(all.bytes.end(), batch.bytes.begin(),
                         batch.bytes.begin() + static_cast<std::ptrdiff_t>(got * source.schema().stride));
        all.count += got;
    }
    all.dropped = reader->dropped();
    return all;
}

}  // namespace lucarne::io::testing
