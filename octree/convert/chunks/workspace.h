#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/files/file.h"
#include "io/files/update_file.h"

namespace lucarne::octree {

/// What becomes of a build's scratch files when it is interrupted.
enum class Resume {
    never,  ///< they are nameless: nothing is left, however the process ends
    later,  ///< a signal or a power cut leaves them for `go_on`; any other failure removes them
    go_on   ///< goes on from the last stage that an interrupted build finished, if there was one
};

/// The scratch files of a build and the journal of its finished stages, in a folder of their own beside the
/// output or in the temporary folder. Others can guess its name, so it is used only where it is private
/// (io/files/private_file.h); else the scratch files are nameless, with a warning. Nothing in it is synced:
/// every record of the journal has a checksum, and has those of the scratch files it speaks of, so that what
/// a power cut took is noticed and done again.
class Workspace {
 public:
    /// `identity` says what is built from what with which options; another build's leftovers are not used.
    /// Errors: somebody else is building `output`; no folder can be made.
    static Result<Workspace> open(const std::filesystem::path& temp_folder,
                                  const std::filesystem::path& output, const std::string& identity,
                                  Resume resume);
    Workspace(Workspace&& other) noexcept { *this = std::move(other); }
    Workspace& operator=(Workspace&& other) noexcept;
    /// Removes the folder, unless `go_on` was asked for, a stage was finished, and the output was not.
    ~Workspace();

    /// `kept`: with what an interrupted build wrote to it.
    Result<ScratchFile> scratch(const std::string& name, bool kept) const;
    /// Whether what is written may be wanted by a resumed build.
    bool resumable() const { return journal_.has_value(); }
    /// What was written down about a stage; null where it was not finished.
    const std::vector<std::byte>* finished(const std::string& stage) const;
    /// Writes a stage down; it and those after it are forgotten first.
    Result<void> finish(const std::string& stage, std::vector<std::byte> record);
    /// The output is there: nothing needs to be resumed any more.
    void done() { keep_ = false; }

 private:
    struct Record {
        std::string stage;
        std::vector<std::byte> bytes;
        uint64_t offset = 0;  ///< in the journal
    };
    Workspace() = default;
    Result<std::vector<Record>> read_journal() const;
    Result<void> start(const std::string& identity, Resume resume);
    Result<void> append(Record record);
    void tell_at_interrupt() const;

    std::filesystem::path temp_folder_, folder_;  ///< `folder_` is empty where nothing has a name
    std::optional<UpdateFile> journal_;
    std::vector<Record> records_;
    uint64_t end_ = 0;
    Resume resume_ = Resume::never;
    bool keep_ = false;
};

}  // namespace lucarne::octree
