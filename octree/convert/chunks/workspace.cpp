#include "octree/convert/chunks/workspace.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cinttypes>
#include <cstdio>
#include <cstring>

#include <fmt/format.h>
#include <sys/stat.h>

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
/// All files of a work folder, in the order in which they are removed; nothing else in it is touched. The
/// journal is the last one, so that what a kill leaves still says what it is. An empty folder is known by its
/// name.
const std::array<std::string, 3> kFiles = {"points", "normals", kJournal};
constexpr uint64_t kMostRanks = 1 << 20;  ///< more are a damaged journal
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

std::string as_text(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string whole_path(const fs::path& output) {
    std::error_code error;
    return fs::absolute(output, error).lexically_normal().string();
}

/// What the names of all work folders of an output begin with.
std::string name_of(const std::string& output) {
    return fmt::format("{:016x}", format::checksum(std::as_bytes(std::span(output))));
}

/// The build that is to go on is not the one that was interrupted.
tl::unexpected<Error> another_build(const fs::path& folder, const std::string& difference) {
    return failed(
        "--resume", fmt::format("{} has stages of another conversion: {}", folder.string(), difference),
        "give the same command and inputs; or remove that folder, if another one is newer; or leave "
        "--resume out to begin anew");
}

/// Returns the mark of a folder, empty if it cannot be looked at. A folder's numbers are the same on all
/// machines that share it, and its time of change tells it from those of other machines' disks.
std::string mark_of(const fs::path& folder) {
    struct stat found {};
    if (::stat(folder.c_str(), &found) != 0) return {};
    return fmt::format("{} {} {}.{:09}", folder.filename().string(), found.st_ino, found.st_mtim.tv_sec,
                       found.st_mtim.tv_nsec);
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

/// Reads what precedes the identity of a build: its output, and whose part of it this is.
struct Owner {
    std::string output;
    Workspace::Part part;
};
std::optional<Owner> owner_of(const std::string& text) {
    const size_t end = text.find('\n');
    Owner owner{text.substr(0, end), {}};
    if (end == std::string::npos ||
        std::sscanf(text.c_str() + end, "\nrank %" SCNu64 " of %" SCNu64, &owner.part.rank,
                    &owner.part.count) != 2 ||
        owner.part.rank >= owner.part.count || owner.part.count > kMostRanks)
        return std::nullopt;
    return owner;
}

}  // namespace

Result<Workspace> Workspace::open(const fs::path& temp_folder, const fs::path& output,
                                  const std::string& identity, Resume resume, Part part) {
    Workspace work;
    work.temp_folder_ = temp_folder;
    if (resume == Resume::never) return work;
    work.output_ = whole_path(output);
    work.identity_ = identity;
    work.part_ = part;
    std::string name = name_of(work.output_);
    if (part.count > 1) name += fmt::format(".{}-of-{}", part.rank, part.count);
    const fs::path folder = temp_folder / (name + kSuffix);
    LUCARNE_TRY(ScratchFile::create(temp_folder));  // reports errors of the parent folder
    if (const auto own = make_private_folder(folder); !own) {
        log::warn("{}; this conversion cannot be resumed", own.error().line());
        return work;
    }
    LUCARNE_ASSIGN(work.journal_, UpdateFile::open_private(folder / kJournal, true, kBusy));
    work.folder_ = folder;
    work.resume_ = resume;
    LUCARNE_TRY(work.start(text_of(work.output_, part, identity), resume));
    return work;
}

bool Workspace::in_use(const fs::path& temp_folder, const fs::path& output) {
    const fs::path folder = temp_folder / (name_of(whole_path(output)) + kSuffix);
    const auto journal = UpdateFile::open_private(folder / kJournal, false, kBusy);
    return !journal && journal.error().why == kBusy;
}

std::string Workspace::text_of(const std::string& output, Part part, const std::string& identity) {
    return fmt::format("{}\nrank {} of {}\n{}", output, part.rank, part.count, identity);
}

std::string Workspace::mark() const {
    return folder_.empty() ? std::string() : mark_of(folder_);
}

Result<std::vector<Workspace>> Workspace::left_by_others(std::span<const std::string> used) {
    std::vector<Workspace> left;
    if (folder_.empty()) return left;
    std::vector<fs::path> folders;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(temp_folder_, error))
        if (entry.path().filename().string().ends_with(kSuffix) && entry.path() != folder_)
            folders.push_back(entry.path());
    std::ranges::sort(folders);
    for (const fs::path& folder : folders) {
        if (std::ranges::find(used, mark_of(folder)) != used.end()) continue;
        const bool named = folder.filename().string().starts_with(name_of(output_));
        // A folder that has lost its journal gets an empty one, which is its lock.
        auto journal = UpdateFile::open_private(folder / kJournal, named, kBusy);
        if (!journal) continue;  // just removed, in use, or another user's
        Workspace other;
        other.journal_ = std::move(*journal);
        auto records = other.read_journal();
        if (!records && resume_ == Resume::go_on) return tl::unexpected(records.error());
        if (!records) continue;
        const std::string text = records->empty() ? "" : as_text((*records)[0].bytes);
        const auto owner = owner_of(text);
        if (owner ? owner->output != output_ : !named) {
            if (part_.rank == 0)
                log::warn(
                    "{} holds {} of an interrupted conversion; resume that one with --resume, or remove it",
                    folder.string(), bytes_text(folder_bytes(folder)));
            continue;
        }
        other.temp_folder_ = temp_folder_;
        other.folder_ = folder;
        if (!owner || records->size() < 2) continue;  // its destructor removes it
        other.part_ = owner->part;
        other.records_ = std::move(*records);
        other.end_ = other.records_.back().end();
        other.resume_ = resume_;
        other.keep_ = resume_ == Resume::go_on;
        if (!other.keep_) {
            if (!other.ended()) removed_ += folder_bytes(folder);
            continue;
        }
        const std::string now = text_of(output_, owner->part, identity_);
        if (text != now) {
            if (!other.ended()) return another_build(folder, difference(text, now));
            other.done();
            continue;
        }
        left.push_back(std::move(other));
    }
    return left;
}

