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

/// The files that a mesh names: materials and pictures. None may lie outside the mesh's own folder: of a path
/// that leads out, or begins at a root or drive, the bare name is looked for beside the file that names it.
/// What is missing or broken is said, and done without.
class Companions {
 public:
    Companions(Mesh& mesh, const std::filesystem::path& mesh_file);
    /// The number of a picture in the mesh's textures; kNone where there is none to be had.
    uint32_t texture(std::string_view name, const std::filesystem::path& from);
    /// The text of a material file, once each; `path` is its place.
    std::optional<std::string> text(std::string_view name, std::filesystem::path& path);
    uint64_t state() const { return state_; }  ///< changes with size and time of any file

 private:
    std::filesystem::path place(std::string_view name, const std::filesystem::path& from) const;
    void count(const ByteSource& file);

    Mesh& mesh_;
    std::filesystem::path folder_;
    std::map<std::filesystem::path, uint32_t> textures_;
    std::map<std::filesystem::path, bool> texts_;
    uint64_t state_ = 0, pixels_ = 0;
};

}  // namespace lucarne::io::mesh
