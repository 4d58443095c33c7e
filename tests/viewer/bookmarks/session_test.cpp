// Bookmarks of several scans, loaded and saved while the user changes them.
#include "viewer/bookmarks/session.h"

#include <gmock/gmock.h>

#include "tests/viewer/program.h"

namespace lucarne::viewer {
namespace {

using testing::ElementsAre;

class KeptBookmarks : public testing::Test {
 protected:
    static Bookmark named(const std::string& name) {
        Bookmark bookmark;
        bookmark.camera.name = name;
        return bookmark;
    }
    static std::vector<std::string> names(const std::vector<Bookmark>& bookmarks) {
        std::vector<std::string> all;
        for (const Bookmark& bookmark : bookmarks) all.push_back(bookmark.camera.name);
        return all;
    }
    std::vector<std::string> saved(const char* scan) const {
        return names(load_bookmarks(folder_.path() / scan).bookmarks);
    }
    void set(const std::string& name) {
        model_.all.push_back(named(name));
        model_.commands.push(SaveBookmarks{});
    }
    void follow(const char* scan) { session_->follow({view_, model_}, folder_.path() / scan); }
    /// Calls follow() until the bookmarks of the scan's file are loaded.
    void load(const char* scan, size_t count) {
        ASSERT_TRUE(test::eventually(
            [&] {
                follow(scan);
                return model_.all.size() == count;
            },
            std::chrono::milliseconds(5)))
            << model_.all.size();
    }

    const test::TemporaryFolder folder_;
    View view_{10};
    BookmarkModel model_;
    std::optional<BookmarkSession> session_{std::in_place, [](const io::Image8&) { return 1u; },
                                            [](unsigned) {}};
};

TEST_F(KeptBookmarks, SetJustBeforeAnotherScanIsShownBelongToTheOldScan) {
    ASSERT_TRUE(save_bookmarks({named("theirs")}, folder_.path() / "b"));
    follow("a");
    set("mine");
    load("b", 1);
    EXPECT_THAT(names(model_.all), ElementsAre("theirs"));
    session_.reset();  // waits for the files
    EXPECT_THAT(saved("a"), ElementsAre("mine"));
    EXPECT_THAT(saved("b"), ElementsAre("theirs"));
}

TEST_F(KeptBookmarks, SetWhileOthersAreBeingReadAreSavedTogetherWithThem) {
    ASSERT_TRUE(save_bookmarks({named("first"), named("second")}, folder_.path() / "a"));
    follow("a");
    set("third");
    load("a", 3);
    EXPECT_THAT(names(model_.all), ElementsAre("first", "second", "third"));
    follow("a");
    session_.reset();
    EXPECT_THAT(saved("a"), ElementsAre("first", "second", "third"));
}

}  // namespace
}  // namespace lucarne::viewer
