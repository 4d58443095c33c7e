// Writes the attributes of a fragment, for sums over those of a voxel. Areas are those of the surface: a fragment is a
// voxel face, seen along the axis of the sweep. (The thesis takes the maximum, which is wrong for normals with signs.)
in vec3 surface_albedo;
in float depth;
flat in vec3 surface_normal;
flat in float surface_area;
flat in int slice;

uniform vec3 grid_size;

layout(location = 0) out float coverage;
#ifdef LUCARNE_ALBEDO
layout(location = 1) out vec4 albedo_sum;
#endif
#if defined(LUCARNE_ALBEDO) && defined(LUCARNE_NORMAL)
layout(location = 2) out vec4 normal_sum;
#elif defined(LUCARNE_NORMAL)
layout(location = 1) out vec4 normal_sum;
#endif

void main() {
#ifdef LUCARNE_DISCARD
    // Half open: what lies in the border of two slices belongs to one of them.
    if (clamp(int(floor(depth)), 0, int(grid_size.z) - 1) != slice) discard;
#endif
    coverage = surface_area;
#ifdef LUCARNE_ALBEDO
    albedo_sum = vec4(surface_albedo, 1.0) * surface_area;
#endif
#ifdef LUCARNE_NORMAL
    normal_sum = vec4(surface_normal, 1.0) * surface_area;
#endif
}
