#include "viewer/measure/worker.h"

#include <utility>

#include <fmt/format.h>

#include "viewer/ui/whole_path.h"

namespace lucarne::viewer {
NodeCache& MeasureWorker::cache_of(const std::shared_ptr<const octree::NodeSource>& source) {
    if (!cache_ || cache_->source() != source) cache_ = std::make_unique<NodeCache>(source);
    return *cache_;
}

void MeasureWorker::pick(std::shared_ptr<const Picture> picture, const glm::dvec2& place) {
    if (waiting_ >= kMostWaiting) return;
    ++waiting_;
    picking_.push(
        "picking",
        [this, picture = std::move(picture), place] {
            return pick_point(*picture, place, cache_of(picture->source));
        },
        [this](Pick found) {
            {
                const std::lock_guard lock(mutex_);
                picks_.push_back(std::move(found));
            }
            --waiting_;
            published_();
        });
}

std::vector<MeasureWorker::Pick> MeasureWorker::take_picks() {
    const std::lock_guard lock(mutex_);
    return std::exchange(picks_, {});
}

void MeasureWorker::say(std::string message) {
    {
        const std::lock_guard lock(mutex_);
        message_ = std::move(message);
    }
    published_();
}

std::optional<std::string> MeasureWorker::take_message() {
    const std::lock_guard lock(mutex_);
    return std::exchange(message_, std::nullopt);
}

void MeasureWorker::read(std::shared_ptr<const octree::NodeSource> source, const Slice& slice) {
    {
        const std::lock_guard lock(mutex_);
        if (source == section_source_ && slice_ == slice) return;
        section_source_ = source;
        slice_ = slice;
        section_ = nullptr;
    }
    *stop_ = true;
    stop_ = std::make_shared<std::atomic<bool>>(false);
    const auto work = [this, source = std::move(source), slice, stop = stop_]() -> Result<void> {
        if (*stop) return {};
        const auto publish = [&](const Section& section) {
            auto copy = std::make_shared<const Section>(section);
            {
                const std::lock_guard lock(mutex_);
                if (slice_ == slice && section_source_ == source) section_ = std::move(copy);
            }
            published_();
        };
        LUCARNE_ASSIGN(const Section section, read_section(*source, slice, kMostSectionPoints,
                                                           [&](const Section& now, bool level_done) {
                                                               if (level_done) publish(now);
                                                               return !*stop;
                                                           }));
        if (!*stop) publish(section);
        return {};
    };
    sections_.push("section", work, [this](const Result<void>& read) {
        if (!read) say(read.error().line());
    });
}

std::shared_ptr<const Section> MeasureWorker::section() const {
    const std::lock_guard lock(mutex_);
    return section_;
}

Result<void> MeasureWorker::write_section(const std::filesystem::path& base, const std::string& title,
                                          const UnitChoice& units) {
    std::shared_ptr<const Section> section;
    std::shared_ptr<const octree::NodeSource> source;
    {
        const std::lock_guard lock(mutex_);
        section = section_;
        source = section_source_;
    }
    if (!section) return failed("section", "there is none to save");
    NodeCache cache(source);
    return viewer::write_section(base, *section, title, units, cache, false);
}

void MeasureWorker::save_section(const std::filesystem::path& base, const std::string& title,
                                 const UnitChoice& units) {
    sections_.push(
        "section", [=, this] { return write_section(base, title, units); },
        [=, this](const Result<void>& written) {
            say(written ? fmt::format("saved {}.csv and .svg", whole_path(base)) : written.error().line());
        });
}

}  // namespace lucarne::viewer
