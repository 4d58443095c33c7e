#include "octree/cache/writer.h"

#include <algorithm>

#include <fmt/format.h>

#include "octree/cache/checked_read.h"
#include "octree/cache/directory.h"
#include "octree/cache/metadata.h"
#include "octree/tree/scan_number.h"

namespace lucarne::octree {
namespace {

using format::kEntryBytes;

constexpr size_t kBufferedEntries = 1024;  // 64 KiB
constexpr size_t kLevelEntries = 64;       // 4 KiB a level while the directory is written

}  // namespace

Result<CacheWriter> CacheWriter::create(const std::filesystem::path& path, bool overwrite,
                                        const std::filesystem::path& temp_folder) {
    LUCARNE_ASSIGN(OutputFile output, OutputFile::create(path, overwrite));
    LUCARNE_ASSIGN(ScratchFile entries, ScratchFile::create(temp_folder));
    CacheWriter writer(std::move(entries));
    writer.output_ = std::move(output);
    LUCARNE_TRY(writer.start());
    return writer;
}

Result<CacheWriter> CacheWriter::create_shared(const std::filesystem::path& path, bool overwrite,
                                               const std::filesystem::path& temp_folder) {
    LUCARNE_ASSIGN(SharedOutput output, SharedOutput::create(path, overwrite));
    LUCARNE_ASSIGN(ScratchFile entries, ScratchFile::create(temp_folder));
    CacheWriter writer(std::move(entries));
    writer.shared_ = std::move(output);
    LUCARNE_TRY(writer.start());
    return writer;
}

Result<CacheWriter> CacheWriter::stage(const std::filesystem::path& temp_folder) {
    LUCARNE_ASSIGN(ScratchFile entries, ScratchFile::create(temp_folder));
    LUCARNE_ASSIGN(ScratchFile payloads, ScratchFile::create(temp_folder));
    CacheWriter writer(std::move(entries));
    writer.stage_ = std::move(payloads);
    return writer;
}

/// Leaves room for the superblocks. They are zeros until finish(), so that an unfinished file is not a cache.
Result<void> CacheWriter::start() {
    LUCARNE_TRY(append(std::vector<std::byte>(format::kFirstPayload)));
    return {};
}

Result<CacheWriter> CacheWriter::update(UpdateFile file, const format::Superblock& before, size_t newest,
                                        const std::filesystem::path& temp_folder) {
    LUCARNE_ASSIGN(ScratchFile entries, ScratchFile::create(temp_folder));
    CacheWriter writer(std::move(entries));
    LUCARNE_TRY(file.truncate(before.file_bytes));
    writer.update_ = std::move(file);
    writer.next_block_ = 1 - newest;
    writer.before_ = before;
    writer.generation_ = before.generation + 1;
    writer.begin_ = writer.end_ = before.file_bytes;
    return writer;
}

Result<void> CacheWriter::write_at(uint64_t offset, std::span<const std::byte> data) {
    if (stage_) return stage_->write_at(offset, data);
    if (shared_) return shared_->write_at(offset, data);
    return output_ ? output_->write_at(offset, data) : update_->write_at(offset, data);
}
Result<void> CacheWriter::read_at(uint64_t offset, std::span<std::byte> out) const {
    if (stage_) return stage_->read_at(offset, out);
    if (shared_) return shared_->read_at(offset, out);
    return output_ ? output_->read_at(offset, out) : update_->read_at(offset, out);
}

Result<uint64_t> CacheWriter::append(std::span<const std::byte> payload) {
    const uint64_t at = end_;
    LUCARNE_TRY(write_at(at, payload));
    end_ += payload.size();
    return at;
}

Result<void> CacheWriter::add(const format::Entry& entry) {
    buffer_.resize(buffer_.size() + kEntryBytes);
    format::store_entry(entry, &buffer_[buffer_.size() - kEntryBytes]);
    ++nodes_;
    ++per_level_[entry.key.level];
    if (buffer_.size() >= kBufferedEntries * kEntryBytes) return flush_entries();
    return {};
}

Result<void> CacheWriter::flush_entries() {
    LUCARNE_TRY(entries_.write_at(entries_written_, buffer_));
    entries_written_ += buffer_.size();
    buffer_.clear();
    return {};
}

Result<std::vector<std::byte>> CacheWriter::entries(uint64_t first, uint64_t count) const {
    std::vector<std::byte> bytes(count * kEntryBytes);
    LUCARNE_TRY(entries_.read_at(first * kEntryBytes, bytes));
    return bytes;
}

/// Distributes the entries to their levels' ranges at the end of the file.
Result<void> CacheWriter::write_directory() {
    LUCARNE_TRY(flush_entries());
    const uint64_t begin = end_, bytes = nodes_ * kEntryBytes;
    std::array<uint64_t, kMostLevel + 1> cursor{begin};
    for (uint32_t level = 1; level <= kMostLevel; ++level)
        cursor[level] = cursor[level - 1] + per_level_[level - 1] * kEntryBytes;
    std::array<std::vector<std::byte>, kMostLevel + 1> waiting;
    const auto flush = [&](uint32_t level) -> Result<void> {
        LUCARNE_TRY(write_at(cursor[level], waiting[level]));
        cursor[level] += waiting[level].size();
        waiting[level].clear();
        return {};
    };
    std::vector<std::byte> block(kBufferedEntries * kEntryBytes);
    for (uint64_t at = 0; at < bytes; at += block.size()) {
        const std::span part(block.data(), std::min<uint64_t>(block.size(), bytes - at));
        LUCARNE_TRY(entries_.read_at(at, part));
        for (size_t i = 0; i < part.size(); i += kEntryBytes) {
            const uint32_t level = format::load_entry(&part[i]).key.level;
            waiting[level].insert(waiting[level].end(), &part[i], &part[i] + kEntryBytes);
            if (waiting[level].size() >= kLevelEntries * kEntryBytes) LUCARNE_TRY(flush(level));
        }
    }
    for (uint32_t level = 0; level <= kMostLevel; ++level) LUCARNE_TRY(flush(level));
    end_ += bytes;
    return {};
}

/// Writes the list of the pages of a directory that is written.
Result<DirectoryPages> CacheWriter::write_pages(uint64_t directory, uint32_t nodes) {
    PageList list;
    std::vector<std::byte> page(nodes * kEntryBytes);
    const uint64_t bytes = nodes_ * kEntryBytes;
    for (uint64_t at = 0; at < bytes; at += page.size()) {
        const std::span part(page.data(), std::min<uint64_t>(page.size(), bytes - at));
        LUCARNE_TRY(read_at(directory + at, part));
        list.add(part);
    }
    std::vector<std::byte> stored(list.pages().size() * format::kPageBytes);
    for (size_t i = 0; i < list.pages().size(); ++i)
        format::store_page(list.pages()[i], &stored[i * format::kPageBytes]);
    DirectoryPages pages{nodes, 0, format::checksum(stored)};
    LUCARNE_ASSIGN(pages.offset, append(stored));
    return pages;
}

/// The metadata are before the directory, and behind the pages of it if there are any, whose place they
/// state.
Result<void> CacheWriter::finish(const SourceHeader& described, const Paged& paged) {
    format::Superblock block;
    block.generation = generation_;
    if (ScanNumber(described.schema).most() > kMostShortScans) block.version = format::kWideVersion;
    block.directory_bytes = nodes_ * kEntryBytes;
    SourceHeader header = described;
    header.directory_pages.reset();
    const auto put_directory = [&]() -> Result<void> {
        block.directory_offset = end_;
        LUCARNE_TRY(write_directory());
        const auto read = [this](uint64_t at, std::span<std::byte> out) { return read_at(at, out); };
        LUCARNE_ASSIGN(block.directory_checksum,
                       checksum_of(read, block.directory_offset, block.directory_bytes));
        return {};
    };
    const bool pages = nodes_ >= paged.from;
    if (pages) {
        LUCARNE_TRY(put_directory());
        LUCARNE_ASSIGN(header.directory_pages, write_pages(block.directory_offset, paged.nodes));
    }
    const std::string metadata = metadata_text(header);
    if (metadata.size() > format::kMaxMetadata)
        return failed("metadata", fmt::format("{} bytes are more than a cache can hold", metadata.size()));
    const auto text = std::as_bytes(std::span(metadata));
    block.metadata_bytes = metadata.size();
    block.metadata_checksum = format::checksum(text);
    LUCARNE_ASSIGN(block.metadata_offset, append(text));
    if (!pages) LUCARNE_TRY(put_directory());
    block.file_bytes = end_;
    return commit(block);
}

void CacheWriter::abandon() {
    // Errors do not matter: what stays there does no harm.
    if (update_ && !switching_) (void)update_->truncate(begin_);
}

/// A new cache gets both superblocks and its name. An update overwrites the older superblock once all data
/// that the new one refers to is on the disk. If it is the first of its version, the state before gets that
/// version as well, or programs that do not know it would show that state, and write after it.
Result<void> CacheWriter::commit(format::Superblock block) {
    const auto bytes = format::encode(block);
    if (!update_) {
        LUCARNE_TRY(write_at(0, bytes));
        LUCARNE_TRY(write_at(format::kSuperblockBytes, bytes));
        return output_ ? output_->commit() : shared_->commit();
    }
    LUCARNE_TRY(update_->sync());
    switching_ = true;
    LUCARNE_TRY(update_->write_at(next_block_ * format::kSuperblockBytes, bytes));
    LUCARNE_TRY(update_->sync());
    if (before_.version == block.version) return {};
    before_.version = block.version;
    LUCARNE_TRY(update_->write_at((1 - next_block_) * format::kSuperblockBytes, format::encode(before_)));
    return update_->sync();
}

}  // namespace lucarne::octree
