#include "io/formats/crs/registry.h"

#include <memory>
#include <string>

#include <proj.h>

namespace lucarne::io {
namespace {

struct Close {
    void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
    void operator()(PJ* object) const { proj_destroy(object); }
};
using Context = std::unique_ptr<PJ_CONTEXT, Close>;
using Object = std::unique_ptr<PJ, Close>;

Context make_context() {
    Context context(proj_context_create());
    proj_log_level(context.get(), PJ_LOG_NONE);  // errors are reported by the caller
    proj_context_set_enable_network(context.get(), 0);
    return context;
}

/// Returns the metres per unit of an axis; empty for angles and for axes that do not exist.
std::optional<double> axis_metres(const Context& context, const PJ* system, int axis) {
    const Object cs(proj_crs_get_coordinate_system(context.get(), system));
    double metres = 0;
    if (!cs || axis >= proj_cs_get_axis_count(context.get(), cs.get()) ||
        !proj_cs_get_axis_info(context.get(), cs.get(), axis, nullptr, nullptr, nullptr, &metres, nullptr,
                               nullptr, nullptr))
        return std::nullopt;
    return metres > 1e-9 && metres < 1e9 ? std::optional(metres) : std::nullopt;
}

/// Adds the units of a system and of its parts. Systems do not nest deeply.
void add_units(const Context& context, const PJ* system, SystemUnits& units, int depth = 0) {
    if (!system || depth > 4) return;
    switch (proj_get_type(system)) {
        case PJ_TYPE_COMPOUND_CRS:
            for (int part = 0; part < 2; ++part)
                add_units(context, Object(proj_crs_get_sub_crs(context.get(), system, part)).get(), units,
                          depth + 1);
            return;
        case PJ_TYPE_BOUND_CRS:
            return add_units(context, Object(proj_get_source_crs(context.get(), system)).get(), units,
                             depth + 1);
        case PJ_TYPE_GEOGRAPHIC_2D_CRS:
        case PJ_TYPE_GEOGRAPHIC_3D_CRS:
            units.degrees = true;
            units.vertical = axis_metres(context, system, 2);
            return;
        case PJ_TYPE_VERTICAL_CRS:
            units.vertical = axis_metres(context, system, 0);
            return;
        default:
            units.horizontal = axis_metres(context, system, 0);
            if (const auto height = axis_metres(context, system, 2)) units.vertical = height;
    }
}

std::optional<SystemUnits> units_of(const Context& context, const Object& system) {
    if (!system || !proj_is_crs(system.get())) return std::nullopt;
    SystemUnits units;
    add_units(context, system.get(), units);
    return units;
}

}  // namespace

std::optional<SystemUnits> registered_units(uint32_t epsg) {
    const Context context = make_context();
    const Object system(proj_create_from_database(context.get(), "EPSG", std::to_string(epsg).c_str(),
                                                  PJ_CATEGORY_CRS, 0, nullptr));
    return units_of(context, system);
}

std::optional<double> registered_unit(uint32_t epsg) {
    const Context context = make_context();
    const char* category = nullptr;
    double metres = 0;
    if (!proj_uom_get_info_from_database(context.get(), "EPSG", std::to_string(epsg).c_str(), nullptr,
                                         &metres, &category) ||
        std::string_view(category) != "linear" || !(metres > 0))
        return std::nullopt;
    return metres;
}

std::optional<SystemUnits> understood_units(std::string_view wkt) {
    const Context context = make_context();
    const Object system(
        proj_create_from_wkt(context.get(), std::string(wkt).c_str(), nullptr, nullptr, nullptr));
    return units_of(context, system);
}

}  // namespace lucarne::io
