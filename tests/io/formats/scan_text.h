#pragma once

#include "tests/io/io_testing.h"

namespace lucarne::io::testing {

/// Shared by tests of small files: a file in memory, opened and read completely.
class TextScan : public ::testing::Test {
 protected:
    Result<void> try_read(std::string_view bytes, const ReadOptions& options) {
        file_.set(bytes);
        source_ = nullptr;
        records_ = {};
        LUCARNE_ASSIGN(source_, open_scan(file_.path(), options));
        LUCARNE_ASSIGN(records_, read_all(*source_, 3));
        return {};
    }
    void read(std::string_view bytes, const ReadOptions& options = {"", true}) {
        const auto done = try_read(bytes, options);
        EXPECT_TRUE(done) << done.error().line() << '\n' << bytes.substr(0, 300);
    }
    /// Returns the error of opening or reading; empty if both succeed.
    Error error_of(std::string_view bytes, const ReadOptions& options = {"", true}) {
        const auto done = try_read(bytes, options);
        return done ? Error{} : done.error();
    }
    size_t points() const { return records_.count; }
    const Schema& schema() const { return source_->schema(); }
    glm::dvec3 position(size_t i) const {
        if (i < points()) return position_of(schema(), &records_.bytes[i * schema().stride]);
        ADD_FAILURE() << "no point " << i;
        return glm::dvec3(0.0);
    }
    double value(size_t i, std::string_view name, size_t component = 0) const {
        const Attribute* a = source_ ? schema().find(name) : nullptr;
        if (a && i < points() && component < a->components)
            return scalar_at(
                a->type,
                &records_.bytes[i * schema().stride + a->offset + component * scalar_bytes(a->type)]);
        ADD_FAILURE() << "no " << name << " of point " << i;
        return 0;
    }

    const MemoryFile file_;
    std::unique_ptr<PointSource> source_;
    Records records_;
};

}  // namespace lucarne::io::testing
