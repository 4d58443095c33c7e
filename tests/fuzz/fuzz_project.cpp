#include <cstdlib>

#include "tests/fuzz/fuzz.h"
#include "viewer/project/project.h"

bool lucarne::fuzz::run(const uint8_t* data, size_t size) {
    using namespace viewer;
    const auto project =
        parse_project({reinterpret_cast<const char*>(data), size}, "fuzz", "/nonexistent", std::nullopt);
    if (!project) return true;
    (void)find_scans(project->scans, "/nonexistent");
    // What is kept of a project that is accepted must be accepted again.
    const std::string text = project_text(*project, 1, "/nonexistent");
    const auto again = parse_project(text, "again", "/nonexistent", std::nullopt);
    if (!again || again->scans != project->scans || again->scene.lights != project->scene.lights ||
        again->measurements.size() != project->measurements.size())
        std::abort();
    return true;
}
