#include "octree/convert/scans/unify.h"

#include <algorithm>

#include <fmt/format.h>

#include "octree/cache/format.h"
#include "octree/tree/scan_number.h"
#include "octree/tree/stored_names.h"

namespace lucarne::octree {
namespace {

using io::ScalarType;

bool is_float(ScalarType t) {
    return t == ScalarType::f32 || t == ScalarType::f64;
}
bool is_signed(ScalarType t) {
    return t == ScalarType::i8 || t == ScalarType::i16 || t == ScalarType::i32 || t == ScalarType::i64;
}

ScalarType integer_type(bool with_sign, size_t bytes) {
    switch (bytes) {
        case 1:
            return with_sign ? ScalarType::i8 : ScalarType::u8;
        case 2:
            return with_sign ? ScalarType::i16 : ScalarType::u16;
        case 4:
            return with_sign ? ScalarType::i32 : ScalarType::u32;
        default:
            return with_sign ? ScalarType::i64 : ScalarType::u64;
    }
}

/// Returns the narrowest type that can represent every value of both; empty if there is none.
std::optional<ScalarType> common_type(ScalarType a, ScalarType b) {
    if (a == b) return a;
    if (is_float(a) || is_float(b)) {
        // Integers of up to 4 bytes are exact in a double, of up to 2 bytes in a float.
        const auto need = [](ScalarType t) {
            return is_float(t) ? io::scalar_bytes(t) : 2 * io::scalar_bytes(t);
        };
        const size_t bytes = std::max(need(a), need(b));
        if (bytes > 8) return std::nullopt;
        return bytes <= 4 ? ScalarType::f32 : ScalarType::f64;
    }
    if (is_signed(a) == is_signed(b))
        return integer_type(is_signed(a), std::max(io::scalar_bytes(a), io::scalar_bytes(b)));
    const size_t with = io::scalar_bytes(is_signed(a) ? a : b),
                 without = io::scalar_bytes(is_signed(a) ? b : a);
    const size_t bytes = std::max(with, 2 * without);
    if (bytes > 8) return std::nullopt;
    return integer_type(true, bytes);
}

}  // namespace

Result<Unifier> Unifier::create(std::vector<const io::PointSource*> sources, bool replace_normals) {
    if (sources.empty()) return bad_arguments("inputs", "there are none");
    if (sources.size() > kMostScans)
        return bad_arguments("inputs", fmt::format("{} are more than {}", sources.size(), kMostScans));
    Unifier unifier;
    unifier.sources_ = std::move(sources);
    unifier.replace_normals_ = replace_normals;
    unifier.unify_positions();
    LUCARNE_TRY(unifier.unify_attributes());
    if (unifier.schema_.stride > format::kMaxStride / 2)
        return rejected(unifier.sources_[0]->info().path,
                        fmt::format("{} bytes a point are more than 32 KiB", unifier.schema_.stride));
    for (const auto* source : unifier.sources_)
        unifier.maps_.emplace_back(source->schema(), unifier.schema_, [&](const io::Attribute& attribute) {
            return stored_name(attribute, replace_normals);
        });
    return unifier;
}

uint64_t Unifier::declared_points() const {
    uint64_t points = 0;
    for (const io::PointSource* source : sources_) points += source->info().declared_points;
    return points;
}

bool Unifier::has_normals(size_t input) const {
    const auto* normal = sources_[input]->schema().find(io::names::normal);
    return normal && is_normal(*normal);
}

void Unifier::unify_positions() {
    const auto& first = sources_[0]->schema();
    schema_.position = first.position;
    schema_.scale = first.scale;
    schema_.offset = first.offset;
    for (const auto* source : sources_) {
        const auto& other = source->schema();
        const bool same = other.position == schema_.position &&
                          (other.position != io::PositionType::i32_scaled ||
                           (other.scale == schema_.scale && other.offset == schema_.offset));
        if (!same) schema_.position = io::PositionType::f64;
    }
    if (schema_.position != io::PositionType::i32_scaled)
        schema_.scale = glm::dvec3(1.0), schema_.offset = glm::dvec3(0.0);
    schema_.stride = static_cast<uint32_t>(io::position_bytes(schema_.position));
}

Result<void> Unifier::unify_attributes() {
    std::vector<io::Attribute> all;
    for (const auto* source : sources_)
        for (const auto& attribute : source->schema().attributes) {
            const std::string name = stored_name(attribute, replace_normals_);
            const auto known =
                std::find_if(all.begin(), all.end(), [&](const auto& a) { return a.name == name; });
            if (known == all.end()) {
                all.push_back({name, attribute.type, attribute.components, 0});
                continue;
            }
            const auto type = common_type(known->type, attribute.type);
            if (!type || known->components != attribute.components)
                return rejected(
                    source->info().path,
                    fmt::format("its attribute '{}' does not fit that of the other inputs", attribute.name),
                    "convert it on its own");
            known->type = *type;
        }
    for (const auto& a : all) schema_.add(a.name, a.type, a.components);
    if (inputs() > 1) {
        const bool few = inputs() <= kMostShortScans;
        schema_.add(std::string(io::names::scan), few ? ScalarType::u16 : ScalarType::u32);
    }
    return {};
}

std::span<const std::byte> Unifier::convert(size_t input, const io::PointBatch& batch,
                                            std::vector<std::byte>& storage) const {
    if (inputs() == 1 && maps_[input].identical())
        return std::span(batch.bytes).first(batch.count * schema_.stride);
    maps_[input].convert(batch.bytes.data(), batch.count, storage);
    if (inputs() > 1) {
        const ScanNumber scan(schema_);
        for (size_t i = 0; i < batch.count; ++i)
            scan.store(&storage[i * schema_.stride], static_cast<uint32_t>(input));
    }
    return storage;
}

}  // namespace lucarne::octree
