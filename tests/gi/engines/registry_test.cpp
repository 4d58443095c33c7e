#include "gi/registry.h"

#include <algorithm>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
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

TEST(Options, HaveDefaultsThatTheyThemselvesAllow) {
    for (const OptionInfo* option : engine_options())
        for (const OptionValue& value : option->defaults) {
            const std::string text = option_text(*option, value);
            if (text == option->unset) continue;
            const auto read = parse_option(*option, text);
            ASSERT_TRUE(read) << read.error().line();
            EXPECT_EQ(*read, value) << option->key;
        }
}

TEST(Options, OfOneKeyAreTheSameInEveryEngine) {
    for (const EngineEntry& entry : engines())
        for (const OptionInfo* option : entry.info.options)
            EXPECT_EQ(find_option(option->key), option) << option->key;
}

TEST(Options, ReadWhatTheyAllowAndNothingElse) {
    for (const OptionInfo* option : engine_options()) {
        if (option->kind != OptionKind::integer) continue;
        for (const double value : {option->least, option->most})
            EXPECT_TRUE(parse_option(*option, fmt::format("{:.0f}", value))) << option->key;
        for (const std::string& wrong :
             {fmt::format("{:.0f}", option->least - 1), fmt::format("{:.0f}", option->most + 1),
              std::string(), std::string("1x"), std::string("0x10"), std::string(" 1"), std::string("nan"),
              std::string(400, '9')})
            EXPECT_FALSE(parse_option(*option, wrong)) << option->key << " " << wrong;
    }
}

TEST(EngineSettings, HaveTheDefaultsOfInteractiveUntilTheyAreSet) {
    EngineSettings settings;
    for (const OptionInfo* option : engine_options())
        EXPECT_EQ(settings.get(*option), default_settings(Effort::interactive).get(*option)) << option->key;
    EngineSettings over;
    const OptionInfo* bounces = find_option("bounces");
    ASSERT_NE(bounces, nullptr);
    over.set(*bounces, int64_t{7});
    settings.override_with(over);
    EXPECT_EQ(settings.get(*bounces), OptionValue(int64_t{7}));
    EngineSettings under = default_settings(Effort::high);
    over.fill_from(under);
    EXPECT_EQ(over.get(*bounces), OptionValue(int64_t{7}));
}

/// Returns the table of options in data/README.md.
std::string options_table() {
    std::string table =
        "| key | values | preview, interactive, high | engines | meaning |\n| --- | --- | --- | --- | --- "
        "|\n";
    for (const OptionInfo* option : engine_options()) {
        std::string owners, defaults;
        for (const EngineEntry& entry : engines())
            if (std::ranges::find(entry.info.options, option) != entry.info.options.end())
                owners += fmt::format("{}`{}`", owners.empty() ? "" : ", ", entry.info.name);
        for (const OptionValue& value : option->defaults)
            defaults += (defaults.empty() ? "" : ", ") + option_text(*option, value);
        std::string name = option->flag_name();
        table += fmt::format("| `{}`, `{}` | {} | {} | {} | {} |\n", option->key, name, range_text(*option),
                             defaults, owners, option->help);
    }
    return table;
}

TEST(Options, TableOfTheDocumentsIsThatOfTheEngines) {
    std::stringstream document;
    document << std::ifstream(LUCARNE_SOURCE_DIR "/data/README.md").rdbuf();
    EXPECT_NE(document.str().find(options_table()), std::string::npos)
        << "put this table into data/README.md:\n"
        << options_table();
}

}  // namespace
}  // namespace lucarne::gi
