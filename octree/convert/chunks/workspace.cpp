#include "octree/convert/chunks/workspace.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

#include <fmt/format.h>

#include "io/core/interrupt.h"
#include "io/core/log.h"
#include "io/core/options.h"
#include "io/files/private_file.h"
#include "io/points.h"
#include "octree/cache/format.h"

namespace lucarne::octree {
namespace {

namespace fs = std::filesystem;

constexpr const char* kJournal = "journal";
constexpr const char* kSuffix = ".lucarne-work";
constexpr const char* kIdentity = "identity";
/// All files of a work folder; nothing else in it is touched.
const std::array<std::string, 3> kFiles = {kJournal, "points", "normals"};
constexpr const char* kBusy = "another conversion to this cache is running";
/// A record: its stage's name padded with zeros, the number of bytes, the checksum of the whole record, and
/// the bytes.
constexpr size_t kNameBytes = 16, kHeadBytes = kNameBytes + 16;

std::vector<std::byte> encode(const std::string& stage, std::span<const std::byte> bytes) {
    assert(stage.size() <= kNameBytes);
    std::vector<std::byte> record(kHeadBytes + bytes.size());
    std::memcpy(record.data(), stage.data(), stage.size());
    io::store(&record[kNameBytes], uint64_t{bytes.size()});
    std::copy(bytes.begin(), bytes.end(), record.begin() + kHeadBytes);
    const uint64_t sum = format::checksum(record);  // the checksum's own bytes are still zero
    io::store(&record[kNameBytes + 8], sum);
    return record;
}

uint64_t folder_bytes(const fs::path& folder) {
    uint64_t bytes = 0;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored))
        if (const auto size = entry.file_size(ignored); !ignored) bytes += size;
    return bytes;
}

std::string text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Returns the first line in which two identities differ.
std::string difference(const std::string& before, const std::string& now) {
    const auto at = std::mismatch(before.begin(), before.end(), now.begin(), now.end());
    const auto line = [](const std::string& text, auto where) {
        const auto begin = std::find(std::reverse_iterator(where), text.rend(), '\n').base();
        return std::string(begin, std::find(where, text.end(), '\n'));
    };
    return fmt::format("'{}' then, '{}' now", line(before, at.first), line(now, at.second));
}

/// Logs interrupted builds of other outputs. They are left alone: their owners may resume them.
void report_others(const fs::path& temp_folder, const fs::path& own) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(temp_folder, error)) {
        if (!entry.path().filename().string().ends_with(kSuffix) || entry.path() == own) continue;
        if (!UpdateFile::open_private(entry.path() / kJournal, false, kBusy))
            continue;  // just made, in use, or another user's
        log::warn("{} holds {} of an interrupted conversion; resume that one with --resume, or remove it",
                  entry.path().string(), bytes_text(folder_bytes(entry.path())));
    }
}

}  // namespace

Result<Workspace> Workspace::open(const fs::path& temp_folder, const fs::path& output,
                                  const std::string& identity, Resume resume, std::optional<size_t> rank) {
    Workspace work;
    work.temp_folder_ = temp_folder;
    if (resume == Resume::never) return work;
    std::error_code error;
    std::string whole = fs::absolute(output, error).lexically_normal().string();
    if (rank) whole += fmt::format("\nrank {}", *rank);
    const auto hash = format::checksum(std::as_bytes(std::span(whole)));
    const fs::path folder = temp_folder / fmt::format("{:016x}{}", hash, kSuffix);
    LUCARNE_TRY(ScratchFile::create(temp_folder));  // reports errors of the parent folder
    if (const auto own = make_private_folder(folder); !own) {
        log::warn("{}; this conversion cannot be resumed", own.error().line());
        return work;
    }
    LUCARNE_ASSIGN(work.journal_, UpdateFile::open_private(folder / kJournal, true, kBusy));
    work.folder_ = folder;
    work.resume_ = resume;
    if (!rank) report_others(temp_folder, folder);  // ranks begin at different times
    LUCARNE_TRY(work.start(whole + "\n" + identity, resume));
    return work;
}

Workspace& Workspace::operator=(Workspace&& other) noexcept {
    temp_folder_.swap(other.temp_folder_);
    folder_.swap(other.folder_);
    journal_.swap(other.journal_);
    records_.swap(other.records_);
    std::swap(end_, other.end_);
    std::swap(resume_, other.resume_);
    std::swap(keep_, other.keep_);
    return *this;
}
Workspace::~Workspace() {
    if (folder_.empty()) return;
    if (keep_ && records_.size() > 1)
        log::warn("{} keeps {} for --resume", folder_.string(), bytes_text(folder_bytes(folder_)));
    else
        remove_private_folder(folder_, kFiles);  // the next build reports what cannot be removed
    forget_interrupt(folder_);
}

