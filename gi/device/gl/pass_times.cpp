#include "gi/device/gl/pass_times.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <epoxy/gl.h>

namespace lucarne::gi {
namespace {

double seconds_now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

uint64_t nanoseconds_of(uint32_t query) {
    GLuint64 time = 0;
    glGetQueryObjectui64v(query, GL_QUERY_RESULT, &time);  // waits for it
    return time;
}

}  // namespace

PassTimes::~PassTimes() {
    if (!queries_.empty()) glDeleteQueries(static_cast<GLsizei>(queries_.size()), queries_.data());
}

void PassTimes::begin(std::string name) {
    name_ = std::move(name);
    if (clock_ == Clock::wall) {
        device_.finish();
    } else {
        device_.finish_opencl();
        if (queries_.size() < 2 * (passes_.size() + 1)) {
            queries_.resize(queries_.size() + 2);
            glCreateQueries(GL_TIMESTAMP, 2, &queries_[queries_.size() - 2]);
        }
        glQueryCounter(queries_[2 * passes_.size()], GL_TIMESTAMP);
    }
    start_ = seconds_now();
}

void PassTimes::end() {
    if (clock_ == Clock::wall) {
        device_.finish();
    } else {
        glQueryCounter(queries_[2 * passes_.size() + 1], GL_TIMESTAMP);
        device_.finish_opencl();
    }
    passes_.push_back({std::move(name_), seconds_now() - start_});
}

void PassTimes::finish() {
    device_.finish();
    if (clock_ == Clock::wall) return;
    for (; resolved_ < passes_.size(); ++resolved_) {
        const uint64_t begun = nanoseconds_of(queries_[2 * resolved_]);
        const uint64_t ended = nanoseconds_of(queries_[2 * resolved_ + 1]);
        const double device_seconds = ended > begun ? 1e-9 * static_cast<double>(ended - begun) : 0.0;
        passes_[resolved_].seconds = std::max(passes_[resolved_].seconds, device_seconds);
    }
}

void PassTimes::clear() {
    passes_.clear();
    resolved_ = 0;
}

}  // namespace lucarne::gi
