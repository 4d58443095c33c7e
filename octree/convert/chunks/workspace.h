#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/files/file.h"
#include "io/files/update_file.h"

namespace lucarne::octree {

/// What happens to a build's scratch files when it is interrupted.
enum class Resume {
    never,  ///< they are nameless: nothing is left, however the process ends
    later,  ///< a signal or a power cut leaves them for `go_on`; any other failure removes them
    go_on   ///< continues after the last stage that an interrupted build finished, if there was one
};

/// The scratch files of a build and the journal of its finished stages, in a folder of their own beside the
/// output or in the temporary folder. The folder's name can be guessed, so it is used only if it is private
/// (io/files/private_file.h); otherwise the scratch files are nameless, with a warning. Nothing in the folder
/// is synced. Each record of the journal has a checksum and contains those of the scratch files that it
/// refers to, so a stage whose data a power cut destroyed is detected and run again.
class Workspace {
 public:
    /// Which process of how many a folder belongs to. Each has a folder of its own, also for each number of
    /// them.
    struct Part {
        uint64_t rank = 0, count = 1;
    };
    /// `identity` says what is built from which inputs with which options; leftovers of another build are not
    /// used. Errors: another process is building `output`; no folder can be made; the build of several
    /// processes is to go on, and the folder has stages of another one.
    static Result<Workspace> open(const std::filesystem::path& temp_folder,
                                  const std::filesystem::path& output, const std::string& identity,
                                  Resume resume, Part part);
    /// Returns whether a process has the folder of a build by one process open.
    static bool in_use(const std::filesystem::path& temp_folder, const std::filesystem::path& output);
    /// Tells the folder from all others, also where locks do not reach from one machine to another; empty
    /// without a folder.
    std::string mark() const;
    /// Opens the other folders that are left of the same output, as far as no other process has them open: of
    /// other numbers of processes, or of a process that runs on another machine now. If the build is not to
    /// go on, they are removed instead, and so are those without a finished stage and those of another build
    /// that has ended. `used`: the marks of all
    /// processes, which have opened their own folders. Errors: the build is to go on, and a folder has stages
    /// of another one, or its journal cannot be read.
    Result<std::vector<Workspace>> left_by_others(std::span<const std::string> used);
    /// Returns how much of an interrupted build was removed that `go_on` would have used, bytes.
    uint64_t removed() const { return removed_; }
    /// Gives the folder another name and returns it. This workspace begins anew in an empty folder.
    Result<Workspace> set_aside();
    Workspace(Workspace&& other) noexcept { *this = std::move(other); }
    Workspace& operator=(Workspace&& other) noexcept;
    /// Removes the folder, unless `go_on` was given, a stage was finished, and the output was not.
    ~Workspace();

    /// Opens a scratch file. `kept`: with what an interrupted build wrote to it.
    Result<ScratchFile> scratch(const std::string& name, bool kept) const;
    Part part() const { return part_; }
    /// Whether a resumed build may want the scratch files.
    bool resumable() const { return journal_.has_value(); }
    /// Returns the record of a finished stage, null if it was not finished.
    const std::vector<std::byte>* finished(const std::string& stage) const;
    /// Records a finished stage. Drops earlier records of it and of the stages after it.
    Result<void> finish(const std::string& stage, std::vector<std::byte> record);
    /// Notes that the output is complete. A folder with this note is not missed if others of the same build
    /// are gone. So of several processes, all note it before one of them calls done().
    void end();
    bool ended() const { return finished(kEnded) != nullptr; }
    /// Forgets that the output was complete, because it is made again.
    Result<void> reopen();
    /// Forgets all stages.
    Result<void> begin_anew();
    /// Call when the output is complete: nothing needs to be resumed any more.
    void done();

 private:
    struct Record {
        std::string stage;
        std::vector<std::byte> bytes;
        uint64_t offset = 0;  ///< in the journal
        uint64_t end() const;
    };
    static constexpr const char* kEnded = "ended";
    Workspace() = default;
    static std::string text_of(const std::string& output, Part part, const std::string& identity);
    Result<std::vector<Record>> read_journal() const;
    Result<void> start(const std::string& identity, Resume resume);
    Result<void> begin(const std::string& identity);
    Result<void> append(Record record);
    void tell_at_interrupt() const;

    std::filesystem::path temp_folder_, folder_;  ///< `folder_` is empty if the scratch files are nameless
    std::string output_, identity_;
    Part part_;
    std::optional<UpdateFile> journal_;
    std::vector<Record> records_;
    uint64_t end_ = 0, removed_ = 0;
    Resume resume_ = Resume::never;
    bool keep_ = false;
};

}  // namespace lucarne::octree