Result<Workspace> Workspace::set_aside() {
    assert(resumable());
    const std::string name = folder_.filename().string();
    std::error_code error;
    fs::path aside;
    for (int number = 1; aside.empty() || fs::exists(aside, error); ++number)
        aside =
            temp_folder_ / fmt::format("{}.before-{}{}", name.substr(0, name.size() - std::strlen(kSuffix)),
                                       number, kSuffix);
    fs::rename(folder_, aside, error);
    if (error) return failed(folder_.string(), fmt::format("cannot be renamed ({})", error.message()));
    Workspace before;
    before.temp_folder_ = temp_folder_;
    before.folder_ = aside;
    before.part_ = part_;
    before.journal_.swap(journal_);
    before.records_.swap(records_);
    std::swap(before.end_, end_);
    before.resume_ = resume_;
    before.keep_ = keep_;
    LUCARNE_TRY(make_private_folder(folder_));
    LUCARNE_ASSIGN(journal_, UpdateFile::open_private(folder_ / kJournal, true, kBusy));
    LUCARNE_TRY(begin(text_of(output_, part_, identity_)));
    return before;
}

Workspace& Workspace::operator=(Workspace&& other) noexcept {
    temp_folder_.swap(other.temp_folder_);
    folder_.swap(other.folder_);
    output_.swap(other.output_);
    identity_.swap(other.identity_);
    std::swap(part_, other.part_);
    journal_.swap(other.journal_);
    records_.swap(other.records_);
    std::swap(end_, other.end_);
    std::swap(removed_, other.removed_);
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
    if (ended()) {  // the others may not have noted it yet
        at_interrupt(folder_, [folder = folder_] {
            return fmt::format("{}: the next conversion to the same cache removes it", folder.string());
        });
        return;
    }
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

uint64_t Workspace::Record::end() const {
    return offset + kHeadBytes + bytes.size();
}

Result<void> Workspace::start(const std::string& identity, Resume resume) {
    keep_ = resume == Resume::go_on;
    LUCARNE_ASSIGN(records_, read_journal());
    if (!records_.empty()) {
        const std::string before = as_text(records_[0].bytes);
        const bool same = records_[0].stage == kIdentity && before == identity;
        if (keep_ && same && records_.size() > 1) {
            if (!ended())
                log::info("going on after '{}' of the interrupted conversion", records_.back().stage);
            end_ = records_.back().end();
            tell_at_interrupt();
            return {};
        }
        if (keep_ && !same && !ended() && part_.count > 1 && records_.size() > 1)
            return another_build(folder_, difference(before, identity));
        if (keep_ && !same && !ended())
            log::warn("the interrupted conversion was another one, starting from the beginning: {}",
                      difference(before, identity));
        if (!keep_ && !ended()) removed_ = folder_bytes(folder_);
    }
    // Files that cannot be removed are emptied when they are opened.
    remove_private_files(folder_, std::span(kFiles).first(kFiles.size() - 1));
    LUCARNE_TRY(journal_->truncate(0));
    return begin(identity);
}

/// Begins an empty journal.
Result<void> Workspace::begin(const std::string& identity) {
    records_.clear();
    end_ = 0;
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

void Workspace::end() {
    if (!journal_ || records_.size() < 2) return;
    if (part_.count > 1 && finish(kEnded, {})) return;
    // Without room for the note, and of one process: the folder has no finished stage.
    if (journal_->truncate(records_[1].offset)) records_.resize(1);
}

Result<void> Workspace::reopen() {
    if (!ended()) return {};
    assert(records_.back().stage == kEnded);
    end_ = records_.back().offset;
    records_.pop_back();
    tell_at_interrupt();
    return journal_->truncate(end_);
}

Result<void> Workspace::begin_anew() {
    if (!journal_) return {};
    LUCARNE_TRY(journal_->truncate(0));
    return begin(text_of(output_, part_, identity_));
}

void Workspace::done() {
    keep_ = false;
    if (folder_.empty()) return;
    records_.clear();
    tell_at_interrupt();
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