/// Registers what an interrupt does: keeps the folder if a resumed build can use it, else removes it.
void Workspace::tell_at_interrupt() const {
    if (records_.size() < 2) {
        at_interrupt(folder_, [folder = folder_] {
            remove_private_folder(folder, kFiles);
            return std::string();
        });
        return;
    }
    const std::string how = resume_ == Resume::go_on ? "again" : "with --resume";
    at_interrupt(folder_, [folder = folder_, stage = records_.back().stage, how] {
        return fmt::format(
            "{}: keeps {} of the interrupted conversion; give the same command {} to go on after '{}', or "
            "remove "
            "the folder",
            folder.string(), bytes_text(folder_bytes(folder)), how, stage);
    });
}

Result<void> Workspace::start(const std::string& identity, Resume resume) {
    keep_ = resume == Resume::go_on;
    LUCARNE_ASSIGN(records_, read_journal());
    if (!records_.empty()) {
        const std::string before = text_of(records_[0].bytes);
        const bool same = records_[0].stage == kIdentity && before == identity;
        if (keep_ && same && records_.size() > 1) {
            log::info("going on after '{}' of the interrupted conversion", records_.back().stage);
            end_ = records_.back().offset + kHeadBytes + records_.back().bytes.size();
            tell_at_interrupt();
            return {};
        }
        if (keep_ && !same)
            log::warn("the interrupted conversion was another one, starting from the beginning: {}",
                      difference(before, identity));
        if (!keep_)
            log::warn("removed {} that an interrupted conversion left; --resume would have used it",
                      bytes_text(folder_bytes(folder_)));
    }
    // Files that cannot be removed are emptied when they are opened.
    remove_private_files(folder_, std::span(kFiles).subspan(1));
    records_.clear();
    LUCARNE_TRY(journal_->truncate(0));
    tell_at_interrupt();
    const auto bytes = std::as_bytes(std::span(identity));
    return append({kIdentity, {bytes.begin(), bytes.end()}});
}

/// Returns the records up to the first damaged one.
Result<std::vector<Workspace::Record>> Workspace::read_journal() const {
    std::vector<Record> records;
    LUCARNE_ASSIGN(const uint64_t size, journal_->size());
    std::vector<std::byte> journal(size);
    LUCARNE_TRY(journal_->read_at(0, journal));
    for (size_t at = 0; journal.size() - at >= kHeadBytes;) {
        const auto bytes = io::load<uint64_t>(&journal[at + kNameBytes]);
        if (bytes > journal.size() - at - kHeadBytes) break;
        const char* name = reinterpret_cast<const char*>(&journal[at]);
        const std::string stage(name, ::strnlen(name, kNameBytes));
        const auto body = std::span(journal).subspan(at + kHeadBytes, bytes);
        const auto whole = std::span(journal).subspan(at, kHeadBytes + bytes);
        const auto expected = encode(stage, body);
        if (!std::equal(whole.begin(), whole.end(), expected.begin())) break;
        records.push_back({stage, {body.begin(), body.end()}, at});
        at += whole.size();
    }
    return records;
}

Result<ScratchFile> Workspace::scratch(const std::string& name, bool kept) const {
    if (folder_.empty()) return ScratchFile::create(temp_folder_);
    return ScratchFile::named(folder_ / name, kept);
}

const std::vector<std::byte>* Workspace::finished(const std::string& stage) const {
    for (const auto& record : records_)
        if (record.stage == stage) return &record.bytes;
    return nullptr;
}

Result<void> Workspace::finish(const std::string& stage, std::vector<std::byte> record) {
    if (!journal_) return {};
    const auto known =
        std::find_if(records_.begin(), records_.end(), [&](const Record& r) { return r.stage == stage; });
    if (known != records_.end()) {
        end_ = known->offset;
        records_.erase(known, records_.end());
        LUCARNE_TRY(journal_->truncate(end_));
    }
    return append({stage, std::move(record)});
}

Result<void> Workspace::append(Record record) {
    const auto bytes = encode(record.stage, record.bytes);
    LUCARNE_TRY(journal_->write_at(end_, bytes));
    record.offset = end_;
    end_ += bytes.size();
    records_.push_back(std::move(record));
    tell_at_interrupt();
    return {};
}

}  // namespace lucarne::octree
