#include "viewer/flythrough/html_report.h"

#include <cmath>

#include <gmock/gmock.h>

#include "viewer/flythrough/report.h"
#include "viewer/flythrough/svg_plot.h"

namespace lucarne::viewer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

size_t count(const std::string& text, const std::string& part) {
    size_t found = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
}

nlohmann::ordered_json flight(const std::string& engine, bool cold) {
    std::vector<FlownFrame> frames(50);
    for (size_t i = 0; i < frames.size(); ++i) {
        frames[i].time = 0.1 * static_cast<double>(i);
        frames[i].stats.seconds = 0.02;
        frames[i].stats.passes = {{"cuts", 0.001}, {"load", 0.0005}, {"G-buffer", 0.015}};
    }
    FlightConditions conditions;
    conditions.inputs = {"a<b>.luc"};
    conditions.engine = engine;
    conditions.preset = "high";
    conditions.mode = "wait";
    conditions.start.cold = cold;
    conditions.build = build_info();
    conditions.machine = machine_info();
    return flight_report(conditions, frames);
}

TEST(SvgPlot, TicksAreRoundAndReachTheLargest) {
    EXPECT_THAT(ticks_up_to(10, 5), ElementsAre(0, 2, 4, 6, 8, 10));
    EXPECT_THAT(ticks_up_to(0.7, 4), ElementsAre(0, testing::DoubleEq(0.2), testing::DoubleEq(0.4),
                                                 testing::DoubleNear(0.6, 1e-12), testing::DoubleEq(0.8)));
    EXPECT_THAT(ticks_up_to(0), ElementsAre(0));
    EXPECT_THAT(ticks_up_to(std::nan("")), ElementsAre(0));
}

TEST(SvgPlot, LongCurvesAreShortAndKeepTheirSpikes) {
    Curve curve{"a", {}, {}};
    for (int i = 0; i < 100'000; ++i) {
        curve.x.push_back(i);
        curve.y.push_back(i == 54'321 ? 1000 : 1);
    }
    const std::string svg = svg_of({"title", "x", "y", {curve}});
    EXPECT_LT(svg.size(), 30'000u);
    Curve cut = curve;
    cut.y[54'321] = 1;
    EXPECT_NE(svg, svg_of({"title", "x", "y", {cut}}));
}

TEST(SvgPlot, NothingToDrawIsAnEmptyPlot) {
    EXPECT_THAT(svg_of({"t", "x", "y", {}}), HasSubstr("</svg>"));
    EXPECT_THAT(svg_of({"t", "x", "y", {{"none", {}, {}}}, true}), HasSubstr("</svg>"));
}

TEST(HtmlReport, IsOnePageThatAsksNothingOfTheNetwork) {
    const std::string page =
        html_report({flight("vpl", true), flight("vpl", false), flight("direct", false)});
    for (const char* part : {"http:", "https:", "src=", "href=", "@import", "url(", "<script"})
        EXPECT_THAT(page, Not(HasSubstr(part)));
    EXPECT_THAT(page, HasSubstr("vpl, cold"));
    EXPECT_THAT(page, HasSubstr(build_info().revision));
    EXPECT_EQ(count(page, "<svg"), count(page, "</svg>"));
    EXPECT_EQ(count(page, "<svg"), 5u + 3u) << "five plots of all flights, and each one's passes";
    EXPECT_EQ(count(page, "<polyline"), 5u * 3u);
}

TEST(HtmlReport, NamesOfFilesAreNoMarkup) {
    const std::string page = html_report({flight("vpl", false)});
    EXPECT_THAT(page, HasSubstr("a&lt;b&gt;.luc"));
    EXPECT_THAT(page, Not(HasSubstr("a<b>")));
    EXPECT_EQ(escaped("<&\"'>"), "&lt;&amp;&quot;&#39;&gt;");
}

}  // namespace
}  // namespace lucarne::viewer
