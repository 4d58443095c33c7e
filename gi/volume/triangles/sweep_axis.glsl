// What the two geometry shaders share: a sweep along one axis of the grid, which draws the triangles that project to
// their largest area along it (Gaitatzes 2012, chapter 6.4).
layout(triangles) in;

uniform int axis;         // of the sweep: 0 to 2
uniform vec3 grid_size;   // voxels, across and down the pictures and along the sweep
uniform int first_slice;  // of each triangle's own, what is drawn now: so many from this one on
uniform int slice_count;

in vec3 place[];
in vec3 albedo[];

out vec3 surface_albedo;
out float depth;  // along the sweep, in units of voxels
flat out vec3 surface_normal;
flat out float surface_area;  // of the surface behind a whole fragment, in voxel faces
flat out int slice;

// The axes across and down the pictures and along the sweep follow each other: x, y, z, x, ...
vec3 turned(vec3 p) { return axis == 0 ? p.yzx : axis == 1 ? p.zxy : p; }

// Returns twice the area of the triangle along its normal. Every sweep computes the same.
vec3 area_vector() {
    precise vec3 normal = cross(place[1] - place[0], place[2] - place[0]);
    return normal;
}
bool is_swept(vec3 normal) {
    vec3 n = abs(normal);
    int dominant = n.x >= n.y && n.x >= n.z ? 0 : n.y >= n.z ? 1 : 2;
    return dominant == axis && n[axis] > 0.0;  // false for what is not a number
}

int slice_of(float z) { return clamp(int(floor(z)), 0, int(grid_size.z) - 1); }

// Emits a corner at a turned place.
void emit(vec3 normal, vec3 at, vec3 colour, int layer) {
    surface_albedo = colour;
    depth = at.z;
    surface_normal = normalize(normal);
    surface_area = length(normal) / abs(normal[axis]);
    slice = layer;
    gl_Layer = layer;
    gl_Position = vec4(2.0 * at.xy / grid_size.xy - 1.0, 0.0, 1.0);
    EmitVertex();
}
