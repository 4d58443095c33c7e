#include "io/formats/pcd/layout.h"

#include <algorithm>

#include <fmt/format.h>

#include "io/formats/common/text.h"

namespace lucarne::io::pcd {
namespace {

bool has_alpha(const Field& field) {
    return same_letters(field.name, "rgba");
}
bool is_packed_color(const Field& field) {
    return (same_letters(field.name, "rgb") || has_alpha(field)) && field.bytes() == 4 && field.count == 1;
}

/// Returns a property for each of a field's values; its name is empty if the value is left out.
std::vector<ply::Property> properties_of(const Field& field, bool packed) {
    std::vector<ply::Property> properties;
    if (packed)  // 0xAARRGGBB, little-endian
        for (const char* name : {"blue", "green", "red", has_alpha(field) ? "alpha" : ""})
            properties.push_back({name, ScalarType::u8, std::nullopt});
    else
        for (uint32_t i = 0; i < field.count; ++i)
            properties.push_back({field.name == "_"  ? ""
                                  : field.count == 1 ? field.name
                                                     : fmt::format("{}_{}", field.name, i),
                                  field.type, std::nullopt});
    return properties;
}

uint32_t place_of(const Schema& schema, const ply::Layout::Column& column) {
    const Attribute* attribute = schema.find(column.attribute);
    return attribute->offset + column.component * static_cast<uint32_t>(scalar_bytes(attribute->type));
}

text::Field text_field(const Schema& schema, const ply::Layout::Column& column) {
    text::Field field;
    field.name = column.property.name;
    field.type = column.property.type;
    if (field.name.empty()) return field;
    if (column.attribute.empty()) {
        field.kind = text::Field::Kind::position;
        field.to = column.component;
    } else {
        field.kind = text::Field::Kind::scalar;
        field.to = place_of(schema, column);
        if (column.attribute == names::color) field.type = schema.find(names::color)->type;
    }
    return field;
}

using Fields = std::vector<Field>;

ply::Layout binary_layout(const Fields& fields, Fields::const_iterator color) {
    std::vector<ply::Property> properties;
    for (auto field = fields.begin(); field != fields.end(); ++field)
        for (auto& property : properties_of(*field, field == color))
            properties.push_back(std::move(property));
    return ply::make_layout(properties, ply::Encoding::little_endian);
}

}  // namespace

Layout make_layout(const Header& header) {
    const Fields& fields = header.fields;
    // The first packed colour, unless other fields are the colour already.
    auto color = std::find_if(fields.begin(), fields.end(), is_packed_color);
    Layout layout{binary_layout(fields, color), {}};
    const auto& columns = layout.binary.columns;
    const auto is_color = [](const auto& c) {
        return c.property.name != "red" || c.attribute == names::color;
    };
    if (color != fields.end() && !std::all_of(columns.begin(), columns.end(), is_color)) {
        color = fields.end();
        layout.binary = binary_layout(fields, color);
    }
    layout.rows.schema = layout.binary.schema;
    auto column = columns.begin();
    for (auto field = fields.begin(); field != fields.end(); ++field) {
        if (field == color) {
            text::Field packed{text::Field::Kind::packed,
                               field->type,
                               place_of(layout.rows.schema, column[2]),
                               field->name,
                               {}};
            if (has_alpha(*field)) packed.alpha = place_of(layout.rows.schema, column[3]);
            layout.rows.fields.push_back(packed);
            column += 4;
        } else {
            for (uint32_t i = 0; i < field->count; ++i, ++column)
                layout.rows.fields.push_back(text_field(layout.rows.schema, *column));
        }
    }
    return layout;
}

}  // namespace lucarne::io::pcd
