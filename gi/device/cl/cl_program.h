#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "gi/device/cl/cl_context.h"
#include "gi/device/cl/cl_kernel.h"
#include "io/core/error.h"

struct _cl_program;

namespace lucarne::gi {

/// A compiled OpenCL program and the kernels that were asked of it.
class ClProgram {
 public:
    /// `path` names it in errors. It has no kernels until compile() succeeds.
    ClProgram(ClContext& context, std::string_view path) : context_(context), path_(path) {}
    ~ClProgram();
    ClProgram(const ClProgram&) = delete;
    ClProgram& operator=(const ClProgram&) = delete;

    /// Compiles `text`, which replaces the one before; kernels keep their addresses. Errors: the compiler's
    /// first message with file and line, or a kernel that was asked for earlier is missing. After an error
    /// the last good program stays.
    Result<void> compile(std::string text);
    /// Returns what the program was compiled from; empty before the first compile().
    const std::string& text() const { return text_; }
    /// Returns the kernel function `name`. Errors: there is none.
    Result<const ClKernel*> kernel(std::string_view name);

 private:
    Result<_cl_kernel*> make_kernel(_cl_program* program, const std::string& name) const;
    std::string name_of(std::string_view kernel) const;

    ClContext& context_;
    std::string path_, text_;
    _cl_program* program_ = nullptr;
    std::map<std::string, std::unique_ptr<ClKernel>, std::less<>> kernels_;
};

}  // namespace lucarne::gi
