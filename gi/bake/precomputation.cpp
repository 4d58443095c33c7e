#include "gi/bake/precomputation.h"

#include <string_view>
#include <type_traits>

#include <xxhash.h>

namespace lucarne::gi {
namespace {

class Hash {
 public:
    void add(std::string_view text) { value_ = XXH3_64bits_withSeed(text.data(), text.size(), value_); }
    template <class T>
    void add(std::span<const T> values) {
        static_assert(std::is_trivially_copyable_v<T>);
        value_ = XXH3_64bits_withSeed(values.data(), values.size_bytes(), value_);
    }
    void add(uint64_t number) { add(std::span<const uint64_t>(&number, 1)); }
    uint64_t value() const { return value_; }

 private:
    uint64_t value_ = 0;
};

}  // namespace

uint64_t bake_key(std::string_view engine, const Precomputes& how, const BakeInput& input) {
    Hash hash;
    hash.add(engine);
    hash.add(how.version);
    hash.add(input.source);
    hash.add(input.cut.shapes);
    if (how.colours) hash.add(input.cut.colours);
    if (how.materials) hash.add(std::span<const Material>(input.materials));
    if (how.lights) hash.add(std::span<const Light>(input.lights));
    if (how.environment && input.environment) {
        const Environment& sky = *input.environment;
        hash.add(uint64_t{sky.width} << 32 | sky.height);
        hash.add(std::span<const glm::vec3>(sky.texels));
        hash.add(std::span<const float>(&sky.rotation, 1));
    }
    if (how.lighting_region && input.lighting_region) {
        const glm::vec3 corners[] = {input.lighting_region->min, input.lighting_region->max};
        hash.add("lighting region");
        hash.add(std::span<const glm::vec3>(corners));
    }
    for (const OptionInfo* option : how.options) {
        hash.add(option->key);
        hash.add(option_text(*option, input.settings.get(*option)));
    }
    return hash.value();
}

}  // namespace lucarne::gi
