#include "gi/registry.h"

#include <gtest/gtest.h>

namespace lucarne::gi {
namespace {

TEST(Registry, UnknownEngineIsAnErrorThatListsTheKnown) {
    const auto engine = make_engine("radiosity");
    ASSERT_FALSE(engine);
    EXPECT_EQ(engine.error().kind, ErrorKind::arguments);
    EXPECT_NE(engine.error().line().find("direct"), std::string::npos);
}

TEST(Registry, EveryEngineAnswersToItsName) {
    for (const EngineEntry& entry : engines()) {
        const auto engine = make_engine(entry.info.name);
        ASSERT_TRUE(engine) << entry.info.name;
        EXPECT_EQ((*engine)->info().name, entry.info.name);
    }
}

}  // namespace
}  // namespace lucarne::gi
