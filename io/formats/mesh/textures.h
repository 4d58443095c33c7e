#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "io/files/file.h"
#include "io/formats/mesh/mesh.h"

namespace lucarne::io::mesh {

/// Reads the files that a mesh names: materials and pictures. None may lie outside the mesh's own folder. If
/// a path leads out of it, or begins at a root or drive, its last part is looked for beside the file that
/// names it. A name that differs only in case from a file's stands for it. Missing or broken files are
/// reported and ignored.
class Companions {
 public:
    Companions(Mesh& mesh, const std::filesystem::path& mesh_file);
    /// Returns the number of a picture in the mesh's textures; kNone if it cannot be read.
    uint32_t texture(std::string_view name, const std::filesystem::path& from);
    /// Returns the text of a material file, only once for each file. Sets `path` to its place.
    std::optional<std::string> text(std::string_view name, std::filesystem::path& path);
    uint64_t state() const { return state_; }  ///< changes with the size and time of any of the files

 private:
    std::filesystem::path place(std::string_view name, const std::filesystem::path& from);
    void count(const ByteSource& file);

    Mesh& mesh_;
    std::filesystem::path folder_;
    std::map<std::filesystem::path, uint32_t> textures_;
    std::map<std::filesystem::path, bool> texts_;
    uint64_t state_ = 0, pixels_ = 0;
    size_t searches_ = 0;
};

}  // namespace lucarne::io::mesh
