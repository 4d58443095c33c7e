#include "viewer/flythrough/compare_flights.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/format.h>

#include "io/files/json.h"
#include "viewer/flythrough/report.h"

namespace lucarne::viewer {
namespace {

constexpr size_t kMostFlights = 100, kMostReportFrames = 1'000'000;
constexpr size_t kResamples = 2000;
constexpr double kConfidence = 0.95;
constexpr double kLeastMs = 1e-6;  ///< shorter times are below the clock's resolution; keeps ratios finite

double median(std::vector<double> values) {
    return quantile(std::move(values), 0.5);
}

/// Draws the indices of a resampled series: blocks of neighbours with replacement.
class BlockBootstrap {
 public:
    explicit BlockBootstrap(size_t count)
        : count_(count),
          block_(std::max<size_t>(1, static_cast<size_t>(std::cbrt(static_cast<double>(count)) + 0.5))) {}

    std::vector<double> draw(const std::vector<double>& values, std::mt19937_64& random) const {
        std::vector<double> drawn;
        drawn.reserve(count_);
        while (drawn.size() < count_) {
            const size_t first = random() % (count_ - block_ + 1);
            for (size_t i = 0; i < block_ && drawn.size() < count_; ++i) drawn.push_back(values[first + i]);
        }
        return drawn;
    }

 private:
    size_t count_, block_;
};

/// Evaluates `once` for many resamples. Sets the interval that contains kConfidence of the results.
template <class Once>
void bootstrap(FlightComparison& comparison, const Once& once) {
    std::mt19937_64 random(1);
    std::vector<double> ratios;
    for (size_t i = 0; i < kResamples; ++i) ratios.push_back(std::exp(once(random)));
    comparison.low = quantile(ratios, (1 - kConfidence) / 2);
    comparison.high = quantile(ratios, (1 + kConfidence) / 2);
}

/// Returns the two-sided p of Mann & Whitney's test ("On a test of whether one of two random variables is
/// stochastically larger than the other", 1947), by the normal approximation with ties.
double mann_whitney(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<std::pair<double, bool>> all;
    for (const double value : a) all.emplace_back(value, true);
    for (const double value : b) all.emplace_back(value, false);
    std::ranges::sort(all);
    const double n = static_cast<double>(all.size()), na = static_cast<double>(a.size()),
                 nb = static_cast<double>(b.size());
    double ranks_of_a = 0, ties = 0;
    for (size_t i = 0; i < all.size();) {
        size_t end = i;
        while (end < all.size() && all[end].first == all[i].first) ++end;
        const double tied = static_cast<double>(end - i), rank = static_cast<double>(i + end + 1) / 2;
        for (size_t k = i; k < end; ++k) ranks_of_a += all[k].second ? rank : 0;
        ties += tied * (tied * tied - 1);
        i = end;
    }
    const double u = ranks_of_a - na * (na + 1) / 2;
    const double variance = na * nb / 12 * (n + 1 - ties / (n * (n - 1)));
    if (!(variance > 0)) return 1;
    return std::erfc(std::abs(u - na * nb / 2) / std::sqrt(2 * variance));
}

std::vector<double> logarithms(const std::vector<double>& ms) {
    std::vector<double> logs;
    for (const double value : ms) logs.push_back(std::log(std::max(value, kLeastMs)));
    return logs;
}

Verdict verdict_of(const FlightComparison& c, double margin) {
    const bool seen = c.paired || c.p < 1 - kConfidence;
    if (seen && c.low > 1 + margin) return Verdict::slower;
    if (seen && c.high < 1 / (1 + margin)) return Verdict::faster;
    return c.low >= 1 / (1 + margin) && c.high <= 1 + margin ? Verdict::same : Verdict::unclear;
}

Result<FlownReport> read_flight(JsonObject& object) {
    FlownReport report;
    LUCARNE_ASSIGN(report.engine, object.text("engine"));
    LUCARNE_ASSIGN(report.mode, object.text("mode"));
    LUCARNE_ASSIGN(report.preset, object.text("preset"));
    LUCARNE_ASSIGN(auto start, object.object("start"));
    if (start) {
        LUCARNE_ASSIGN(report.cold, start->boolean("cold", false));
    }
    LUCARNE_ASSIGN(auto frames, object.objects("each_frame", kMostReportFrames));
    for (JsonObject& frame : frames) {
        LUCARNE_ASSIGN(const double time, frame.number("time", {0, 1e9}));
        LUCARNE_ASSIGN(const double ms, frame.number("ms", {0, 1e9}));
        report.times.push_back(time);
        report.ms.push_back(ms);
    }
    if (report.ms.empty()) return object.wrong("holds no frame", "each_frame");
    return report;
}

}  // namespace

std::string FlownReport::name() const {
    return engine + (cold ? ", cold" : "") + ", " + mode;
}

Result<std::vector<FlownReport>> read_flights(const std::filesystem::path& path) {
    LUCARNE_ASSIGN(const nlohmann::json document, load_json(path));
    LUCARNE_ASSIGN(JsonObject root, JsonObject::of(document, path.string()));
    std::vector<FlownReport> flights;
    if (!root.has("flights")) {
        LUCARNE_ASSIGN(flights.emplace_back(), read_flight(root));
        return flights;
    }
    LUCARNE_ASSIGN(auto list, root.objects("flights", kMostFlights));
    for (JsonObject& object : list) {
        LUCARNE_ASSIGN(flights.emplace_back(), read_flight(object));
    }
    if (flights.empty()) return root.wrong("is empty", "flights");
    return flights;
}

FlightComparison compare_flights(const FlownReport& a, const FlownReport& b, double margin) {
    const std::vector<double> of_a = logarithms(a.ms), of_b = logarithms(b.ms);
    FlightComparison comparison;
    comparison.paired = a.times == b.times;
    if (comparison.paired) {
        std::vector<double> ratios;
        for (size_t i = 0; i < of_a.size(); ++i) ratios.push_back(of_b[i] - of_a[i]);
        const BlockBootstrap blocks(ratios.size());
        comparison.ratio = std::exp(median(ratios));
        bootstrap(comparison, [&](std::mt19937_64& random) { return median(blocks.draw(ratios, random)); });
    } else {
        const BlockBootstrap blocks_a(of_a.size()), blocks_b(of_b.size());
        comparison.ratio = std::exp(median(of_b) - median(of_a));
        comparison.p = mann_whitney(of_a, of_b);
        bootstrap(comparison, [&](std::mt19937_64& random) {
            const double resampled = median(blocks_a.draw(of_a, random));
            return median(blocks_b.draw(of_b, random)) - resampled;
        });
    }
    comparison.verdict = verdict_of(comparison, margin);
    return comparison;
}

std::string verdict_text(const FlightComparison& c, const FlownReport& a, const FlownReport& b) {
    const auto percent = [](double ratio) { return 100 * (ratio - 1); };
    const std::string verdict = c.verdict == Verdict::faster   ? "B is faster than A"
                                : c.verdict == Verdict::slower ? "B is slower than A"
                                : c.verdict == Verdict::same   ? "no difference"
                                                               : "no difference shown";
    const std::string how = c.paired
                                ? fmt::format("{} frames in pairs", a.ms.size())
                                : fmt::format("{} and {} frames, p = {:.2g}", a.ms.size(), b.ms.size(), c.p);
    return fmt::format("{}: B's frames take {:+.1f} % (95 % confidence {:+.1f} to {:+.1f} %; {})", verdict,
                       percent(c.ratio), percent(c.low), percent(c.high), how);
}

}  // namespace lucarne::viewer
